//! What is known of a few neighbouring pixels without a look at them.

/// Surface or solid of a pixel where nothing was drawn.
pub(crate) const EMPTY: u32 = u32::MAX;
/// Surface or solid of pixels that do not all show the same.
pub(crate) const MIXED: u32 = u32::MAX - 1;
/// Columns of a tile.
pub(crate) const TILE: usize = 16;

/// What the pixels of a tile show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Seen {
    /// No pixel on which something is drawn has a smaller 1/z, 1/m.
    pub least: f32,
    /// No pixel has a greater 1/z; 0 = nothing was drawn here.
    pub most: f32,
    /// The surface that all pixels show, or [`MIXED`].
    pub face: u32,
    /// The only solid that was drawn here, or [`MIXED`], or [`EMPTY`].
    pub solid: u32,
}

impl Seen {
    pub const NOTHING: Self = Self {
        least: f32::INFINITY,
        most: 0.0,
        face: MIXED,
        solid: EMPTY,
    };
}

/// A tile while it is drawn: [`TILE`] columns of one band of rows.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tile {
    pub seen: Seen,
    /// Bit 16 r + k: pixel k of row r is drawn. Once all are, what lies behind `seen.least` is passed
    /// over without a look at its pixels (Greene, Kass and Miller 1993).
    pub drawn: u128,
    /// A solid that need not be drawn here.
    pub spared: u32,
}

impl Tile {
    pub const BLANK: Self = Self {
        seen: Seen::NOTHING,
        drawn: 0,
        spared: EMPTY,
    };

    /// True when nothing of a solid that is no nearer than 1/z = `most` can show here.
    #[inline(always)]
    pub fn hides(&self, most: f32, solid: u32, full: u128) -> bool {
        (self.drawn == full && most <= self.seen.least) || self.spared == solid
    }

    /// Notes that some pixels of a solid were drawn.
    #[inline(always)]
    pub fn mix(&mut self, solid: u32) {
        self.seen.face = MIXED;
        self.seen.solid = match self.seen.solid {
            EMPTY => solid,
            same if same == solid => same,
            _ => MIXED,
        };
    }
}
