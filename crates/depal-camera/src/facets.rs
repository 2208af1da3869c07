//! Triangles put together in pairs: a drawn facet costs the same with three corners and with four.

use depal_frames::{Point, Vector};

/// How far the fourth corner may lie beside the plane of the other three, metres: single-precision 1/z at
/// 1 m resolves no less, so no picture shows which of both ways a pair was split.
const FLAT: f64 = 1e-7;

/// Corners of a facet, counter-clockwise from outside; a triangle names its last corner twice.
pub(crate) type Facet = [u32; 4];

/// The same surface with as many pairs of triangles as are found to be flat and convex, each triangle in
/// one pair at most. In the order of the triangles.
pub(crate) fn facets(vertices: &[Point], triangles: &[[u32; 3]]) -> Vec<Facet> {
    // Each side with the triangle that runs along it and the corner it does not touch.
    let mut sides: Vec<([u32; 2], u32, u32)> = Vec::with_capacity(3 * triangles.len());
    for (n, [a, b, c]) in triangles.iter().enumerate() {
        for (from, to, other) in [(a, b, c), (b, c, a), (c, a, b)] {
            sides.push(([*from, *to], n as u32, *other));
        }
    }
    sides.sort_unstable();
    let mut taken = vec![false; triangles.len()];
    let mut facets = Vec::with_capacity(triangles.len());
    for (n, [a, b, c]) in triangles.iter().enumerate() {
        if taken[n] {
            continue;
        }
        let mut facet = [*a, *b, *c, *c];
        for (p, q, r) in [(*a, *b, *c), (*b, *c, *a), (*c, *a, *b)] {
            // The neighbour runs along the common side the other way round.
            let first = sides.partition_point(|side| side.0 < [q, p]);
            let Some((side, neighbour, s)) = sides.get(first) else {
                continue;
            };
            let other = *neighbour as usize;
            let quad = [p, *s, q, r];
            if *side == [q, p] && other > n && !taken[other] && is_flat(vertices, quad) {
                taken[other] = true;
                facet = quad;
                break;
            }
        }
        facets.push(facet);
    }
    facets
}

/// Whether four corners lie in a plane and turn the same way at each of them.
fn is_flat(vertices: &[Point], quad: [u32; 4]) -> bool {
    let corners = quad.map(|k| vertices[k as usize].coords);
    let normal = normal_of(&corners);
    let length = normal.norm();
    let turns = |k: usize| {
        let (before, here, after) = (corners[(k + 3) % 4], corners[k], corners[(k + 1) % 4]);
        (here - before).cross(&(after - here)).dot(&normal) > 0.0
    };
    // The diagonals pass each other at this distance times `length`.
    let apart = (corners[1] - corners[0]).dot(&normal).abs();
    length > 0.0 && apart <= FLAT * length && (0..4).all(turns)
}

/// Outward normal of four corners, as long as twice their area.
#[inline(always)]
pub(crate) fn normal_of(corners: &[Vector; 4]) -> Vector {
    (corners[2] - corners[0]).cross(&(corners[3] - corners[1]))
}
