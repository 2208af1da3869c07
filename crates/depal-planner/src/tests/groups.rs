use depal_frames::{BoxSize, Point, Rotation, Vector};

use super::{Cell, assert_free, cuboid, pallet, seen, visible};
use crate::{
    PickPlan, PlannerSettings, Refusal, RejectReason, SeenBox,
    grasp::grasps,
    group::{Group, fewest_picks},
};

fn pairs() -> Cell {
    let mut cell = Cell::new();
    cell.settings.max_group = 2;
    cell
}

/// Every cup of a switched-on section lies wholly on one member, and every member has a section's worth of cups.
fn assert_sections_fit(cell: &Cell, boxes: &[SeenBox], plan: &PickPlan) {
    let pick = &plan.waypoints[plan.pick_index];
    let tcp = cell.arm.base_from_flange(&pick.joints) * cell.gripper.flange_from_tcp;
    let mut held = vec![0; boxes.len()];
    for cup in &cell.gripper.cups {
        if !plan.sections.contains(&cup.section) {
            continue;
        }
        let at = tcp * Point::new(cup.position[0], cup.position[1], 0.0);
        let on: Vec<usize> = (0..boxes.len())
            .filter(|&i| {
                let here = boxes[i].base_from_box.inverse() * at;
                here.x.abs() + 0.02 <= boxes[i].size.length * 0.5
                    && here.y.abs() + 0.02 <= boxes[i].size.width * 0.5
                    && here.z.abs() < 0.01
            })
            .collect();
        assert_eq!(on.len(), 1, "a cup lies on {on:?}");
        assert!(plan.box_indices.contains(&on[0]), "a cup on a neighbour");
        held[on[0]] += 1;
    }
    for &member in &plan.box_indices {
        assert!(
            held[member] >= 24,
            "member {member} has {} cups",
            held[member]
        );
    }
}

#[test]
fn a_full_pallet_goes_in_pairs() {
    let mut cell = pairs();
    let mut boxes = pallet(6);
    let mut picks = 0;
    while !boxes.is_empty() {
        let top = visible(&boxes);
        let plan = cell
            .plan(&top)
            .unwrap_or_else(|e| panic!("pick {picks}: {e}"));
        assert_eq!(plan.box_indices.len(), 2, "left alone: {:?}", plan.rejected);
        assert_eq!(plan.box_index, plan.box_indices[0]);
        assert_sections_fit(&cell, &top, &plan);
        assert_free(&cell, &top, &plan);
        assert_eq!((plan.group_orientation, plan.box_orientation), (0, 1));
        let [length, width, height] = plan.group_size;
        assert!((0.598..0.615).contains(&length) && (0.398..0.41).contains(&width));
        assert!((height - 0.25).abs() < 1e-9);
        // The group stands on the place as one.
        let end = plan.waypoints.last().unwrap();
        let at = (end.base_from_tcp * plan.carried.pose).translation.vector;
        assert!((at.xy() - cell.place.base_from_place.translation.vector.xy()).norm() < 1e-6);
        picks += 1;
        let gone: Vec<_> = plan
            .box_indices
            .iter()
            .map(|&i| top[i].base_from_box)
            .collect();
        boxes.retain(|b| !gone.contains(&b.base_from_box));
        cell.start = plan.waypoints[plan.waypoints.len() - 2].joints;
    }
    assert_eq!(picks, 24);
}

/// A row of cartons with a gap of 4 mm between their long sides.
fn row(count: usize) -> Vec<SeenBox> {
    let middle = (count - 1) as f64 * 0.5;
    let at = |i: usize| (i as f64 - middle) * 0.304;
    (0..count).map(|i| seen(1.7, at(i), 0.9, 0.0)).collect()
}

#[test]
fn no_single_is_left_without_need() {
    // The place is nearest to the middle pair: taking that one would leave two singles.
    let mut cell = pairs();
    let boxes: Vec<SeenBox> = (0..4)
        .map(|i| {
            seen(
                1.7 + (f64::from(i) - 1.5) * 0.304,
                0.0,
                0.9,
                std::f64::consts::FRAC_PI_2,
            )
        })
        .collect();
    cell.place.base_from_place.translation.vector = Vector::new(1.7, 1.5, 0.7);
    cell.known.truncate(2);
    let plan = cell.plan(&boxes).unwrap_or_else(|e| panic!("{e}"));
    assert!([[0, 1], [2, 3]].map(Vec::from).contains(&plan.box_indices));

    // Of three, two go together.
    let boxes = row(3);
    let picks = fewest_picks(&boxes, &[0, 1, 2], &cell.settings, |_| true);
    assert_eq!(picks.len(), 2);

    // Which half turn vision gives a carton means nothing.
    for turns in 0..16 {
        let turned = |i: usize| {
            if turns >> i & 1 == 1 {
                std::f64::consts::PI
            } else {
                0.0
            }
        };
        let mut boxes = row(4);
        for (i, seen) in boxes.iter_mut().enumerate() {
            let turn = Rotation::from_axis_angle(&Vector::z_axis(), turned(i));
            seen.base_from_box.rotation *= turn;
        }
        let picks = fewest_picks(&boxes, &[0, 1, 2, 3], &cell.settings, |_| true);
        assert_eq!(picks.len(), 2, "turns {turns:04b}");
    }
}

#[test]
fn only_like_neighbours_go_together() {
    let alone = |boxes: &[SeenBox]| {
        let plan = pairs().plan(boxes).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(plan.box_indices.len(), 1, "{boxes:?}");
        assert_eq!(plan.group_size[0], boxes[plan.box_index].size.length);
    };
    let mut far = row(2);
    far[1].base_from_box.translation.vector.y += 0.03;
    alone(&far);
    let mut low = row(2);
    low[1].base_from_box.translation.vector.z -= 0.03;
    alone(&low);
    alone(&[seen(1.7, -0.18, 0.9, 0.0), seen(1.7, 0.18, 0.9, 1.57)]);
    let mut other = row(2);
    other[1].size = BoxSize {
        length: 0.37,
        ..other[1].size
    };
    alone(&other);
    // The counterpart: without any of this they do.
    assert_eq!(pairs().plan(&row(2)).unwrap().box_indices, [0, 1]);
}

#[test]
fn the_arm_carries_no_more_than_it_can() {
    let loaded = |max_load| {
        let mut cell = pairs();
        cell.settings.max_load = max_load;
        cell.plan(&row(4))
    };
    assert_eq!(loaded(40.0).unwrap().box_indices.len(), 2);
    assert_eq!(loaded(39.0).unwrap().box_indices.len(), 1);
    let Err(Refusal::NothingFits(rejected)) = loaded(19.0) else {
        panic!("20 kg on an arm for 19 kg");
    };
    assert_eq!(rejected.len(), 4);
    assert!(rejected.iter().all(|r| {
        matches!(r.reason, RejectReason::TooHeavy { mass, limit } if mass == 20.0 && limit == 19.0)
    }));
}

#[test]
fn the_wrist_bears_no_more_than_it_is_rated_for() {
    // 50 kg at 150 mm and 40 kg at 300 + 125 mm below the flange.
    let two = 9.80665 * (50.0 * 0.15 + 40.0 * 0.425);
    let one = 9.80665 * (50.0 * 0.15 + 20.0 * 0.425);
    let loaded = |max_moment| {
        let mut cell = pairs();
        cell.settings.max_moment = max_moment;
        cell.plan(&row(4))
    };
    assert_eq!(loaded(two + 1.0).unwrap().box_indices.len(), 2);
    assert_eq!(loaded(two - 1.0).unwrap().box_indices.len(), 1);
    let Err(refusal) = loaded(one - 1.0) else {
        panic!("too much for the wrist");
    };
    assert!(
        refusal.to_string().contains("turn the wrist with 157 N m"),
        "{refusal}"
    );
}

/// A post beside the pair: together they meet it, one by one they do not.
#[test]
fn what_cannot_go_together_goes_one_by_one() {
    let mut cell = pairs();
    let boxes = row(2);
    // A beam over the second carton: nothing gets at it.
    cell.known.push(cuboid(1.7, 0.152, 1.1, 0.5, 0.25, 0.1));
    let plan = cell.plan(&boxes).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(plan.box_indices, [0]);
    assert_eq!(
        (plan.rejected[0].box_index, &plan.rejected[0].with[..]),
        (0, &[1][..])
    );
    let text = plan.rejected[0].to_string();
    assert!(
        text.starts_with("box 0+1: ") && text.contains("meets"),
        "{text}"
    );
    // In the words of a longer list.
    let text = plan.rejected[0].clone().renumbered(&[7, 9]).to_string();
    assert!(text.starts_with("box 7+9: "), "{text}");
}

/// Two rows of six cups, each a zone of its own: small cartons take the cups that lie on them, four at a time.
#[test]
fn single_cup_zones_take_what_lies_under_them() {
    let mut cell = Cell::new();
    let template = cell.gripper.cups[0].clone();
    cell.gripper.sections.clear();
    cell.gripper.cups.clear();
    for column in 0..6 {
        for line in 0..2 {
            let x = (f64::from(column) - 2.5) * 0.1;
            let y = (f64::from(line) - 0.5) * 0.2;
            cell.gripper.sections.push(depal_gripper::SectionSpec {
                digital_output: (column * 2 + line) as u16,
                area: [x - 0.045, x + 0.045, y - 0.045, y + 0.045],
            });
            cell.gripper.cups.push(depal_gripper::CupSpec {
                position: [x, y],
                section: (column * 2 + line) as usize,
                diameter: 0.08,
                ..template.clone()
            });
        }
    }
    let settings = PlannerSettings {
        max_carton_mass: 5.0,
        max_group: 4,
        ..PlannerSettings::default()
    };
    let small = |x: f64, y: f64| {
        let mut seen = seen(1.7 + x, y, 0.9, 0.0);
        seen.size = BoxSize {
            length: 0.30,
            width: 0.20,
            height: 0.15,
        };
        seen
    };
    let boxes = [
        small(-0.152, -0.102),
        small(-0.152, 0.102),
        small(0.152, -0.102),
        small(0.152, 0.102),
    ];
    let single = Group::single(0, &boxes[0]);
    let best = &grasps(&cell.gripper, &single, &settings).unwrap()[0];
    assert_eq!(best.sections.len(), 4, "two cups of either row: {best:?}");
    let four = fewest_picks(&boxes, &[0, 1, 2, 3], &settings, |group| {
        grasps(&cell.gripper, group, &settings).is_ok()
    });
    assert_eq!(four.len(), 1, "{four:?}");
    let all = &grasps(&cell.gripper, &four[0], &settings).unwrap()[0];
    assert_eq!(all.sections.len(), 12);
    assert_eq!(all.edge_corner_id, 0, "as large as the field");
    // One carton in the corner of the field, and along an edge.
    let ids: std::collections::BTreeSet<u8> = grasps(&cell.gripper, &single, &settings)
        .unwrap()
        .iter()
        .map(|grasp| grasp.edge_corner_id)
        .collect();
    assert_eq!(ids.into_iter().collect::<Vec<_>>(), [0, 1, 3]);
}
