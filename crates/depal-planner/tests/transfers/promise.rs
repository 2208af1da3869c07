//! What is said of a plan is true of the very path it promises.

use depal_arm::Arm;
use depal_frames::{ConvexHull, JointPositions, PlacedShape, Point, Shape};
use depal_planner::{TransferChecker, TransferGoal, TransferPlan, TransferScene, plan_transfer};
use depal_time::{RandomStream, RandomStreams};

use super::{
    cell::{cuboid, furniture, scene},
    oracle::{Oracle, fastest, stretches},
};

fn blocks(random: &mut RandomStream) -> Vec<PlacedShape> {
    let mut solids = furniture();
    for _ in 0..6 {
        let mut r = |low: f64, high: f64| random.uniform(low, high);
        let centre = [r(-1.5, 2.5), r(-2.0, 2.0), r(0.2, 2.4)];
        solids.push(cuboid(centre, [r(0.1, 0.5), r(0.1, 0.5), r(0.1, 0.5)]));
    }
    solids
}

/// Random cells and random ends, so that wrists turn and the arm folds.
fn plans(count: usize) -> Vec<(TransferScene, TransferPlan)> {
    let mut random = RandomStreams::new(11).stream("promises");
    let mut found = Vec::new();
    while found.len() < count {
        let request = scene(blocks(&mut random));
        let oracle = Oracle::new(&request, 0.01);
        let mut posture = || {
            for _ in 0..200 {
                let mut joints = JointPositions::zeros(6);
                for (q, limit) in joints.iter_mut().zip(request.arm.limits()) {
                    *q = random.uniform(limit.lower.max(-2.5), limit.upper.min(2.5));
                }
                if oracle.touch(&joints).is_none() {
                    return Some(joints);
                }
            }
            None
        };
        let (Some(start), Some(goal)) = (posture(), posture()) else {
            continue;
        };
        if let Ok(plan) = plan_transfer(&request, &start, &TransferGoal::Joints(goal)) {
            assert_eq!(plan.waypoints[0].joints, start);
            assert_eq!(plan.waypoints[plan.waypoints.len() - 1].joints, goal);
            found.push((request, plan));
        }
    }
    found
}

#[test]
fn a_blended_way_stays_clear_and_takes_the_time_that_is_said() {
    let mut blended = 0;
    for (request, plan) in plans(40) {
        Oracle::new(&request, 0.0).check(&plan).unwrap();
        let time = fastest(&plan, request.arm.limits());
        assert!(
            (plan.motion_time - time).abs() < 0.01 * time,
            "said {} s, is {time} s",
            plan.motion_time
        );
        assert!(plan.motion_time >= plan.lower_bound * (1.0 - 1e-9));
        blended += usize::from(plan.waypoints.iter().any(|w| w.blend > 0.0));
    }
    assert!(blended >= 10, "only {blended} ways have corners");
}

/// The least clearance is that of the worst state, within a millimetre and a hundredth.
#[test]
fn the_clearance_that_is_said_is_met_and_not_undercut() {
    for (request, plan) in plans(12) {
        let oracle = Oracle::new(&request, 0.0);
        let mut least = f64::INFINITY;
        for state in samples(&plan, 0.01) {
            least = least.min(oracle.clearance(&state));
        }
        let said = plan.min_clearance;
        assert!(
            (said - least).abs() < 1e-3 + 0.01 * least,
            "said {said} m, is {least} m"
        );
    }
}

fn samples(plan: &TransferPlan, step: f64) -> Vec<JointPositions> {
    stretches(plan)
        .iter()
        .flat_map(|s| s.samples(step))
        .map(|q| JointPositions::from_slice(&q))
        .collect()
}

/// The same box as a hull.
fn as_hull(placed: &PlacedShape) -> PlacedShape {
    let Shape::Cuboid { half_extents: half } = &placed.shape else {
        panic!("a box is expected, found {placed:?}");
    };
    let corners = (0..8).map(|k| {
        let side = |i: usize| if k >> i & 1 == 0 { -half[i] } else { half[i] };
        Point::new(side(0), side(1), side(2))
    });
    // Four corners of each face, as two triangles.
    let quads: [[u32; 4]; 6] = [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ];
    let triangles = quads
        .iter()
        .flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]])
        .collect();
    PlacedShape {
        pose: placed.pose,
        shape: Shape::hull(ConvexHull::new(corners.collect(), triangles)),
    }
}

/// Hulls and boxes of the same form mean the same: free, touching, how near.
#[test]
fn hulls_are_as_solid_as_boxes() {
    for (request, plan) in plans(6) {
        let mut hulls = request.clone();
        for (_, shape) in &mut hulls.attached {
            *shape = as_hull(shape);
        }
        hulls.obstacles = hulls.obstacles.iter().map(as_hull).collect();
        let oracle = Oracle::new(&request, 0.0);
        let (boxed, hulled) = (TransferChecker::new(&request), TransferChecker::new(&hulls));
        for state in samples(&plan, 0.05) {
            assert!(hulled.is_free(&state));
            let exact = oracle.clearance(&state);
            let (a, b) = (boxed.clearance(&state), hulled.clearance(&state));
            assert!(
                (a - exact).abs() < 1e-4 + 0.01 * a && (b - exact).abs() < 1e-4 + 0.01 * a,
                "{exact} m, as boxes {a} m, as hulls {b} m"
            );
        }
        let last = plan.waypoints.len() - 1;
        let [start, goal] = [0, last].map(|i| plan.waypoints[i].joints);
        let found = plan_transfer(&hulls, &start, &TransferGoal::Joints(goal)).unwrap();
        Oracle::new(&request, 0.0).check(&found).unwrap();
    }
}

/// Four axes with mimics: found, free by the checker at fine steps, in the time that is said.
#[test]
fn a_palletizer_finds_its_way() {
    for urdf in [
        include_str!("../../../../urdf/abb_irb660.urdf"),
        include_str!("../../../../urdf/kuka_kr120_r3200_pa.urdf"),
    ] {
        let arm = Arm::from_urdf(urdf, "own", &[3.0, 3.0, 3.0, 8.0]).unwrap();
        let names: Vec<String> = arm.links().iter().map(|l| l.name.clone()).collect();
        let mut random = RandomStreams::new(12).stream("palletizer");
        let mut solved = 0;
        for _ in 0..12 {
            let mut request = TransferScene {
                arm: arm.clone(),
                attached: vec![(names.len() - 1, cuboid([0.0, 0.0, 0.25], [0.4, 0.3, 0.3]))],
                load: depal_arm::Load::NONE,
                obstacles: blocks(&mut random),
                allowed_pairs: Vec::new(),
                tcp_link: None,
            };
            // All links are neighbours here: the obstacles are what counts.
            for (i, a) in names.iter().enumerate() {
                let others = names[i + 1..].iter().map(|b| (a.clone(), b.clone()));
                request.allowed_pairs.extend(others);
            }
            let checker = TransferChecker::new(&request);
            let mut posture = || {
                (0..500).find_map(|_| {
                    let mut joints = JointPositions::zeros(4);
                    for (q, limit) in joints.iter_mut().zip(arm.limits()) {
                        *q = random.uniform(limit.lower, limit.upper);
                    }
                    (checker.clearance(&joints) > 0.01).then_some(joints)
                })
            };
            let (Some(start), Some(goal)) = (posture(), posture()) else {
                continue;
            };
            let Ok(plan) = plan_transfer(&request, &start, &TransferGoal::Joints(goal)) else {
                continue;
            };
            solved += 1;
            for state in samples(&plan, 0.002) {
                assert!(checker.is_free(&state), "{:?}", checker.touch(&state));
            }
            let time = fastest(&plan, arm.limits());
            assert!((plan.motion_time - time).abs() < 0.01 * time);
        }
        assert!(solved >= 8, "{}: {solved} of 12", arm.name());
    }
}
