//! Moves of all kinds: the trajectory as a whole, and the cabinet that gets them one after the other.

use depal_motion::{Speed, Trajectory};

use super::*;

const NEAR: Zone = Zone::Fly {
    tcp: 0.01,
    orientation: 0.026,
};

/// Joint and linear moves, zones, speeds and loads at random: all at once against one after the other.
#[test]
fn a_program_with_zones_takes_the_time_of_its_trajectory() {
    let mut random = RandomStreams::new(33).stream("executed");
    let flange_from_tcp = Pose::translation(0.0, 0.0, 0.3);
    let mut postures = vec![home()];
    postures.resize_with(200, || posture(&mut random));
    let mounted = Load::point(50.0, Point::new(0.0, 0.0, 0.15));
    let full = mounted.and(&load(40.0));
    let strong = Arc::new(arm());
    let weak = Arc::new(weak(&postures, &full, 0.25));
    let (mut limited, mut heavier) = (0, 0);
    for round in 0..24 {
        let arm = if round % 2 == 0 { &strong } else { &weak };
        let mut moves = Vec::new();
        let mut here = home();
        while moves.len() < 8 {
            let linear = random.uniform(0.0, 1.0) < 0.5;
            let target = if linear {
                let mut to = arm.base_from_flange(&here) * flange_from_tcp;
                for axis in 0..3 {
                    to.translation.vector[axis] += random.uniform(-0.3, 0.3);
                }
                SegmentTarget::Tcp(to)
            } else {
                SegmentTarget::Joints(here.lerp(&posture(&mut random), 0.4))
            };
            let last = moves.len() == 7;
            let zone = match random.uniform(0.0, 3.0) as usize {
                _ if last => Zone::Fine,
                0 => NEAR,
                _ => Zone::Fly {
                    tcp: random.uniform(0.01, 0.2),
                    orientation: random.uniform(0.02, 0.3),
                },
            };
            let segment = Segment {
                interpolation: if linear {
                    Interpolation::Linear
                } else {
                    Interpolation::Joint
                },
                target,
                flange_from_tcp,
                speed: Speed {
                    tcp: random.uniform(0.5, 5.0),
                    orientation: 8.0,
                    joint_fraction: random.uniform(0.5, 1.0),
                    acceleration_fraction: random.uniform(0.8, 1.0),
                },
                zone,
                quarters: None,
            };
            // What cannot be reached or held is drawn again.
            let mut probe = Trajectory::new(Arc::clone(&weak), here);
            probe.set_tool_and_load(&mounted, &load(40.0));
            if probe.append(0.0, &segment).is_ok() {
                here = probe.end_joints();
                let mass = if moves.len() < 3 { 0.0 } else { 40.0 };
                moves.push(Driven {
                    segment,
                    carried: (mass, load(40.0).centre),
                });
            }
        }
        let predicted = |arm: &Arc<Arm>, factor: f64| {
            let mut t = Trajectory::new(Arc::clone(arm), home());
            for driven in &moves {
                let (mass, centre) = driven.carried;
                t.set_tool_and_load(&mounted, &Load::point(mass * factor, centre));
                t.append(0.0, &driven.segment).unwrap();
            }
            assert!(t.corner_failures().is_empty());
            t.duration()
        };
        let said = predicted(arm, 1.0);
        let time = executed(arm, home(), mounted, &moves);
        assert!(
            (said - time).abs() < 0.01 * time,
            "round {round}: said {said} s, took {time} s"
        );
        if round % 2 == 1 {
            limited += usize::from(predicted(&strong, 1.0) < 0.99 * time);
            heavier += usize::from(predicted(&weak, 0.05) < 0.995 * time);
        }
    }
    assert!(limited >= 6, "torques count in {limited} of 12");
    assert!(heavier >= 4, "the load counts in {heavier} of 12");
}
