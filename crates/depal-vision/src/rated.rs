//! What speaks against each way to cover a level, and for it.

use crate::{
    VisionSettings,
    level::Level,
    misfit::{Misfit, OVERFIT_BLOCKS, WORSE_BLOCKS},
    tile_fit::{Fitted, fit},
    tile_relief::TileRelief,
    tiling::readings,
    valleys::Valleys,
};

/// Beyond outer sides it is at least so much deeper, in heights of a carton.
const LEAST_DROP: f64 = 0.6;
/// Share of the outer sides that must end the surface.
const LEAST_ENDS: f64 = 0.7;
/// Mean square of the errors of the outer sides, which is one by what a deviation is, and the greatest of them, in
/// deviations.
const MOST_ERROR: f64 = 1.0;
const WORST_ERROR: f64 = 4.5;
/// Share of the surface that no tile explains, at most.
const MOST_OPEN: f64 = 0.04;
/// Width of the outline and of the gaps are so many deviations from what is usual, at most.
const MOST_UNUSUAL: f64 = 2.5;
/// Mean evidence of seams that show, squared deviations.
const SHOWN: f64 = 9.0;
/// That sides of cartons just lie where something hides them is chance of one in twenty: twice its logarithm.
const HIDDEN: f64 = 9.0;
/// What the surface costs where it goes on beyond outer sides, for all of their length.
const GOES_ON: f64 = 40.0;

/// The readings of a level that may be true, and whether there are no others.
pub fn rated(
    level: &Level,
    valleys: &Valleys,
    relief: &TileRelief,
    settings: &VisionSettings,
    slack: f64,
    height: f64,
) -> (Vec<Rated>, bool) {
    let places = level.inner_places(slack);
    let mut complete = true;
    let mut fitted: Vec<Rated> = Vec::new();
    for fat in [0.0, slack, -0.5 * slack] {
        let found = readings(level, valleys, &settings.sizes, slack, fat);
        complete &= found.complete;
        for tiles in &found.readings {
            let Some(one) = fit(level, tiles, slack) else {
                continue;
            };
            let open = places
                .iter()
                .filter(|p| !one.tiles.iter().any(|t| t.holds(**p, 0.8 * slack)))
                .count();
            let seams: f64 = one
                .seams
                .iter()
                .map(|s| {
                    let [a, b] = s.tiles.map(|k| &one.tiles[k]);
                    let at = f64::midpoint(a.high(s.axis), b.low(s.axis));
                    valleys.evidence(s.axis, at, s.range)
                })
                .sum();
            // Narrow gaps may hide in the noise, wide ones must show.
            let shown = seams >= SHOWN * one.seams.len() as f64;
            let hidden = one.tiles.iter().filter(|t| t.hidden).count();
            // A hidden side proves nothing: the others must prove all the more.
            let most = if hidden > 0 { 1.0 } else { MOST_UNUSUAL };
            // True when nothing about its outline is out of the ordinary by `times` what is allowed.
            let is_usual = |times: f64| {
                one.fat_deviations.abs() <= times * most
                    && (shown || one.gap_deviations.abs() <= times * most)
                    && open as f64 <= times * MOST_OPEN * places.len() as f64
                    && one.outer <= times * MOST_ERROR * one.outer_sides as f64
                    && one.worst <= times * WORST_ERROR
                    && 1.0 - one.ends <= times * (1.0 - LEAST_ENDS)
                    && times * one.drop >= LEAST_DROP * height
            };
            let cost = one.squares + HIDDEN * hidden as f64 + GOES_ON * (1.0 - one.ends);
            let seen = relief.misfit(&one.tiles);
            let misfit = seen.unwrap_or_default();
            // One carton is one plane, as far as noise lets it be seen.
            let uneven = misfit.beyond(relief.noise) / (relief.noise * relief.lump);
            let most = WORSE_BLOCKS + OVERFIT_BLOCKS * one.tiles.len() as f64;
            fitted.push(Rated {
                cost,
                seams,
                misfit,
                uneven: 0.0,
                holds: is_usual(1.0) && seen.is_some() && uneven <= most,
                nearly: is_usual(2.0) && seen.is_some(),
                one,
            });
        }
    }
    (fitted, complete)
}

/// A reading with what speaks against it, and for its seams, in squared deviations.
pub struct Rated {
    pub cost: f64,
    pub seams: f64,
    /// How little plane its tops are, and the same beyond the noise, in its deviations.
    pub misfit: Misfit,
    pub uneven: f64,
    /// Nothing about it is out of the ordinary.
    pub holds: bool,
    /// The same in bounds twice as wide, however plane.
    pub nearly: bool,
    pub one: Fitted,
}

/// What of a difference is more than chance.
fn past(difference: f64, chance: f64) -> f64 {
    difference.signum() * (difference.abs() - chance).max(0.0)
}

impl Rated {
    /// What speaks against it in all.
    pub fn total(&self) -> f64 {
        self.cost - self.seams + self.uneven
    }

    /// By how much this one explains what lies inside the outline better than another, beyond chance.
    pub fn inside(&self, other: &Self) -> f64 {
        // Seams where there are none add a half each by chance, with a deviation of 1.1: of two readings four
        // deviations of their sum.
        let by_chance = 4.0 * (2.5 * self.one.seams.len().max(1) as f64).sqrt();
        let cartons = self.one.tiles.len().abs_diff(other.one.tiles.len());
        let uneven = WORSE_BLOCKS + OVERFIT_BLOCKS * cartons as f64;
        past(self.seams - other.seams, by_chance) + past(other.uneven - self.uneven, uneven)
    }
}
