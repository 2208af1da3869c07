use std::sync::Arc;

use depal_frames::{Point, Pose};

use crate::Material;
use crate::facets::{Facet, facets};

/// Triangles in their own frame, metres. Corners are listed counter-clockwise as seen from outside;
/// only that side is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct TriangleMesh {
    vertices: Vec<Point>,
    triangles: Vec<[u32; 3]>,
    facets: Vec<Facet>,
    radius: f64,
}

impl TriangleMesh {
    /// `None` when a triangle names a vertex that is not there, or a coordinate is not finite.
    pub fn new(vertices: Vec<Point>, triangles: Vec<[u32; 3]>) -> Option<Self> {
        let count = vertices.len();
        let known = |t: &[u32; 3]| t.iter().all(|k| (*k as usize) < count);
        let finite = |p: &Point| p.iter().all(|c| c.is_finite());
        if !triangles.iter().all(known) || !vertices.iter().all(finite) {
            return None;
        }
        let radius = vertices.iter().fold(0.0_f64, |r, p| r.max(p.coords.norm()));
        Some(Self {
            facets: facets(&vertices, &triangles),
            vertices,
            triangles,
            radius,
        })
    }

    /// Its corners.
    pub fn vertices(&self) -> &[Point] {
        &self.vertices
    }

    /// Indices of three corners each.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// What is drawn: the same surface in fewer pieces.
    pub(crate) fn facets(&self) -> &[Facet] {
        &self.facets
    }

    /// Distance of the farthest corner from the origin.
    pub fn bounding_radius(&self) -> f64 {
        self.radius
    }
}

/// A solid to be drawn from its triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderMesh {
    /// Where the mesh's own frame stands in the world, metres.
    pub world_from_mesh: Pose,
    /// Its closed surface; shared, since a link keeps its mesh while it moves.
    pub mesh: Arc<TriangleMesh>,
    /// As [`RenderShape::id`](crate::RenderShape::id).
    pub id: u32,
    /// Its surface.
    pub material: Material,
}
