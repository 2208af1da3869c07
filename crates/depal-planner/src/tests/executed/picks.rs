//! Picks: what is said, and what a cabinet takes for the moves of the shipped programs.

use depal_motion::MotionError;

use super::*;
use crate::RejectReason;
use crate::timing::{as_driven, loads};

/// Picks driven in the manner of the shipped programs, with and without torque limits.
#[test]
fn a_pick_takes_the_time_that_is_said() {
    let mut cell = Cell::new();
    let boxes = pallet(2);
    let mut times = Vec::new();
    for limited in [false, true] {
        if limited {
            let states: Vec<JointPositions> = dense(&cell, &cell.plan(&boxes).unwrap(), 0.05)
                .into_iter()
                .map(|(_, q)| q)
                .collect();
            cell.arm = weak(&states, &load(90.0), 0.5);
        }
        let plan = cell.plan(&boxes).unwrap();
        let request = cell.request(&boxes);
        let middle = plan.carried.pose.translation.vector;
        let (tool, carton) = loads(&request, cell.settings.max_carton_mass, &middle);
        let moves: Vec<Driven> = as_driven(&request, &plan.waypoints)
            .into_iter()
            .enumerate()
            .map(|(i, segment)| Driven {
                segment,
                carried: if i > plan.pick_index {
                    (carton.mass, carton.centre)
                } else {
                    (0.0, Point::origin())
                },
            })
            .collect();
        let time = executed(&Arc::new(cell.arm.clone()), cell.start, tool, &moves);
        assert!(
            (plan.estimated_time - time).abs() < 0.01 * time,
            "said {} s, took {time} s",
            plan.estimated_time
        );
        times.push(time);
    }
    assert!(times[1] > 1.02 * times[0], "{times:?}");
}

/// The way is free, but an axis could not hold gripper and carton on it: no plan, and the axis is named.
#[test]
fn a_pick_that_cannot_be_held_is_refused() {
    let mut cell = Cell::new();
    let boxes = pallet(1);
    let states: Vec<JointPositions> = dense(&cell, &cell.plan(&boxes).unwrap(), 0.05)
        .into_iter()
        .map(|(_, q)| q)
        .collect();
    cell.arm = weak(&states, &Load::NONE, 0.0);
    let Err(Refusal::NothingFits(rejections)) = cell.plan(&boxes) else {
        panic!("planned");
    };
    let reason = &rejections[0].reason;
    assert!(
        matches!(
            reason,
            RejectReason::CannotDrive {
                error: MotionError::Overload { .. }
            }
        ),
        "{reason}"
    );
}
