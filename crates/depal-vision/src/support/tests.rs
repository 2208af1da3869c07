use depal_frames::{BoxSize, Pose};

use super::{Measured, Standing, believed, is_made_up, sizes_of};
use crate::DetectedBox;

fn top([length, width]: [f64; 2], standing: Standing) -> Measured {
    Measured {
        found: DetectedBox {
            camera_from_box: Pose::identity(),
            size: BoxSize {
                length,
                width,
                height: 0.0,
            },
            label: 0,
            confidence: 1.0,
            visible_fraction: 1.0,
            proven_sides: 4,
        },
        standing,
        blind: [false; 4],
    }
}

/// How many of these are believed.
fn count(tops: &[([f64; 2], Standing)]) -> usize {
    let measured = tops.iter().map(|&(sides, s)| top(sides, s)).collect();
    let judged = believed(measured);
    assert_eq!(judged.len(), tops.len());
    judged.iter().filter(|top| top.is_ok()).count()
}

#[test]
fn rows_and_rows_of_rows_add_up() {
    let small = [[0.3, 0.2]];
    for made_up in [[0.4, 0.3], [0.6, 0.2], [0.6, 0.4], [0.601, 0.4], [0.8, 0.3]] {
        assert!(is_made_up(&made_up, &small), "{made_up:?}");
    }
    // 500 x 300: one lying beside one standing.
    for other in [
        [0.4, 0.35],
        [0.45, 0.3],
        [0.62, 0.4],
        [0.38, 0.285],
        [0.35, 0.2],
    ] {
        assert!(!is_made_up(&other, &small), "{other:?}");
    }
    assert!(is_made_up(&[0.5, 0.3], &[[0.3, 0.3], [0.3, 0.2]]));
}

#[test]
fn what_smaller_ones_make_up_must_be_seen_twice() {
    use Standing::Certain;
    let small = ([0.3, 0.2], Certain);
    assert_eq!(count(&[small, ([0.4, 0.3], Certain)]), 1);
    assert_eq!(
        count(&[small, ([0.4, 0.3], Certain), ([0.4005, 0.2995], Certain)]),
        3
    );
    // Nothing here makes up the larger one.
    assert_eq!(count(&[small, ([0.45, 0.3], Certain)]), 2);
    assert_eq!(count(&[([0.4, 0.3], Certain)]), 1);
}

#[test]
fn sizes_that_are_parted_as_often_as_not_are_not_believed() {
    use Standing::{Certain, Parted};
    let pair = |standing| ([0.6, 0.2], standing);
    assert_eq!(count(&[pair(Certain), pair(Parted)]), 0);
    assert_eq!(count(&[pair(Certain), pair(Certain), pair(Parted)]), 2);
}

#[test]
fn one_in_question_needs_a_certain_one() {
    use Standing::{Certain, InQuestion};
    assert_eq!(
        count(&[([0.3, 0.2], InQuestion), ([0.3, 0.2], InQuestion)]),
        0
    );
    assert_eq!(count(&[([0.3, 0.2], InQuestion), ([0.3, 0.2], Certain)]), 2);
    // Two of the certain ones look like it where their gap does not show.
    assert_eq!(count(&[([0.6, 0.2], InQuestion), ([0.3, 0.2], Certain)]), 1);
}

#[test]
fn each_of_a_size_makes_the_others_more_sure() {
    let confidence = |n: usize| {
        let tops = (0..n).map(|_| top([0.3, 0.2], Standing::Certain)).collect();
        let judged = believed(tops);
        judged[0].as_ref().expect("believed").confidence
    };
    assert!((confidence(1) - 0.75).abs() < 1e-12);
    assert!(confidence(2) > confidence(1) && confidence(8) > 0.99);
}

#[test]
fn sizes_are_means_of_those_that_are_alike() {
    use Standing::Certain;
    let all = [[0.3, 0.2], [0.302, 0.2], [0.35, 0.3], [0.4, 0.3]];
    let tops = all.map(|sides| top(sides, Certain).found);
    let sizes = sizes_of(&tops);
    let of: Vec<(f64, usize)> = sizes.iter().map(|(s, n)| (s.length, *n)).collect();
    // Two of the smallest are as large as the largest.
    assert_eq!(of, [(0.301, 2), (0.35, 1)]);
}

#[test]
fn a_side_that_is_not_seen_is_where_others_of_the_size_have_it() {
    use Standing::{Certain, InQuestion};
    let mut short = top([0.298, 0.2], InQuestion);
    short.blind[1] = true;
    let judged = believed(vec![short, top([0.3, 0.2], Certain)]);
    let one = judged[0].as_ref().expect("believed");
    assert!((one.size.length - 0.3).abs() < 1e-12 && (one.size.width - 0.2).abs() < 1e-12);
    // The side that is seen stays where it is.
    let middle = one.camera_from_box.translation.vector;
    assert!((middle.x - 0.001).abs() < 1e-12 && middle.y.abs() < 1e-12);
}
