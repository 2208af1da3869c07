//! Arm, attached bodies and obstacles as solids, in several thicknesses.

use depal_arm::Arm;
use depal_frames::{JointPositions, PlacedShape, Point, Pose, convert};
use parry3d::{
    bounding_volume::{Aabb, BoundingVolume},
    math::Pose as Pose32,
    partitioning::{Bvh, BvhBuildStrategy},
    query,
    shape::SharedShape,
};

use super::request::TransferScene;
use crate::world::solid;

/// One solid of the arm or attached to it.
pub(crate) struct Body {
    /// Index of its link.
    link: usize,
    link_from_shape: Pose32,
    shape: SharedShape,
    /// The same, thicker by each padding.
    padded: Vec<SharedShape>,
    /// From the shape's origin to its farthest point, m.
    radius: f32,
    moves: bool,
    /// Corners of its box in the frame of its link, m: no point of it moves farther than one of them.
    corners: [Point; 8],
    /// Farthest corner from the origin of its link, m.
    pub lever: f64,
}

/// Obstacles of one thickness.
struct Obstacles {
    solids: Vec<(Pose32, SharedShape)>,
    tree: Bvh,
}

impl Obstacles {
    fn new(placed: &[PlacedShape], padding: f64) -> Self {
        let solids: Vec<_> = placed.iter().map(|p| solid(p, padding)).collect();
        let leaves: Vec<Aabb> = solids
            .iter()
            .map(|(pose, shape)| shape.compute_aabb(pose))
            .collect();
        Self {
            tree: Bvh::from_leaves(BvhBuildStrategy::Binned, &leaves),
            solids,
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
    thicknesses: Vec<Obstacles>,
}

/// Distances at one state.
pub(crate) struct Distances {
    /// Corners of every body, in the base frame.
    corners: Vec<[Point; 8]>,
    /// Least distance of every moving body to obstacles, m, at most the cap.
    to_obstacles: Vec<f32>,
    /// Distance of every pair, m, at most the cap.
    to_pairs: Vec<f32>,
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
        let thicknesses = PADDINGS
            .iter()
            .chain(&[0.0])
            .map(|&padding| Obstacles::new(&request.obstacles, padding))
            .collect();
        Self {
            arm,
            bodies,
            pairs,
            rigid_pairs,
            thicknesses,
        }
    }

    fn poses(&self, joints: &JointPositions) -> Vec<Pose32> {
        let frames = self.arm.base_from_links(joints);
        self.bodies
            .iter()
            .map(|b| convert::to_glam(&frames[b.link]) * b.link_from_shape)
            .collect()
    }

    /// The first contact at a state with bodies of one thickness, in a fixed order.
    pub fn contact(&self, joints: &JointPositions, thickness: usize) -> Option<Contact> {
        let poses = self.poses(joints);
        let obstacles = &self.thicknesses[thickness];
        for (body, (b, pose)) in self.bodies.iter().zip(&poses).enumerate() {
            if !b.moves {
                continue;
            }
            let around = b.shape.compute_aabb(pose);
            for i in obstacles.tree.intersect_aabb(&around) {
                let (at, solid) = &obstacles.solids[i as usize];
                let met = query::intersection_test(pose, b.shape.as_ref(), at, solid.as_ref());
                if met.is_ok_and(|m| m.intersecting) {
                    return Some(Contact::Obstacle {
                        body,
                        obstacle: i as usize,
                    });
                }
            }
        }
        let padding = PADDINGS.get(thickness).copied().unwrap_or(0.0) as f32;
        for &(first, second) in &self.pairs {
            let (a, b) = (&self.bodies[first], &self.bodies[second]);
            let reach = a.radius + b.radius + 2.0 * padding;
            if (poses[first].translation - poses[second].translation).length() > reach {
                continue;
            }
            let shape = a.padded.get(thickness).unwrap_or(&a.shape);
            let met = query::intersection_test(
                &poses[first],
                shape.as_ref(),
                &poses[second],
                b.shape.as_ref(),
            );
            if met.is_ok_and(|m| m.intersecting) {
                return Some(Contact::Pair { first, second });
            }
        }
        None
    }

    /// Distance of bodies that are checked but never move against each other, m, and the nearest such pair.
    pub fn rigid_distance(&self) -> Option<(f64, Contact)> {
        let poses = self.poses(&JointPositions::zeros(self.arm.joint_count()));
        self.rigid_pairs
            .iter()
            .map(|&(first, second)| {
                let far = f32::INFINITY;
                let distance = self.pair_distance(&poses, first, second, far);
                (f64::from(distance), Contact::Pair { first, second })
            })
            .min_by(|a, b| a.0.total_cmp(&b.0))
    }

    fn pair_distance(&self, poses: &[Pose32], first: usize, second: usize, cap: f32) -> f32 {
        let (a, b) = (&self.bodies[first], &self.bodies[second]);
        let gap =
            (poses[first].translation - poses[second].translation).length() - a.radius - b.radius;
        if gap >= cap {
            return cap;
        }
        query::distance(
            &poses[first],
            a.shape.as_ref(),
            &poses[second],
            b.shape.as_ref(),
        )
        .map_or(0.0, |d| d.distance.min(cap))
    }

    /// All distances of the bare bodies at one state, measured up to `cap`, m.
    pub fn distances(&self, joints: &JointPositions, cap: f64) -> Distances {
        let cap = cap as f32;
        let frames = self.arm.base_from_links(joints);
        let poses: Vec<Pose32> = self
            .bodies
            .iter()
            .map(|b| convert::to_glam(&frames[b.link]) * b.link_from_shape)
            .collect();
        let obstacles = &self.thicknesses[BARE];
        let (mut least, mut contact) = (cap, None);
        let mut to_obstacles = vec![cap; self.bodies.len()];
        for (body, (b, pose)) in self.bodies.iter().zip(&poses).enumerate() {
            if !b.moves {
                continue;
            }
            let around = b.shape.compute_aabb(pose).loosened(cap);
            for i in obstacles.tree.intersect_aabb(&around) {
                let (at, solid) = &obstacles.solids[i as usize];
                let d = query::distance(pose, b.shape.as_ref(), at, solid.as_ref())
                    .map_or(0.0, |d| d.distance);
                to_obstacles[body] = to_obstacles[body].min(d);
                if d < least {
                    least = d;
                    contact = Some(Contact::Obstacle {
                        body,
                        obstacle: i as usize,
                    });
                }
            }
        }
        let mut to_pairs = Vec::with_capacity(self.pairs.len());
        for &(first, second) in &self.pairs {
            let d = self.pair_distance(&poses, first, second, cap);
            to_pairs.push(d);
            if d < least {
                least = d;
                contact = Some(Contact::Pair { first, second });
            }
        }
        let corners = self
            .bodies
            .iter()
            .map(|b| b.corners.map(|c| frames[b.link] * c))
            .collect();
        Distances {
            corners,
            to_obstacles,
            to_pairs,
            least: f64::from(least),
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
                let sum = f64::from(a.to_obstacles[i] + b.to_obstacles[i]);
                least = least.min((sum - ways[i]) * 0.5 - stray);
            }
        }
        for (k, &(first, second)) in self.pairs.iter().enumerate() {
            let sum = f64::from(a.to_pairs[k] + b.to_pairs[k]);
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
    fn new(arm: &Arm, link: usize, placed: &PlacedShape) -> Self {
        let (link_from_shape, shape) = solid(placed, 0.0);
        let around = shape.compute_local_aabb();
        let corners = around
            .vertices()
            .map(|v| convert::point_from_glam(link_from_shape * v));
        let lever = corners.iter().map(|c| c.coords.norm()).fold(0.0, f64::max);
        Self {
            link,
            link_from_shape,
            padded: PADDINGS.iter().map(|&p| solid(placed, p).1).collect(),
            shape,
            radius: placed.shape.bounding_radius() as f32,
            moves: arm.joints_below(link) > 0,
            corners,
            lever,
        }
    }
}
