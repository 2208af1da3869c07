//! `depal plan`: ways from posture to posture among boxes, from a JSON file to JSON or a table.

mod question;

use std::path::Path;

use depal_frames::{JointPositions, MAX_JOINTS};
use depal_planner::{TransferGoal, TransferScene, plan_transfer};
use serde_json::{Value, json};

use self::question::{Goal, Problem};
use crate::failure::Failure;

/// Plans every problem of the file; fails with exit code 1 when one of them is unsolved.
pub fn plan(path: &Path, as_json: bool) -> Result<(), Failure> {
    let (scene, problems) = question::read(path)?;
    let mut results = Vec::new();
    let mut all_solved = true;
    for problem in &problems {
        let result = solve(&scene, problem);
        all_solved &= result["solved"] == true;
        if !as_json {
            print_row(&result);
        }
        results.push(result);
    }
    if as_json {
        say!("{}", json!({ "results": results }));
    }
    if all_solved {
        Ok(())
    } else {
        Err(Failure::NotAccepted)
    }
}

fn solve(scene: &TransferScene, problem: &Problem) -> Value {
    let joints = |values: &[f64]| {
        let fits = values.len() == scene.arm.joint_count() && values.len() <= MAX_JOINTS;
        fits.then(|| JointPositions::from_slice(values))
    };
    let unsolved = |reason: String, plan_ms: f64, bound: Option<f64>| {
        json!({
            "id": problem.id, "solved": false, "reason": reason, "waypoints": [], "plan_ms": plan_ms,
            "motion_s": null, "lower_bound_s": bound, "min_clearance_mm": null,
        })
    };
    let Some(start) = joints(&problem.start) else {
        let (found, expected) = (problem.start.len(), scene.arm.joint_count());
        return unsolved(
            format!("start has {found} joints, the arm has {expected}"),
            0.0,
            None,
        );
    };
    let goal = match &problem.goal {
        Goal::Joints(values) => {
            if let Some(goal) = joints(values) {
                TransferGoal::Joints(goal)
            } else {
                let (found, expected) = (values.len(), scene.arm.joint_count());
                return unsolved(
                    format!("goal has {found} joints, the arm has {expected}"),
                    0.0,
                    None,
                );
            }
        }
        Goal::Tcp(pose) => TransferGoal::Tcp(*pose),
    };
    // Shown only: no decision hangs on it.
    #[allow(clippy::disallowed_methods)]
    let before = std::time::Instant::now();
    let outcome = plan_transfer(scene, &start, &goal);
    let plan_ms = before.elapsed().as_secs_f64() * 1e3;
    match outcome {
        Err(refusal) => unsolved(refusal.reason, plan_ms, refusal.lower_bound),
        Ok(plan) => {
            let waypoints: Vec<Value> = plan
                .waypoints
                .iter()
                .map(|w| json!({"joints": w.joints.to_vec(), "motion": "joint", "blend": w.blend}))
                .collect();
            json!({
                "id": problem.id, "solved": true, "reason": plan.found_by, "waypoints": waypoints,
                "plan_ms": plan_ms, "motion_s": plan.motion_time, "lower_bound_s": plan.lower_bound,
                "min_clearance_mm": plan.min_clearance * 1e3,
            })
        }
    }
}

fn print_row(result: &Value) {
    let id = match &result["id"] {
        Value::String(id) => id.clone(),
        other => other.to_string(),
    };
    let figure = |key: &str| result[key].as_f64().unwrap_or(f64::NAN);
    let reason = result["reason"].as_str().unwrap_or("");
    if result["solved"] == true {
        say!(
            "{id}: {:.3} s in {} waypoints, bound {:.3} s, clearance {:.1} mm, planned in {:.1} ms ({reason})",
            figure("motion_s"),
            result["waypoints"].as_array().map_or(0, Vec::len),
            figure("lower_bound_s"),
            figure("min_clearance_mm"),
            figure("plan_ms"),
        );
    } else {
        say!("{id}: no way: {reason} ({:.1} ms)", figure("plan_ms"));
    }
}
