//! Levenberg-Marquardt over both unknown transforms on all disc centres.
//!
//! Source of the damping rule: D. W. Marquardt, "An algorithm for least-squares estimation of
//! nonlinear parameters", SIAM Journal on Applied Mathematics 11(2), 1963, 431-441.

use depal_frames::{Point, Pose, Rotation, Vector};
use nalgebra::{Matrix3, SMatrix, SVector};

use super::weights::Weights;

/// Rotation and translation of `camera_from_hub`, then of `carrier_from_board`.
pub type Normal = SMatrix<f64, 12, 12>;
type Step = SVector<f64, 12>;

/// What the estimation works on.
pub struct Problem<'a> {
    /// By pose.
    pub hub_from_carrier: &'a [Pose],
    /// Disc centres in the camera frame, by pose, in the order of `in_board`.
    pub in_camera: &'a [&'a [Point]],
    /// Disc centres in the board frame.
    pub in_board: &'a [Point],
    /// Touched points: in the camera frame and in the hub frame.
    pub touched: &'a [(Point, Point)],
}

/// The two transforms.
#[derive(Debug, Clone, Copy)]
pub struct Unknowns {
    /// X.
    pub camera_from_hub: Pose,
    /// Y.
    pub carrier_from_board: Pose,
}

/// Scales of the step's twelve numbers and the point about which the camera turns.
///
/// X turns about the middle of all disc centres, and both rotations are counted in metres at the
/// typical distance from it: then all twelve move the discs by about as much, and the normal
/// matrix tells at a glance what is not observable.
struct Gauge {
    middle_in_hub: Vector,
    lever_x: f64,
    lever_y: f64,
}

impl Problem<'_> {
    fn in_hub(&self, unknowns: &Unknowns) -> impl Iterator<Item = (usize, usize, Point)> {
        let carrier_from_board = unknowns.carrier_from_board;
        self.hub_from_carrier
            .iter()
            .enumerate()
            .flat_map(move |(i, m)| {
                let hub_from_board = m * carrier_from_board;
                self.in_board
                    .iter()
                    .enumerate()
                    .map(move |(k, b)| (i, k, hub_from_board * b))
            })
    }

    fn gauge(&self, unknowns: &Unknowns) -> Gauge {
        let count = (self.hub_from_carrier.len() * self.in_board.len()).max(1) as f64;
        let sum = self
            .in_hub(unknowns)
            .fold(Vector::zeros(), |s, (_, _, p)| s + p.coords);
        let middle = sum / count;
        let spread: f64 = self
            .in_hub(unknowns)
            .map(|(_, _, p)| (p.coords - middle).norm_squared())
            .sum();
        let own: f64 = self.in_board.iter().map(|p| p.coords.norm_squared()).sum();
        Gauge {
            middle_in_hub: middle,
            lever_x: (spread / count).sqrt().max(1e-3),
            lever_y: (own / self.in_board.len().max(1) as f64).sqrt().max(1e-3),
        }
    }

    /// Weighted sum of squared residuals, in square metres of a disc centre's own noise.
    fn cost(&self, unknowns: &Unknowns, weights: &Weights) -> f64 {
        let mut sum = 0.0;
        for (i, pose) in weights.poses.iter().enumerate() {
            let camera_from_board =
                unknowns.camera_from_hub * self.hub_from_carrier[i] * unknowns.carrier_from_board;
            let mut squares = 0.0;
            let mut shared = SVector::zeros();
            for (k, b) in self.in_board.iter().enumerate() {
                let residual = camera_from_board * b - self.in_camera[i][k];
                squares += residual.norm_squared();
                shared += pose.shared[k].transpose() * residual;
            }
            sum += squares - shared.dot(&(pose.inverse * shared));
        }
        let touched: f64 = self
            .touched
            .iter()
            .map(|(c, h)| (unknowns.camera_from_hub * h - c).norm_squared())
            .sum();
        sum + weights.touched * touched
    }

    fn normal_equations(
        &self,
        unknowns: &Unknowns,
        gauge: &Gauge,
        weights: &Weights,
    ) -> (Normal, Step) {
        let mut normal = Normal::zeros();
        let mut right = Step::zeros();
        let turn_x = unknowns.camera_from_hub.rotation.to_rotation_matrix();
        let from_middle = |in_hub: &Point| {
            let arm = turn_x * (in_hub.coords - gauge.middle_in_hub);
            -arm.cross_matrix() / gauge.lever_x
        };
        let mut jacobian = SMatrix::<f64, 3, 12>::zeros();
        jacobian.fixed_view_mut::<3, 3>(0, 3).fill_with_identity();
        for (i, m) in self.hub_from_carrier.iter().enumerate() {
            let hub_from_board = m * unknowns.carrier_from_board;
            let turn: Matrix3<f64> = (turn_x * m.rotation.to_rotation_matrix()).into_inner();
            jacobian.fixed_view_mut::<3, 3>(0, 9).copy_from(&turn);
            let pose = &weights.poses[i];
            let mut shared = SMatrix::<f64, 9, 12>::zeros();
            let mut shared_right = SVector::<f64, 9>::zeros();
            for (k, b) in self.in_board.iter().enumerate() {
                let in_hub = hub_from_board * b;
                let residual = unknowns.camera_from_hub * in_hub - self.in_camera[i][k];
                let arm_y = unknowns.carrier_from_board.rotation * b.coords;
                jacobian
                    .fixed_view_mut::<3, 3>(0, 0)
                    .copy_from(&from_middle(&in_hub));
                jacobian
                    .fixed_view_mut::<3, 3>(0, 6)
                    .copy_from(&(-turn * arm_y.cross_matrix() / gauge.lever_y));
                normal += jacobian.transpose() * jacobian;
                right -= jacobian.transpose() * residual;
                shared += pose.shared[k].transpose() * jacobian;
                shared_right += pose.shared[k].transpose() * residual;
            }
            normal -= shared.transpose() * pose.inverse * shared;
            right += shared.transpose() * (pose.inverse * shared_right);
        }
        for (in_camera, in_hub) in self.touched {
            let residual = unknowns.camera_from_hub * in_hub - in_camera;
            let mut jacobian = SMatrix::<f64, 3, 12>::zeros();
            jacobian
                .fixed_view_mut::<3, 3>(0, 0)
                .copy_from(&from_middle(in_hub));
            jacobian.fixed_view_mut::<3, 3>(0, 3).fill_with_identity();
            normal += jacobian.transpose() * jacobian * weights.touched;
            right -= jacobian.transpose() * residual * weights.touched;
        }
        (normal, right)
    }

    /// The normal matrix in the scales of the gauge, per disc centre: an eigenvalue of 1 means that
    /// a step of 1 m in that direction moves the discs by 1 m, 0 that it does not move them at all.
    pub fn information(&self, unknowns: &Unknowns) -> Normal {
        let count = (self.hub_from_carrier.len() * self.in_board.len()).max(1) as f64;
        // A touched point counts as a picture here: it is measured about as well.
        let weights = Weights::equal(self.in_camera, self.in_board.len() as f64);
        self.normal_equations(unknowns, &self.gauge(unknowns), &weights)
            .0
            / count
    }

    /// Descends from `start`; also the weighted sum of squares where it ends.
    ///
    /// The weights hang on where the flange is in the camera frame, so they are set up twice:
    /// at the beginning and at the first result.
    pub fn solve(&self, start: Unknowns, flange_in_hub: &[Point]) -> (Unknowns, f64) {
        let weights = |at: &Unknowns| {
            let flanges: Vec<Point> = flange_in_hub
                .iter()
                .map(|p| at.camera_from_hub * p)
                .collect();
            Weights::new(self.in_camera, &flanges)
        };
        let (first, _) = self.descend(start, &weights(&start));
        self.descend(first, &weights(&first))
    }

    fn descend(&self, start: Unknowns, weights: &Weights) -> (Unknowns, f64) {
        let mut best = start;
        let mut cost = self.cost(&best, weights);
        let mut damping = 1e-4;
        for _ in 0..100 {
            let gauge = self.gauge(&best);
            let (normal, right) = self.normal_equations(&best, &gauge, weights);
            let mut improved = None;
            while damping < 1e9 {
                let mut damped = normal;
                let floor = 1e-12 * normal.trace();
                for d in 0..12 {
                    damped[(d, d)] += damping * normal[(d, d)] + floor;
                }
                if let Some(factor) = damped.cholesky() {
                    let step = factor.solve(&right);
                    let next = moved(&best, &step, &gauge);
                    let next_cost = self.cost(&next, weights);
                    if next_cost < cost {
                        improved = Some((next, next_cost, step.norm()));
                        break;
                    }
                }
                damping *= 8.0;
            }
            let Some((next, next_cost, length)) = improved else {
                break;
            };
            let gain = cost - next_cost;
            (best, cost) = (next, next_cost);
            damping = (damping * 0.1).max(1e-12);
            if length < 1e-12 || gain < 1e-14 * cost {
                break;
            }
        }
        (best, cost)
    }
}

/// The unknowns after a step in the scales of the gauge.
fn moved(unknowns: &Unknowns, step: &Step, gauge: &Gauge) -> Unknowns {
    let part = |at: usize| Vector::new(step[at], step[at + 1], step[at + 2]);
    let x = &unknowns.camera_from_hub;
    let middle_in_camera = x * Point::from(gauge.middle_in_hub);
    let rotation = Rotation::new(part(0) / gauge.lever_x) * x.rotation;
    let translation = middle_in_camera.coords + part(3) - rotation * gauge.middle_in_hub;
    let y = &unknowns.carrier_from_board;
    Unknowns {
        camera_from_hub: Pose::from_parts(translation.into(), rotation),
        carrier_from_board: Pose::from_parts(
            (y.translation.vector + part(9)).into(),
            Rotation::new(part(6) / gauge.lever_y) * y.rotation,
        ),
    }
}
