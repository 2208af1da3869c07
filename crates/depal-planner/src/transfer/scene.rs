//! Arm, attached bodies and obstacles as solids, in several thicknesses.

use depal_arm::{Arm, Load};
use depal_frames::{JointPositions, PlacedShape, Point, Pose, convert};
use depal_motion::{BlendedPath, MotionError};
use parry3d::{
    bounding_volume::Aabb,
    math::{Pose as Pose32, Vector as Vector32},
    partitioning::{Bvh, BvhBuildStrategy},
    query,
};

use super::{oriented::Oriented, request::TransferScene, solid::Solid};
use crate::world::distance;

/// One solid of the arm or attached to it.
pub(crate) struct Body {
    /// Index of its link.
    link: usize,
    solid: Solid,
    moves: bool,
    /// Farthest corner of its box from the origin of its link, m.
    pub lever: f64,
}

/// What stands around.
struct Obstacles {
    solids: Vec<Solid>,
    /// In the base frame.
    boxes: Vec<Oriented>,
    tree: Bvh,
}

fn around(at: &Oriented, grown: f64) -> Aabb {
    let (c, e) = (at.centre, at.extents());
    // A hair wider than what rounding takes away.
    let side = |i: usize, sign: f64| (c[i] + sign * (e[i] + grown + 1e-6)) as f32;
    let corner = |sign: f64| Vector32::new(side(0, sign), side(1, sign), side(2, sign));
    Aabb::new(corner(-1.0), corner(1.0))
}

impl Obstacles {
    fn new(placed: &[PlacedShape]) -> Self {
        let solids: Vec<Solid> = placed.iter().map(Solid::new).collect();
        let boxes: Vec<Oriented> = solids
            .iter()
            .map(|s| Oriented::new(&s.frame_from_box, s.half))
            .collect();
        let leaves: Vec<Aabb> = boxes.iter().map(|b| around(b, 0.0)).collect();
        Self {
            tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves),
            solids,
            boxes,
        }
    }
}

/// What touches what, by index.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Contact {
    Obstacle { body: usize, obstacle: usize },
    Pair { first: usize, second: usize },
}

/// Paddings that are tried, thickest first, m; the bare bodies come after them.
pub(crate) const PADDINGS: [f64; 3] = [0.02, 0.006, 0.0015];
/// Index of the bare bodies.
pub(crate) const BARE: usize = PADDINGS.len();

pub(crate) struct Scene<'a> {
    pub arm: &'a Arm,
    pub bodies: Vec<Body>,
    /// Pairs that move against each other and are not allowed to meet.
    pairs: Vec<(usize, usize)>,
    /// Pairs that are checked but never move against each other.
    rigid_pairs: Vec<(usize, usize)>,
    obstacles: Obstacles,
    load: Load,
}

/// Bodies at one state.
struct State {
    frames: Vec<Pose>,
    boxes: Vec<Oriented>,
}

/// Distances at one state.
pub(crate) struct Distances {
    /// Corners of every body, in the base frame.
    corners: Vec<[Point; 8]>,
    /// Least distance of every moving body to obstacles, m, at most the cap.
    to_obstacles: Vec<f64>,
    /// Distance of every pair, m, at most the cap.
    to_pairs: Vec<f64>,
    pub least: f64,
    pub contact: Option<Contact>,
}

impl<'a> Scene<'a> {
    pub fn new(request: &'a TransferScene) -> Self {
        let arm = &request.arm;
        let links = arm.links();
        let mut bodies = Vec::new();
        for (link, placed) in &request.attached {
            bodies.push(Body::new(arm, *link, placed));
        }
        for (i, link) in links.iter().enumerate().rev() {
            bodies.extend(link.collision.iter().map(|p| Body::new(arm, i, p)));
        }
        let allowed = |a: &str, b: &str| {
            request
                .allowed_pairs
                .iter()
                .any(|(x, y)| (x == a && y == b) || (x == b && y == a))
        };
        // Link poses at states without symmetry tell which links are rigid to each other.
        let probes: Vec<Vec<Pose>> = [0.31, 0.77]
            .iter()
            .map(|&share| {
                let mut joints = JointPositions::zeros(arm.joint_count());
                for (i, limit) in arm.limits().iter().enumerate() {
                    let at = (share * (i as f64 + 1.37)).fract();
                    joints[i] = limit.lower + (limit.upper - limit.lower) * at;
                }
                arm.base_from_links(&joints)
            })
            .collect();
        let rigid = |a: usize, b: usize| {
            let [first, second] = [0, 1].map(|k| probes[k][a].inverse() * probes[k][b]);
            (first.translation.vector - second.translation.vector).norm() < 1e-9
                && first.rotation.angle_to(&second.rotation) < 1e-7
        };
        let (mut pairs, mut rigid_pairs) = (Vec::new(), Vec::new());
        for i in 0..bodies.len() {
            for j in i + 1..bodies.len() {
                let (a, b): (&Body, &Body) = (&bodies[i], &bodies[j]);
                if a.link == b.link
                    || !(a.moves || b.moves)
                    || allowed(&links[a.link].name, &links[b.link].name)
                {
                    continue;
                }
                if rigid(a.link, b.link) {
                    rigid_pairs.push((i, j));
                } else {
                    pairs.push((i, j));
                }
            }
        }
        Self {
            arm,
            bodies,
            pairs,
            rigid_pairs,
            obstacles: Obstacles::new(&request.obstacles),
            load: request.load,
        }
    }

    /// Time over a path inside the limits of the arm, s; fails where the arm could not stand with its load.
    pub fn time(&self, path: &BlendedPath) -> Result<f64, MotionError> {
        path.loaded_time(self.arm, &Load::NONE, &self.load)
    }

    fn state(&self, joints: &JointPositions) -> State {
        let frames = self.arm.base_from_links(joints);
        let boxes = self.bodies.iter().map(|b| b.placed(&frames)).collect();
        State { frames, boxes }
    }

    /// Pose of a body's shape in the collision library's form.
    fn pose(&self, state: &State, body: usize) -> Pose32 {
        let body = &self.bodies[body];
        convert::to_glam(&state.frames[body.link]) * body.solid.frame_from_shape
    }

    /// The first contact at a state with bodies of one thickness, in a fixed order.
    pub fn contact(&self, joints: &JointPositions, thickness: usize) -> Option<Contact> {
        let mut state = State {
            frames: self.arm.base_from_links(joints),
            boxes: Vec::with_capacity(self.bodies.len()),
        };
        let padding = PADDINGS.get(thickness).copied().unwrap_or(0.0);
        for (body, b) in self.bodies.iter().enumerate() {
            let at = b.placed(&state.frames);
            state.boxes.push(at);
            if !b.moves {
                continue;
            }
            // The corner of a padded obstacle reaches out by the padding's diagonal.
            let near = around(&at, padding * 1.7321);
            for i in self.obstacles.tree.intersect_aabb(&near) {
                let obstacle = i as usize;
                if !at.meets(&self.obstacles.boxes[obstacle], padding) {
                    continue;
                }
                let other = &self.obstacles.solids[obstacle];
                if b.solid.is_box && other.is_box
                    || self.shapes_meet(&state, body, obstacle, thickness)
                {
                    return Some(Contact::Obstacle { body, obstacle });
                }
            }
        }
        for &(first, second) in &self.pairs {
            if !state.boxes[second].meets(&state.boxes[first], padding) {
                continue;
            }
            let (a, b) = (&self.bodies[first].solid, &self.bodies[second].solid);
            if a.is_box && b.is_box || {
                let (pose_a, pose_b) = (self.pose(&state, first), self.pose(&state, second));
                let thick = a.thick_box(thickness);
                let a = thick.as_ref().unwrap_or_else(|| a.thick(thickness));
                query::intersection_test(&pose_a, a.as_ref(), &pose_b, b.shape.as_ref())
                    .is_ok_and(|m| m.intersecting)
            } {
                return Some(Contact::Pair { first, second });
            }
        }
        None
    }

    fn shapes_meet(&self, state: &State, body: usize, obstacle: usize, thickness: usize) -> bool {
        let pose = self.pose(state, body);
        let other = &self.obstacles.solids[obstacle];
        let thick = other.thick_box(thickness);
        let shape = thick.as_ref().unwrap_or_else(|| other.thick(thickness));
        query::intersection_test(
            &pose,
            self.bodies[body].solid.shape.as_ref(),
            &other.frame_from_shape,
            shape.as_ref(),
        )
        .is_ok_and(|m| m.intersecting)
    }

    /// Distance of bodies that are checked but never move against each other, m, and the nearest such pair.
    pub fn rigid_distance(&self) -> Option<(f64, Contact)> {
        let state = self.state(&JointPositions::zeros(self.arm.joint_count()));
        self.rigid_pairs
            .iter()
            .map(|&(first, second)| {
                let distance = self.pair_distance(&state, first, second);
                (distance, Contact::Pair { first, second })
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))
    }

    fn pair_distance(&self, state: &State, first: usize, second: usize) -> f64 {
        let shape = |body: usize| &self.bodies[body].solid.shape;
        let (a, b) = (self.pose(state, first), self.pose(state, second));
        distance(&a, shape(first), &b, shape(second)).map_or(0.0, f64::from)
    }

    fn obstacle_distance(&self, state: &State, body: usize, obstacle: usize) -> f64 {
        let other = &self.obstacles.solids[obstacle];
        let shape = &self.bodies[body].solid.shape;
        let pose = self.pose(state, body);
        distance(&pose, shape, &other.frame_from_shape, &other.shape).map_or(0.0, f64::from)
    }

    /// All distances of the bare bodies at one state, measured up to `cap`, m.
    pub fn distances(&self, joints: &JointPositions, cap: f64) -> Distances {
        self.distances_below(joints, cap, cap)
    }

    /// The same, but what is surely farther away than `exact`, m, is only told to be at least so far as its box is.
    pub fn distances_below(&self, joints: &JointPositions, cap: f64, exact: f64) -> Distances {
        let state = self.state(joints);
        let (mut least, mut contact) = (cap, None);
        let mut to_obstacles = vec![cap; self.bodies.len()];
        for (body, (b, at)) in self.bodies.iter().zip(&state.boxes).enumerate() {
            if !b.moves {
                continue;
            }
            let near = around(at, cap);
            for i in self.obstacles.tree.intersect_aabb(&near) {
                let obstacle = i as usize;
                let mut d = at.least_distance(&self.obstacles.boxes[obstacle]);
                if d >= to_obstacles[body] {
                    continue;
                }
                if d < exact {
                    d = self.obstacle_distance(&state, body, obstacle);
                }
                to_obstacles[body] = to_obstacles[body].min(d);
                if d < least {
                    least = d;
                    contact = Some(Contact::Obstacle { body, obstacle });
                }
            }
        }
        let mut to_pairs = Vec::with_capacity(self.pairs.len());
        for &(first, second) in &self.pairs {
            let mut d = state.boxes[first].least_distance(&state.boxes[second]);
            if d < exact {
                d = self.pair_distance(&state, first, second);
            }
            to_pairs.push(d.min(cap));
            if d < least {
                least = d;
                contact = Some(Contact::Pair { first, second });
            }
        }
        Distances {
            corners: state.boxes.iter().map(Oriented::corners).collect(),
            to_obstacles,
            to_pairs,
            least,
            contact,
        }
    }

    /// A distance, m, that nothing falls below between two states, when no point strays more than `stray`, m,
    /// from the straight line between its two places.
    ///
    /// A point that is `d0` away at the begin and `d1` at the end of a straight way of length `w`
    /// is nowhere nearer than `(d0 + d1 - w) / 2`.
    pub fn least_between(&self, a: &Distances, b: &Distances, stray: f64) -> f64 {
        let way = |body: usize| -> f64 {
            a.corners[body]
                .iter()
                .zip(&b.corners[body])
                .map(|(p, q)| (q - p).norm())
                .fold(0.0, f64::max)
        };
        let ways: Vec<f64> = (0..self.bodies.len())
            .map(|i| if self.bodies[i].moves { way(i) } else { 0.0 })
            .collect();
        let mut least = f64::INFINITY;
        for (i, body) in self.bodies.iter().enumerate() {
            if body.moves {
                let sum = a.to_obstacles[i] + b.to_obstacles[i];
                least = least.min((sum - ways[i]) * 0.5 - stray);
            }
        }
        for (k, &(first, second)) in self.pairs.iter().enumerate() {
            let sum = a.to_pairs[k] + b.to_pairs[k];
            let way = ways[first] + ways[second];
            least = least.min((sum - way) * 0.5 - 2.0 * stray);
        }
        least
    }

    /// A contact in words.
    pub fn words(&self, contact: Contact) -> String {
        let name = |body: usize| self.arm.links()[self.bodies[body].link].name.clone();
        match contact {
            Contact::Obstacle { body, obstacle } => {
                format!("'{}' touches obstacle {obstacle}", name(body))
            }
            Contact::Pair { first, second } => {
                format!("'{}' touches '{}'", name(first), name(second))
            }
        }
    }
}

impl Body {
    /// The box around it with the links in these frames.
    fn placed(&self, frames: &[Pose]) -> Oriented {
        Oriented::new(
            &(frames[self.link] * self.solid.frame_from_box),
            self.solid.half,
        )
    }

    fn new(arm: &Arm, link: usize, placed: &PlacedShape) -> Self {
        let solid = Solid::new(placed);
        let at = Oriented::new(&solid.frame_from_box, solid.half);
        let far = |c: &Point| c.coords.norm();
        Self {
            link,
            lever: at.corners().iter().map(far).fold(0.0, f64::max),
            solid,
            moves: arm.joints_below(link) > 0,
        }
    }
}
