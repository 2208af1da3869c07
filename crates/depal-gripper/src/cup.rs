use crate::CupSpec;

/// Stiffness of the open bellows as a share of the collapsed cup's: a bellows of 12 mm stroke
/// and 10 N/mm when collapsed pushes with 12 N when it is pressed flat.
const BELLOWS_SHARE: f64 = 0.1;
/// Shear stiffness as a share of the axial one.
const SHEAR_SHARE: f64 = 0.5;
/// A lip seals when it is pressed in by at least this much, m; it opens at gap zero.
const SEAL_COMPRESSION: f64 = 0.0005;
/// Tilt up to which a lip seals fully, rad.
const FULL_SEAL_TILT: f64 = 0.087;
/// Tilt from which it does not seal at all, rad.
const NO_SEAL_TILT: f64 = 0.21;

/// What lies in front of one cup, measured with tool and carton at the same instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CupContact {
    /// The carton whose face is met along the tool's Z axis; `None` when there is nothing.
    pub carton: Option<u32>,
    /// Distance from the relaxed lip to the face along the tool's Z, m; negative: pressed in.
    pub gap: f64,
    /// Angle between the cup axis and the face's normal, rad.
    pub tilt: f64,
    /// Speed at which the gap closes, m/s.
    pub closing_speed: f64,
    /// Share of the lip's circle over that face, 0 to 1.
    pub covered: f64,
    /// Velocity of the face relative to the lip along the tool's X and Y, m/s.
    pub slip_velocity: [f64; 2],
}

impl CupContact {
    /// Nothing within reach.
    pub const OPEN: Self = Self {
        carton: None,
        gap: f64::INFINITY,
        tilt: 0.0,
        closing_speed: 0.0,
        covered: 0.0,
        slip_velocity: [0.0; 2],
    };

    /// A cup at rest, square and fully over a face of `carton`.
    pub fn touching(carton: u32, gap: f64) -> Self {
        Self {
            carton: Some(carton),
            gap,
            covered: 1.0,
            ..Self::OPEN
        }
    }

    /// Seal of a lip in this position, 0 (open) to 1: whole lip on the face, small tilt.
    pub(crate) fn seal(&self) -> f64 {
        if self.carton.is_none() || self.covered < 1.0 {
            return 0.0;
        }
        ((NO_SEAL_TILT - self.tilt) / (NO_SEAL_TILT - FULL_SEAL_TILT)).clamp(0.0, 1.0)
    }
}

/// Force of one cup on its carton, at the lip's centre on the face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CupForce {
    /// Index of the cup.
    pub cup: usize,
    /// The carton.
    pub carton: u32,
    /// Along the tool's -Z, N: positive pulls the carton to the gripper, negative pushes it away.
    pub pull: f64,
    /// Along the tool's X and Y, N.
    pub shear: [f64; 2],
}

/// Why a lip opened.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Opening {
    /// Pulled away from the face.
    PulledOff,
    /// Slid over an edge or tilted.
    Uncovered,
}

/// Memory of one cup.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct CupState {
    /// The carton on which the lip is sealed.
    pub sealed_on: Option<u32>,
    /// Seal of the last update, 0 to 1.
    pub seal: f64,
    /// Elastic shear deflection of the lip, tool X and Y, m.
    pub shear: [f64; 2],
}

/// Force with which a cup of `spec` pushes a face away, N, never negative.
///
/// `gap` as in [`CupContact`]. The open bellows is soft over its stroke; once it is flat
/// (the face at the `tcp` plane) the full stiffness resists.
pub fn axial_push(spec: &CupSpec, gap: f64, closing_speed: f64) -> f64 {
    if gap >= 0.0 {
        return 0.0;
    }
    let bellows = spec.stiffness * BELLOWS_SHARE * -gap;
    let flat = spec.stiffness * (-gap - spec.stroke).max(0.0);
    (bellows + flat + spec.damping * closing_speed).max(0.0)
}

impl CupState {
    /// Follows the lip: sealed, resealed or opened. A lip that opened must be pressed on again.
    pub fn follow(&mut self, contact: &CupContact) -> Option<Opening> {
        self.seal = contact.seal();
        if let Some(carton) = self.sealed_on {
            let opening = if contact.carton == Some(carton) && contact.gap > 0.0 {
                Some(Opening::PulledOff)
            } else if contact.carton != Some(carton) || self.seal == 0.0 {
                Some(Opening::Uncovered)
            } else {
                None
            };
            if opening.is_some() {
                self.sealed_on = None;
                self.seal = 0.0;
            }
            return opening;
        }
        if self.seal > 0.0 && contact.gap <= -SEAL_COMPRESSION {
            self.sealed_on = contact.carton;
        } else {
            self.seal = 0.0;
        }
        None
    }

    /// What the vacuum can hold at this cup, N: `s * dp * A`.
    pub fn limit(&self, spec: &CupSpec, vacuum: f64) -> f64 {
        self.seal * vacuum * spec.area()
    }

    /// Force on the carton: vacuum pull minus the lip's push, and shear up to
    /// `friction * push` (the push is `dp * A - f_n`, the squeezed lip).
    pub fn force(
        &mut self,
        index: usize,
        spec: &CupSpec,
        contact: &CupContact,
        vacuum: f64,
        friction: f64,
        dt: f64,
    ) -> Option<CupForce> {
        let carton = contact.carton?;
        if contact.gap >= 0.0 {
            self.shear = [0.0; 2];
            return None;
        }
        let push = axial_push(spec, contact.gap, contact.closing_speed);
        let stiffness = spec.stiffness * SHEAR_SHARE;
        let damping = spec.damping * SHEAR_SHARE;
        let mut shear = [0.0; 2];
        for (axis, force) in shear.iter_mut().enumerate() {
            self.shear[axis] += contact.slip_velocity[axis] * dt;
            *force = -stiffness * self.shear[axis] - damping * contact.slip_velocity[axis];
        }
        let size = shear[0].hypot(shear[1]);
        let bound = friction * push;
        if size > bound {
            // The lip slips: the force stays at the bound, the deflection at what it can carry.
            for (axis, force) in shear.iter_mut().enumerate() {
                *force *= bound / size;
                self.shear[axis] = -*force / stiffness;
            }
        }
        Some(CupForce {
            cup: index,
            carton,
            pull: self.limit(spec, vacuum) - push,
            shear,
        })
    }
}
