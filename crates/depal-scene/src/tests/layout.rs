use depal_frames::{Point, Vector};
use depal_time::RandomStreams;

use super::demo;
use crate::*;

/// Corners of a carton's footprint in the world, mm.
fn corners(carton: &CartonPlacement) -> [Point; 4] {
    let half = carton.size.half_extents();
    [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(x, y)| {
        let corner = carton.world_from_carton * Point::new(x * half.x, y * half.y, 0.0);
        corner * 1e3
    })
}

/// Exact distance between two turned rectangles, mm; the depth of the overlap, negative, where they meet.
fn separation_mm(a: &CartonPlacement, b: &CartonPlacement) -> f64 {
    let depth = overlap_mm(a, b);
    if depth <= 0.0 {
        return depth;
    }
    // The nearest points of two polygons that do not meet are a corner of one and an edge of the other.
    let (corners_a, corners_b) = (corners(a), corners(b));
    let from_corners = |points: &[Point; 4], polygon: &[Point; 4]| {
        let mut nearest = f64::INFINITY;
        for point in points {
            for side in 0..4 {
                let (start, end) = (polygon[side].xy(), polygon[(side + 1) % 4].xy());
                let edge = end - start;
                let share = ((point.xy() - start).dot(&edge) / edge.norm_squared()).clamp(0.0, 1.0);
                nearest = nearest.min((point.xy() - (start + edge * share)).norm());
            }
        }
        nearest
    };
    from_corners(&corners_a, &corners_b).min(from_corners(&corners_b, &corners_a))
}

/// Distance along the best separating direction, mm; negative when the rectangles overlap.
/// Only the edges' normals have to be tried (separating axis theorem).
fn overlap_mm(a: &CartonPlacement, b: &CartonPlacement) -> f64 {
    let (corners_a, corners_b) = (corners(a), corners(b));
    let normals = [a, b].into_iter().flat_map(|carton| {
        let rotation = carton.world_from_carton.rotation;
        [rotation * Vector::x(), rotation * Vector::y()]
    });
    let along = |normal: &Vector, points: &[Point; 4]| {
        let heights = points.map(|point| normal.dot(&point.coords));
        (
            heights.iter().copied().fold(f64::INFINITY, f64::min),
            heights.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        )
    };
    normals
        .map(|normal| {
            let (low_a, high_a) = along(&normal, &corners_a);
            let (low_b, high_b) = along(&normal, &corners_b);
            (low_a - high_b).max(low_b - high_a)
        })
        .fold(f64::NEG_INFINITY, f64::max)
}

/// Smallest separation of two cartons of one layer, mm.
pub(super) fn closest_mm(cartons: &[CartonPlacement]) -> f64 {
    let mut closest = f64::INFINITY;
    for (position, a) in cartons.iter().enumerate() {
        for b in cartons[position + 1..]
            .iter()
            .filter(|b| b.layer == a.layer)
        {
            closest = closest.min(separation_mm(a, b));
        }
    }
    closest
}

#[test]
fn the_separation_tells_overlap_from_distance() {
    let cartons = carton_layout(&demo(&[]), RandomStreams::new(1));
    let (a, mut b) = (cartons[0], cartons[1]);
    assert!(separation_mm(&a, &b) > 0.0);
    b.world_from_carton = a.world_from_carton;
    b.world_from_carton.translation.x += 0.399;
    assert!(
        (separation_mm(&a, &b) + 1.0).abs() < 0.01,
        "overlap of 1 mm"
    );
    b.world_from_carton.translation.x += 0.005;
    assert!(
        (separation_mm(&a, &b) - 4.0).abs() < 0.05,
        "distance of 4 mm"
    );
}

#[test]
fn two_hundred_seeds_never_overlap_and_stay_on_the_pallet() {
    let scene = demo(&[]);
    let (mut closest, mut farthest_out) = (f64::INFINITY, 0.0_f64);
    for seed in 0..200 {
        let cartons = carton_layout(&scene, RandomStreams::new(seed));
        assert_eq!(cartons.len(), 48);
        closest = closest.min(closest_mm(&cartons));
        for carton in &cartons {
            for corner in corners(carton) {
                let out_x = (corner.x - 1700.0).abs() - 400.0;
                let out_y = corner.y.abs() - 600.0;
                farthest_out = farthest_out.max(out_x).max(out_y);
            }
        }
    }
    assert!(closest >= 2.0 - 1e-6, "closest {closest} mm");
    assert!(
        closest < 2.2,
        "the lower end of the range is really used: {closest} mm"
    );
    assert!(farthest_out <= 15.0, "{farthest_out} mm over the edge");
}

#[test]
fn gaps_in_a_column_fill_their_range_and_keep_it() {
    let scene = demo(&[]);
    let (mut smallest, mut largest) = (f64::INFINITY, 0.0_f64);
    for seed in 0..200 {
        for pair in carton_layout(&scene, RandomStreams::new(seed)).windows(2) {
            let [a, b] = pair else { unreachable!() };
            if a.layer == b.layer && a.cell[0] == b.cell[0] {
                let top = corners(a)
                    .iter()
                    .map(|corner| corner.y)
                    .fold(f64::NEG_INFINITY, f64::max);
                let bottom = corners(b)
                    .iter()
                    .map(|corner| corner.y)
                    .fold(f64::INFINITY, f64::min);
                smallest = smallest.min(bottom - top);
                largest = largest.max(bottom - top);
            }
        }
    }
    assert!((2.0 - 1e-6..2.1).contains(&smallest), "{smallest}");
    assert!(largest > 5.9 && largest <= 6.0 + 1e-6, "{largest}");
}

#[test]
fn a_scene_that_asks_for_nothing_random_is_tidy() {
    let scene = demo(&[
        ("randomize.gap_mm", "0"),
        ("randomize.yaw_deg", "0"),
        ("randomize.shift_mm", "0"),
        ("cartons.mass_kg", "12"),
    ]);
    let cartons = carton_layout(&scene, RandomStreams::new(3));
    assert_eq!(cartons, carton_layout(&scene, RandomStreams::new(4)));
    let first = cartons[0].world_from_carton;
    assert!((first.translation.vector - Vector::new(1.5, -0.45, 0.269)).norm() < 1e-12);
    let top = cartons[47].world_from_carton;
    assert!((top.translation.vector - Vector::new(1.9, 0.45, 1.519)).norm() < 1e-12);
    assert!(closest_mm(&cartons).abs() < 1e-9, "they touch");
    assert_eq!(cartons[7].mass_kg, 12.0);
}

#[test]
fn a_seed_gives_the_same_stack_and_another_gives_another() {
    let scene = demo(&[]);
    let of = |seed| carton_layout(&scene, RandomStreams::new(seed));
    assert_eq!(of(7), of(7));
    assert_ne!(of(7), of(8));
    assert!(
        of(7)
            .iter()
            .all(|carton| (8.0..=20.0).contains(&carton.mass_kg))
    );
}

#[test]
fn one_key_does_not_move_what_another_draws() {
    let masses = |overrides: &[(&str, &str)]| -> Vec<f64> {
        let cartons = carton_layout(&demo(overrides), RandomStreams::new(5));
        cartons.iter().map(|carton| carton.mass_kg).collect()
    };
    assert_eq!(
        masses(&[]),
        masses(&[("randomize.yaw_deg", "0.1"), ("randomize.gap_mm", "3")])
    );
}

#[test]
fn a_turned_pallet_carries_its_stack_along() {
    let straight = carton_layout(&demo(&[]), RandomStreams::new(2));
    let turned = carton_layout(&demo(&[("pallet.yaw_deg", "30")]), RandomStreams::new(2));
    assert!((closest_mm(&straight) - closest_mm(&turned)).abs() < 1e-6);
    let angle = straight[5]
        .world_from_carton
        .rotation
        .angle_to(&turned[5].world_from_carton.rotation);
    assert!((angle.to_degrees() - 30.0).abs() < 1e-9);
}
