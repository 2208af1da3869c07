use depal_frames::{PlacedShape, Pose, Rotation, Vector};
use depal_gripper::GripperSpec;
use nalgebra::Translation3;

use crate::{
    candidate::load,
    group::{Face, Group},
    refusal::RejectReason,
    request::PlannerSettings,
    suction::{GRAVITY, Hold, needed_at_rest},
};

/// An edge of the gripper and one of the carton are flush when they are this close, m.
const FLUSH: f64 = 0.02;

/// One way to hold a group of boxes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Grasp {
    /// Sections to switch on, ascending.
    pub sections: Vec<usize>,
    /// Tool pose on the group.
    pub box_from_tcp: Pose,
    /// From the tool centre to the middle of the top face, tool frame.
    pub tcp_offset: Vector,
    /// How the carton hangs that is held least.
    pub hold: Hold,
    /// The long side of the group lies across the tool's X.
    pub across: bool,
    /// Edge or corner of the gripper that is flush with the group, as in [`crate::PickPlan::edge_corner_id`].
    pub edge_corner_id: u8,
    /// The group in the tool frame.
    pub carried: PlacedShape,
}

/// All grasps, best first: what bears more sideways acceleration (up to what arms do), then more force, then less offset,
/// then a fixed order.
pub(crate) fn grasps(
    gripper: &GripperSpec,
    group: &Group,
    settings: &PlannerSettings,
) -> Result<Vec<Grasp>, RejectReason> {
    use std::f64::consts::{FRAC_PI_2, PI};
    let size = &group.whole.size;
    let (length, width, height) = (size.length, size.width, size.height);
    let mut found = Vec::new();
    for yaw in [FRAC_PI_2, -FRAC_PI_2, 0.0, PI] {
        let across = yaw.abs() == FRAC_PI_2;
        // Half sides of the face along the tool's X and Y.
        let half = if across {
            [width * 0.5, length * 0.5]
        } else {
            [length * 0.5, width * 0.5]
        };
        let turn = Rotation::from_axis_angle(&Vector::z_axis(), yaw)
            * Rotation::from_axis_angle(&Vector::x_axis(), PI);
        let faces: Vec<Face> = group.faces.iter().map(|face| turned(face, &turn)).collect();
        for (members, tcp_offset) in runs(gripper) {
            let sections: Vec<usize> = (0..gripper.sections.len())
                .filter(|&s| wholly_on(gripper, s, &tcp_offset, &faces, settings.cup_margin))
                .collect();
            // A run that does not fit, or one that is part of a larger one that does.
            if sections != members {
                continue;
            }
            let box_from_tcp = Pose::from_parts(Translation3::from(turn * -tcp_offset), turn);
            let carried = PlacedShape::cuboid(
                Pose::translation(tcp_offset.x, tcp_offset.y, height * 0.5),
                Vector::new(half[0] * 2.0, half[1] * 2.0, height),
            );
            found.push(Grasp {
                hold: weakest_hold(gripper, &sections, &tcp_offset, &faces, height, settings),
                edge_corner_id: edge_corner_id(gripper, &tcp_offset, half),
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
    let force = found.iter().map(|g| g.hold.force).fold(0.0, f64::max);
    found.retain(|g| g.hold.force >= needed);
    if found.is_empty() {
        return Err(RejectReason::TooLittleForce { force, needed });
    }
    let load = load(group, settings);
    let moment = |g: &Grasp| wrist_moment(gripper, &g.carried, load);
    let least = found.iter().map(moment).fold(f64::INFINITY, f64::min);
    found.retain(|g| moment(g) <= settings.max_moment);
    if found.is_empty() {
        return Err(RejectReason::TooMuchMoment {
            moment: least,
            limit: settings.max_moment,
        });
    }
    let rank = |g: &Grasp| {
        (
            -(g.hold.sideways(settings) * 10.0).round() as i64,
            -(g.hold.force * 1e3).round() as i64,
            (g.tcp_offset.norm() * 1e3).round() as i64,
        )
    };
    found.sort_by_key(rank);
    Ok(found)
}

/// Moment of gripper and load about the flange when the tool lies level, the worst posture, N m.
/// The gripper's own weight is taken to sit half-way to the cups.
fn wrist_moment(gripper: &GripperSpec, carried: &PlacedShape, load: f64) -> f64 {
    let cups = gripper.flange_from_tcp.translation.vector;
    let centre = (gripper.flange_from_tcp * carried.pose).translation.vector;
    GRAVITY * (gripper.mass * cups.norm() * 0.5 + load * centre.norm())
}

/// A face along the tool's X and Y, about the group's middle. The turn is by quarters, face down.
fn turned(face: &Face, turn: &Rotation) -> Face {
    let to_tool = turn.inverse();
    let middle = to_tool * Vector::new(face.middle[0], face.middle[1], 0.0);
    let half = to_tool * Vector::new(face.half[0], face.half[1], 0.0);
    Face {
        middle: [middle.x, middle.y],
        half: [half.x.abs(), half.y.abs()],
    }
}

/// Rectangles of neighbouring sections, with the place of the middle of each. Sections in a row or in rows and columns.
fn runs(gripper: &GripperSpec) -> Vec<(Vec<usize>, Vector)> {
    let strips = |low: usize, high: usize| {
        let mut strips: Vec<[f64; 2]> = Vec::new();
        for section in &gripper.sections {
            let strip = [section.area[low], section.area[high]];
            let is_known = |s: &[f64; 2]| (s[0] - strip[0]).abs() + (s[1] - strip[1]).abs() < 2e-3;
            if !strips.iter().any(is_known) {
                strips.push(strip);
            }
        }
        strips.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        strips
    };
    let spans = |strips: &[[f64; 2]]| -> Vec<[f64; 2]> {
        let all = (0..strips.len())
            .flat_map(|first| (first..strips.len()).map(move |last| [first, last]));
        all.map(|[first, last]| [strips[first][0], strips[last][1]])
            .collect()
    };
    let mut found: Vec<(Vec<usize>, Vector)> = Vec::new();
    for x in spans(&strips(0, 1)) {
        for y in spans(&strips(2, 3)) {
            let inside = |s: &depal_gripper::SectionSpec| {
                s.area[0] >= x[0] - 1e-3
                    && s.area[1] <= x[1] + 1e-3
                    && s.area[2] >= y[0] - 1e-3
                    && s.area[3] <= y[1] + 1e-3
            };
            let members: Vec<usize> = (0..gripper.sections.len())
                .filter(|&s| inside(&gripper.sections[s]))
                .collect();
            let bounds = |low: usize, high: usize| {
                let areas = members.iter().map(|&s| gripper.sections[s].area);
                areas.fold([f64::INFINITY, f64::NEG_INFINITY], |b, area| {
                    [b[0].min(area[low]), b[1].max(area[high])]
                })
            };
            let is_known = |(known, _): &(Vec<usize>, Vector)| *known == members;
            if members.is_empty() || found.iter().any(is_known) {
                continue;
            }
            let middle = |b: [f64; 2]| (b[0] + b[1]) * 0.5;
            let at = Vector::new(middle(bounds(0, 1)), middle(bounds(2, 3)), 0.0);
            found.push((members, at));
        }
    }
    found
}

/// Whether a cup of this reach lies wholly on a face, whose group's middle is at `tcp_offset`.
fn is_on(position: [f64; 2], reach: f64, tcp_offset: &Vector, face: &Face) -> bool {
    (position[0] - tcp_offset.x - face.middle[0]).abs() + reach <= face.half[0]
        && (position[1] - tcp_offset.y - face.middle[1]).abs() + reach <= face.half[1]
}

/// Whether all cups of a section lie wholly on faces of the group: no cup on a gap, none on a box beside it.
/// A section without cups does not.
fn wholly_on(
    gripper: &GripperSpec,
    section: usize,
    tcp_offset: &Vector,
    faces: &[Face],
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
            faces
                .iter()
                .any(|face| is_on(cup.position, reach, tcp_offset, face))
        })
}

/// Hold on the face that is held least.
fn weakest_hold(
    gripper: &GripperSpec,
    sections: &[usize],
    tcp_offset: &Vector,
    faces: &[Face],
    height: f64,
    settings: &PlannerSettings,
) -> Hold {
    let holds = faces.iter().map(|face| {
        let on_face = |cup: &&depal_gripper::CupSpec| {
            sections.contains(&cup.section) && is_on(cup.position, 0.0, tcp_offset, face)
        };
        let cups: Vec<_> = gripper.cups.iter().filter(on_face).collect();
        let middle = [0, 1].map(|k| tcp_offset[k] + face.middle[k]);
        Hold::of(gripper, &cups, middle, height)
    });
    let weaker = |a: &Hold, b: &Hold| {
        let [a_bears, b_bears] = [a, b].map(|hold| hold.sideways(settings));
        a_bears
            .total_cmp(&b_bears)
            .then(a.force.total_cmp(&b.force))
    };
    holds.min_by(weaker).expect("a group has a face")
}

/// Which edge or corner of the suction field is flush with the group, whose half sides along the tool's axes are given.
/// Flush on two opposite sides is none: the group is as large as the field.
fn edge_corner_id(gripper: &GripperSpec, tcp_offset: &Vector, half: [f64; 2]) -> u8 {
    let side = |axis: usize| {
        let areas = || gripper.sections.iter().map(|s| s.area);
        let low = areas().map(|a| a[2 * axis]).fold(f64::INFINITY, f64::min);
        let high = areas()
            .map(|a| a[2 * axis + 1])
            .fold(f64::NEG_INFINITY, f64::max);
        let at_high = (tcp_offset[axis] + half[axis] - high).abs() <= FLUSH;
        let at_low = (tcp_offset[axis] - half[axis] - low).abs() <= FLUSH;
        match (at_low, at_high) {
            (false, true) => 1,
            (true, false) => -1,
            _ => 0,
        }
    };
    match (side(0), side(1)) {
        (1, 0) => 1,
        (0, 1) => 2,
        (-1, 0) => 3,
        (0, -1) => 4,
        (1, 1) => 5,
        (-1, 1) => 6,
        (-1, -1) => 7,
        (1, -1) => 8,
        _ => 0,
    }
}
