use depal_frames::{PlacedShape, Pose, Rotation, Vector};
use depal_gripper::GripperSpec;
use nalgebra::Translation3;

use crate::{
    refusal::RejectReason,
    request::{PlannerSettings, SeenBox},
    suction::{holding_force, needed_at_rest},
};

/// One way to hold a box.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Grasp {
    /// Sections to switch on, ascending.
    pub sections: Vec<usize>,
    /// Tool pose on the box.
    pub box_from_tcp: Pose,
    /// From the tool centre to the middle of the top face, tool frame.
    pub tcp_offset: Vector,
    /// Holding force at full vacuum, N.
    pub force: f64,
    /// The long side of the box lies across the tool's X.
    pub across: bool,
    /// The carton in the tool frame.
    pub carried: PlacedShape,
}

/// All grasps, best first: more force, then less offset, then a fixed order.
pub(crate) fn grasps(
    gripper: &GripperSpec,
    seen: &SeenBox,
    settings: &PlannerSettings,
) -> Result<Vec<Grasp>, RejectReason> {
    use std::f64::consts::{FRAC_PI_2, PI};
    let (length, width, height) = (seen.size.length, seen.size.width, seen.size.height);
    let mut found = Vec::new();
    for yaw in [FRAC_PI_2, -FRAC_PI_2, 0.0, PI] {
        let across = yaw.abs() == FRAC_PI_2;
        // Half sides of the face along the tool's X and Y.
        let half = if across {
            [width * 0.5, length * 0.5]
        } else {
            [length * 0.5, width * 0.5]
        };
        for (first, last) in groups(gripper.sections.len()) {
            let group = &gripper.sections[first..=last];
            let middle = |low: usize, high: usize| {
                let low = group
                    .iter()
                    .map(|s| s.area[low])
                    .fold(f64::INFINITY, f64::min);
                let high = group
                    .iter()
                    .map(|s| s.area[high])
                    .fold(f64::NEG_INFINITY, f64::max);
                (low + high) * 0.5
            };
            let tcp_offset = Vector::new(middle(0, 1), middle(2, 3), 0.0);
            let sections: Vec<usize> = (0..gripper.sections.len())
                .filter(|&s| wholly_on(gripper, s, &tcp_offset, half, settings.cup_margin))
                .collect();
            // A group that does not fit, or one that is part of a larger one that does.
            if sections != (first..=last).collect::<Vec<_>>() {
                continue;
            }
            let turn = Rotation::from_axis_angle(&Vector::z_axis(), yaw)
                * Rotation::from_axis_angle(&Vector::x_axis(), PI);
            let box_from_tcp = Pose::from_parts(Translation3::from(turn * -tcp_offset), turn);
            let carried = PlacedShape::cuboid(
                Pose::translation(tcp_offset.x, tcp_offset.y, height * 0.5),
                Vector::new(half[0] * 2.0, half[1] * 2.0, height),
            );
            found.push(Grasp {
                force: holding_force(gripper, &sections),
                sections,
                box_from_tcp,
                tcp_offset,
                across,
                carried,
            });
        }
    }
    if found.is_empty() {
        return Err(RejectReason::NoSectionFits {
            face: [length, width],
        });
    }
    let needed = needed_at_rest(settings);
    let force = found.iter().map(|g| g.force).fold(0.0, f64::max);
    found.retain(|g| g.force >= needed);
    if found.is_empty() {
        return Err(RejectReason::TooLittleForce { force, needed });
    }
    let rank = |g: &Grasp| {
        (
            -(g.force * 1e3).round() as i64,
            (g.tcp_offset.norm() * 1e3).round() as i64,
        )
    };
    found.sort_by_key(rank);
    Ok(found)
}

/// Every run of neighbouring sections, as first and last.
fn groups(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(move |first| (first..count).map(move |last| (first, last)))
}

/// Whether all cups of a section lie on the face, whose middle is at `tcp_offset`. A section without cups does not.
fn wholly_on(
    gripper: &GripperSpec,
    section: usize,
    tcp_offset: &Vector,
    half: [f64; 2],
    margin: f64,
) -> bool {
    let mut cups = gripper
        .cups
        .iter()
        .filter(|c| c.section == section)
        .peekable();
    cups.peek().is_some()
        && cups.all(|cup| {
            let reach = cup.diameter * 0.5 + margin;
            (cup.position[0] - tcp_offset.x).abs() + reach <= half[0]
                && (cup.position[1] - tcp_offset.y).abs() + reach <= half[1]
        })
}
