//! A scene seen from one eye: surfaces in pixel terms, front to back, binned by bands of rows.

use depal_frames::{Pose, Vector};

use crate::rounded::RoundedBox;
use crate::surface::{
    BoundedPolygon, Collect, Polygon, Round, TangentBounds, collect_mesh, collect_shape,
};
use crate::{RenderMesh, RenderShape};

/// Rows that share a bin; together they fit into the second-level cache.
pub(crate) const BAND: usize = 8;

/// Pixel grid: column u looks along x = (u - cx) / fx. Columns may be drawn from `columns.0` to
/// `columns.1` (excluded); those of an eye beside the camera may start below 0.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Grid {
    pub columns: (i32, i32),
    pub rows: usize,
    pub fx: f64,
    pub fy: f64,
    pub cx: f64,
    pub cy: f64,
}

/// A polygon in pixels: 1/z = `at_origin + per_column u + per_row v`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FlatSpan {
    pub at_origin: f64,
    pub per_column: f64,
    pub per_row: f64,
    /// Its sides as u = a + b v: first those it lies to the right of, then the others.
    pub sides: [[f64; 2]; 4],
    pub left_sides: u8,
    pub side_count: u8,
}

#[derive(Debug, Clone, Copy)]
pub(crate) enum Outline {
    Flat(FlatSpan),
    /// Index into [`View::rounds`].
    Round(u32),
    /// Index into [`View::rims`].
    Rim(u32),
}

/// What is not flat of a face of a rounded box: pixels in the sharp box's face around it, where the ray
/// meets an edge, a corner or nothing.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rim {
    /// The sharp box's face.
    pub whole: FlatSpan,
    /// Index of the flat part, if it can be seen; its pixels are not the rim's.
    pub flat: Option<u32>,
    pub rounded: RoundedBox,
}

/// A surface with the pixels that it can touch (ends excluded).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Drawable {
    pub outline: Outline,
    pub columns: (i32, i32),
    pub rows: (u32, u32),
    /// Bounds of 1/z on it.
    pub least: f32,
    pub most: f32,
}

/// What is needed to light a surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Face {
    /// Solid that it belongs to.
    pub solid: u32,
    /// Index into [`View::rounds`], or [`Face::FLAT`].
    pub round: u32,
    /// Outward normal; of no meaning for round surfaces.
    pub normal: [f32; 3],
    /// Distance of the eye in front of the plane, metres.
    pub distance: f32,
}

impl Face {
    pub const FLAT: u32 = u32::MAX;
}

#[derive(Debug, Clone, Default)]
pub(crate) struct View {
    pub grid: Grid,
    pub drawables: Vec<Drawable>,
    /// One for each drawable.
    pub faces: Vec<Face>,
    pub rounds: Vec<Round>,
    pub rims: Vec<Rim>,
    /// Where the list of each band starts in `binned`.
    starts: Vec<u32>,
    /// Drawables of each band, nearest solid first.
    binned: Vec<u32>,
    solid: u32,
}

impl View {
    /// Shows another scene. Solids are numbered through shapes, then meshes.
    pub fn show(
        &mut self,
        grid: Grid,
        view_from_world: &Pose,
        shapes: &[RenderShape],
        meshes: &[RenderMesh],
    ) {
        pulp::Arch::new().dispatch(ShowJob {
            view: self,
            grid,
            view_from_world,
            shapes,
            meshes,
        });
    }

    #[inline(always)]
    fn fill(
        &mut self,
        grid: Grid,
        view_from_world: &Pose,
        shapes: &[RenderShape],
        meshes: &[RenderMesh],
    ) {
        self.grid = grid;
        self.drawables.clear();
        self.faces.clear();
        self.rounds.clear();
        self.rims.clear();
        let from_shapes = shapes.iter().map(|s| &s.world_from_shape);
        let from_meshes = meshes.iter().map(|m| &m.world_from_mesh);
        let placed: Vec<Pose> = from_shapes
            .chain(from_meshes)
            .map(|world_from_it| view_from_world * world_from_it)
            .collect();
        // Nearest middle first: a guess that only costs time when it is wrong.
        let mut order: Vec<usize> = (0..placed.len()).collect();
        order.sort_by(|a, b| {
            let depth = |k: usize| placed[k].translation.z;
            depth(*a).total_cmp(&depth(*b)).then(a.cmp(b))
        });
        for k in order {
            self.solid = k as u32;
            match shapes.get(k) {
                Some(item) => collect_shape(self, &placed[k], &item.shape, item.edge_radius),
                None => collect_mesh(self, &placed[k], &meshes[k - shapes.len()].mesh),
            }
        }
        self.bin();
    }

    /// Drawables that touch the rows of a band, in drawing order.
    pub fn band(&self, band: usize) -> &[u32] {
        &self.binned[self.starts[band] as usize..self.starts[band + 1] as usize]
    }

    #[inline(always)]
    fn bin(&mut self) {
        let bands = self.grid.rows.div_ceil(BAND);
        let touched = |d: &Drawable| {
            let (first, last) = (d.rows.0 as usize / BAND, (d.rows.1 as usize - 1) / BAND);
            first..=last
        };
        let mut counts = std::mem::take(&mut self.starts);
        counts.clear();
        counts.resize(bands + 1, 0);
        for drawable in &self.drawables {
            for band in touched(drawable) {
                counts[band + 1] += 1;
            }
        }
        for band in 0..bands {
            counts[band + 1] += counts[band];
        }
        let mut next = counts.clone();
        self.starts = counts;
        self.binned.clear();
        self.binned.resize(next[bands] as usize, 0);
        for (index, drawable) in self.drawables.iter().enumerate() {
            for band in touched(drawable) {
                self.binned[next[band] as usize] = index as u32;
                next[band] += 1;
            }
        }
    }

    /// Whole pixels that tangent bounds can touch.
    #[inline(always)]
    fn pixels(&self, bounds: &TangentBounds) -> Option<((i32, i32), (u32, u32))> {
        let g = &self.grid;
        let columns = whole(
            bounds.x[0] * g.fx + g.cx,
            bounds.x[1] * g.fx + g.cx,
            f64::from(g.columns.0),
            f64::from(g.columns.1),
        )?;
        let rows = whole(
            bounds.y[0] * g.fy + g.cy,
            bounds.y[1] * g.fy + g.cy,
            0.0,
            g.rows as f64,
        )?;
        Some((
            (columns.0 as i32, columns.1 as i32),
            (rows.0 as u32, rows.1 as u32),
        ))
    }
}

/// Integers of `lo..=hi` within `least..end`, as a half-open range.
/// A hundredth of a pixel of slack: bounds and outlines round differently.
#[inline(always)]
fn whole(lo: f64, hi: f64, least: f64, end: f64) -> Option<(f64, f64)> {
    let first = (lo - 0.01).ceil().max(least);
    let last = (hi + 0.01).floor().min(end - 1.0);
    (first <= last).then_some((first, last + 1.0))
}

/// Compiled once for each instruction set that the processor may have.
struct ShowJob<'a> {
    view: &'a mut View,
    grid: Grid,
    view_from_world: &'a Pose,
    shapes: &'a [RenderShape],
    meshes: &'a [RenderMesh],
}

impl pulp::WithSimd for ShowJob<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.view
            .fill(self.grid, self.view_from_world, self.shapes, self.meshes);
    }
}

impl View {
    /// The pixels of a polygon; none when it is beside the picture.
    #[inline(always)]
    fn outline(&self, polygon: &Polygon, bounds: &TangentBounds) -> Option<(Drawable, FlatSpan)> {
        let (columns, rows) = self.pixels(bounds)?;
        let g = self.grid;
        let mut drawable = Drawable {
            outline: Outline::Round(0),
            columns,
            rows,
            least: bounds.least(),
            most: bounds.most(),
        };
        let mut sides = [[0.0; 2]; 4];
        let (mut left, mut right) = (0, 4);
        let width = f64::from(g.columns.1 - g.columns.0);
        for edge in &polygon.edges[..polygon.corners] {
            let (per_u, per_v) = (edge.x / g.fx, edge.y / g.fy);
            let rest = edge.z - per_u * g.cx - per_v * g.cy;
            // Along the whole width it stays in its row, or it is at infinity.
            let tiny = 1e-9 * (per_v.abs() + rest.abs());
            if per_u.abs() * width <= tiny {
                let middle = f64::from(g.columns.0) + 0.5 * width;
                let value = rest + per_u * middle;
                if per_v.abs() <= 1e-15 * rest.abs() {
                    if value < 0.0 {
                        return None;
                    }
                } else if per_v > 0.0 {
                    let first = (-value / per_v).ceil().clamp(0.0, g.rows as f64);
                    drawable.rows.0 = drawable.rows.0.max(first as u32);
                } else {
                    let end = (-value / per_v).floor().clamp(-1.0, g.rows as f64) + 1.0;
                    drawable.rows.1 = drawable.rows.1.min(end as u32);
                }
                continue;
            }
            let side = [-rest / per_u, -per_v / per_u];
            if per_u > 0.0 {
                sides[left] = side;
                left += 1;
            } else {
                right -= 1;
                sides[right] = side;
            }
        }
        if drawable.rows.0 >= drawable.rows.1 {
            return None;
        }
        // Close the space between both kinds.
        let count = left + 4 - right;
        sides.copy_within(right..4, left);
        let inverse = polygon.normal / polygon.plane;
        let (per_column, per_row) = (inverse.x / g.fx, inverse.y / g.fy);
        let flat = FlatSpan {
            at_origin: inverse.z - per_column * g.cx - per_row * g.cy,
            per_column,
            per_row,
            sides,
            left_sides: left as u8,
            side_count: count as u8,
        };
        drawable.outline = Outline::Flat(flat);
        Some((drawable, flat))
    }

    /// Notes a polygon of one flat face, and says the index of its drawable; none when it is beside the picture.
    #[inline(always)]
    fn flat_face(&mut self, polygon: &Polygon, bounds: &TangentBounds) -> Option<u32> {
        let (drawable, _) = self.outline(polygon, bounds)?;
        let index = self.drawables.len() as u32;
        self.drawables.push(drawable);
        self.faces.push(Face {
            solid: self.solid,
            round: Face::FLAT,
            normal: single(&polygon.normal),
            distance: -polygon.plane as f32,
        });
        Some(index)
    }
}

impl Collect for View {
    #[inline(always)]
    fn polygon(&mut self, polygon: &Polygon, bounds: TangentBounds) {
        self.flat_face(polygon, &bounds);
    }

    #[inline(always)]
    fn round(&mut self, round: Round, bounds: TangentBounds) {
        let Some((columns, rows)) = self.pixels(&bounds) else {
            return;
        };
        let index = self.rounds.len() as u32;
        let (round_index, normal, distance) = match &round {
            Round::Disk { normal, plane, .. } => (Face::FLAT, single(normal), -*plane as f32),
            _ => (index, [0.0; 3], 0.0),
        };
        self.rounds.push(round);
        self.drawables.push(Drawable {
            outline: Outline::Round(index),
            columns,
            rows,
            least: bounds.least(),
            most: bounds.most(),
        });
        self.faces.push(Face {
            solid: self.solid,
            round: round_index,
            normal,
            distance,
        });
    }

    #[inline(always)]
    fn rounded(&mut self, rounded: RoundedBox) {
        self.rounds.push(Round::Rounded(rounded));
    }

    #[inline(always)]
    fn rounded_face(&mut self, whole: &BoundedPolygon, flat: Option<&BoundedPolygon>) {
        let round = self.rounds.len() as u32 - 1;
        let Round::Rounded(rounded) = self.rounds[round as usize] else {
            return;
        };
        let Some((drawable, span)) = self.outline(&whole.0, &whole.1) else {
            return;
        };
        let flat = flat.and_then(|(polygon, bounds)| self.flat_face(polygon, bounds));
        self.drawables.push(Drawable {
            outline: Outline::Rim(self.rims.len() as u32),
            ..drawable
        });
        self.rims.push(Rim {
            whole: span,
            flat,
            rounded,
        });
        self.faces.push(Face {
            solid: self.solid,
            round,
            normal: [0.0; 3],
            distance: 0.0,
        });
    }
}

#[inline(always)]
fn single(v: &Vector) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}
