use std::collections::BTreeSet;

use depal_frames::{BoxSize, JointPositions, PlacedShape, Pose, Rotation, Vector};
use depal_gripper::{CupSpec, SectionSpec};

use super::{Cell, assert_consistent, assert_free, pallet, seen, visible};
use crate::{
    PlannerSettings, RejectReason,
    grasp::{Grasp, grasps},
    group::Group,
};

#[test]
fn sections_follow_the_face() {
    let cell = Cell::new();
    let carton = seen(1.7, 0.0, 1.0, 0.0);
    let found = grasps(&cell.gripper, &Group::single(0, &carton), &cell.settings).unwrap();
    // The 300 mm side along the gripper: the middle pair is centred, the outer pairs are 150 mm off.
    let of = |sections: &[usize]| found.iter().find(|g| g.sections == sections);
    assert_eq!(found[0].sections, [1, 2]);
    assert!(found[0].tcp_offset.norm() < 1e-9 && found[0].across);
    assert!((of(&[0, 1]).unwrap().tcp_offset.x + 0.15).abs() < 1e-9);
    assert!((of(&[2, 3]).unwrap().tcp_offset.x - 0.15).abs() < 1e-9);
    assert!(found.iter().all(|g| g.sections.len() <= 2));

    // A face of 150 x 370 mm takes one section; one of 100 x 100 mm takes none.
    let mut narrow = carton;
    narrow.size = BoxSize {
        length: 0.37,
        width: 0.15,
        height: 0.2,
    };
    let light = PlannerSettings {
        max_carton_mass: 5.0,
        ..PlannerSettings::default()
    };
    assert!(
        grasps(&cell.gripper, &Group::single(0, &narrow), &light)
            .unwrap()
            .iter()
            .all(|g| g.sections.len() == 1)
    );
    narrow.size = BoxSize {
        length: 0.1,
        width: 0.1,
        height: 0.1,
    };
    assert_eq!(
        grasps(&cell.gripper, &Group::single(0, &narrow), &light),
        Err(RejectReason::NoSectionFits { face: [0.1, 0.1] })
    );

    // Force: 48 cups of 40 mm at 30 kPa hold 1810 N, enough for 92 kg at rest with a safety factor of 2, not for 93 kg.
    let heavy = |kg| PlannerSettings {
        max_carton_mass: kg,
        ..PlannerSettings::default()
    };
    assert!(grasps(&cell.gripper, &Group::single(0, &carton), &heavy(92.0)).is_ok());
    assert!(matches!(
        grasps(&cell.gripper, &Group::single(0, &carton), &heavy(93.0)),
        Err(RejectReason::TooLittleForce { .. })
    ));
}

/// Four zones in two rows and columns: which of them hold a carton says which edge or corner of the field it is flush with.
#[test]
fn edges_and_corners_of_the_gripper_have_their_numbers() {
    let mut cell = Cell::new();
    let template = cell.gripper.cups[0].clone();
    cell.gripper.sections.clear();
    cell.gripper.cups.clear();
    for (section, [x, y]) in [[0.1, 0.1], [-0.1, 0.1], [-0.1, -0.1], [0.1, -0.1]]
        .into_iter()
        .enumerate()
    {
        cell.gripper.sections.push(SectionSpec {
            digital_output: section as u16,
            area: [x - 0.1, x + 0.1, y - 0.1, y + 0.1],
        });
        cell.gripper.cups.push(CupSpec {
            position: [x, y],
            section,
            diameter: 0.1,
            ..template.clone()
        });
    }
    cell.settings.max_carton_mass = 5.0;
    let found = |length, width| {
        let mut carton = seen(1.7, 0.0, 1.0, 0.0);
        carton.size = BoxSize {
            length,
            width,
            height: 0.15,
        };
        let found = grasps(&cell.gripper, &Group::single(0, &carton), &cell.settings).unwrap();
        // The best, and those that hold as much.
        let as_many = |g: &&Grasp| g.sections.len() == found[0].sections.len();
        let numbers = found.iter().filter(as_many);
        let numbers = numbers.map(|g| (g.edge_corner_id, g.sections.clone()));
        numbers.collect::<BTreeSet<_>>().into_iter().collect()
    };
    let corners: Vec<(u8, Vec<usize>)> = found(0.2, 0.19);
    let expected = [(5, vec![0]), (6, vec![1]), (7, vec![2]), (8, vec![3])];
    assert_eq!(corners, expected);
    let edges: Vec<(u8, Vec<usize>)> = found(0.39, 0.2);
    let expected = [
        (1, vec![0, 3]),
        (2, vec![0, 1]),
        (3, vec![1, 2]),
        (4, vec![2, 3]),
    ];
    assert_eq!(edges, expected);
    let whole: Vec<(u8, Vec<usize>)> = found(0.4, 0.39);
    assert_eq!(whole, [(0, vec![0, 1, 2, 3])], "opposite edges are none");
}

#[test]
fn covered_unsure_and_leaning_boxes_are_named() {
    let cell = Cell::new();
    let mut unsure = seen(1.5, 0.4, 0.9, 0.0);
    unsure.confidence = 0.1;
    let mut leaning = seen(1.5, -0.4, 0.9, 0.0);
    leaning.base_from_box.rotation *= Rotation::from_axis_angle(&Vector::x_axis(), 0.3);
    // Box 3 lies half on box 2.
    let boxes = [
        unsure,
        leaning,
        seen(1.7, 0.0, 0.9, 0.0),
        seen(1.9, 0.0, 1.15, 0.0),
    ];
    let plan = cell.plan(&boxes).unwrap();
    assert_eq!(plan.box_index, 3);
    let reason = |i| {
        &plan
            .rejected
            .iter()
            .find(|r| r.box_index == i)
            .unwrap()
            .reason
    };
    assert!(matches!(reason(0), RejectReason::LowConfidence { .. }));
    assert!(matches!(reason(1), RejectReason::Tilted { .. }));
    assert!(
        matches!(reason(2), RejectReason::Covered { by: 3, overlap } if (overlap - 0.2).abs() < 1e-9)
    );
}

/// A box whose neighbour towers beside it: the middle sections would put the plate into the tower, so outer ones are taken.
/// The plate reaches 160 mm beyond the middle of an outer pair and 85 mm beyond the middle of an outer section.
#[test]
fn a_tower_beside_the_box_shifts_the_gripper() {
    let cell = Cell::new();
    let free = cell.plan(&[seen(1.7, 0.0, 0.9, 0.0)]).unwrap();
    assert_eq!(free.sections, [1, 2]);
    for side in [-1.0, 1.0] {
        for (distance, expected) in [
            (0.36, [[0, 1], [2, 3]].map(Vec::from)),
            (0.304, [[0], [3]].map(Vec::from)),
        ] {
            let mut boxes = [
                seen(1.7, 0.0, 0.9, 0.0),
                seen(1.7, side * distance, 1.4, 0.0),
            ];
            // The tower itself is higher and would come first: vision is not sure of it.
            boxes[1].confidence = 0.1;
            let plan = cell.plan(&boxes).unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(plan.box_index, 0);
            assert!(
                expected.contains(&plan.sections),
                "{distance} m: {:?}",
                plan.sections
            );
            assert_eq!(plan.rejected.len(), 1);
            assert_consistent(&cell, &boxes, &plan);
            assert_free(&cell, &boxes, &plan);
            let pick = &plan.waypoints[plan.pick_index];
            assert!(
                pick.base_from_tcp.translation.y * side < 0.0,
                "the plate is on the far side"
            );
        }
    }
}

/// Another gripper: four strips that together cover one face, so the long side lies along the gripper and all are used.
#[test]
fn a_plate_of_the_cartons_size_uses_all_its_sections() {
    let mut cell = Cell::new();
    cell.gripper.flange_from_tcp = Pose::translation(0.0, 0.0, 0.25);
    cell.gripper.bodies = vec![PlacedShape::cuboid(
        Pose::translation(0.0, 0.0, -0.06),
        Vector::new(0.39, 0.29, 0.06),
    )];
    cell.gripper.cups.clear();
    for section in 0..4 {
        let x = -0.1425 + 0.095 * section as f64;
        cell.gripper.sections[section].area = [x - 0.0475, x + 0.0475, -0.14, 0.14];
        for (i, j) in [
            (-1, -3),
            (-1, -1),
            (-1, 1),
            (-1, 3),
            (1, -3),
            (1, -1),
            (1, 1),
            (1, 3),
        ] {
            cell.gripper.cups.push(CupSpec {
                position: [x + 0.02375 * f64::from(i), 0.035 * f64::from(j)],
                section,
                diameter: 0.045,
                stiffness: 10_000.0,
                damping: 100.0,
                stroke: 0.01,
            });
        }
    }
    let mut boxes = pallet(2);
    while !boxes.is_empty() {
        cell.start = JointPositions::from_degrees(&[90.0, -20.0, 20.0, 0.0, 90.0, 0.0]);
        let top = visible(&boxes);
        let plan = cell.plan(&top).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(
            (&plan.sections[..], plan.group_orientation),
            (&[0, 1, 2, 3][..], 0)
        );
        assert!(plan.pick_index >= 1, "there is a way down");
        assert_consistent(&cell, &top, &plan);
        assert_free(&cell, &top, &plan);
        boxes.retain(|b| b.base_from_box != top[plan.box_index].base_from_box);
    }
}
