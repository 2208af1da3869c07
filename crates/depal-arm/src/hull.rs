//! Convex hulls of point clouds, with few corners.

use std::{cmp::Ordering::Equal, f64::consts::PI};

use depal_frames::{ConvexHull, Point, Pose, Shape, Vector};

/// Directions whose farthest points make the hull.
const DIRECTIONS: usize = 200;
/// Corners beyond which a hull is not made finer.
const MOST_CORNERS: usize = 400;
/// Corners that are added at once.
const ROUND: usize = 30;
/// What may lie outside before it is made larger, as a share of the smallest side.
const FINE: f64 = 0.002;
/// A hull thinner than this becomes a box of this thickness, m.
const THINNEST: f64 = 1e-3;

/// A convex solid that holds all points, and where it sits.
///
/// The points that lie farthest in 200 directions span it, then those farthest outside of a face, until hardly anything
/// is outside or it has 400 corners. It is then made larger about its middle until all points are inside:
/// nothing for bodies with few corners, about a hundredth for round ones.
/// Flat point clouds become flat boxes.
pub(crate) fn around(points: &[Point]) -> (Pose, Shape) {
    let (low, high) = bounds(points);
    let middle = nalgebra::center(&low, &high);
    let size = high - low;
    let boxed = || {
        let half = size.map(|s| s.max(THINNEST) * 0.5);
        let shape = Shape::Cuboid { half_extents: half };
        (Pose::translation(middle.x, middle.y, middle.z), shape)
    };
    if size.min() < THINNEST {
        return boxed();
    }
    let mut points: Vec<Vector> = points.iter().map(|p| p - middle).collect();
    points.sort_by(|a, b| a.as_slice().partial_cmp(b.as_slice()).unwrap_or(Equal));
    points.dedup();
    let mut chosen: Vec<Vector> = extremes(&points).into_iter().map(|i| points[i]).collect();
    let (faces, planes) = loop {
        let Some(faces) = faces(&chosen, size.norm()) else {
            return boxed();
        };
        let planes: Vec<(Vector, f64)> = faces.iter().map(|f| plane(&chosen, f)).collect();
        let room = MOST_CORNERS.saturating_sub(chosen.len()).min(ROUND);
        let outside = farthest_outside(&points, &planes, FINE * size.min(), room);
        if outside.is_empty() {
            break (faces, planes);
        }
        chosen.extend(outside);
    };
    // The middle of the corners lies inside; everything grows away from it.
    let inner = chosen.iter().sum::<Vector>() / chosen.len() as f64;
    let mut growth: f64 = 1.0;
    for point in &points {
        let way = point - inner;
        for (normal, offset) in &planes {
            growth = growth.max(normal.dot(&way) / (offset - normal.dot(&inner)));
        }
    }
    if !growth.is_finite() || growth > 1.5 {
        return boxed();
    }
    let vertices = chosen
        .iter()
        .map(|v| Point::from(inner + (v - inner) * growth))
        .collect();
    let pose = Pose::translation(middle.x, middle.y, middle.z);
    (pose, Shape::hull(ConvexHull::new(vertices, faces)))
}

/// The points farthest outside of some face, if they are farther out than `slack`; at most `most`, no point twice.
fn farthest_outside(
    points: &[Vector],
    planes: &[(Vector, f64)],
    slack: f64,
    most: usize,
) -> Vec<Vector> {
    let mut best: Vec<(f64, usize)> = vec![(slack, usize::MAX); planes.len()];
    for (i, point) in points.iter().enumerate() {
        for ((normal, offset), best) in planes.iter().zip(&mut best) {
            let out = normal.dot(point) - offset;
            if out > best.0 {
                *best = (out, i);
            }
        }
    }
    best.retain(|b| b.1 != usize::MAX);
    best.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut chosen: Vec<usize> = Vec::new();
    for (_, i) in best {
        if chosen.len() < most && !chosen.contains(&i) {
            chosen.push(i);
        }
    }
    chosen.into_iter().map(|i| points[i]).collect()
}

/// Diagonal of the box around all points.
pub(crate) fn size(points: &[Point]) -> f64 {
    let (low, high) = bounds(points);
    (high - low).norm()
}

fn bounds(points: &[Point]) -> (Point, Point) {
    let mut low = points[0];
    let mut high = points[0];
    for point in points {
        for i in 0..3 {
            low[i] = low[i].min(point[i]);
            high[i] = high[i].max(point[i]);
        }
    }
    (low, high)
}

/// Indices of the farthest points along the axes, the diagonals and directions spread evenly over the sphere, without doubles.
fn extremes(points: &[Vector]) -> Vec<usize> {
    let mut directions = Vec::new();
    for i in 0..27 {
        let sign = |digit: usize| (digit % 3) as f64 - 1.0;
        let diagonal = Vector::new(sign(i), sign(i / 3), sign(i / 9));
        if diagonal != Vector::zeros() {
            directions.push(diagonal);
        }
    }
    // A spiral from pole to pole, turning by the golden angle.
    let golden = PI * (3.0 - 5.0_f64.sqrt());
    for i in 0..DIRECTIONS {
        let z = 1.0 - (2.0 * i as f64 + 1.0) / DIRECTIONS as f64;
        let (sine, cosine) = (golden * i as f64).sin_cos();
        let round = (1.0 - z * z).sqrt();
        directions.push(Vector::new(round * cosine, round * sine, z));
    }
    let mut chosen: Vec<usize> = Vec::new();
    for direction in directions {
        let mut best = (f64::NEG_INFINITY, 0);
        for (i, point) in points.iter().enumerate() {
            let far = direction.dot(point);
            if far > best.0 {
                best = (far, i);
            }
        }
        let known = |&i: &usize| (points[i] - points[best.1]).norm_squared() < 1e-12;
        if !chosen.iter().any(known) {
            chosen.push(best.1);
        }
    }
    chosen
}

fn plane(points: &[Vector], face: &[u32; 3]) -> (Vector, f64) {
    let [a, b, c] = face.map(|i| points[i as usize]);
    let normal = (b - a).cross(&(c - a)).normalize();
    (normal, normal.dot(&a))
}

/// Triangles of the hull, counter-clockwise from outside; point by point, the faces that see a new point make way
/// for a cone to it. None when the points lie in a plane or rounding breaks the surface.
fn faces(points: &[Vector], size: f64) -> Option<Vec<[u32; 3]>> {
    let slack = size * 1e-7;
    let mut faces = first_four(points, slack)?;
    for new in 0..points.len() as u32 {
        let at = points[new as usize];
        let seen: Vec<bool> = faces
            .iter()
            .map(|face| {
                let (normal, offset) = plane(points, face);
                !face.contains(&new) && normal.dot(&at) - offset > slack
            })
            .collect();
        if !seen.contains(&true) {
            continue;
        }
        // Edges between seen and hidden faces, in the sense of the seen ones.
        let edges = |face: &[u32; 3]| [0, 1, 2].map(|i| (face[i], face[(i + 1) % 3]));
        let seen_edges: Vec<(u32, u32)> = faces
            .iter()
            .zip(&seen)
            .filter(|(_, s)| **s)
            .flat_map(|(f, _)| edges(f))
            .collect();
        let rim: Vec<(u32, u32)> = seen_edges
            .iter()
            .copied()
            .filter(|&(a, b)| !seen_edges.contains(&(b, a)))
            .collect();
        let mut kept: Vec<[u32; 3]> = faces
            .iter()
            .zip(&seen)
            .filter(|(_, s)| !**s)
            .map(|(f, _)| *f)
            .collect();
        for (a, b) in rim {
            let face = [a, b, new];
            if !plane(points, &face).1.is_finite() {
                return None;
            }
            kept.push(face);
        }
        faces = kept;
    }
    // A closed surface has two more corners than half its faces.
    let mut corners: Vec<u32> = faces.iter().flatten().copied().collect();
    corners.sort_unstable();
    corners.dedup();
    (faces.len() + 4 == 2 * corners.len()).then_some(faces)
}

/// A tetrahedron to begin with.
fn first_four(points: &[Vector], slack: f64) -> Option<Vec<[u32; 3]>> {
    let farthest = |far: &dyn Fn(&Vector) -> f64| {
        let (i, distance) = points
            .iter()
            .map(far)
            .enumerate()
            .max_by(|a, b| a.1.total_cmp(&b.1))?;
        (distance > slack.max(1e-9)).then_some(i)
    };
    let a = points[0];
    let second = farthest(&|p| (p - a).norm())?;
    let along = (points[second] - a).normalize();
    let third = farthest(&|p| (p - a).cross(&along).norm())?;
    let normal = (points[second] - a).cross(&(points[third] - a)).normalize();
    let fourth = farthest(&|p| (p - a).dot(&normal).abs())?;
    let [mut b, mut c, d] = [second, third, fourth].map(|i| i as u32);
    if (points[fourth] - a).dot(&normal) > 0.0 {
        std::mem::swap(&mut b, &mut c);
    }
    // Now the fourth lies behind the first face.
    Some(vec![[0, b, c], [0, c, d], [0, d, b], [b, d, c]])
}
