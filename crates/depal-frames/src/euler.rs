use nalgebra::Translation3;

use crate::{Pose, Rotation, Vector};

/// How a brand writes an orientation as three angles on the wire.
///
/// Source: published robot manuals; the triplet order of ABB on the wire is undocumented
/// and therefore a setting ([`EulerConvention::AbbZyx`] sends Rz, Ry, Rx, as the name lists them).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum EulerConvention {
    /// Intrinsic Z, Y', X''; triplet (Rz, Ry, Rx). ABB default here.
    #[default]
    AbbZyx,
    /// Intrinsic Z, Y', X''; triplet (Rx, Ry, Rz): the other reading of the ABB triplet.
    AbbXyz,
    /// Intrinsic Z, Y', X''; triplet (A, B, C) = (Rz, Ry, Rx). KUKA.
    KukaAbc,
    /// Fixed axes X, Y, Z; triplet (W, P, R) = (Rx, Ry, Rz). FANUC.
    FanucWpr,
}

impl EulerConvention {
    /// Rotation from the triplet, radians.
    pub fn rotation(self, angles: [f64; 3]) -> Rotation {
        // Intrinsic Z-Y'-X'' and fixed X-Y-Z are the same rotation: Rz * Ry * Rx.
        let (rx, ry, rz) = match self {
            Self::AbbZyx | Self::KukaAbc => (angles[2], angles[1], angles[0]),
            Self::AbbXyz | Self::FanucWpr => (angles[0], angles[1], angles[2]),
        };
        Rotation::from_euler_angles(rx, ry, rz)
    }

    /// Triplet of a rotation, radians. At a middle angle of +-90 degrees one outer angle is 0.
    pub fn angles(self, rotation: &Rotation) -> [f64; 3] {
        let (rx, ry, rz) = rotation.euler_angles();
        match self {
            Self::AbbZyx | Self::KukaAbc => [rz, ry, rx],
            Self::AbbXyz | Self::FanucWpr => [rx, ry, rz],
        }
    }

    /// Pose from x, y, z in mm and the triplet in degrees, as it stands on the wire.
    pub fn pose_from_mm_deg(self, values: [f64; 6]) -> Pose {
        let rotation = self.rotation([
            values[3].to_radians(),
            values[4].to_radians(),
            values[5].to_radians(),
        ]);
        let position = Vector::new(values[0], values[1], values[2]) * 1e-3;
        Pose::from_parts(Translation3::from(position), rotation)
    }

    /// x, y, z in mm and the triplet in degrees.
    pub fn mm_deg_from_pose(self, pose: &Pose) -> [f64; 6] {
        let p = pose.translation.vector * 1e3;
        let a = self.angles(&pose.rotation).map(f64::to_degrees);
        [p.x, p.y, p.z, a[0], a[1], a[2]]
    }
}
