//! What a program asks for, as the path takes it.

use depal_motion::{Interpolation, Segment, SegmentTarget, Speed, Zone};
use depal_vm::system::{MoveKind, MoveRequest, MoveTarget, MoveZone};

pub(super) fn segment(request: &MoveRequest) -> Segment {
    Segment {
        interpolation: match request.kind {
            MoveKind::Joint => Interpolation::Joint,
            MoveKind::Linear => Interpolation::Linear,
        },
        target: match &request.target {
            MoveTarget::Joints(joints) => SegmentTarget::Joints(*joints),
            MoveTarget::Tcp(pose) => SegmentTarget::Tcp(*pose),
            MoveTarget::Arc { through, to } => SegmentTarget::Arc {
                through: *through,
                to: *to,
            },
        },
        flange_from_tcp: request.flange_from_tcp,
        speed: Speed {
            tcp: request.speed.tcp,
            orientation: request.speed.orientation,
            joint_fraction: request.speed.joint_fraction,
            acceleration_fraction: request.speed.acceleration_fraction,
        },
        zone: match request.zone {
            MoveZone::Fine => Zone::Fine,
            MoveZone::Fly { tcp, orientation } => Zone::Fly { tcp, orientation },
        },
        quarters: request.configuration,
    }
}
