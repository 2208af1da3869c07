use std::ops::{Deref, DerefMut};

/// Most joints an arm may have.
pub const MAX_JOINTS: usize = 8;

/// Joint positions (or speeds, accelerations), radians, in URDF order of the movable joints
/// that are not mimics. A small copyable vector; use it as a slice.
#[derive(Clone, Copy, PartialEq)]
pub struct JointPositions {
    count: usize,
    values: [f64; MAX_JOINTS],
}

impl JointPositions {
    /// `count` zeros.
    ///
    /// # Panics
    /// If `count` exceeds [`MAX_JOINTS`].
    #[inline]
    pub fn zeros(count: usize) -> Self {
        assert!(count <= MAX_JOINTS, "{count} joints, at most {MAX_JOINTS}");
        Self {
            count,
            values: [0.0; MAX_JOINTS],
        }
    }

    /// From a slice of radians.
    ///
    /// # Panics
    /// If the slice is longer than [`MAX_JOINTS`].
    #[inline]
    pub fn from_slice(values: &[f64]) -> Self {
        let mut joints = Self::zeros(values.len());
        joints.copy_from_slice(values);
        joints
    }

    /// From degrees.
    pub fn from_degrees(values: &[f64]) -> Self {
        let mut joints = Self::from_slice(values);
        joints.iter_mut().for_each(|v| *v = v.to_radians());
        joints
    }

    /// The values in degrees.
    pub fn to_degrees(&self) -> Vec<f64> {
        self.iter().map(|v| v.to_degrees()).collect()
    }

    /// `self + (other - self) * t`, joint by joint.
    #[inline]
    pub fn lerp(&self, other: &Self, t: f64) -> Self {
        let mut out = *self;
        for (o, b) in out.iter_mut().zip(other.iter()) {
            *o += (b - *o) * t;
        }
        out
    }

    /// Largest absolute joint difference, radians.
    pub fn max_distance(&self, other: &Self) -> f64 {
        self.iter()
            .zip(other.iter())
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max)
    }
}

impl Deref for JointPositions {
    type Target = [f64];
    #[inline]
    fn deref(&self) -> &[f64] {
        &self.values[..self.count]
    }
}

impl DerefMut for JointPositions {
    #[inline]
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.values[..self.count]
    }
}

impl std::fmt::Debug for JointPositions {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}
