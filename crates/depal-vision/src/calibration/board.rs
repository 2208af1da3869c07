use depal_frames::{Point, Pose};

use super::problem::CalibrationProblem;

/// Which of camera and board the arm carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mounting {
    /// The camera stands still, the board is on the flange.
    EyeToHand,
    /// The camera is on the flange, the board stands still.
    EyeInHand,
}

impl Mounting {
    /// The moving link of the chain `camera_from_board = camera_from_hub * hub_from_carrier * carrier_from_board`:
    /// `base_from_flange` for a fixed camera (hub = base, carrier = flange), its inverse for a camera
    /// on the flange (hub = flange, carrier = base).
    pub(crate) fn hub_from_carrier(self, base_from_flange: &Pose) -> Pose {
        match self {
            Self::EyeToHand => *base_from_flange,
            Self::EyeInHand => base_from_flange.inverse(),
        }
    }
}

/// A light plate with a rectangular grid of dark discs; three discs are larger and tell where it begins.
///
/// Disc (column, row) counts from 0 at negative X and Y of the board frame. With
/// `c = (columns - 3) / 2` and `r = (rows - 3) / 2`, rounded down, the large discs are
/// (c, r), (c + 2, r) and (c, r + 2): no turn of the grid maps them onto themselves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CircleBoard {
    /// Discs along X, 3 to 50.
    pub columns: usize,
    /// Discs along Y, 3 to 50.
    pub rows: usize,
    /// Distance between neighbouring disc centres, metres.
    pub pitch: f64,
    /// Diameter of an ordinary disc, metres: a quarter to half of the pitch.
    pub disc_diameter: f64,
}

impl CircleBoard {
    /// Diameter of the three large discs as a multiple of the others'.
    pub const MARK_FACTOR: f64 = 1.5;
    /// From the centres of the outermost discs to the plate's edge, as a multiple of the pitch.
    pub const MARGIN: f64 = 1.0;
    /// Most discs along a side.
    const MOST: usize = 50;

    /// Checks that the detection can tell the discs apart.
    ///
    /// # Errors
    /// [`CalibrationProblem::Board`] with the first figure that is out of range.
    pub fn validate(&self) -> Result<(), CalibrationProblem> {
        let refuse = |field, expected, found| {
            Err(CalibrationProblem::Board {
                field,
                expected,
                found,
            })
        };
        for (field, count) in [("columns", self.columns), ("rows", self.rows)] {
            if !(3..=Self::MOST).contains(&count) {
                return refuse(field, "3 to 50", count as f64);
            }
        }
        if !(0.002..=1.0).contains(&self.pitch) {
            return refuse("pitch", "0.002 to 1 m", self.pitch);
        }
        let share = self.disc_diameter / self.pitch;
        if !(0.25..=0.5).contains(&share) {
            return refuse("disc_diameter / pitch", "0.25 to 0.5", share);
        }
        Ok(())
    }

    /// Number of discs.
    pub fn discs(&self) -> usize {
        self.columns * self.rows
    }

    /// Centre of a disc in the board frame, metres.
    pub fn centre(&self, column: usize, row: usize) -> Point {
        let from_middle =
            |k: usize, count: usize| (k as f64 - (count as f64 - 1.0) / 2.0) * self.pitch;
        Point::new(
            from_middle(column, self.columns),
            from_middle(row, self.rows),
            0.0,
        )
    }

    /// Whether a disc is one of the three large ones.
    pub fn is_mark(&self, column: usize, row: usize) -> bool {
        let (c, r) = ((self.columns - 3) / 2, (self.rows - 3) / 2);
        [(c, r), (c + 2, r), (c, r + 2)].contains(&(column, row))
    }

    /// Diameter of a disc, metres.
    pub fn diameter(&self, column: usize, row: usize) -> f64 {
        if self.is_mark(column, row) {
            self.disc_diameter * Self::MARK_FACTOR
        } else {
            self.disc_diameter
        }
    }

    /// (column, row) of all discs, row by row: the order of [`BoardView::centres`](super::BoardView::centres).
    pub fn nodes(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let columns = self.columns;
        (0..self.discs()).map(move |n| (n % columns, n / columns))
    }

    /// All disc centres in the board frame, row by row.
    pub fn centres(&self) -> Vec<Point> {
        self.nodes().map(|(c, r)| self.centre(c, r)).collect()
    }

    /// Full sides of the plate along X and Y, metres.
    pub fn plate_size(&self) -> [f64; 2] {
        [self.columns, self.rows].map(|n| (n as f64 - 1.0 + 2.0 * Self::MARGIN) * self.pitch)
    }

    /// Corners of the plate's printed face, board frame.
    pub fn corners(&self) -> [Point; 4] {
        let [x, y] = self.plate_size().map(|side| side / 2.0);
        [(-x, -y), (x, -y), (x, y), (-x, y)].map(|(x, y)| Point::new(x, y, 0.0))
    }
}
