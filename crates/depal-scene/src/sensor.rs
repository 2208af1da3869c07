//! The faults of a depth picture: which sensor, which of its terms, which filters.

use crate::choice::choice;

choice! {
    /// Which faults a depth picture has.
    pub enum SensorPreset {
        /// Structured laser light seen past a baseline: shadow, axial noise, edge dropout, 0.1 mm steps.
        Laser = "laser",
        /// Structured laser light for the middle range: 0.1 mm at 2 m.
        Laser2m = "laser-2m",
        /// Structured laser light for the long range: 0.5 mm at 3 m.
        Laser3m = "laser-3m",
        /// A small stereo camera with its own pattern: 10 mm at 2 m, smeared edges.
        ActiveStereo = "active-stereo",
        /// Time of flight: no shadow, 3 mm at 3 m, flying pixels at edges.
        TimeOfFlight = "time-of-flight",
        /// The exact distance at every pixel.
        Ideal = "ideal",
    }
}

choice! {
    /// One term of the sensor's model.
    pub enum SensorTerm {
        /// No depth where the projector's light does not reach.
        Shadow = "shadow",
        /// Loss on faces that are seen or lit at more than 60 degrees.
        Grazing = "grazing",
        /// Loss on faces that send too little light back.
        Darkness = "darkness",
        /// More noise on faces that send less light back.
        WeakSignal = "weak_signal",
        /// Less light from farther away than the picture is exposed for.
        Falloff = "falloff",
        /// Noise along the line of sight.
        AxialNoise = "axial_noise",
        /// The part of that noise that neighbouring pixels share; without it all of it is each pixel's own.
        CorrelatedNoise = "correlated_noise",
        /// A smooth bend of the whole picture.
        Bowl = "bowl",
        /// Distances that are too long or too short by a factor.
        ScaleError = "scale_error",
        /// Distances that are too long or too short by a length.
        DistanceBias = "distance_bias",
        /// Pixels that look a little aside.
        LateralJitter = "lateral_jitter",
        /// Loss beside depth steps.
        EdgeDropout = "edge_dropout",
        /// Flying pixels between the two surfaces of a depth step.
        MixedPixels = "mixed_pixels",
        /// Loss here and there.
        RandomDropout = "random_dropout",
        /// Steps of the delivered depth.
        Quantisation = "quantisation",
        /// Steps of the disparity of a stereo camera.
        DisparitySteps = "disparity_steps",
        /// Blur of the intensity picture.
        LensBlur = "lens_blur",
        /// Noise of the intensity picture.
        IntensityNoise = "intensity_noise",
    }
}

choice! {
    /// A filter that the camera runs over a finished depth picture.
    pub enum DepthFilter {
        /// Takes pixels with which fewer than three of their eight neighbours agree.
        OutlierRemoval = "outlier_removal",
        /// Gives each measured pixel the median of those measured in 3x3 around it; runs last.
        Median = "median",
    }
}
