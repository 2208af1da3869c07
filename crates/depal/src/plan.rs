//! `depal plan`: ways from posture to posture among boxes, from a JSON file to JSON or a table.

use std::path::Path;

use depal_arm::Arm;
use depal_frames::{JointPositions, MAX_JOINTS, PlacedShape, Pose, Rotation, Vector};
use depal_planner::{TransferGoal, TransferScene, plan_transfer};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::failure::Failure;

/// Acceleration limits that are left out: full speed in this time, s.
const RAMP_S: f64 = 0.5;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Cuboid {
    center: [f64; 3],
    size: [f64; 3],
    quat_wxyz: Option<[f64; 4]>,
    link: Option<String>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Goal {
    Joints(Vec<f64>),
    Tcp {
        tcp_xyz: [f64; 3],
        tcp_quat_wxyz: [f64; 4],
    },
}

#[derive(Deserialize)]
struct Problem {
    id: Value,
    start: Vec<f64>,
    goal: Goal,
}

#[derive(Deserialize)]
struct File {
    robot: String,
    tcp_link: Option<String>,
    #[serde(default)]
    attached: Vec<Cuboid>,
    #[serde(default)]
    obstacles: Vec<Cuboid>,
    velocity_limits: Option<Vec<f64>>,
    acceleration_limits: Option<Vec<f64>>,
    #[serde(default)]
    allowed_pairs: Vec<(String, String)>,
    problems: Vec<Problem>,
}

/// Plans every problem of the file; fails with exit code 1 when one of them is unsolved.
pub fn plan(path: &Path, as_json: bool) -> Result<(), Failure> {
    let text = read(path)?;
    let file: File = serde_json::from_str(&text)
        .map_err(|error| Failure::Input(format!("{}: {error}", path.display())))?;
    let scene = scene(path, &file)?;
    let mut results = Vec::new();
    let mut all_solved = true;
    for problem in &file.problems {
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

fn read(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path)
        .map_err(|error| Failure::Input(format!("cannot read {}: {error}", path.display())))
}

fn scene(path: &Path, file: &File) -> Result<TransferScene, Failure> {
    let input = |message: String| Failure::Input(format!("{}: {message}", path.display()));
    let robot = path.parent().unwrap_or(Path::new("")).join(&file.robot);
    let name = robot.to_string_lossy();
    let arm = Arm::from_urdf_uniform(&read(&robot)?, &name, 1.0)
        .map_err(|error| Failure::Input(error.to_string()))?;
    for warning in arm.warnings() {
        tell!("warning: {name}: {warning}");
    }
    let speeds = match &file.velocity_limits {
        Some(limits) => limits.clone(),
        None => arm.limits().iter().map(|l| l.max_speed).collect(),
    };
    let accelerations = if let Some(limits) = &file.acceleration_limits {
        limits.clone()
    } else {
        tell!(
            "warning: {}: no acceleration_limits; full speed is taken to need {RAMP_S} s",
            path.display()
        );
        speeds.iter().map(|v| v / RAMP_S).collect()
    };
    let arm = arm
        .with_rates(&speeds, &accelerations)
        .map_err(|error| input(format!("velocity_limits, acceleration_limits: {error}")))?;
    let link = |name: &str| {
        let known = arm.links().iter().position(|l| l.name == name);
        known.ok_or_else(|| input(format!("the robot has no link '{name}'")))
    };
    let tcp_link = file.tcp_link.as_deref().map(link).transpose()?;
    let mut attached = Vec::new();
    for (i, cuboid) in file.attached.iter().enumerate() {
        let on = match (&cuboid.link, tcp_link) {
            (Some(name), _) => link(name)?,
            (None, Some(tcp)) => tcp,
            (None, None) => return Err(input(format!("attached[{i}] has no link"))),
        };
        let placed = placed(cuboid).map_err(|e| input(format!("attached[{i}]: {e}")))?;
        attached.push((on, placed));
    }
    let mut obstacles = Vec::new();
    for (i, cuboid) in file.obstacles.iter().enumerate() {
        obstacles.push(placed(cuboid).map_err(|e| input(format!("obstacles[{i}]: {e}")))?);
    }
    for name in file.allowed_pairs.iter().flat_map(|(a, b)| [a, b]) {
        if link(name).is_err() {
            tell!(
                "warning: {}: allowed_pairs: no link '{name}'",
                path.display()
            );
        }
    }
    Ok(TransferScene {
        arm,
        attached,
        obstacles,
        allowed_pairs: file.allowed_pairs.clone(),
        tcp_link,
    })
}

fn placed(cuboid: &Cuboid) -> Result<PlacedShape, String> {
    if let Some(side) = cuboid.size.iter().find(|s| **s <= 0.0) {
        return Err(format!("size {side} m, expected a positive length"));
    }
    let pose = pose(
        cuboid.center,
        cuboid.quat_wxyz.unwrap_or([1.0, 0.0, 0.0, 0.0]),
    )?;
    Ok(PlacedShape::cuboid(pose, Vector::from(cuboid.size)))
}

fn pose(xyz: [f64; 3], [w, i, j, k]: [f64; 4]) -> Result<Pose, String> {
    let quaternion = depal_frames::nalgebra::Quaternion::new(w, i, j, k);
    if (quaternion.norm() - 1.0).abs() > 1e-2 {
        return Err(format!(
            "quaternion of length {}, expected 1",
            quaternion.norm()
        ));
    }
    Ok(Pose::from_parts(
        Vector::from(xyz).into(),
        Rotation::from_quaternion(quaternion),
    ))
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
        Goal::Tcp {
            tcp_xyz,
            tcp_quat_wxyz,
        } => match pose(*tcp_xyz, *tcp_quat_wxyz) {
            Ok(pose) => TransferGoal::Tcp(pose),
            Err(reason) => return unsolved(format!("goal: {reason}"), 0.0, None),
        },
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
