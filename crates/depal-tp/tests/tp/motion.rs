//! Moves: where, how fast, in which frame.

use crate::fake_system::*;

fn moves(text: &[&str]) -> Vec<String> {
    let left = lines(text);
    assert_eq!(left.end, "", "{text:?}");
    left.trace
}

#[test]
fn joint_linear_and_circular() {
    assert_eq!(
        moves(&[
            "J P[1] 50% FINE",
            "L P[2:over] 250mm/sec CNT50",
            "C P[1]",
            "L P[2] 600cm/min FINE"
        ])
        .len(),
        4
    );
}
