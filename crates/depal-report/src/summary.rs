use std::fmt::Write as _;

use crate::report::Report;

/// What to try next, by the reason of a failed pick.
const ADVICE: &[(&str, &str)] = &[
    (
        "no_detection",
        "nothing was seen: look at the depth picture of the replay, camera.xyz_mm, cartons.size_mm and camera.blackout",
    ),
    (
        "wrong_box",
        "a carton below another was picked: look at the estimates in the replay",
    ),
    (
        "pose_error",
        "the estimate was off: lower camera.noise_mm, or look at the points in the replay",
    ),
    (
        "ik_unreachable",
        "move the pallet or the conveyor closer to the arm",
    ),
    (
        "plan_collision",
        "no free path: lower planner.clearance_mm, or raise planner.lift_mm",
    ),
    (
        "no_seal",
        "the vacuum switch never closed: raise gripper.vacuum_kpa, or look at gripper.section",
    ),
    (
        "seal_lost",
        "the load beat the vacuum: raise gripper.vacuum_kpa or planner.suction_safety",
    ),
    (
        "dropped",
        "cartons fell: raise gripper.vacuum_kpa, or compare cartons.mass_kg with planner.assumed_mass_kg",
    ),
    (
        "collision",
        "the arm hit something: replay the run at the first failure",
    ),
    (
        "neighbour_moved",
        "neighbours were dragged along: widen randomize.gap_mm, or lower cartons.friction",
    ),
    (
        "place_missed",
        "a carton did not end on the belt: look at conveyor.place_xyz_mm",
    ),
    (
        "protocol_error",
        "robot and server did not understand each other: compare interface.encoding with the program",
    ),
    (
        "program_error",
        "the robot program stopped: depal check shows what is wrong with it",
    ),
    ("timeout", "the run was too slow: raise run.max_sim_s"),
];

/// Status codes by which the server says that a result came too late: of vision, and of the planning project.
const LATE: [u32; 2] = [1019, 2025];
const LATE_ADVICE: &str =
    "a result came too late for the server: raise interface.timeout_s, or lower the latencies";

/// A page for people: the verdict first, then the figures, then why picks failed and what to try.
pub fn summary(report: &Report) -> String {
    let mut page = String::new();
    let missed: Vec<_> = report
        .accept
        .checks
        .iter()
        .filter(|check| !check.passed)
        .collect();
    let verdict = match (report.accept.passed, report.accept.checks.len()) {
        (true, 0) => "ACCEPTED (the scene sets no thresholds)".to_owned(),
        (true, count) => format!("ACCEPTED ({count} of {count} thresholds kept)"),
        (false, count) => format!(
            "NOT ACCEPTED ({} of {count} thresholds missed)",
            missed.len()
        ),
    };
    line(
        &mut page,
        format_args!("{verdict}: scene {}, seed {}", report.scene, report.seed),
    );
    for check in &missed {
        let side = if check.name.ends_with("_max") {
            "at most"
        } else {
            "at least"
        };
        line(
            &mut page,
            format_args!(
                "  missed      {} {side} {}, reached {}",
                check.name,
                check.limit,
                reached(check.value)
            ),
        );
    }
    let boxes = &report.boxes;
    line(
        &mut page,
        format_args!(
            "  cartons     {} of {} delivered, {} dropped, {} left",
            boxes.delivered, boxes.total, boxes.dropped, boxes.left
        ),
    );
    let picks = &report.picks;
    line(
        &mut page,
        format_args!(
            "  picks       {} of {} succeeded, {} failed",
            picks.succeeded, picks.attempted, picks.failed
        ),
    );
    let mut reasons: Vec<(&String, &u64)> = picks.by_reason.iter().collect();
    reasons.sort_by(|a, b| b.1.cmp(a.1).then(a.0.cmp(b.0)));
    for (reason, count) in &reasons {
        line(&mut page, format_args!("    {count:>4} x    {reason}"));
    }
    line(
        &mut page,
        format_args!(
            "  rate        {} cartons/h; cycle mean {} s, p50 {} s, p95 {} s",
            figure(report.boxes_per_hour, 0),
            figure(report.cycle_s.mean, 2),
            figure(report.cycle_s.p50, 2),
            figure(report.cycle_s.p95, 2)
        ),
    );
    let vision = &report.vision;
    line(
        &mut page,
        format_args!(
            "  vision      {} frames, recall {}, {} false; p50 {} ms",
            vision.frames,
            figure(vision.recall, 3),
            vision.false_picks,
            figure(vision.time_ms.p50, 1)
        ),
    );
    line(
        &mut page,
        format_args!(
            "  pose error  p95 {} mm and {} deg, largest {} mm and {} deg",
            figure(vision.pose_err_mm.p95, 2),
            figure(vision.pose_err_deg.p95, 2),
            figure(vision.pose_err_mm.max, 2),
            figure(vision.pose_err_deg.max, 2)
        ),
    );
    line(
        &mut page,
        format_args!(
            "  planning    {} calls, p50 {} ms, p95 {} ms, smallest clearance {} mm",
            report.planning.calls,
            figure(report.planning.time_ms.p50, 1),
            figure(report.planning.time_ms.p95, 1),
            figure(report.planning.min_clearance_mm, 1)
        ),
    );
    line(
        &mut page,
        format_args!(
            "  interface   commands {}; statuses {}",
            counts(&report.interface.commands),
            counts(&report.interface.statuses)
        ),
    );
    line(
        &mut page,
        format_args!(
            "  time        {:.1} s simulated in {:.1} s, {} x real time",
            report.sim_time_s,
            report.wall_time_s,
            figure(report.real_time_factor, 1)
        ),
    );
    line(
        &mut page,
        format_args!("  state       {}", report.state_hash),
    );
    if !report.ended_because.is_empty() {
        line(
            &mut page,
            format_args!("  ended       {}", report.ended_because),
        );
    }
    if !report.faults.is_empty() {
        line(
            &mut page,
            format_args!("  faults      {}, as injected", report.faults.join("; ")),
        );
    }
    if !report.accept.passed {
        for advice in advices(report, &reasons) {
            line(&mut page, format_args!("  try         {advice}"));
        }
    }
    page
}

fn advices(report: &Report, reasons: &[(&String, &u64)]) -> Vec<&'static str> {
    if !report.faults.is_empty() {
        return vec!["without the injected faults: what went wrong may be their doing"];
    }
    let is_late = LATE
        .iter()
        .any(|status| report.interface.statuses.contains_key(status));
    let advice_for = |wanted: &str| {
        if wanted == "timeout" && is_late {
            return Some(LATE_ADVICE);
        }
        let row = ADVICE.iter().find(|(reason, _)| *reason == wanted);
        row.map(|(_, advice)| *advice)
    };
    let mut advices: Vec<&str> = reasons
        .iter()
        .filter_map(|(reason, _)| advice_for(reason))
        .take(2)
        .collect();
    if advices.is_empty() && report.picks.attempted == 0 {
        advices.extend(if report.vision.frames == 0 {
            advice_for("protocol_error")
        } else {
            advice_for("no_detection")
        });
    }
    if advices.is_empty() {
        advices.push("replay the run and look at the first failure marker");
    }
    advices
}

fn line(page: &mut String, text: std::fmt::Arguments<'_>) {
    writeln!(page, "{text}").expect("writing to a String does not fail");
}

/// A figure with some decimals, or a dash.
fn figure(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.decimals$}"))
}

/// A reached value like a threshold is written: no decimals that say nothing.
fn reached(value: Option<f64>) -> String {
    value.map_or_else(
        || "nothing measured".to_owned(),
        |value| ((value * 1000.0).round() / 1000.0).to_string(),
    )
}

fn counts(counts: &std::collections::BTreeMap<u32, u64>) -> String {
    if counts.is_empty() {
        return "none".to_owned();
    }
    let items: Vec<String> = counts
        .iter()
        .map(|(number, count)| format!("{number} x{count}"))
        .collect();
    items.join(", ")
}
