use depal_frames::{Rotation, Vector};
use depal_time::RandomStreams;

use super::{Cell, assert_consistent, assert_free, pallet, visible};

#[test]
fn a_full_pallet_is_planned_to_the_last_box() {
    let mut cell = Cell::new();
    let mut boxes = pallet(6);
    let (mut least, mut time, mut most): (f64, f64, usize) = (1.0, 0.0, 0);
    for pick in 0..48 {
        let top = visible(&boxes);
        let plan = cell
            .plan(&top)
            .unwrap_or_else(|e| panic!("pick {pick}: {e}"));
        assert_consistent(&cell, &top, &plan);
        assert_free(&cell, &top, &plan);
        let chosen = top[plan.box_index];
        let highest = boxes
            .iter()
            .map(|b| b.base_from_box.translation.z)
            .fold(0.0, f64::max);
        assert!(
            highest - chosen.base_from_box.translation.z < 0.125,
            "top layer first"
        );
        assert!(plan.min_clearance > 0.0);
        least = least.min(plan.min_clearance);
        time += plan.estimated_time;
        most = most.max(plan.waypoints.len());
        boxes.retain(|b| b.base_from_box != chosen.base_from_box);
        cell.start = plan.waypoints[plan.waypoints.len() - 2].joints;
    }
    assert!(boxes.is_empty());
    assert!(least > 0.010, "least clearance {least} m");
    assert!(time / 48.0 < 4.0, "mean time {} s", time / 48.0);
    assert!(most <= 9, "{most} waypoints");
}

#[test]
fn heavier_cartons_move_slower() {
    let slowest = |mass| {
        let mut cell = Cell::new();
        cell.settings.max_carton_mass = mass;
        let plan = cell.plan(&visible(&pallet(4))).unwrap();
        let pick = plan.pick_index;
        assert!(
            plan.waypoints[..=pick]
                .iter()
                .all(|w| w.velocity_percent == 100.0)
        );
        let percents = plan.waypoints[pick + 1..]
            .iter()
            .map(|w| w.velocity_percent);
        percents.fold(100.0, f64::min)
    };
    let percents = [5.0, 40.0, 60.0, 80.0].map(slowest);
    assert_eq!(percents[0], 100.0);
    assert!(
        percents[1] >= percents[2] && percents[2] > percents[3],
        "{percents:?}"
    );
    assert!(percents[3] < 70.0, "{percents:?}");
}

#[test]
fn same_request_same_plan() {
    let cell = Cell::new();
    let boxes = visible(&pallet(5));
    assert_eq!(cell.plan(&boxes), cell.plan(&boxes));
}

/// What vision gets wrong: 4 mm in place and size, half a degree in all angles. The planner must live with it.
#[test]
fn noisy_vision_is_lived_with() {
    let mut random = RandomStreams::new(11).stream("vision");
    for layers in [1, 3, 6] {
        let mut cell = Cell::new();
        let mut boxes = visible(&pallet(layers));
        for b in &mut boxes {
            let mut off = |scale: f64| random.uniform(-scale, scale);
            b.base_from_box.translation.vector += Vector::new(off(0.004), off(0.004), off(0.004));
            b.base_from_box.rotation *=
                Rotation::from_euler_angles(off(0.009), off(0.009), off(0.009));
            b.size.length += off(0.004);
            b.size.width += off(0.004);
        }
        while !boxes.is_empty() {
            let plan = cell
                .plan(&boxes)
                .unwrap_or_else(|e| panic!("{layers} layers: {e}"));
            assert_free(&cell, &boxes, &plan);
            assert!(!plan.sections.is_empty());
            boxes.remove(plan.box_index);
            cell.start = plan.waypoints[plan.waypoints.len() - 2].joints;
        }
    }
}
