use depal_frames::{Intrinsics, Pose};
use rayon::prelude::*;

use crate::raster::{Strip, Tiles, draw};
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
        view: View::new(grid(&spec.intrinsics), &Pose::identity(), &[], &[]),
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
        self.view = View::new(grid(&i), &self.camera_from_world, shapes, meshes);
        // What is left of an earlier picture is overwritten band by band, while it is in the cache.
        self.inverse_depth.resize(pixels, 0.0);
        self.surface.resize(pixels, 0);
        if pixels == 0 {
            return;
        }
        let view = &self.view;
        let band = BAND * i.width;
        let arch = pulp::Arch::new();
        self.inverse_depth
            .par_chunks_mut(band)
            .zip(self.surface.par_chunks_mut(band))
            .enumerate()
            .for_each_init(Tiles::default, |tiles, (n, (inverse_depth, surface))| {
                let strip = Strip {
                    first_row: n * BAND,
                    first_column: 0,
                    width: i.width,
                    inverse_depth,
                    surface,
                };
                arch.dispatch(DrawJob { view, strip, tiles });
            });
    }

    /// Number of a face's solid, through shapes, then meshes.
    pub(crate) fn material(&self, solid: u32) -> crate::Material {
        let solid = solid as usize;
        match self.shapes.get(solid) {
            Some(shape) => shape.material,
            None => self.meshes[solid - self.shapes.len()].material,
        }
    }

    pub(crate) fn id(&self, solid: u32) -> u32 {
        let solid = solid as usize;
        match self.shapes.get(solid) {
            Some(shape) => shape.id,
            None => self.meshes[solid - self.shapes.len()].id,
        }
    }
}

/// One strip, compiled once for each instruction set that the processor may have.
struct DrawJob<'a> {
    view: &'a View,
    strip: Strip<'a>,
    tiles: &'a mut Tiles,
}

impl pulp::WithSimd for DrawJob<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(mut self, _: S) {
        draw(self.view, &mut self.strip, self.tiles);
    }
}
