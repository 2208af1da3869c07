//! A preset, less what the scene leaves out, with the scene's own figures.

use depal_camera::SensorSpec;

use crate::camera::{Camera, LASER_NOISE_AT_MM};
use crate::sensor::{DepthFilter, SensorPreset, SensorTerm};

/// The sensor's model as the scene wants it.
pub(super) fn sensor(camera: &Camera) -> SensorSpec {
    let mut sensor = match camera.sensor {
        SensorPreset::Laser => SensorSpec::laser_structured_light(),
        SensorPreset::Laser2m => SensorSpec::laser_2m(),
        SensorPreset::Laser3m => SensorSpec::laser_3m(),
        SensorPreset::ActiveStereo => SensorSpec::active_stereo(),
        SensorPreset::TimeOfFlight => SensorSpec::time_of_flight(),
        // Exact means exact: neither over-exposure nor filters.
        SensorPreset::Ideal => {
            return SensorSpec {
                hdr: true,
                blackout: camera.blackout,
                ..SensorSpec::ideal()
            };
        }
    };
    for term in &camera.without {
        leave_out(&mut sensor, *term);
    }
    let noise_at_mm = match camera.sensor {
        SensorPreset::Laser => camera.noise_at_mm.or(Some(LASER_NOISE_AT_MM)),
        _ => camera.noise_at_mm,
    };
    if let Some(at_mm) = noise_at_mm
        && !camera.without.contains(&SensorTerm::AxialNoise)
    {
        sensor = sensor.with_axial_noise_at(camera.noise_mm * 1e-3, at_mm * 1e-3);
    }
    let runs = |filter| camera.filters.contains(&filter);
    SensorSpec {
        device_seed: camera.device_seed,
        hdr: camera.hdr,
        outlier_removal: runs(DepthFilter::OutlierRemoval),
        median: runs(DepthFilter::Median),
        blackout: camera.blackout,
        ..sensor
    }
}

/// Takes one term's figures from the sensor that has none.
fn leave_out(sensor: &mut SensorSpec, term: SensorTerm) {
    let none = SensorSpec::ideal();
    match term {
        SensorTerm::Shadow => sensor.shadow = none.shadow,
        SensorTerm::Grazing => {
            sensor.grazing_start = none.grazing_start;
            sensor.grazing_end = none.grazing_end;
        }
        SensorTerm::Darkness => sensor.dark_limit = none.dark_limit,
        SensorTerm::WeakSignal => sensor.radiometric_noise = none.radiometric_noise,
        SensorTerm::Falloff => sensor.signal_distance = none.signal_distance,
        SensorTerm::AxialNoise => sensor.axial_noise = none.axial_noise,
        SensorTerm::CorrelatedNoise => sensor.correlated_share = none.correlated_share,
        SensorTerm::Bowl => sensor.bowl = none.bowl,
        SensorTerm::ScaleError => sensor.scale_error = none.scale_error,
        SensorTerm::DistanceBias => sensor.distance_bias = none.distance_bias,
        SensorTerm::LateralJitter => sensor.lateral_jitter_px = none.lateral_jitter_px,
        SensorTerm::EdgeDropout => sensor.edge_dropout = none.edge_dropout,
        SensorTerm::MixedPixels => sensor.mixed_pixels = none.mixed_pixels,
        SensorTerm::RandomDropout => sensor.random_dropout = none.random_dropout,
        SensorTerm::Quantisation => sensor.quantum = none.quantum,
        SensorTerm::DisparitySteps => sensor.disparity_step_px = none.disparity_step_px,
        SensorTerm::LensBlur => sensor.blur = none.blur,
        SensorTerm::IntensityNoise => sensor.intensity_noise = none.intensity_noise,
    }
}
