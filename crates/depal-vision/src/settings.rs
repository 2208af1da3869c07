use depal_frames::{BoxSize, Point, Pose, Vector};

use crate::gate::LEAST_SMEAR;

/// An oriented box in space; only points inside it can belong to a reported carton.
#[derive(Debug, Clone, PartialEq)]
pub struct RegionOfInterest {
    /// `camera_from_region`: the region's centre and axes in the camera frame.
    pub camera_from_region: Pose,
    /// Half of each side along the region's own axes, metres.
    pub half_extents: Vector,
}

impl RegionOfInterest {
    /// Whether a point (camera frame, metres) lies inside or on the border.
    pub fn contains(&self, point_in_camera: &Point) -> bool {
        let p = self
            .camera_from_region
            .inverse_transform_point(point_in_camera);
        p.x.abs() <= self.half_extents.x
            && p.y.abs() <= self.half_extents.y
            && p.z.abs() <= self.half_extents.z
    }
}

/// What is known before the frame arrives, and the tunables of the estimation. Metres, radians.
#[derive(Debug, Clone, PartialEq)]
pub struct VisionSettings {
    /// Known carton sizes; a box's label is the index in this list. Empty: nothing is reported.
    pub sizes: Vec<BoxSize>,
    /// Nearest depth that can belong to a carton or count as a point of the region.
    pub min_depth: f64,
    /// Farthest such depth. Points beyond still prove that an edge falls away.
    pub max_depth: f64,
    /// Where cartons may be; `None`: the whole view.
    pub region: Option<RegionOfInterest>,
    /// A pixel this much deeper than the nearest one within two pixels is no surface.
    /// 4 mm: six standard deviations of a structured-light camera at 3 m, and less than the depth
    /// seen inside the narrowest gap. Larger values merge cartons, smaller ones tear tilted tops.
    pub step: f64,
    /// Lower steps are noise, metres at a depth of one metre; it goes with the square of depth, as the noise of
    /// triangulation does: several of its deviations. Without it a floor far below the cartons is torn to pieces.
    pub step_noise: f64,
    /// Distance from a fitted plane up to which a point lies on it.
    /// 4 mm for the same reason; it must also swallow the unevenness of cardboard.
    pub plane_tolerance: f64,
    /// Largest difference of a measured side from the known one, beyond one pixel.
    /// 4 mm: cartons bulge and the edge of a noisy frame lies within a pixel.
    pub size_tolerance: f64,
    /// Largest angle between a top face's normal and the direction to the camera.
    /// 40 degrees: leaning stacks and cameras that look from the side pass; side faces, square to tops, are then at 50
    /// degrees or more.
    pub max_tilt: f64,
    /// Smallest share of a top face that must be seen as surface. The rest may only be hidden
    /// (a taller neighbour in the line of sight, a shadow), never covered or missing.
    pub min_visible: f64,
    /// A flat surface with a longer side is background and not searched: larger than any layer.
    pub max_surface_side: f64,
    /// Over how many pixels the camera smears depth steps; 0 for one that does not.
    pub smear_px: usize,
    /// Half of the square over which depths are averaged along a surface, pixels; 0 where they are good enough.
    pub average_px: usize,
    /// Only depths that differ by no more than this are averaged, at a depth of one metre; it goes with the square of
    /// depth, as stereo noise does: several of its deviations.
    pub average_within: f64,
    /// Edge of the cubes in which unexplained points are gathered as obstacles.
    pub obstacle_voxel: f64,
}

impl VisionSettings {
    /// True where steps are smeared so far that they are put back: sides are known roughly then, heights beside them not.
    pub(crate) fn is_smeared(&self) -> bool {
        self.smear_px >= LEAST_SMEAR
    }

    /// Defaults for a structured-light camera 1.5 to 4 m above the cartons.
    pub fn new(sizes: Vec<BoxSize>) -> Self {
        Self {
            sizes,
            min_depth: 0.3,
            max_depth: 6.0,
            region: None,
            step: 0.004,
            step_noise: 0.0,
            plane_tolerance: 0.004,
            size_tolerance: 0.004,
            max_tilt: 40f64.to_radians(),
            min_visible: 0.7,
            max_surface_side: 2.0,
            smear_px: 0,
            average_px: 0,
            average_within: 0.0,
            obstacle_voxel: 0.025,
        }
    }
}
