use depal_frames::{Intrinsics, Pose};
use rayon::prelude::*;

use crate::raster::{Seen, TILE, Target, Tile};
use crate::view::{BAND, Grid, View};
use crate::{CameraSpec, RenderMesh, RenderShape};

/// What is there, seen without a sensor: the exact image of the solids.
#[derive(Debug, Clone)]
pub struct Rendering {
    pub(crate) intrinsics: Intrinsics,
    /// 1/z, 1/m; 0 = nothing.
    pub(crate) inverse_depth: Vec<f32>,
    /// Index into the view's faces, or `EMPTY`.
    pub(crate) surface: Vec<u32>,
    /// What each tile shows, band by band of rows.
    pub(crate) tiles: Vec<Seen>,
    pub(crate) view: View,
    pub(crate) camera_from_world: Pose,
    pub(crate) shapes: Vec<RenderShape>,
    pub(crate) meshes: Vec<RenderMesh>,
}

/// Draws the shapes as the camera sees them.
pub fn render(spec: &CameraSpec, world_from_camera: &Pose, shapes: &[RenderShape]) -> Rendering {
    render_with_meshes(spec, world_from_camera, shapes, &[])
}

/// The same with solids given as triangles.
pub fn render_with_meshes(
    spec: &CameraSpec,
    world_from_camera: &Pose,
    shapes: &[RenderShape],
    meshes: &[RenderMesh],
) -> Rendering {
    let mut rendering = Rendering {
        intrinsics: spec.intrinsics,
        inverse_depth: Vec::new(),
        surface: Vec::new(),
        tiles: Vec::new(),
        view: View::default(),
        camera_from_world: Pose::identity(),
        shapes: Vec::new(),
        meshes: Vec::new(),
    };
    rendering.redraw_with_meshes(spec, world_from_camera, shapes, meshes);
    rendering
}

/// The pixels of the image itself.
fn grid(i: &Intrinsics) -> Grid {
    Grid {
        columns: (0, i.width as i32),
        rows: i.height,
        fx: i.fx,
        fy: i.fy,
        cx: i.cx,
        cy: i.cy,
    }
}

impl Rendering {
    /// The same as [`render`] into the buffers of an earlier rendering, whatever it showed:
    /// at 1.3 million pixels fetching new memory costs as much as drawing.
    pub fn redraw(&mut self, spec: &CameraSpec, world_from_camera: &Pose, shapes: &[RenderShape]) {
        self.redraw_with_meshes(spec, world_from_camera, shapes, &[]);
    }

    /// The same as [`render_with_meshes`] into the buffers of an earlier rendering.
    pub fn redraw_with_meshes(
        &mut self,
        spec: &CameraSpec,
        world_from_camera: &Pose,
        shapes: &[RenderShape],
        meshes: &[RenderMesh],
    ) {
        let i = spec.intrinsics;
        let pixels = i.width * i.height;
        self.intrinsics = i;
        self.camera_from_world = world_from_camera.inverse();
        self.shapes.clear();
        self.shapes.extend_from_slice(shapes);
        self.meshes.clear();
        self.meshes.extend_from_slice(meshes);
        self.view
            .show(grid(&i), &self.camera_from_world, shapes, meshes);
        // What is left of an earlier picture is overwritten band by band, while it is in the cache.
        self.inverse_depth.resize(pixels, 0.0);
        self.surface.resize(pixels, 0);
        let tiles = i.width.div_ceil(TILE);
        self.tiles
            .resize(tiles * i.height.div_ceil(BAND), Seen::NOTHING);
        if pixels == 0 {
            return;
        }
        let view = &self.view;
        let band = BAND * i.width;
        let arch = pulp::Arch::new();
        self.inverse_depth
            .par_chunks_mut(band)
            .zip(self.surface.par_chunks_mut(band))
            .zip(self.tiles.par_chunks_mut(tiles))
            .enumerate()
            .for_each_init(Vec::new, |tiles, (n, ((inverse_depth, surface), seen))| {
                tiles.clear();
                tiles.resize(seen.len(), Tile::BLANK);
                let target = Target {
                    first_row: n * BAND,
                    rows: inverse_depth.len() / i.width,
                    first_column: 0,
                    width: i.width,
                    inverse_depth,
                    surface,
                    tiles,
                };
                arch.dispatch(DrawJob { view, target, seen });
            });
    }

    /// Id of a solid; they are numbered through shapes, then meshes.
    pub(crate) fn id(&self, solid: u32) -> u32 {
        let solid = solid as usize;
        match self.shapes.get(solid) {
            Some(shape) => shape.id,
            None => self.meshes[solid - self.shapes.len()].id,
        }
    }
}

/// One band of rows, compiled once for each instruction set that the processor may have.
struct DrawJob<'a> {
    view: &'a View,
    target: Target<'a>,
    seen: &'a mut [Seen],
}

impl pulp::WithSimd for DrawJob<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(mut self, _: S) {
        self.target.draw(self.view);
        for (k, seen) in self.seen.iter_mut().enumerate() {
            *seen = self.target.tiles[k].seen;
            self.target.clear_if_unseen(k);
        }
    }
}
