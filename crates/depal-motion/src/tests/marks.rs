use super::*;
use crate::{Along, Mark, MarkTime};

fn time(t: &Trajectory, mark: &Mark) -> f64 {
    match t.mark_time(mark) {
        MarkTime::At(time) => time,
        MarkTime::Passed => panic!("not passed yet"),
    }
}

fn tcp(t: &Trajectory, time: f64) -> depal_frames::Vector {
    (t.arm().base_from_flange(&t.sample(time)) * tool())
        .translation
        .vector
}

#[test]
fn a_place_is_passed_where_it_is() {
    let arm = arm();
    let mut t = Trajectory::new(Arc::clone(&arm), home());
    let to = home_tcp(&arm, 0.4, 0.0, 0.0);
    t.append(0.0, &linear_move(to, 1.0, Zone::Fine)).unwrap();
    for distance in [0.0, 0.001, 0.05, 0.15, 0.399] {
        let before_end = time(&t, &t.mark_last(Along::BeforeEnd(distance)));
        let left = (tcp(&t, before_end) - to.translation.vector).norm();
        assert!((left - distance).abs() < 2e-4, "{left} for {distance}");
        let after_start = time(&t, &t.mark_last(Along::AfterStart(distance)));
        let gone = (tcp(&t, after_start) - tcp(&t, 0.0)).norm();
        assert!((gone - distance).abs() < 2e-4, "{gone} for {distance}");
    }
    // Farther than the move is long: at its start, or its end.
    assert_eq!(time(&t, &t.mark_last(Along::BeforeEnd(9.0))), 0.0);
    assert_eq!(time(&t, &t.mark_last(Along::AfterStart(9.0))), t.duration());
}

/// The end of a fly-by move is the middle of its corner, and places on both sides keep their order.
#[test]
fn places_go_through_a_corner_in_order() {
    let arm = arm();
    let mut t = Trajectory::new(Arc::clone(&arm), home());
    t.append(
        0.0,
        &linear_move(home_tcp(&arm, 0.4, 0.0, 0.0), 1.0, fly(0.1)),
    )
    .unwrap();
    let ends: Vec<Mark> = [0.3, 0.2, 0.12, 0.08, 0.04, 0.0]
        .map(|d| t.mark_last(Along::BeforeEnd(d)))
        .into();
    t.append(
        0.0,
        &linear_move(home_tcp(&arm, 0.4, 0.4, 0.0), 1.0, Zone::Fine),
    )
    .unwrap();
    let starts: Vec<Mark> = [0.0, 0.04, 0.08, 0.12, 0.2, 0.5]
        .map(|d| t.mark_last(Along::AfterStart(d)))
        .into();
    let times: Vec<f64> = ends.iter().chain(&starts).map(|m| time(&t, m)).collect();
    assert!(
        times.windows(2).all(|w| w[1] >= w[0] - 1e-9),
        "in order: {times:?}"
    );
    assert!((times[5] - times[6]).abs() < 1e-6, "the middle is both");
    let corner = home_tcp(&arm, 0.4, 0.0, 0.0).translation.vector;
    let cut = (tcp(&t, times[5]) - corner).norm();
    assert!((0.01..0.07).contains(&cut), "the corner is cut by {cut}");
    assert!((times[11] - t.duration()).abs() < 1e-9);
    // Outside of the corner nothing changed by the second move.
    let left = (tcp(&t, times[1]) - corner).norm();
    assert!((left - 0.2).abs() < 2e-4);
    // A place that is held behind never comes, until the path is resumed.
    t.hold(0.05);
    assert_eq!(t.mark_time(&ends[5]), MarkTime::At(f64::INFINITY));
    t.resume(3.0);
    assert!(time(&t, &ends[5]) > 3.0);
    t.forget_before(60.0);
    assert_eq!(t.mark_time(&ends[5]), MarkTime::Passed);
}
