//! Levenberg-Marquardt over both unknown transforms on all disc centres.
//!
//! Source of the damping rule: D. W. Marquardt, "An algorithm for least-squares estimation of
//! nonlinear parameters", SIAM Journal on Applied Mathematics 11(2), 1963, 431-441.

use depal_frames::{Point, Pose, Rotation, Vector};
use nalgebra::{Matrix3, SMatrix, SVector};

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

    /// A touched point counts as much as a picture: it is measured about as well as a board's middle.
    fn touch_weight(&self) -> f64 {
        self.in_board.len() as f64
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

    /// Sum of squared residuals, square metres.
    pub fn cost(&self, unknowns: &Unknowns) -> f64 {
        let discs: f64 = self
            .in_hub(unknowns)
            .map(|(i, k, p)| (unknowns.camera_from_hub * p - self.in_camera[i][k]).norm_squared())
            .sum();
        let touched: f64 = self
            .touched
            .iter()
            .map(|(c, h)| (unknowns.camera_from_hub * h - c).norm_squared())
            .sum();
        discs + self.touch_weight() * touched
    }

    fn normal_equations(&self, unknowns: &Unknowns, gauge: &Gauge) -> (Normal, Step) {
        let mut normal = Normal::zeros();
        let mut right = Step::zeros();
        let turn_x = unknowns.camera_from_hub.rotation.to_rotation_matrix();
        let turns: Vec<Matrix3<f64>> = self
            .hub_from_carrier
            .iter()
            .map(|m| (turn_x * m.rotation.to_rotation_matrix()).into_inner())
            .collect();
        let mut jacobian = SMatrix::<f64, 3, 12>::zeros();
        for (i, k, in_hub) in self.in_hub(unknowns) {
            let residual = unknowns.camera_from_hub * in_hub - self.in_camera[i][k];
            let arm_x = turn_x * (in_hub.coords - gauge.middle_in_hub);
            let arm_y = unknowns.carrier_from_board.rotation * self.in_board[k].coords;
            let set = |at: usize, block: Matrix3<f64>, j: &mut SMatrix<f64, 3, 12>| {
                j.fixed_view_mut::<3, 3>(0, at).copy_from(&block);
            };
            set(0, -arm_x.cross_matrix() / gauge.lever_x, &mut jacobian);
            set(3, Matrix3::identity(), &mut jacobian);
            set(
                6,
                -turns[i] * arm_y.cross_matrix() / gauge.lever_y,
                &mut jacobian,
            );
            set(9, turns[i], &mut jacobian);
            normal += jacobian.transpose() * jacobian;
            right -= jacobian.transpose() * residual;
        }
        let weight = self.touch_weight();
        for (in_camera, in_hub) in self.touched {
            let residual = unknowns.camera_from_hub * in_hub - in_camera;
            let arm_x = turn_x * (in_hub.coords - gauge.middle_in_hub);
            let mut jacobian = SMatrix::<f64, 3, 12>::zeros();
            jacobian
                .fixed_view_mut::<3, 3>(0, 0)
                .copy_from(&(-arm_x.cross_matrix() / gauge.lever_x));
            jacobian
                .fixed_view_mut::<3, 3>(0, 3)
                .copy_from(&Matrix3::identity());
            normal += jacobian.transpose() * jacobian * weight;
            right -= jacobian.transpose() * residual * weight;
        }
        (normal, right)
    }

    /// The normal matrix in the scales of the gauge, per disc centre: an eigenvalue of 1 means that
    /// a step of 1 m in that direction moves the discs by 1 m, 0 that it does not move them at all.
    pub fn information(&self, unknowns: &Unknowns) -> Normal {
        let count = (self.hub_from_carrier.len() * self.in_board.len()).max(1) as f64;
        self.normal_equations(unknowns, &self.gauge(unknowns)).0 / count
    }

    /// Descends from `start`; also the sum of squares where it ends.
    pub fn solve(&self, start: Unknowns) -> (Unknowns, f64) {
        let mut best = start;
        let mut cost = self.cost(&best);
        let mut damping = 1e-4;
        for _ in 0..100 {
            let gauge = self.gauge(&best);
            let (normal, right) = self.normal_equations(&best, &gauge);
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
                    let next_cost = self.cost(&next);
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
