//! One height of a stack in a smeared picture: where its surface is, where it ends, and where nobody knows.

use crate::{
    fall::{bridged, growth},
    gate::DepthImage,
    plane::{Plane, PlaneFrame},
    resample::ResampledRow,
};

/// What a cell shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cell {
    /// Not measured, or beyond the picture.
    Unknown,
    /// Hidden by something nearer.
    Hidden,
    /// On the plane, or in a valley narrower than the smear: a gap between two cartons.
    On,
    /// On the plane, at the foot of what stands on it.
    Foot,
    /// Behind it: here the surface has ended.
    Deep,
}

/// A plane in cells.
pub struct Level {
    pub frame: PlaneFrame,
    /// Side of a cell, metres.
    pub cell: f64,
    /// So far beyond its edge it has fallen all the way, metres.
    pub foot: f64,
    low: [f64; 2],
    count: [usize; 2],
    cells: Vec<Cell>,
    /// Height over the plane, metres; NaN where nothing on it was measured.
    height: Vec<f32>,
    /// How far behind the plane, without bound; NaN where nothing was measured.
    below: Vec<f32>,
    /// The same in 1/z, which is what matching of patches averages, as metres at the level.
    fall: Vec<f32>,
    /// Sums over all cells below and left: on, deep.
    on: Vec<u32>,
    deep: Vec<u32>,
    /// The same of what is neither on a step around the surface nor on one up from it.
    flat: Vec<u32>,
    /// The same of the heights that were measured, and of how many they are.
    heights: Vec<[f64; 2]>,
}

/// How a level is cut out of a picture.
pub struct Cut {
    pub frame: PlaneFrame,
    /// Ranges along the frame's axes, metres.
    pub range: [[f64; 2]; 2],
    pub cell: f64,
    /// How far from the plane its surface lies at most, metres.
    pub tolerance: f64,
    /// What stands on it is at least so high, metres.
    pub height: f64,
    /// Cells over which a step is smeared.
    pub smear: usize,
    /// Valleys and holes up to so many cells between two parts of the surface belong to it.
    pub valley: usize,
}

impl Level {
    pub fn new(image: &DepthImage, cut: &Cut) -> Self {
        let count = cut
            .range
            .map(|r| ((r[1] - r[0]) / cut.cell).ceil().max(1.0) as usize);
        let [columns, rows] = count;
        let mut cells = vec![Cell::Unknown; columns * rows];
        let mut height = vec![f32::NAN; columns * rows];
        let mut below = vec![f32::NAN; columns * rows];
        let mut fall = vec![f32::NAN; columns * rows];
        let depth = cut.frame.origin.z as f32;
        let mut row = ResampledRow::new(columns);
        let low = [cut.range[0][0], cut.range[1][0]];
        // Half way up what stands on it, its foot is.
        let hidden = -(cut.tolerance.max(0.5 * cut.height)) as f32;
        for j in 0..rows {
            let first = cut.frame.point(
                low[0] + 0.5 * cut.cell,
                low[1] + (j as f64 + 0.5) * cut.cell,
            );
            row.fetch(image, &cut.frame, first, cut.frame.x * cut.cell);
            let here = j * columns..(j + 1) * columns;
            for (at, deeper) in here.zip(row.deeper()) {
                let Some(deeper) = deeper else { continue };
                let (cell, height) = (&mut cells[at], &mut height[at]);
                below[at] = deeper;
                fall[at] = deeper / (1.0 + deeper / depth).max(0.1);
                *cell = if deeper > cut.tolerance as f32 {
                    Cell::Deep
                } else if deeper < hidden {
                    Cell::Hidden
                } else if deeper < -(cut.tolerance as f32) {
                    Cell::Foot
                } else {
                    Cell::On
                };
                // A gap is no deeper than the smear lets it seem; the foot of what stands on it is no height of its own.
                if deeper >= -(cut.tolerance as f32) {
                    *height = (-deeper).max(-3.0 * cut.tolerance as f32);
                }
            }
        }
        let mut level = Self {
            frame: cut.frame,
            cell: cut.cell,
            foot: (0.5 * cut.smear as f64 + 3.0) * cut.cell,
            low,
            count,
            cells,
            height,
            below,
            fall,
            on: Vec::new(),
            flat: Vec::new(),
            deep: Vec::new(),
            heights: Vec::new(),
        };
        level.bridge(cut.valley);
        let flat = level.sums(Cell::On);
        level.extend(cut.smear, 0, cut.height);
        level.extend(cut.smear, 1, cut.height);
        level.flat = flat;
        for cell in level.cells.iter_mut().filter(|c| **c == Cell::Foot) {
            *cell = Cell::On;
        }
        level.on = level.sums(Cell::On);
        level.deep = level.sums(Cell::Deep);
        level.heights = level.sum_heights();
        level
    }

    /// Takes in, along an axis, what lies before the steps around the surface. A step smeared alike to both sides has
    /// fallen by half as much again a quarter of a smear beyond its edge as there. That asks for no level ground at its
    /// foot: on the rim of a pallet there may be none before the next step begins.
    fn extend(&mut self, smear: usize, axis: usize, carton: f64) {
        let [columns, rows] = self.count;
        let (count, stride) = if axis == 0 {
            (columns, 1)
        } else {
            (rows, columns)
        };
        let mut taken = Vec::new();
        // The camera over the level's origin: along the axis in cells, and above it.
        let to_camera = -self.frame.origin.coords;
        let along = if axis == 0 {
            self.frame.x
        } else {
            self.frame.y
        };
        let camera = (to_camera.dot(&along) - self.low[axis]) / self.cell;
        let above = to_camera.dot(&self.frame.plane.normal());
        let ahead = (smear / 4).max(1);
        let share = ahead as f64 / smear.max(1) as f64;
        for line in 0..columns * rows / count.max(1) {
            let start = if axis == 0 { line * columns } else { line };
            let at = |k: usize| start + k * stride;
            let falls = bridged((0..count).map(|k| self.fall[at(k)]), smear);
            for k in (0..count).filter(|k| self.cells[at(*k)] == Cell::On) {
                for sign in [1, -1] {
                    let step = |by: usize| {
                        k.checked_add_signed(sign * by as isize)
                            .filter(|k| *k < count)
                    };
                    let mut begun = false;
                    for by in 1..=smear / 2 + 1 {
                        let Some((here, beyond)) = step(by).zip(step(by + ahead)) else {
                            break;
                        };
                        // What is lost on a step belongs to it, what is lost beside a sharp one does not.
                        let cell = self.cells[at(here)];
                        begun |= cell == Cell::Deep;
                        let on_step = cell == Cell::Deep || begun && cell == Cell::Unknown;
                        let drop = step(by + smear).map_or(carton, |b| f64::from(falls[b]));
                        // A wall is as high as its carton, or goes on over the one below.
                        let drop = drop.max(carton).min(2.0 * carton);
                        let wall = sign as f64 * (camera - here as f64) * drop / (above + drop);
                        let ratio = growth(wall / smear as f64, share) as f32;
                        // Not measured compares as false.
                        if !(on_step && falls[beyond] > ratio * falls[here]) {
                            break;
                        }
                        taken.push(at(here));
                    }
                }
            }
        }
        for at in taken {
            self.cells[at] = Cell::On;
        }
    }

    /// Takes in what lies in narrow valleys along either axis.
    fn bridge(&mut self, widest: usize) {
        let [columns, rows] = self.count;
        let mut bridged = Vec::new();
        let mut line = |cells: &[Cell], start: usize, stride: usize, count: usize| {
            let mut last: Option<usize> = None;
            for k in 0..count {
                match cells[start + k * stride] {
                    Cell::On => {}
                    Cell::Hidden => {
                        last = None;
                        continue;
                    }
                    Cell::Unknown | Cell::Deep | Cell::Foot => continue,
                }
                if let Some(last) = last.filter(|l| k - l > 1 && k - l <= widest + 1) {
                    bridged.extend((last + 1..k).map(|k| start + k * stride));
                }
                last = Some(k);
            }
        };
        for j in 0..rows {
            line(&self.cells, j * columns, 1, columns);
        }
        for i in 0..columns {
            line(&self.cells, i, columns, rows);
        }
        for at in bridged {
            self.cells[at] = Cell::On;
        }
    }

    fn sums(&self, what: Cell) -> Vec<u32> {
        let [columns, rows] = self.count;
        let mut sums = vec![0u32; (columns + 1) * (rows + 1)];
        for j in 0..rows {
            let mut row = 0;
            for i in 0..columns {
                row += u32::from(self.cells[j * columns + i] == what);
                sums[(j + 1) * (columns + 1) + i + 1] = sums[j * (columns + 1) + i + 1] + row;
            }
        }
        sums
    }

    fn sum_heights(&self) -> Vec<[f64; 2]> {
        let [columns, rows] = self.count;
        let mut sums = vec![[0.0; 2]; (columns + 1) * (rows + 1)];
        for j in 0..rows {
            let mut row = [0.0; 2];
            for i in 0..columns {
                let at = j * columns + i;
                if self.cells[at] == Cell::On && !self.height[at].is_nan() {
                    row[0] += f64::from(self.height[at]);
                    row[1] += 1.0;
                }
                let before = sums[j * (columns + 1) + i + 1];
                sums[(j + 1) * (columns + 1) + i + 1] = [before[0] + row[0], before[1] + row[1]];
            }
        }
        sums
    }

    /// Ranges along both axes, metres.
    pub fn range(&self, axis: usize) -> [f64; 2] {
        let low = self.low[axis];
        [low, low + self.count[axis] as f64 * self.cell]
    }

    /// The border between cells that is next to a place along an axis, also beyond the level.
    fn border(&self, axis: usize, at: f64) -> f64 {
        ((at - self.low[axis]) / self.cell).round()
    }

    fn index(&self, axis: usize, at: f64) -> usize {
        self.border(axis, at).clamp(0.0, self.count[axis] as f64) as usize
    }

    /// How many cells a rectangle has, those beyond the level too: whole ones, as the sums count them.
    fn cells_within(&self, low: [f64; 2], high: [f64; 2]) -> f64 {
        let [columns, rows] = [0, 1].map(|k| self.border(k, high[k]) - self.border(k, low[k]));
        columns * rows
    }

    /// What is at a place.
    pub fn at(&self, place: [f64; 2]) -> Cell {
        let of = |axis: usize| ((place[axis] - self.low[axis]) / self.cell).floor();
        let (i, j) = (of(0), of(1));
        let inside = i >= 0.0 && j >= 0.0 && i < self.count[0] as f64 && j < self.count[1] as f64;
        if inside {
            self.cells[j as usize * self.count[0] + i as usize]
        } else {
            Cell::Unknown
        }
    }

    /// Shares of a rectangle (low, high corner) that are on the plane and deep; what lies beyond the level is neither.
    pub fn shares(&self, low: [f64; 2], high: [f64; 2]) -> [f64; 2] {
        let [i0, i1] = [low[0], high[0]].map(|x| self.index(0, x));
        let [j0, j1] = [low[1], high[1]].map(|y| self.index(1, y));
        if i1 <= i0 || j1 <= j0 {
            return [0.0; 2];
        }
        let whole = self.cells_within(low, high);
        let n = self.count[0] + 1;
        [&self.on, &self.deep].map(|s| {
            let sum = s[j1 * n + i1] + s[j0 * n + i0] - s[j0 * n + i1] - s[j1 * n + i0];
            f64::from(sum) / whole.max(1.0)
        })
    }

    /// Share of a rectangle that is surface beside no step.
    pub fn flat_share(&self, low: [f64; 2], high: [f64; 2]) -> f64 {
        let [i0, i1] = [low[0], high[0]].map(|x| self.index(0, x));
        let [j0, j1] = [low[1], high[1]].map(|y| self.index(1, y));
        let n = self.count[0] + 1;
        let s = &self.flat;
        let sum = s[j1 * n + i1] + s[j0 * n + i0] - s[j0 * n + i1] - s[j1 * n + i0];
        f64::from(sum) / self.cells_within(low, high).max(1.0)
    }

    /// Places of a lattice around which, up to half of `slack` metres, all is surface.
    pub fn inner_places(&self, slack: f64) -> Vec<[f64; 2]> {
        const ALL: f64 = 0.97;
        let step = 0.5 * slack;
        let counts = [0, 1].map(|k| (self.count[k] as f64 * self.cell / step) as usize);
        let mut places = Vec::new();
        for j in 0..counts[1] {
            for i in 0..counts[0] {
                let at = [self.low[0] + i as f64 * step, self.low[1] + j as f64 * step];
                let [on, _] = self.shares(at.map(|v| v - step), at.map(|v| v + step));
                if on > ALL {
                    places.push(at);
                }
            }
        }
        places
    }

    /// Mean height of the cells of a rectangle, metres; `None` where less than half was measured.
    pub fn mean_height(&self, low: [f64; 2], high: [f64; 2]) -> Option<f64> {
        let [i0, i1] = [low[0], high[0]].map(|x| self.index(0, x));
        let [j0, j1] = [low[1], high[1]].map(|y| self.index(1, y));
        let cells = i1.saturating_sub(i0) * j1.saturating_sub(j0);
        if cells == 0 {
            return None;
        }
        let n = self.count[0] + 1;
        let (a, b) = (self.heights[j1 * n + i1], self.heights[j0 * n + i0]);
        let (c, d) = (self.heights[j0 * n + i1], self.heights[j1 * n + i0]);
        let [sum, count] = [0, 1].map(|k| a[k] + b[k] - c[k] - d[k]);
        (2.0 * count >= cells as f64).then(|| sum / count)
    }

    /// By how much the heights along a line (across `axis` at `at`, `range` along it) lie below those `beside` metres to
    /// both sides, metres; each over `wide` metres.
    pub fn valley(
        &self,
        axis: usize,
        at: f64,
        range: [f64; 2],
        beside: f64,
        wide: f64,
    ) -> Option<f64> {
        let strip = |middle: f64| {
            let (mut low, mut high) = ([0.0; 2], [0.0; 2]);
            (low[axis], high[axis]) = (middle - 0.5 * wide, middle + 0.5 * wide);
            (low[1 - axis], high[1 - axis]) = (range[0], range[1]);
            self.mean_height(low, high)
        };
        let (before, after) = (strip(at - beside)?, strip(at + beside)?);
        Some(f64::midpoint(before, after) - strip(at)?)
    }

    /// How far behind the plane it is at a place, metres; up to the tolerance 0, `None` where nobody knows.
    pub fn depth_below(&self, place: [f64; 2]) -> Option<f64> {
        let of = |axis: usize| ((place[axis] - self.low[axis]) / self.cell).floor();
        let (i, j) = (of(0), of(1));
        let inside = i >= 0.0 && j >= 0.0 && i < self.count[0] as f64 && j < self.count[1] as f64;
        let below = inside.then(|| self.below[j as usize * self.count[0] + i as usize])?;
        (!below.is_nan()).then_some(f64::from(below))
    }

    /// The plane of the level moved along its normal, metres towards the camera.
    pub fn plane_at(&self, height: f64) -> Plane {
        let normal = self.frame.plane.normal();
        let point = self.frame.origin + normal * height;
        Plane {
            coefficient: normal / normal.dot(&point.coords),
        }
    }
}

#[cfg(test)]
mod tests;
