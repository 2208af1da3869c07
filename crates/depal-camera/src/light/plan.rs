//! Which tiles of the image are simple, and which pixels lie in the projector's shadow.

use std::cell::RefCell;

use rayon::prelude::*;

use super::projector::{Projector, Strip};
use super::{Lighting, Patch};
use crate::raster::TILE;
use crate::view::BAND;

thread_local! {
    /// Kept from frame to frame: fetching new memory costs time.
    static STRIP: RefCell<Strip> = RefCell::default();
}

/// A rough tile is here or beside this one.
const BESIDE: u8 = 1;
/// A rough tile is above or below this one, or beside one of those.
const ABOVE: u8 = 2;
const BELOW: u8 = 4;

/// The image in tiles.
pub(crate) struct Plan {
    /// Tiles in a row of them.
    pub columns: usize,
    patches: Vec<Patch>,
    /// For every tile, by whom it is looked at: [`BESIDE`], [`ABOVE`], [`BELOW`].
    looked_at: Vec<u8>,
    /// For every image row and tile, bit k: pixel k is not reached by the projector.
    shade: Vec<u16>,
}

impl Plan {
    /// Jitter and lens look `margin` pixels beyond a tile.
    pub fn new(lighting: &Lighting, margin: usize) -> Self {
        let i = lighting.rendering.intrinsics;
        let (columns, bands) = (i.width.div_ceil(TILE), i.height.div_ceil(BAND));
        let mut plan = Self {
            columns,
            patches: vec![Patch::ROUGH; columns * bands],
            looked_at: vec![0; columns * bands],
            shade: vec![0; columns * bands * BAND],
        };
        let sensor = &lighting.spec.sensor;
        let projector = sensor
            .shadow
            .then(|| Projector::new(lighting.spec, lighting.rendering));
        let arch = pulp::Arch::new();
        plan.patches
            .par_chunks_mut(columns)
            .zip(plan.shade.par_chunks_mut(columns * BAND))
            .enumerate()
            .for_each(|(band, (patches, shade))| {
                STRIP.with_borrow_mut(|strip| {
                    arch.dispatch(PlanJob {
                        lighting,
                        projector: projector.as_ref(),
                        margin,
                        band,
                        strip,
                        patches,
                        shade,
                    });
                });
            });
        plan.find_looks();
        plan
    }

    fn find_looks(&mut self) {
        let columns = self.columns;
        for (at, _) in self.patches.iter().enumerate().filter(|(_, p)| !p.smooth) {
            let column = at % columns;
            for beside in at - usize::from(column > 0)..=at + usize::from(column + 1 < columns) {
                self.looked_at[beside] |= BESIDE;
                if beside >= columns {
                    self.looked_at[beside - columns] |= BELOW;
                }
                if let Some(below) = self.looked_at.get_mut(beside + columns) {
                    *below |= ABOVE;
                }
            }
        }
    }

    /// Who looks at the tiles that image row `v` runs through.
    pub fn looked_at(&self, v: usize) -> &[u8] {
        let band = v / BAND;
        &self.looked_at[band * self.columns..(band + 1) * self.columns]
    }

    /// Who of them looks as far as row `v`, when it looks `margin` rows beyond its own.
    pub fn looks(v: usize, margin: usize) -> u8 {
        let row = v % BAND;
        let above = if row < margin { ABOVE } else { 0 };
        let below = if row + margin >= BAND { BELOW } else { 0 };
        BESIDE | above | below
    }

    /// The tiles that image row `v` runs through.
    pub fn patches(&self, v: usize) -> &[Patch] {
        let band = v / BAND;
        &self.patches[band * self.columns..(band + 1) * self.columns]
    }

    /// Shadow of image row `v`, see [`Self::shade`].
    pub fn shade(&self, v: usize) -> &[u16] {
        &self.shade[v * self.columns..(v + 1) * self.columns]
    }
}

/// One band of rows, compiled once for each instruction set that the processor may have.
struct PlanJob<'a> {
    lighting: &'a Lighting<'a>,
    projector: Option<&'a Projector<'a>>,
    margin: usize,
    band: usize,
    strip: &'a mut Strip,
    patches: &'a mut [Patch],
    shade: &'a mut [u16],
}

impl pulp::WithSimd for PlanJob<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        if let Some(projector) = self.projector {
            projector.shade(self.band, self.strip, self.shade);
        }
        // Beyond that the pixels that a tile looks at are not those of its neighbours alone.
        if self.margin > BAND.min(TILE) {
            return;
        }
        for (column, patch) in self.patches.iter_mut().enumerate() {
            let reached = self.projector.is_none() || self.strip.is_reached(column);
            *patch = self.lighting.patch(column, self.band, self.margin, reached);
        }
    }
}
