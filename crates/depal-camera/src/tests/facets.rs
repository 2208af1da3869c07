//! Triangles drawn in pairs.

use depal_frames::Point;

use crate::facets::facets;

/// Two triangles over a square of 0.1 m: the fourth corner lies at `corner`.
fn pair(corner: [f64; 3]) -> (Vec<Point>, [[u32; 3]; 2]) {
    let at = |[x, y, z]: [f64; 3]| Point::new(x, y, z);
    let corners = [[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.1, 0.1, 0.0], corner];
    (corners.map(at).to_vec(), [[0, 1, 2], [0, 2, 3]])
}

#[test]
fn a_flat_convex_pair_is_one_facet_and_any_other_stays_two() {
    let count = |corner| {
        let (vertices, triangles) = pair(corner);
        facets(&vertices, &triangles).len()
    };
    assert_eq!(count([0.0, 0.1, 0.0]), 1);
    // A fold of a hundredth of a millimetre is one.
    assert_eq!(count([0.0, 0.1, 1e-5]), 2);
    assert_eq!(count([0.04, 0.05, 0.0]), 1);
    // A notch at the first corner.
    assert_eq!(count([-0.1, -0.05, 0.0]), 2);
    // Nothing is left of the second triangle.
    assert_eq!(count([0.05, 0.05, 0.0]), 2);
}

#[test]
fn a_facet_has_the_corners_of_both_triangles_the_same_way_round() {
    let (vertices, triangles) = pair([0.0, 0.1, 0.0]);
    let quad = facets(&vertices, &triangles)[0];
    let first = quad.iter().position(|k| *k == 0).expect("the corner 0");
    let turned: Vec<u32> = (0..4).map(|k| quad[(first + k) % 4]).collect();
    assert_eq!(turned, [0, 1, 2, 3]);
    // Alone it names its last corner twice.
    assert_eq!(facets(&vertices, &triangles[..1]), [[0, 1, 2, 2]]);
}
