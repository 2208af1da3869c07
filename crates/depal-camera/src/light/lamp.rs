//! What the projector's light makes of one point, before chance enters.

use crate::{CameraSpec, Material};

/// Distance for which `SensorSpec::axial_noise` is given, metres.
pub(crate) const NOISE_DISTANCE: f32 = 3.0;
/// Albedo times projector cosine at which the axial noise is as given (brown board, head on).
const NOISE_SIGNAL: f32 = 0.5;
/// A weak or strong signal changes the axial noise by no more than these factors.
pub(crate) const SIGNAL_FACTORS: (f32, f32) = (0.5, 3.0);
/// Most that oblique sight adds to the axial noise.
const MOST_OBLIQUE: f32 = 20.0;
/// Half of the angle around the mirror direction that is over-exposed, as seen by the half vector.
const LOBE_DEG: f64 = 4.0;

/// Bits for the chance to be kept, below those for the deviation.
pub(crate) const KEEP_BITS: u32 = 12;
/// Always kept.
const KEEP_ALL: u32 = (1 << KEEP_BITS) - 1;
/// Steps of the packed deviation per metre.
const SIGMA_STEPS: f32 = 1e7;

/// Deviation of the axial noise, cut off at 0.1 m, and chance to be kept (0..=4095), in one word.
#[inline(always)]
pub(super) fn pack(sigma: f32, keep: u32) -> u32 {
    // Pushes the integer into the low bits of the mantissa; the shift drops the others.
    const SHIFT: f32 = 8_388_608.0; // 2^23
    let steps = (sigma * SIGMA_STEPS).min(1_048_575.0) + SHIFT;
    (steps.to_bits() << KEEP_BITS) | keep
}

/// Deviation, metres, and chance from such a word.
#[inline(always)]
pub(crate) fn unpack(packed: u32) -> (f32, u32) {
    let steps = ((packed >> KEEP_BITS) as i32) as f32;
    (steps * (1.0 / SIGMA_STEPS), packed & KEEP_ALL)
}

/// The projector, the camera and a material.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lamp {
    baseline: f32,
    near: f32,
    far: f32,
    /// Deviation per z^2, head on.
    sigma: f32,
    /// Least cosine to the projector, at the distance of the exposure.
    dark_cos: f32,
    /// sqrt of this times (distance to the projector / c1) is the factor of a weak signal there.
    weak: f32,
    /// 1/sqrt of what distance does to the signal: this plus the other times z.
    fall: (f32, f32),
    /// Least and greatest of that factor.
    factors: (f32, f32),
    /// Grey of a surface that the projector does not reach.
    pub ambient_grey: f32,
    /// Grey of a surface facing the projector at 1 m.
    grey: f32,
    needs_light: bool,
    /// Chance to be kept, 0..=4095.
    pub keep: u32,
    pub gloss: f32,
    /// Where the chance of being lost starts and where it is certain, as cosines; both 0 = nowhere.
    grazing: (f32, f32),
    /// At this cosine and above nothing is lost; more than 1 on glossy surfaces.
    plain: f32,
}

/// A ray (x, y, 1) that meets a plane: 1/z there, and how far the plane lies before the camera (`k`)
/// and before the projector (`c1`), metres.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hit {
    pub w: f32,
    pub x: f32,
    /// y^2 + 1.
    pub yy: f32,
    pub k: f32,
    pub c1: f32,
}

/// What a lamp makes of it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lit {
    /// Metres; 0 where the sensor gets nothing for sure.
    pub depth: f32,
    /// Deviation of the axial noise, metres.
    pub sigma: f32,
    /// Grey value before lens and noise.
    pub grey: f32,
    cos_view: f32,
    cos_light: f32,
}

impl Lamp {
    /// `exposed_for`: distance for which the picture is exposed, metres; none where the signal does not
    /// depend on distance.
    pub fn new(spec: &CameraSpec, material: &Material, exposed_for: Option<f64>) -> Self {
        let s = &spec.sensor;
        let albedo = material.albedo as f32;
        let ambient = s.ambient as f32;
        let keep = (1.0 - material.dropout).clamp(0.0, 1.0);
        let reach = (s.exposure_distance * s.exposure_distance) as f32;
        let grazing = if s.grazing_end < std::f64::consts::FRAC_PI_2 {
            (s.grazing_start.cos() as f32, s.grazing_end.cos() as f32)
        } else {
            (0.0, 0.0)
        };
        Self {
            baseline: spec.baseline as f32,
            near: spec.near as f32,
            far: spec.far as f32,
            sigma: (s.axial_noise * material.noise_factor) as f32
                / (NOISE_DISTANCE * NOISE_DISTANCE),
            dark_cos: s.dark_limit as f32 / albedo.max(1e-6),
            weak: NOISE_SIGNAL / albedo.max(1e-6),
            fall: exposed_for.map_or((1.0, 0.0), |z| (0.0, (1.0 / z) as f32)),
            factors: if s.radiometric_noise {
                SIGNAL_FACTORS
            } else {
                (1.0, 1.0)
            },
            ambient_grey: 255.0 * albedo * ambient,
            grey: 255.0 * albedo * (1.0 - ambient) * reach,
            needs_light: s.shadow,
            keep: (keep * f64::from(KEEP_ALL)).round() as u32,
            gloss: material.gloss as f32,
            grazing,
            plain: if material.gloss > 0.0 {
                f32::INFINITY
            } else {
                grazing.0
            },
        }
    }

    #[inline(always)]
    pub fn shine(&self, hit: Hit) -> Lit {
        let Hit { w, x, yy, k, c1 } = hit;
        let z = 1.0 / w;
        let ray2 = x * x + yy;
        let per_d = 1.0 / self.distance(z, x, yy);
        let cos_view = (k * w / ray2.sqrt()).max(1e-6);
        let c1 = c1.max(0.0);
        let cos_light = c1 * per_d;
        let oblique = (1.0 / cos_view).min(MOST_OBLIQUE);
        let fall = self.fall.0 + self.fall.1 * z;
        let weak = (fall * (self.weak / cos_light.max(1e-9)).sqrt())
            .max(self.factors.0)
            .min(self.factors.1);
        let lost = (z < self.near)
            | (z > self.far)
            | (cos_light < self.dark_cos * (fall * fall))
            | (self.needs_light & (cos_light <= 0.0));
        Lit {
            depth: if lost { 0.0 } else { z },
            sigma: self.sigma * z * z * oblique * weak,
            grey: self.ambient_grey + self.grey * cos_light * per_d * per_d,
            cos_view,
            cos_light,
        }
    }

    /// From the projector to the point at depth `z`.
    #[inline(always)]
    fn distance(&self, z: f32, x: f32, yy: f32) -> f32 {
        let across = self.baseline - x * z;
        (across * across + yy * (z * z)).sqrt()
    }

    /// True when neither grazing sight nor gloss takes a pixel. Distances to points of a plane are
    /// greatest at the corners of an area, so the cosines are least there: what is plain at its
    /// corners is plain throughout.
    #[inline(always)]
    pub fn is_plain(&self, lit: &Lit) -> bool {
        self.least_cosine(lit) >= self.plain
    }

    #[inline(always)]
    fn least_cosine(&self, lit: &Lit) -> f32 {
        let light = if self.needs_light { lit.cos_light } else { 1.0 };
        lit.cos_view.min(light)
    }

    /// Takes what is seen at a grazing angle; returns the chance to be kept.
    #[inline(always)]
    pub fn take_grazing(&self, lit: &mut Lit) -> u32 {
        let (start, end) = self.grazing;
        let share = (self.least_cosine(lit) - end) / (start - end).max(1e-6);
        // Pushes the fraction out of the mantissa.
        const SHIFT: f32 = 8_388_608.0; // 2^23
        let on = start > 0.0;
        lit.depth = if on & (share <= 0.0) { 0.0 } else { lit.depth };
        let share = if on { share.clamp(0.0, 1.0) } else { 1.0 };
        (self.keep as i32 as f32 * share + SHIFT).to_bits() & KEEP_ALL
    }

    /// Whether the mirror image of the projector on a glossy surface blinds the camera.
    #[inline(always)]
    pub fn is_over_exposed(&self, hit: Hit) -> bool {
        let lit = self.shine(hit);
        // Between the directions to camera and projector: v . l = (z ray^2 - x b) / (|ray| d).
        let z = 1.0 / hit.w;
        let ray2 = hit.x * hit.x + hit.yy;
        let d = self.distance(z, hit.x, hit.yy);
        let between = (z * ray2 - hit.x * self.baseline) / (ray2.sqrt() * d);
        let half = (lit.cos_view + lit.cos_light) / (2.0 + 2.0 * between).max(1e-6).sqrt();
        (lit.cos_light > 0.0) & (half > LOBE_DEG.to_radians().cos() as f32)
    }
}
