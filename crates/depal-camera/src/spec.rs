use std::f64::consts::FRAC_PI_2;

use depal_frames::Intrinsics;

use crate::light::{NOISE_DISTANCE, SIGNAL_FACTORS};

/// What is wrong with a [`CameraSpec`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CameraError {
    /// A value is outside what the model is made for.
    #[error("camera {field}: expected {expected}, found {found}")]
    OutOfRange {
        /// Name of the field.
        field: &'static str,
        /// What is accepted, with its unit.
        expected: &'static str,
        /// What was given.
        found: f64,
    },
}

/// The constant description of a depth camera: one imager and one projector.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraSpec {
    /// Pinhole model of the imager.
    pub intrinsics: Intrinsics,
    /// Least depth that is measured, metres. A nearer surface still hides what is behind it.
    pub near: f64,
    /// Greatest depth that is measured, metres.
    pub far: f64,
    /// The projector stands at (baseline, 0, 0) of the camera frame, metres; may be negative.
    pub baseline: f64,
    /// What the sensor adds to and takes from the ideal image.
    pub sensor: SensorSpec,
}

impl CameraSpec {
    /// Checks that every figure is one that the model is made for.
    ///
    /// # Errors
    /// [`CameraError::OutOfRange`] with the first field that is not.
    pub fn validate(&self) -> Result<(), CameraError> {
        let check = |holds: bool, field, expected, found| {
            if holds {
                Ok(())
            } else {
                Err(CameraError::OutOfRange {
                    field,
                    expected,
                    found,
                })
            }
        };
        let i = &self.intrinsics;
        let s = &self.sensor;
        let share = |x: f64| (0.0..=1.0).contains(&x);
        let positive = |x: f64| x > 0.0 && x.is_finite();
        let not_negative = |x: f64| x >= 0.0 && x.is_finite();
        let (width, height) = (i.width as f64, i.height as f64);
        check(
            (1.0..=16384.0).contains(&width),
            "width",
            "1 to 16384 px",
            width,
        )?;
        check(
            (1.0..=16384.0).contains(&height),
            "height",
            "1 to 16384 px",
            height,
        )?;
        check(positive(i.fx), "fx", "more than 0 px", i.fx)?;
        check(positive(i.fy), "fy", "more than 0 px", i.fy)?;
        check(i.cx.is_finite(), "cx", "a finite number of px", i.cx)?;
        check(i.cy.is_finite(), "cy", "a finite number of px", i.cy)?;
        check(positive(self.near), "near", "more than 0 m", self.near)?;
        check(self.far > self.near, "far", "more than near, m", self.far)?;
        check(
            self.baseline.abs() <= 5.0,
            "baseline",
            "-5 to 5 m",
            self.baseline,
        )?;
        check(
            not_negative(s.axial_noise),
            "axial_noise",
            "0 m or more",
            s.axial_noise,
        )?;
        check(
            share(s.correlated_share),
            "correlated_share",
            "0 to 1",
            s.correlated_share,
        )?;
        check(
            not_negative(s.lateral_jitter_px),
            "lateral_jitter_px",
            "0 px or more",
            s.lateral_jitter_px,
        )?;
        check(not_negative(s.quantum), "quantum", "0 m or more", s.quantum)?;
        check(
            not_negative(s.disparity_step_px),
            "disparity_step_px",
            "0 px or more",
            s.disparity_step_px,
        )?;
        check(
            share(s.edge_dropout + s.mixed_pixels),
            "edge_dropout + mixed_pixels",
            "0 to 1",
            s.edge_dropout + s.mixed_pixels,
        )?;
        check(
            share(s.random_dropout),
            "random_dropout",
            "0 to 1",
            s.random_dropout,
        )?;
        check(
            not_negative(s.signal_distance),
            "signal_distance",
            "0 m or more",
            s.signal_distance,
        )?;
        check(not_negative(s.bowl), "bowl", "0 m or more", s.bowl)?;
        check(
            s.scale_error.abs() <= 0.1,
            "scale_error",
            "-0.1 to 0.1",
            s.scale_error,
        )?;
        check(
            not_negative(s.disparity_base),
            "disparity_base",
            "0 px m or more",
            s.disparity_base,
        )?;
        check(
            s.distance_bias.abs() <= 1.0,
            "distance_bias",
            "-1 to 1 m",
            s.distance_bias,
        )?;
        check(share(s.ambient), "ambient", "0 to 1", s.ambient)?;
        check(
            s.grazing_start <= s.grazing_end && s.grazing_end <= FRAC_PI_2,
            "grazing_end",
            "grazing_start to pi/2 rad",
            s.grazing_end,
        )
    }
}

/// The terms of the sensor model. Each can be switched off by itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SensorSpec {
    /// A point that the projector does not reach is lost in depth and dark in intensity.
    /// It counts as hidden when something stands more than 2 mm before it.
    pub shadow: bool,
    /// Standard deviation of depth at 3 m on a surface facing the camera, metres.
    /// It grows with z squared and with 1/cos of the incidence (stereo triangulation). 0 = off.
    pub axial_noise: f64,
    /// Share of that variance that is correlated over [`Self::correlation_px`], 0 to 1.
    /// White noise alone would let a plane fit over 10,000 pixels be a hundred times too good.
    pub correlated_share: f64,
    /// Length of that correlation, pixels; less than 2 acts as 2.
    pub correlation_px: usize,
    /// Standard deviation of the nearest-neighbour sideways shift, pixels, which is cut off at 16.
    /// 0 = off.
    pub lateral_jitter_px: f64,
    /// Share of the pixels at a depth step that are lost. 0 = off.
    pub edge_dropout: f64,
    /// Share of the pixels at a depth step that land between both surfaces. Where between them is the
    /// weight that the blurred edge has in the pixel, a blur's cumulative share at the edge's place in
    /// it; that place is by chance, so the weight is uniform from 0 to 1. 0 = off.
    pub mixed_pixels: f64,
    /// A depth range above this within 3x3 pixels is a step, metres.
    pub step: f64,
    /// Share of all pixels lost for no reason. 0 = off.
    pub random_dropout: f64,
    /// Incidence (camera or projector) up to which nothing is lost, radians.
    pub grazing_start: f64,
    /// Incidence from which all is lost, radians; the share is linear in the cosine between.
    /// pi/2 for both = off.
    pub grazing_end: f64,
    /// Albedo times cosine of the projector incidence below which the pattern drowns. 0 = off.
    pub dark_limit: f64,
    /// The axial noise also goes with 1/sqrt(albedo x cosine of the projector incidence),
    /// by 0.5 to 3 times; brown board (albedo 0.5) head on is 1.
    pub radiometric_noise: bool,
    /// The signal also falls with 1/z^2: albedo x cosine of the projector incidence x (z0 / z)^2, for
    /// the noise and for [`Self::dark_limit`]. z0 is the distance for which the picture is exposed:
    /// the camera meters the mean of 1/z^2 over what stands between near and far, but cannot expose
    /// for more than this many metres. So a wall of brown board anywhere up to here has the deviation
    /// of [`Self::axial_noise`] alone, which is given for a fitting exposure; within one picture what is
    /// nearer than z0 is better and what is farther is worse by z / z0; and beyond here the deviation
    /// grows with z^3. 0 = off: every distance gets the light that it needs.
    pub signal_distance: f64,
    /// Which camera of its kind this is: the shape of the bowl and the signs of scale error and
    /// distance bias are drawn from it. They belong to the camera, not to the picture.
    pub device_seed: u64,
    /// Peak-to-valley of the smooth depth error over the image ("global planarity trueness"), metres:
    /// a quadratic and a tilt, drawn from [`Self::device_seed`], with its middle value at zero. 0 = off.
    pub bowl: f64,
    /// Relative depth error ("dimension trueness"), the same everywhere; its sign is that of the
    /// device. 0.0005 reads 1 mm too far (or too near) at 2 m, 0.0002 0.4 mm. 0 = off.
    pub scale_error: f64,
    /// Depth error that is the same at all distances, metres; its sign is that of the device. 0 = off.
    pub distance_bias: f64,
    /// Step of the delivered depth, metres. 0 = off.
    pub quantum: f64,
    /// Step of disparity ([`Self::disparity_base`] / z) of a stereo camera, pixels: its depth steps
    /// grow with z squared. Rounded before [`Self::quantum`]. 0 = off.
    pub disparity_step_px: f64,
    /// Focal length times baseline of the two imagers whose disparity that is, px m.
    /// 0 = fx times the baseline of the camera.
    pub disparity_base: f64,
    /// Share of the light in the intensity image that does not come from the projector.
    pub ambient: f64,
    /// Distance at which a white surface facing the projector just reaches grey 255, metres.
    pub exposure_distance: f64,
    /// The intensity image is blurred by 1-2-1 in both directions (the lens and the pixel size).
    pub blur: bool,
    /// Standard deviation of the intensity, grey steps. 0 = off.
    pub intensity_noise: f64,
    /// Several exposures: what the projector's mirror image over-exposes in one is measured in another.
    /// Its brightness in the intensity image stays.
    pub hdr: bool,
    /// Vendor filter: a pixel with which fewer than three of its eight neighbours agree is lost. To
    /// agree is to differ by no more than [`Self::step`] and four times the axial noise.
    pub outlier_removal: bool,
    /// Vendor filter, after the other: each measured pixel takes the median of those measured in 3x3
    /// around it, the nearer of the middle two of an even number. Nothing is filled.
    pub median: bool,
    /// The lens is covered: no depth anywhere, intensity 0.
    pub blackout: bool,
}

impl SensorSpec {
    /// Every term off: exact depth wherever a surface is seen between near and far.
    pub fn ideal() -> Self {
        Self {
            shadow: false,
            axial_noise: 0.0,
            correlated_share: 0.0,
            correlation_px: 4,
            lateral_jitter_px: 0.0,
            edge_dropout: 0.0,
            mixed_pixels: 0.0,
            step: 0.005,
            random_dropout: 0.0,
            grazing_start: FRAC_PI_2,
            grazing_end: FRAC_PI_2,
            dark_limit: 0.0,
            radiometric_noise: false,
            signal_distance: 0.0,
            device_seed: 1,
            bowl: 0.0,
            scale_error: 0.0,
            distance_bias: 0.0,
            quantum: 0.0,
            disparity_step_px: 0.0,
            disparity_base: 0.0,
            ambient: 0.15,
            exposure_distance: 1.8,
            blur: false,
            intensity_noise: 0.0,
            hdr: false,
            outlier_removal: false,
            median: false,
            blackout: false,
        }
    }

    /// A laser structured-light camera for stacks at 1.2 to 3 m:
    /// 0.5 mm (one sigma) at 3 m, 0.22 mm at 2 m, 0.1 mm steps.
    pub fn laser_structured_light() -> Self {
        Self::laser_3m()
    }

    /// Laser structured light, long range (1.2 to 3 m): 0.5 mm (one sigma) at 3 m, a bowl of 0.3 mm,
    /// 0.02 % in scale (0.4 mm at 2 m).
    pub fn laser_3m() -> Self {
        Self {
            shadow: true,
            axial_noise: 0.0005,
            correlated_share: 0.5,
            correlation_px: 4,
            lateral_jitter_px: 0.3,
            edge_dropout: 0.3,
            mixed_pixels: 0.1,
            random_dropout: 0.002,
            grazing_start: 60.0_f64.to_radians(),
            grazing_end: 78.0_f64.to_radians(),
            dark_limit: 0.02,
            radiometric_noise: true,
            signal_distance: 3.0,
            bowl: 0.0003,
            scale_error: 0.0002,
            quantum: 0.0001,
            blur: true,
            intensity_noise: 2.0,
            ..Self::ideal()
        }
    }

    /// Laser structured light, middle range (1 to 2 m): 0.1 mm (one sigma) at 2 m, a bowl of 0.3 mm,
    /// 0.02 % in scale (0.4 mm at 2 m).
    pub fn laser_2m() -> Self {
        Self {
            axial_noise: 0.000_225,
            lateral_jitter_px: 0.25,
            signal_distance: 2.0,
            ..Self::laser_3m()
        }
    }

    /// A small active stereo camera: sigma = z^2 x 0.08 px / (640 px x 50 mm), 22 mm at 3 m, over
    /// eight pixels; depths of whole steps of 0.08 px (2.5 mm at 1 m, 10 mm at 2 m), then of 1 mm; wide
    /// smears and losses at edges. Noise and steps are those of the D435 class.
    pub fn active_stereo() -> Self {
        Self {
            axial_noise: 0.0225,
            correlated_share: 0.7,
            correlation_px: 8,
            lateral_jitter_px: 0.8,
            mixed_pixels: 0.4,
            bowl: 0.004,
            scale_error: 0.002,
            disparity_step_px: 0.08,
            disparity_base: 640.0 * 0.05,
            quantum: 0.001,
            ..Self::laser_3m()
        }
    }

    /// A continuous-wave time-of-flight camera: light from beside the lens, so no shadow; 3 mm (one
    /// sigma) at 3 m, a bowl of 6 mm, flying pixels at edges, 1 mm steps. Its distance is off by 11 mm,
    /// the greatest error that Tolgyessy et al. 2021 (Sensors 21, 413) found up to 3.5 m on an Azure Kinect.
    pub fn time_of_flight() -> Self {
        Self {
            shadow: false,
            axial_noise: 0.003,
            correlated_share: 0.3,
            lateral_jitter_px: 0.3,
            edge_dropout: 0.1,
            mixed_pixels: 0.6,
            bowl: 0.006,
            scale_error: 0.0,
            distance_bias: 0.011,
            quantum: 0.001,
            ..Self::laser_3m()
        }
    }
}

impl SensorSpec {
    /// The same with the axial noise of a data sheet: a wall of brown board squarely at `distance` metres
    /// has this standard deviation of depth, metres. What distance does to the signal, beyond
    /// [`Self::signal_distance`], is taken as it stands in `self`.
    #[must_use]
    pub fn with_axial_noise_at(self, deviation: f64, distance: f64) -> Self {
        let reference = f64::from(NOISE_DISTANCE);
        let falls = self.radiometric_noise && self.signal_distance > 0.0;
        let weaker = if falls {
            let most = f64::from(SIGNAL_FACTORS.1);
            (distance / self.signal_distance).clamp(1.0, most)
        } else {
            1.0
        };
        let growth = (distance / reference) * (distance / reference) * weaker;
        Self {
            axial_noise: deviation / growth,
            ..self
        }
    }
}

impl Default for SensorSpec {
    /// [`SensorSpec::laser_structured_light`].
    fn default() -> Self {
        Self::laser_structured_light()
    }
}
