//! Boxes that go together, and a layer's division into the fewest picks.

use std::collections::{BTreeMap, BTreeSet};

use depal_frames::{BoxSize, Pose, Rotation, Vector};
use nalgebra::{Rotation3, Translation3};

use crate::request::{PlannerSettings, SeenBox};

/// Cartons of one group differ by at most this much in size and height, m: more, and some cups would not reach.
const SAME: f64 = 0.010;
/// Their long sides differ by at most this angle, rad.
const SAME_TURN: f64 = 0.052;
/// Vision may see neighbours overlap by this much, m.
const OVERLAP: f64 = 0.006;
/// Steps of the search for the fewest picks; then the best so far is taken.
const SEARCH_STEPS: usize = 20_000;

/// A member's face in the frame of its group.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Face {
    /// Middle, m.
    pub middle: [f64; 2],
    /// Half sides of the largest rectangle along the group's axes that lies on the face, m.
    pub half: [f64; 2],
}

/// Boxes that are picked together: one, or a rectangle of like boxes side by side.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Group {
    /// Indices of the request's boxes, ascending.
    pub members: Vec<usize>,
    /// The bounding cuboid as one box, X along its longer side.
    pub whole: SeenBox,
    /// The members' faces, in the order of `members`.
    pub faces: Vec<Face>,
    /// The members' long sides lie across the group's longer side.
    pub is_across: bool,
}

impl Group {
    /// A box by itself.
    pub fn single(index: usize, seen: &SeenBox) -> Self {
        Self {
            members: vec![index],
            whole: *seen,
            faces: vec![Face {
                middle: [0.0; 2],
                half: [seen.size.length * 0.5, seen.size.width * 0.5],
            }],
            is_across: false,
        }
    }

    /// The bounding cuboid of like boxes; its turn and lean are their mean.
    fn around(boxes: &[SeenBox], mut members: Vec<usize>) -> Self {
        members.sort_unstable();
        let first = boxes[members[0]].base_from_box;
        let axis = |pose: &Pose, k: usize| pose.rotation * Vector::ith(k, 1.0);
        let (mut long, mut up) = (Vector::zeros(), Vector::zeros());
        for &member in &members {
            let pose = &boxes[member].base_from_box;
            let x = axis(pose, 0);
            // A box looks alike after half a turn.
            long += x * x.dot(&axis(&first, 0)).signum();
            up += axis(pose, 2);
        }
        let up = up.normalize();
        let long = (long - up * long.dot(&up)).normalize();
        let turn = |x: &Vector| {
            let axes = nalgebra::Matrix3::from_columns(&[*x, up.cross(x), up]);
            Rotation::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes))
        };
        let origin = first.translation.vector;
        let spread = |rotation: &Rotation| {
            let frame = Pose::from_parts(Translation3::from(origin), *rotation).inverse();
            let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
            let (mut height, mut faces) = (0.0, Vec::new());
            for &member in &members {
                let seen = &boxes[member];
                let here = frame * seen.base_from_box;
                let x = here.rotation * Vector::x();
                let (cos, sin) = (x.x.abs(), x.y.abs());
                let half = [seen.size.length * 0.5, seen.size.width * 0.5];
                let outer = [half[0] * cos + half[1] * sin, half[0] * sin + half[1] * cos];
                let inner = if cos >= sin {
                    [half[0] - half[1] * sin, half[1] - half[0] * sin]
                } else {
                    [half[1] - half[0] * cos, half[0] - half[1] * cos]
                };
                let middle = [here.translation.x, here.translation.y];
                for k in 0..2 {
                    low[k] = low[k].min(middle[k] - outer[k]);
                    high[k] = high[k].max(middle[k] + outer[k]);
                }
                height += here.translation.z;
                faces.push(Face {
                    middle,
                    half: inner,
                });
            }
            (low, high, height / members.len() as f64, faces)
        };
        let (low, high, ..) = spread(&turn(&long));
        let is_across = high[1] - low[1] > high[0] - low[0];
        let rotation = if is_across {
            turn(&up.cross(&long))
        } else {
            turn(&long)
        };
        let (low, high, height, mut faces) = spread(&rotation);
        let middle = [0, 1].map(|k| (low[k] + high[k]) * 0.5);
        for face in &mut faces {
            face.middle = [0, 1].map(|k| face.middle[k] - middle[k]);
        }
        let at = origin + rotation * Vector::new(middle[0], middle[1], height);
        let of = |value: fn(&SeenBox) -> f64, pick: fn(f64, f64) -> f64, from: f64| {
            members.iter().map(|&m| value(&boxes[m])).fold(from, pick)
        };
        Self {
            whole: SeenBox {
                base_from_box: Pose::from_parts(Translation3::from(at), rotation),
                size: BoxSize {
                    length: high[0] - low[0],
                    width: high[1] - low[1],
                    height: of(|b| b.size.height, f64::max, 0.0),
                },
                confidence: of(|b| b.confidence, f64::min, 1.0),
            },
            members,
            faces,
            is_across,
        }
    }
}

/// Every rectangle of two or more like boxes side by side, up to [`PlannerSettings::max_group`] of them, each once.
fn rectangles(boxes: &[SeenBox], layer: &[usize], settings: &PlannerSettings) -> Vec<Group> {
    let mut found = Vec::new();
    let mut known = BTreeSet::new();
    // A box looks alike after half a turn: the grid may run either way from its corner.
    let corners = layer
        .iter()
        .flat_map(|&corner| [(corner, 1.0), (corner, -1.0)]);
    for (corner, way) in corners {
        let cells = cells_from(boxes, layer, corner, way, settings);
        for columns in 1..=settings.max_group as i64 {
            for rows in 1..=settings.max_group as i64 / columns {
                let all = (0..columns)
                    .flat_map(|u| (0..rows).map(move |v| (u, v)))
                    .map(|cell| cells.get(&cell).copied());
                let Some(mut members) = all.collect::<Option<Vec<usize>>>() else {
                    continue;
                };
                members.sort_unstable();
                if members.len() > 1 && known.insert(members.clone()) {
                    found.push(Group::around(boxes, members));
                }
            }
        }
    }
    found
}

/// Like boxes at the places of a grid that begins at `corner` and runs along its X and Y, or (`way` -1) against them.
fn cells_from(
    boxes: &[SeenBox],
    layer: &[usize],
    corner: usize,
    way: f64,
    settings: &PlannerSettings,
) -> BTreeMap<(i64, i64), usize> {
    let first = &boxes[corner];
    let corner_from_base = first.base_from_box.inverse();
    // The place along an axis, if a box of side `side` at `at` is in line.
    let place = |at: f64, side: f64| {
        let cell = (at / (side + settings.group_gap * 0.5)).round();
        let rest = at - cell * side;
        let slack = cell.abs().max(1.0);
        let widest = if cell > 0.0 {
            slack * settings.group_gap
        } else {
            SAME
        };
        (cell >= 0.0 && rest >= -slack * OVERLAP && rest <= widest).then_some(cell as i64)
    };
    let mut cells = BTreeMap::new();
    for &index in layer {
        let seen = &boxes[index];
        let here = corner_from_base * seen.base_from_box;
        let x = here.rotation * Vector::x();
        let up = here.rotation * Vector::z();
        let alike = (seen.size.length - first.size.length).abs() < SAME
            && (seen.size.width - first.size.width).abs() < SAME
            && (seen.size.height - first.size.height).abs() < SAME
            && here.translation.z.abs() < SAME
            && x.y.abs() < SAME_TURN.sin()
            && up.z > SAME_TURN.cos();
        if !alike {
            continue;
        }
        let u = place(here.translation.x * way, first.size.length);
        let v = place(here.translation.y * way, first.size.width);
        if let (Some(u), Some(v)) = (u, v) {
            cells.entry((u, v)).or_insert(index);
        }
    }
    cells
}

/// A layer's boxes as the fewest picks: groups that `holds` accepts, and single boxes for the rest.
///
/// Taking any of them leaves the others a fewest-picks division of what remains, so no box is left alone without need.
/// The search is exact up to [`SEARCH_STEPS`] steps.
pub(crate) fn fewest_picks(
    boxes: &[SeenBox],
    layer: &[usize],
    settings: &PlannerSettings,
    holds: impl Fn(&Group) -> bool,
) -> Vec<Group> {
    let mut groups = rectangles(boxes, layer, settings);
    groups.retain(|group| holds(group));
    // Large ones first; equal ones keep the order of their boxes.
    groups.sort_by_key(|group| std::cmp::Reverse(group.members.len()));
    let mut search = Search {
        layer,
        largest: groups.first().map_or(1, |group| group.members.len()),
        groups: &groups,
        taken: BTreeSet::new(),
        chosen: Vec::new(),
        best: None,
        best_count: usize::MAX,
        steps: 0,
    };
    search.run();
    let chosen = search.best.unwrap_or_default();
    let mut picks: Vec<Group> = chosen.into_iter().map(|i| groups[i].clone()).collect();
    let grouped: BTreeSet<usize> = picks.iter().flat_map(|g| g.members.clone()).collect();
    let alone = layer.iter().filter(|index| !grouped.contains(index));
    picks.extend(alone.map(|&index| Group::single(index, &boxes[index])));
    picks
}

/// Depth-first search for the division of a layer with the fewest picks.
struct Search<'a> {
    layer: &'a [usize],
    groups: &'a [Group],
    largest: usize,
    taken: BTreeSet<usize>,
    chosen: Vec<usize>,
    best: Option<Vec<usize>>,
    best_count: usize,
    steps: usize,
}

impl Search<'_> {
    fn run(&mut self) {
        self.descend(0, 0);
    }

    /// `place` counts through the layer; `alone` are boxes so far that stay single.
    fn descend(&mut self, place: usize, alone: usize) {
        self.steps += 1;
        let count = self.chosen.len() + alone;
        let left = self.layer[place..]
            .iter()
            .filter(|index| !self.taken.contains(index))
            .count();
        if count + left.div_ceil(self.largest) >= self.best_count
            || (self.steps > SEARCH_STEPS && self.best.is_some())
        {
            return;
        }
        let free = self.layer[place..]
            .iter()
            .position(|index| !self.taken.contains(index));
        let Some(place) = free.map(|offset| place + offset) else {
            self.best_count = count;
            self.best = Some(self.chosen.clone());
            return;
        };
        let index = self.layer[place];
        for (number, group) in self.groups.iter().enumerate() {
            let fits = group.members.contains(&index)
                && group
                    .members
                    .iter()
                    .all(|member| !self.taken.contains(member));
            if !fits {
                continue;
            }
            self.taken.extend(&group.members);
            self.chosen.push(number);
            self.descend(place + 1, alone);
            self.chosen.pop();
            for member in &group.members {
                self.taken.remove(member);
            }
        }
        self.taken.insert(index);
        self.descend(place + 1, alone + 1);
        self.taken.remove(&index);
    }
}
