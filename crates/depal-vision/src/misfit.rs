//! How little plane the cartons of a covering are, and when that decides between two coverings.

use crate::{relief::Relief, search::Candidate};

/// A reading is out of the question when its cartons are less plane than those of the best one by this
/// share,
pub const WORSE_SHARE: f64 = 0.004;
/// The same, in means of a block.
pub const WORSE_BLOCKS: f64 = 30.0;
/// Each carton more explains so many means of a block of noise, for its plane fits that as well.
pub const OVERFIT_BLOCKS: f64 = 20.0;
/// How little plane the cartons of a reading are.
#[derive(Debug, Clone, Copy, Default)]
pub struct Misfit {
    pub squares: f64,
    pub blocks: usize,
    pub cartons: usize,
}

impl Misfit {
    /// Mean square of a block, square metres.
    pub fn mean(&self) -> f64 {
        self.squares / self.blocks.max(1) as f64
    }

    /// What it is by more than the noise of its blocks (variance, square metres): sides that cross many blocks
    /// leave fewer of them to judge by, which is no merit.
    pub fn beyond(&self, noise: f64) -> f64 {
        self.squares - noise * self.blocks as f64
    }

    /// The same with a price on each carton, without which more and smaller cartons would always be the better reading:
    /// each explains some noise.
    pub fn price(&self, noise: f64) -> f64 {
        self.beyond(noise) + OVERFIT_BLOCKS * noise * self.cartons as f64
    }

    /// True when another reading of the same surface is out of the question beside this one. `whole`: all of the
    /// best reading; the larger it is, the more places there are where a wrong one may fit by chance. `lump`: blocks
    /// over which noise hangs together.
    pub fn rules_out(&self, other: &Self, whole: &Self, lump: f64) -> bool {
        let mean = whole.mean();
        let fewer = self.cartons as f64 - other.cartons as f64;
        let limit = whole.squares * WORSE_SHARE
            + (WORSE_BLOCKS + OVERFIT_BLOCKS * fewer.max(0.0)) * mean * lump;
        other.beyond(mean) - self.beyond(mean) > limit
    }
}

/// The misfits of the cartons in which two readings differ. What they share says nothing about which of them it is:
/// on a large layer its noise would drown the few cartons that do.
pub fn apart(relief: &Relief, best: &[Candidate], other: &[Candidate]) -> [Misfit; 2] {
    let of = |these: &[Candidate], those: &[Candidate]| {
        these
            .iter()
            .filter(|c| !those.iter().any(|o| c.is_like(o)))
            .fold(Misfit::default(), |sum, c| {
                let own = relief.misfit(&[*c]);
                Misfit {
                    squares: sum.squares + own.squares,
                    blocks: sum.blocks + own.blocks,
                    cartons: sum.cartons + 1,
                }
            })
    };
    [of(best, other), of(other, best)]
}
