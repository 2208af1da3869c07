//! Geometry in joint space: position and derivatives over a path parameter.

use depal_frames::JointPositions;

/// Joint travel per cell of a straight joint move or a corner, radians.
const JOINT_STEP: f64 = 0.04;

/// Cells for so much travel of a joint, radians.
pub(crate) fn cells_for(travel: f64) -> usize {
    ((travel / JOINT_STEP).ceil() as usize).clamp(16, 64)
}

/// A curve over a parameter in 0..=1.
#[derive(Debug, Clone)]
pub(crate) enum Curve {
    /// `from + u * delta`.
    Line {
        from: JointPositions,
        delta: JointPositions,
    },
    /// Cubic Hermite pieces over evenly spaced nodes; `slopes` are derivatives over the parameter.
    Sampled {
        nodes: Vec<JointPositions>,
        slopes: Vec<JointPositions>,
    },
    /// A cubic Bezier curve.
    Corner { control: [JointPositions; 4] },
}

/// First and second derivative over the parameter.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Derivatives {
    pub first: JointPositions,
    pub second: JointPositions,
}

impl Curve {
    /// Hermite pieces through evenly spaced nodes, at least five.
    /// Slopes from five-point differences (error of fourth order), one-sided at the ends.
    pub fn through(nodes: Vec<JointPositions>) -> Self {
        let last = nodes.len() - 1;
        let scale = last as f64 / 12.0;
        let slope = |at: usize| {
            let (first, weights) = match at {
                0 => (0, [-25.0, 48.0, -36.0, 16.0, -3.0]),
                1 => (0, [-3.0, -10.0, 18.0, -6.0, 1.0]),
                _ if at == last => (last - 4, [3.0, -16.0, 36.0, -48.0, 25.0]),
                _ if at + 1 == last => (last - 4, [-1.0, 6.0, -18.0, 10.0, 3.0]),
                _ => (at - 2, [1.0, -8.0, 0.0, 8.0, -1.0]),
            };
            combine(
                &weights.map(|w| w * scale),
                &[
                    &nodes[first],
                    &nodes[first + 1],
                    &nodes[first + 2],
                    &nodes[first + 3],
                    &nodes[first + 4],
                ],
            )
        };
        let slopes = (0..=last).map(slope).collect();
        Self::Sampled { nodes, slopes }
    }

    /// Position.
    pub fn position(&self, u: f64) -> JointPositions {
        match self {
            Self::Line { from, delta } => combine(&[1.0, u], &[from, delta]),
            Self::Sampled { nodes, slopes } => {
                let pieces = nodes.len() - 1;
                let i = piece(pieces, u);
                let h = 1.0 / pieces as f64;
                let t = u * pieces as f64 - i as f64;
                let (t2, t3) = (t * t, t * t * t);
                combine(
                    &[
                        2.0 * t3 - 3.0 * t2 + 1.0,
                        3.0 * t2 - 2.0 * t3,
                        (t3 - 2.0 * t2 + t) * h,
                        (t3 - t2) * h,
                    ],
                    &[&nodes[i], &nodes[i + 1], &slopes[i], &slopes[i + 1]],
                )
            }
            Self::Corner {
                control: [a, b, c, d],
            } => {
                let v = 1.0 - u;
                combine(
                    &[v * v * v, 3.0 * v * v * u, 3.0 * v * u * u, u * u * u],
                    &[a, b, c, d],
                )
            }
        }
    }

    /// Derivatives at `u`, seen from the side of `inside` where the second one steps.
    pub fn derivatives(&self, u: f64, inside: f64) -> Derivatives {
        match self {
            Self::Line { delta, .. } => Derivatives {
                first: *delta,
                second: JointPositions::zeros(delta.len()),
            },
            Self::Sampled { nodes, slopes } => {
                let pieces = nodes.len() - 1;
                let i = piece(pieces, inside);
                let n = pieces as f64;
                let t = u * n - i as f64;
                let of = [&nodes[i], &nodes[i + 1], &slopes[i], &slopes[i + 1]];
                let rise = (6.0 * t * t - 6.0 * t) * n;
                let bend = (12.0 * t - 6.0) * n * n;
                Derivatives {
                    first: combine(
                        &[
                            rise,
                            -rise,
                            3.0 * t * t - 4.0 * t + 1.0,
                            3.0 * t * t - 2.0 * t,
                        ],
                        &of,
                    ),
                    second: combine(
                        &[bend, -bend, (6.0 * t - 4.0) * n, (6.0 * t - 2.0) * n],
                        &of,
                    ),
                }
            }
            Self::Corner {
                control: [a, b, c, d],
            } => {
                let v = 1.0 - u;
                let of = [a, b, c, d];
                Derivatives {
                    first: combine(
                        &[
                            -3.0 * v * v,
                            3.0 * v * v - 6.0 * v * u,
                            6.0 * v * u - 3.0 * u * u,
                            3.0 * u * u,
                        ],
                        &of,
                    ),
                    second: combine(
                        &[6.0 * v, 6.0 * u - 12.0 * v, 6.0 * v - 12.0 * u, 6.0 * u],
                        &of,
                    ),
                }
            }
        }
    }

    /// How many cells it is cut into for its law.
    pub fn cells(&self) -> usize {
        match self {
            Self::Line { delta, .. } => {
                cells_for(delta.iter().fold(0.0, |most, d| d.abs().max(most)))
            }
            Self::Sampled { nodes, .. } => nodes.len() - 1,
            Self::Corner { control } => {
                cells_for(control.windows(2).map(|w| w[0].max_distance(&w[1])).sum())
            }
        }
    }

    /// Whether it rounds the corner between two segments.
    pub fn is_corner(&self) -> bool {
        matches!(self, Self::Corner { .. })
    }

    /// Whether the second derivative is zero everywhere.
    pub fn is_straight(&self) -> bool {
        matches!(self, Self::Line { .. })
    }
}

fn piece(pieces: usize, u: f64) -> usize {
    ((u * pieces as f64).max(0.0) as usize).min(pieces - 1)
}

/// Sum of weighted joint vectors.
pub(crate) fn combine<const N: usize>(
    weights: &[f64; N],
    of: &[&JointPositions; N],
) -> JointPositions {
    let mut sum = JointPositions::zeros(of[0].len());
    for (weight, joints) in weights.iter().zip(of) {
        for (s, j) in sum.iter_mut().zip(joints.iter()) {
            *s += weight * j;
        }
    }
    sum
}
