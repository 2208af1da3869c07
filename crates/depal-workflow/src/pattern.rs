//! Places that are chosen by an index.

use depal_frames::{Pose, Rotation, Vector};

/// A grid of tool poses, all turned the same way.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Tool pose at index 0.
    pub base_from_first: Pose,
    /// Poses along the base's X, Y and Z.
    pub counts: [u32; 3],
    /// Distances along the base's X, Y and Z, metres; may be negative.
    pub offsets: [f64; 3],
}

impl Grid {
    /// Number of poses.
    pub fn len(&self) -> u32 {
        self.counts.iter().product()
    }

    /// Whether it has no pose at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Tool pose at an index: X counts fastest, Z slowest. None beyond the last.
    pub fn base_from_tcp(&self, index: u32) -> Option<Pose> {
        if index >= self.len() {
            return None;
        }
        let [nx, ny, _] = self.counts;
        let cell = [index % nx, index / nx % ny, index / nx / ny];
        let mut pose = self.base_from_first;
        let shift = [0, 1, 2].map(|axis| f64::from(cell[axis]) * self.offsets[axis]);
        pose.translation.vector += Vector::from(shift);
        Some(pose)
    }
}

/// Where cartons are placed one after another: the middle of the bottom face, Z up, X along the long side.
#[derive(Debug, Clone, PartialEq)]
pub enum CartonPattern {
    /// A list of places.
    Custom(Vec<Pose>),
    /// Equal layers of rows and columns.
    Predefined(Layers),
}

/// Equal layers of rows and columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Layers {
    /// Place of the first carton: row, column and layer 0. Columns run along its X, rows along its Y, layers along its Z.
    pub base_from_first: Pose,
    /// Rows of a layer.
    pub rows: u32,
    /// Columns of a layer.
    pub columns: u32,
    /// Layers.
    pub layers: u32,
    /// Distances from column to column, from row to row and from layer to layer, metres.
    pub pitch: [f64; 3],
    /// Every second layer is turned by 90 degrees about its own middle.
    pub is_alternating: bool,
}

impl CartonPattern {
    /// Number of places.
    pub fn len(&self) -> u32 {
        match self {
            Self::Custom(places) => places.len() as u32,
            Self::Predefined(layers) => layers.rows * layers.columns * layers.layers,
        }
    }

    /// Whether it has no place at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The place at an index: columns count fastest, layers slowest. None beyond the last.
    pub fn base_from_carton(&self, index: u32) -> Option<Pose> {
        match self {
            Self::Custom(places) => places.get(index as usize).copied(),
            Self::Predefined(layers) => {
                (index < self.len()).then(|| layers.base_from_carton(index))
            }
        }
    }
}

impl Layers {
    fn base_from_carton(&self, index: u32) -> Pose {
        let column = index % self.columns;
        let row = index / self.columns % self.rows;
        let layer = index / self.columns / self.rows;
        let [along, across, up] = self.pitch;
        let middle = Vector::new(
            f64::from(self.columns - 1) * 0.5 * along,
            f64::from(self.rows - 1) * 0.5 * across,
            f64::from(layer) * up,
        );
        let from_middle = Vector::new(f64::from(column) * along, f64::from(row) * across, 0.0)
            - Vector::new(middle.x, middle.y, 0.0);
        let turn = if self.is_alternating && layer % 2 == 1 {
            std::f64::consts::FRAC_PI_2
        } else {
            0.0
        };
        let turned = Pose::from_parts(
            middle.into(),
            Rotation::from_axis_angle(&Vector::z_axis(), turn),
        );
        self.base_from_first * turned * Pose::from_parts(from_middle.into(), Rotation::identity())
    }
}
