//! From a segment to joint-space geometry with path lengths.

use std::sync::Arc;

use depal_arm::Arm;
use depal_frames::{JointPositions, Point, Pose};

use crate::cell::CellLimits;
use crate::circle::Circle;
use crate::curve::{Curve, combine};
use crate::torque::TorqueLimits;
use crate::{Along, Interpolation, MotionError, Segment, SegmentTarget, Zone};
use line::line;
use posture::{check_joints, in_quarters, off_quarters};

mod line;
mod posture;

/// Divisions of a cell next to a stand.
const STAND_PIECES: i32 = 4;
/// Shorter than this a path has no length to cut a zone from.
const NO_LENGTH: f64 = 1e-3;

/// A grid point with the path travelled so far.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node {
    pub parameter: f64,
    pub tcp: f64,
    pub turn: f64,
}

/// The geometry of a whole segment, before corners cut it.
#[derive(Debug, Clone)]
pub(crate) struct Shape {
    pub curve: Arc<Curve>,
    pub limits: Arc<CellLimits>,
    pub nodes: Vec<Node>,
    pub flange_from_tcp: Pose,
    pub zone: Zone,
    pub end: JointPositions,
}

impl Shape {
    /// None if the segment does not move the arm.
    pub fn new(
        arm: &Arm,
        start: &JointPositions,
        segment: &Segment,
        torque: Option<&Arc<TorqueLimits>>,
    ) -> Result<Option<Self>, MotionError> {
        segment.speed.check()?;
        let tool = &segment.flange_from_tcp;
        let (curve, end) = match (&segment.interpolation, &segment.target) {
            (Interpolation::Joint, target) => {
                let end = match target {
                    SegmentTarget::Joints(joints) => *joints,
                    SegmentTarget::Tcp(base_from_tcp)
                    | SegmentTarget::Arc {
                        to: base_from_tcp, ..
                    } => {
                        let base_from_flange = base_from_tcp * tool.inverse();
                        arm.inverse_nearest(&base_from_flange, start)
                            .filter(|found| {
                                segment
                                    .quarters
                                    .is_none_or(|q| off_quarters(found, q).is_none())
                            })
                            .map_or_else(
                                || in_quarters(arm, start, &base_from_flange, segment),
                                Ok,
                            )?
                    }
                };
                check_joints(arm, &end)?;
                let delta = combine(&[1.0, -1.0], &[&end, start]);
                (
                    Curve::Line {
                        from: *start,
                        delta,
                    },
                    end,
                )
            }
            (Interpolation::Linear, target) => {
                let base_from_tcp = match target {
                    SegmentTarget::Tcp(to) | SegmentTarget::Arc { to, .. } => *to,
                    SegmentTarget::Joints(joints) => {
                        check_joints(arm, joints)?;
                        arm.base_from_flange(joints) * tool
                    }
                };
                let circle = match target {
                    SegmentTarget::Arc { through, .. } => {
                        let begin = arm.base_from_flange(start) * tool;
                        Some(Circle::through(
                            &Point::from(begin.translation.vector),
                            through,
                            &Point::from(base_from_tcp.translation.vector),
                        )?)
                    }
                    _ => None,
                };
                let joints = line(arm, start, &base_from_tcp, tool, circle.as_ref())?;
                let end = joints[joints.len() - 1];
                if let Some((joint, quarter)) = segment.quarters.and_then(|q| off_quarters(&end, q))
                {
                    return Err(MotionError::Configuration {
                        joint,
                        found_deg: end[joint - 1].to_degrees(),
                        quarter,
                    });
                }
                (Curve::through(joints), end)
            }
        };
        if start.max_distance(&end) < 1e-9 {
            return Ok(None);
        }
        let nodes = measure(arm, &curve, curve.cells(), |_| tool);
        if let Some(torque) = torque {
            for node in &nodes {
                torque.check_holding(&curve.position(node.parameter))?;
            }
        }
        let mut limits = CellLimits::new(arm.limits(), &segment.speed);
        limits.torque = torque.cloned();
        Ok(Some(Self {
            curve: Arc::new(curve),
            limits: Arc::new(limits),
            nodes,
            flange_from_tcp: *tool,
            zone: segment.zone,
            end,
        }))
    }

    fn last(&self) -> Node {
        self.nodes[self.nodes.len() - 1]
    }

    /// Parameter where the TCP has travelled so far, or has so far to go. A mere turn has no metres:
    /// its end or its start.
    pub fn parameter_at(&self, along: Along) -> f64 {
        let Some(length) = self.length() else {
            return match along {
                Along::BeforeEnd(_) => 1.0,
                Along::AfterStart(_) => 0.0,
            };
        };
        let travelled = match along {
            Along::BeforeEnd(distance) => length - distance,
            Along::AfterStart(distance) => distance,
        };
        if travelled >= length {
            return 1.0;
        }
        reached(&self.nodes, |n| n.tcp, travelled)
    }

    /// Length of the TCP path, metres; none if the tool only turns.
    fn length(&self) -> Option<f64> {
        let length = self.last().tcp;
        (length > NO_LENGTH).then_some(length)
    }

    /// Parameters where this segment is left and where the next is entered; none without a corner.
    pub fn corner(&self, next: &Self) -> Option<(f64, f64)> {
        let (tcp, orientation) = match self.zone {
            Zone::Fine => return None,
            Zone::Blend { joints } => return self.blend(next, joints),
            Zone::Fly { tcp, orientation } => (tcp, orientation),
        };
        let half = |shape: &Self| shape.length().map_or(f64::INFINITY, |l| 0.5 * l);
        let tcp = tcp.min(half(self)).min(half(next));
        let own = self.last();
        let leave = [
            self.length()
                .map(|l| reached(&self.nodes, |n| n.tcp, l - tcp)),
            (own.turn > NO_LENGTH)
                .then(|| reached(&self.nodes, |n| n.turn, own.turn - orientation)),
        ];
        let leave = leave.into_iter().flatten().fold(0.5, f64::max);
        let enter = [
            next.length().map(|_| reached(&next.nodes, |n| n.tcp, tcp)),
            (next.last().turn > NO_LENGTH).then(|| reached(&next.nodes, |n| n.turn, orientation)),
        ];
        let enter = enter.into_iter().flatten().fold(0.5, f64::min);
        (leave < 1.0 - 1e-6 && enter > 1e-6).then_some((leave, enter))
    }

    /// The corner that begins so far (L2 in joint space) before the end of a joint move and ends so far behind it.
    fn blend(&self, next: &Self, joints: f64) -> Option<(f64, f64)> {
        let share = |shape: &Self| match &*shape.curve {
            Curve::Line { delta, .. } => {
                let length = delta.iter().map(|d| d * d).sum::<f64>().sqrt();
                Some((joints / length).min(1.0))
            }
            _ => None,
        };
        let (leave, enter) = (1.0 - share(self)?, share(next)?);
        (leave < 1.0 - 1e-6 && enter > 1e-6).then_some((leave, enter))
    }

    /// Grid of the part `from..=to`: cell borders with their TCP and turn rates.
    pub fn cells(&self, from: f64, to: f64) -> Vec<((f64, f64), (f64, f64))> {
        divided(self.even_cells(from, to), from <= 0.0, to >= 1.0)
    }

    fn even_cells(&self, from: f64, to: f64) -> Vec<((f64, f64), (f64, f64))> {
        const SLIVER: f64 = 1e-7;
        let mut cells = Vec::with_capacity(self.nodes.len());
        let mut begin = from;
        for pair in self.nodes.windows(2) {
            let width = pair[1].parameter - pair[0].parameter;
            let rates = (
                (pair[1].tcp - pair[0].tcp) / width,
                (pair[1].turn - pair[0].turn) / width,
            );
            let end = pair[1].parameter.min(to);
            if end - begin > SLIVER {
                cells.push(((begin, end), rates));
                begin = end;
            }
        }
        cells
    }
}

/// Cells (ranges of the parameter, each with what belongs to it) of a stretch that may begin or end with a stand.
///
/// Within a cell the acceleration is even. A cell next to a stand is divided towards it, each piece half as
/// wide as the one before, or a slow move would take the whole cell to gain its speed.
pub(crate) fn divided<T: Copy>(
    mut cells: Vec<((f64, f64), T)>,
    from_stand: bool,
    to_stand: bool,
) -> Vec<((f64, f64), T)> {
    if to_stand && let Some(((begin, end), with)) = cells.pop() {
        let mut border = begin;
        for piece in 1..=STAND_PIECES {
            let next = end - (end - begin) * 0.5_f64.powi(piece);
            cells.push(((border, next), with));
            border = next;
        }
        cells.push(((border, end), with));
    }
    if from_stand && !cells.is_empty() {
        let ((begin, end), with) = cells.remove(0);
        let mut pieces = Vec::new();
        let mut border = begin;
        for piece in (1..=STAND_PIECES).rev() {
            let next = begin + (end - begin) * 0.5_f64.powi(piece);
            pieces.push(((border, next), with));
            border = next;
        }
        pieces.push(((border, end), with));
        cells.splice(0..0, pieces);
    }
    cells
}

/// Evenly spaced nodes along a curve with the path travelled.
pub(crate) fn measure<'a>(
    arm: &Arm,
    curve: &Curve,
    cells: usize,
    tool: impl Fn(f64) -> &'a Pose,
) -> Vec<Node> {
    let mut nodes = Vec::with_capacity(cells + 1);
    let mut node = Node {
        parameter: 0.0,
        tcp: 0.0,
        turn: 0.0,
    };
    nodes.push(node);
    let mut flange = arm.base_from_flange(&curve.position(0.0));
    for i in 1..=cells {
        let parameter = i as f64 / cells as f64;
        let next = arm.base_from_flange(&curve.position(parameter));
        let tool = tool(parameter - 0.5 / cells as f64);
        let (a, b) = (flange * tool, next * tool);
        node = Node {
            parameter,
            tcp: node.tcp + (b.translation.vector - a.translation.vector).norm(),
            turn: node.turn + a.rotation.angle_to(&b.rotation),
        };
        nodes.push(node);
        flange = next;
    }
    nodes
}

/// Parameter at which a quantity that grows along the nodes has the given value.
fn reached(nodes: &[Node], quantity: impl Fn(&Node) -> f64, value: f64) -> f64 {
    if value <= 0.0 {
        return 0.0;
    }
    for pair in nodes.windows(2) {
        let (a, b) = (quantity(&pair[0]), quantity(&pair[1]));
        if b >= value && b > a {
            let share = ((value - a) / (b - a)).clamp(0.0, 1.0);
            return pair[0].parameter + share * (pair[1].parameter - pair[0].parameter);
        }
    }
    1.0
}
