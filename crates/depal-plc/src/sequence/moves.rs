//! The moves of the sequence: along the path, up from the place, home.

use depal_frames::{JointPositions, Pose};
use depal_vm::system::{MoveKind, MoveRequest, MoveSpeed, MoveTarget, MoveZone, System};

use super::{SLOW_PERCENT, Sequence};

/// Speed of reorientation at 100 percent, rad/s.
const TURN_SPEED: f64 = 500.0 * std::f64::consts::PI / 180.0;
/// Corner zones next to stops and elsewhere: TCP in metres, reorientation in radians.
const NEAR_ZONE: MoveZone = MoveZone::Fly {
    tcp: 0.010,
    orientation: 1.5 * std::f64::consts::PI / 180.0,
};
const FREE_ZONE: MoveZone = MoveZone::Fly {
    tcp: 0.050,
    orientation: 7.5 * std::f64::consts::PI / 180.0,
};
impl Sequence {
    /// Queues waypoints of the path.
    pub(super) fn follow(
        &mut self,
        places: impl Iterator<Item = usize>,
        acceleration: f64,
        system: &dyn System,
    ) {
        for place in places {
            let point = &self.path.points[place];
            let zone = if self.path.is_stop(place) {
                MoveZone::Fine
            } else if self.path.is_near_stop(place) {
                NEAR_ZONE
            } else {
                FREE_ZONE
            };
            let (kind, target) = if point.is_linear {
                let base_from_tcp = self.tcp(&point.joints, system);
                (MoveKind::Linear, MoveTarget::Tcp(base_from_tcp))
            } else {
                (MoveKind::Joint, MoveTarget::Joints(point.joints))
            };
            let request = self.request(kind, target, point.percent, acceleration, zone);
            self.moves.push_back(request);
        }
    }

    pub(super) fn go_home(&mut self, percent: f64, zone: MoveZone) {
        let target = MoveTarget::Joints(self.settings.home);
        let request = self.request(MoveKind::Joint, target, percent, 1.0, zone);
        self.moves.push_back(request);
    }

    /// Straight up from the place, then home without stopping there.
    pub(super) fn retreat(&mut self, system: &dyn System) {
        if let Some(place) = self.path.points.last() {
            let mut base_from_tcp = self.tcp(&place.joints, system);
            base_from_tcp.translation.z += self.settings.retreat;
            let target = MoveTarget::Tcp(base_from_tcp);
            let request = self.request(MoveKind::Linear, target, SLOW_PERCENT, 1.0, NEAR_ZONE);
            self.moves.push_back(request);
        }
        self.go_home(100.0, FREE_ZONE);
    }

    fn tcp(&self, joints: &JointPositions, system: &dyn System) -> Pose {
        system.forward(joints) * self.settings.flange_from_tcp
    }

    fn request(
        &self,
        kind: MoveKind,
        target: MoveTarget,
        percent: f64,
        acceleration: f64,
        zone: MoveZone,
    ) -> MoveRequest {
        let share = percent / 100.0;
        MoveRequest {
            kind,
            target,
            speed: MoveSpeed {
                tcp: self.settings.tcp_speed * share,
                orientation: TURN_SPEED * share,
                joint_fraction: 1.0,
                acceleration_fraction: acceleration,
            },
            zone,
            flange_from_tcp: self.settings.flange_from_tcp,
            configuration: None,
            location: self.location(),
        }
    }
}
