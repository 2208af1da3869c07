use depal_frames::Pose;

use crate::system::{MoveTarget, System};

/// Length of the TCP path of a move from where the queue ends, metres; for a joint move that of the line, for an arc
/// both chords, a little less than the arc.
pub fn path_length(system: &dyn System, target: &MoveTarget, flange_from_tcp: &Pose) -> f64 {
    let begin = system.forward(&system.planned_joints()) * flange_from_tcp;
    let begin = begin.translation.vector;
    match target {
        MoveTarget::Joints(joints) => {
            let end = system.forward(joints) * flange_from_tcp;
            (end.translation.vector - begin).norm()
        }
        MoveTarget::Tcp(to) => (to.translation.vector - begin).norm(),
        MoveTarget::Arc { through, to } => {
            (through.coords - begin).norm() + (to.translation.vector - through.coords).norm()
        }
    }
}
