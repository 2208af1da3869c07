//! What speaks against each way to cover a level, and for it.

use crate::{
    VisionSettings,
    level::Level,
    misfit::{Misfit, OVERFIT_BLOCKS, WORSE_BLOCKS},
    tile_fit::{Fitted, fit},
    tile_relief::TileRelief,
    tiling::{Tile, readings},
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
/// Squared deviations of noise that a carton's plane explains.
const NUMBERS_OF_A_PLANE: f64 = 3.0;
/// Planes leave at least this share of the noise.
const LEAST_LEFT: f64 = 0.3;
/// By so much, in squared deviations, a reading is better than another one that is out of the question,
const LEAD: f64 = 9.0;
/// besides so many deviations of what chance makes of both.
const DEVIATIONS: f64 = 2.0;
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

impl Rated {
    /// Takes how little plane its tops are in deviations of noise. Each plane explains as much as it has numbers.
    fn weigh(&mut self, noise: &Noise) {
        self.uneven = self.misfit.beyond(noise.variance) / (noise.variance * noise.lump)
            + NUMBERS_OF_A_PLANE * self.misfit.cartons as f64;
    }

    /// What speaks against it in all.
    pub fn total(&self) -> f64 {
        self.cost - self.seams + self.uneven
    }

    /// True when another one arranges the cartons otherwise and the picture does not rule it out: that explains it
    /// hardly worse, or by no more than chance makes of the planes in which the two differ. The square of a number by
    /// chance has a variance of two.
    pub fn leaves_open(&self, other: &Self) -> bool {
        let alone = |these: &[Tile], those: &[Tile]| {
            let is_there = |t: &&Tile| !those.iter().any(|o| o.is_like(t));
            these.iter().filter(is_there).count()
        };
        let (ours, theirs) = (&self.one.tiles, &other.one.tiles);
        let differ = alone(ours, theirs) + alone(theirs, ours);
        let by_chance = (2.0 * NUMBERS_OF_A_PLANE * differ as f64).sqrt();
        differ > 0 && other.total() - self.total() <= LEAD + DEVIATIONS * by_chance
    }
}

/// Noise of a level's blocks.
pub struct Noise {
    /// What planes leave of it, and all of it, square metres.
    pub left: f64,
    variance: f64,
    /// Blocks over which it hangs together.
    lump: f64,
}

/// Weighs all readings by the noise that the planes of the most plane one leave; `None` where no plane is seen.
pub fn weigh(fitted: &mut [Rated], relief: &TileRelief) -> Option<Noise> {
    let plane = fitted
        .iter()
        .filter(|r| r.holds && r.misfit.mean() > 0.0)
        .min_by(|a, b| a.misfit.mean().total_cmp(&b.misfit.mean()))?;
    let (left, lump) = (plane.misfit.mean(), relief.lump_of(&plane.one.tiles));
    // Planes follow the noise: each of their numbers takes as much of it as hangs together.
    let taken = NUMBERS_OF_A_PLANE * lump * plane.misfit.cartons as f64;
    let share = (1.0 - taken / plane.misfit.blocks as f64).max(LEAST_LEFT);
    let noise = Noise {
        left,
        variance: left / share,
        lump: lump / share,
    };
    for r in fitted {
        r.weigh(&noise);
    }
    Some(noise)
}
