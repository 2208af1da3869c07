//! Cells in which lift, turn and lower do not do, drawn from a seed.

#![allow(dead_code)]

use depal_frames::{JointPositions, PlacedShape, Pose, Rotation, Vector};
use depal_planner::TransferScene;
use depal_time::{RandomStream, RandomStreams};

use super::{
    cell::{cuboid, goal, obstacles, scene, transfers},
    oracle::Oracle,
};

pub const KINDS: [&str; 7] = [
    "low beam",
    "post in the sweep of joint 1",
    "rack on two sides",
    "roll cage",
    "wall behind",
    "tall neighbour",
    "narrow aisle",
];

/// Room that both ends of a question have, m.
const ROOM: f64 = 0.004;

pub struct Question {
    pub name: String,
    pub scene: TransferScene,
    pub start: JointPositions,
    pub goal: JointPositions,
}

/// `count` questions of every kind. Each end is free by the oracle; the fixed template (drawn in, turned, out again) is not,
/// nor is the straight move.
pub fn questions(seed: u64, count: usize) -> Vec<Question> {
    let mut random = RandomStreams::new(seed).stream("hard cells");
    let all = transfers();
    let mut found = Vec::new();
    for kind in KINDS {
        let mut kept = 0;
        let mut tries = 0;
        while kept < count {
            tries += 1;
            assert!(tries < 400 * count, "{kind}: hardly any such cell is hard");
            let pick = (random.uniform(0.0, all.len() as f64) as usize).min(all.len() - 1);
            let (transfer, layers, slot, start) = &all[pick];
            let mut solids = obstacles(*layers, *slot);
            solids.extend(hardship(kind, &mut random));
            let scene = scene(solids);
            let oracle = Oracle::new(&scene, ROOM);
            let (mut from, mut to) = (*start, goal());
            if random.uniform(0.0, 1.0) < 0.5 {
                (from, to) = (to, from);
            }
            if oracle.touch(&from).is_some() || oracle.touch(&to).is_some() {
                continue;
            }
            let bare = Oracle::new(&scene, 0.0);
            if bare.touch_on_polyline(&[from, to]).is_none()
                || bare.touch_on_polyline(&template(&from, &to)).is_none()
            {
                continue;
            }
            kept += 1;
            found.push(Question {
                name: format!("{kind} {kept} ({transfer})"),
                scene,
                start: from,
                goal: to,
            });
        }
    }
    found
}

/// Questions without an answer, though both ends are free: plates from the arm's foot outwards on both sides, and a ceiling
/// too low for the arm to stand upright between them. Wherever joint 1 passes the plates, the arm is longer than the gap.
pub fn unsolvable(seed: u64, count: usize) -> Vec<Question> {
    let mut random = RandomStreams::new(seed).stream("unsolvable cells");
    let all = transfers();
    let mut found = Vec::new();
    for _ in 0..400 * count {
        if found.len() == count {
            return found;
        }
        let pick = (random.uniform(0.0, all.len() as f64) as usize).min(all.len() - 1);
        let (transfer, layers, slot, start) = &all[pick];
        let mut solids = obstacles(*layers, *slot);
        let bearing = random.uniform(0.65, 0.95);
        let (thick, ceiling) = (random.uniform(0.02, 0.08), random.uniform(2.85, 2.95));
        for side in [0.0, std::f64::consts::PI] {
            let turn = Rotation::from_axis_angle(&Vector::z_axis(), bearing + side);
            let at = turn * Vector::new(0.55 + 1.75, 0.0, 1.5);
            let pose = Pose::from_parts(at.into(), turn);
            solids.push(PlacedShape::cuboid(pose, Vector::new(3.5, thick, 3.0)));
        }
        solids.push(cuboid([0.0, 0.0, ceiling + 0.05], [8.0, 8.0, 0.1]));
        let scene = scene(solids);
        let oracle = Oracle::new(&scene, ROOM);
        if oracle.touch(start).is_some() || oracle.touch(&goal()).is_some() {
            continue;
        }
        found.push(Question {
            name: format!("closed {} ({transfer})", found.len()),
            scene,
            start: *start,
            goal: goal(),
        });
    }
    panic!(
        "{} of {count} closed cells leave both ends free",
        found.len()
    );
}

/// Drawn in, turned, out again; the tool keeps its lean.
pub fn template(from: &JointPositions, to: &JointPositions) -> Vec<JointPositions> {
    let drawn_in = |at: &JointPositions| {
        let mut via = *at;
        (via[1], via[2]) = (-0.2, -0.2);
        via[4] += at[1] + at[2] + 0.4;
        via
    };
    vec![*from, drawn_in(from), drawn_in(to), *to]
}

fn hardship(kind: &str, random: &mut RandomStream) -> Vec<PlacedShape> {
    let mut r = |low: f64, high: f64| random.uniform(low, high);
    match kind {
        "low beam" => {
            let (x, z) = (r(0.5, 1.3), r(2.0, 2.6));
            vec![cuboid([x, r(0.3, 1.0), z], [0.2, 2.6, 0.3])]
        }
        "post in the sweep of joint 1" => {
            let (bearing, away) = (r(0.4, 1.2), r(1.15, 1.9));
            let (x, y) = (away * bearing.cos(), away * bearing.sin());
            let height = r(1.4, 3.2);
            let side = r(0.06, 0.16);
            vec![cuboid([x, y, height * 0.5], [side, side, height])]
        }
        "rack on two sides" => {
            let (y, x) = (r(0.62, 0.9), r(2.42, 2.7));
            let height = r(1.6, 2.6);
            let shelf = r(1.9, 2.4);
            vec![
                cuboid([1.75, -y, height * 0.5], [1.4, 0.06, height]),
                cuboid([1.75, y, height * 0.5], [1.4, 0.06, height]),
                cuboid([x, 0.0, height * 0.5], [0.06, 1.4, height]),
                cuboid([2.0, 0.0, shelf], [0.8, 1.6, 0.05]),
            ]
        }
        "roll cage" => {
            let (y, x) = (r(0.58, 0.7), r(2.36, 2.5));
            let height = r(1.5, 2.2);
            let beam = r(2.0, 2.6);
            vec![
                cuboid([1.75, y, height * 0.5 + 0.1], [1.25, 0.04, height]),
                cuboid([1.75, -y, height * 0.5 + 0.1], [1.25, 0.04, height]),
                cuboid([x, 0.0, height * 0.5 + 0.1], [0.04, 1.25, height]),
                cuboid([r(0.5, 0.9), 0.9, beam], [0.12, 1.8, 0.12]),
            ]
        }
        "wall behind" => {
            let (behind, height) = (r(0.62, 0.95), r(2.0, 3.2));
            let side = r(0.9, 1.2);
            let lintel = r(1.9, 2.5);
            vec![
                cuboid([-behind - 0.1, 0.0, height * 0.5], [0.2, 6.0, height]),
                cuboid([0.3, -side - 0.1, height * 0.5], [2.0, 0.2, height]),
                cuboid([0.9, 0.8, lintel], [0.15, 1.2, 0.2]),
            ]
        }
        "tall neighbour" => {
            let (x, y) = (r(1.0, 1.7), r(0.75, 1.1));
            let height = r(1.6, 2.6);
            let side = r(0.3, 0.6);
            vec![
                cuboid([x, y, height * 0.5], [side, side * 0.5, height]),
                cuboid([1.2, -0.9, height * 0.5], [0.6, 0.4, height]),
            ]
        }
        "narrow aisle" => {
            let (behind, side) = (r(0.6, 0.9), r(1.0, 1.3));
            let ceiling = r(2.5, 2.9);
            vec![
                cuboid([-behind - 0.1, 0.0, 1.5], [0.2, 4.0, 3.0]),
                cuboid([0.4, -side - 0.1, 1.5], [2.4, 0.2, 3.0]),
                cuboid([0.2, r(2.35, 2.5), 1.5], [2.4, 0.2, 3.0]),
                cuboid([0.8, 0.8, ceiling], [2.4, 2.4, 0.1]),
            ]
        }
        other => panic!("no such hardship: {other}"),
    }
}
