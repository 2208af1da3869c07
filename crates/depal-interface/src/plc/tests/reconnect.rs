//! The connection is lost at every possible place.

use depal_wire::s7::Field;

use super::bench::*;

/// A whole cycle of a controller that waits for nothing for ever: 101, then 102, with the connection lost
/// after `cut` transfers. The command runs once, and in the end the points are there.
fn cycle_with_cut(cut: usize, last_arrives: bool) -> Bench {
    let mut b = Bench::new();
    b.run(ms(100));
    b.set(Field::Project, 1);
    b.call(101);
    assert_eq!(b.run_count(), 1);
    b.cut_after = Some((cut, last_arrives));
    b.set(Field::Command, 102);
    b.trigger(true);
    let mut lost_at = None;
    let mut is_lowered = false;
    for _ in 0..3_000 {
        b.run(ms(1));
        if b.cut_after.is_none() && lost_at.is_none() {
            lost_at = Some(b.now);
        }
        if lost_at.is_some_and(|at| b.now.saturating_since(at) == ms(300)) {
            b.connect();
        }
        if b.is_set(Field::Acknowledge) && !is_lowered {
            b.trigger(false);
            is_lowered = true;
        }
        if b.is_set(Field::PoseSent) && is_lowered && b.cut_after.is_none() && b.handshake.is_up() {
            break;
        }
    }
    b.cut_after = None;
    b.connect();
    b.run(ms(500));
    b
}

#[test]
fn a_connection_lost_anywhere() {
    for cut in 0..20 {
        for last_arrives in [false, true] {
            let b = cycle_with_cut(cut, last_arrives);
            let case = format!("after {cut} transfers, the last arrived: {last_arrives}");
            assert_eq!(b.int(Field::Status), 1100, "{case}");
            assert!(b.is_set(Field::PoseSent), "{case}");
            assert!(!b.is_set(Field::Acknowledge), "{case}");
            assert_eq!(b.int(Field::PoseCount), 2, "{case}");
            assert_eq!(b.block.int(Field::TargetLabel, 1), 2, "{case}");
            assert_eq!(b.run_count(), 1, "{case}");
        }
    }
}

/// Lost between payload and flag: the payload goes out again before the flag does.
#[test]
fn payload_is_rewritten_before_the_flag() {
    let mut b = Bench::new();
    b.set(Field::Project, 1);
    b.call(101);
    b.run(ms(200));
    b.set(Field::Command, 102);
    b.trigger(true);
    b.run_until("Acknowledge", |b| b.is_set(Field::Acknowledge));
    // Poses and labels arrive; Status does not.
    let labels = |b: &Bench| {
        b.seen
            .iter()
            .filter(|s| s.field == Field::TargetLabel)
            .count()
    };
    while labels(&b) == 0 {
        b.cut_after = Some((1, false));
        b.run(ms(1));
        if !b.handshake.is_up() {
            b.connect();
        }
    }
    b.run_until("the points", |b| b.is_set(Field::PoseSent));
    let flag = b
        .seen
        .iter()
        .rposition(|s| s.field == Field::PoseSent)
        .expect("written");
    let order: Vec<_> = b.seen[..=flag].iter().map(|s| s.field).collect();
    assert!(
        order.ends_with(&[
            Field::TargetPose,
            Field::TargetPose,
            Field::TargetPose,
            Field::TargetLabel,
            Field::PoseCount,
            Field::Status,
            Field::PoseSent
        ]),
        "{order:?}"
    );
    assert_eq!(b.run_count(), 1);
}

/// At a fresh start the block decides: Trigger with Acknowledge is an old edge, without it a new one.
#[test]
fn the_block_decides() {
    let mut b = Bench::disconnected();
    b.set(Field::Command, 901);
    b.trigger(true);
    b.block.set_bool(Field::Acknowledge, true);
    b.connect();
    b.run(ms(2_000));
    assert_eq!(b.int(Field::Status), 0, "an old edge");
    b.trigger(false);
    b.run(ms(100));
    assert!(!b.is_set(Field::Acknowledge));
    assert_eq!(b.call(901), 1101);

    let mut b = Bench::disconnected();
    b.set(Field::Command, 901);
    b.trigger(true);
    b.connect();
    b.run(ms(100));
    assert_eq!(b.int(Field::Status), 1101, "a new edge");

    // Acknowledge of a vision server that is gone.
    let mut b = Bench::disconnected();
    b.block.set_bool(Field::Acknowledge, true);
    b.connect();
    b.run(ms(100));
    assert!(!b.is_set(Field::Acknowledge));
}

/// While the controller is away the run goes on, and its result waits.
#[test]
fn a_result_waits_for_the_controller() {
    let mut b = Bench::new();
    b.set(Field::Project, 1);
    b.call(101);
    b.set(Field::Command, 102);
    b.trigger(true);
    b.run_until("Acknowledge", |b| b.is_set(Field::Acknowledge));
    b.handshake.handle_disconnect();
    b.trigger(false);
    b.run(ms(5_000));
    assert_eq!(b.int(Field::Status), 0);
    b.connect();
    b.run(ms(100));
    assert_eq!(b.int(Field::Status), 1100);
    assert!(b.is_set(Field::PoseSent) && !b.is_set(Field::Acknowledge));
    assert_eq!(b.run_count(), 1);
}

/// The heartbeat goes on from what the block holds, at once.
#[test]
fn first_beat_after_a_reconnect() {
    let mut b = Bench::new();
    b.run(ms(2_500));
    b.handshake.handle_disconnect();
    b.block.set_bool(Field::Heartbeat, false);
    let from = b.seen.len();
    b.connect();
    b.run(ms(1));
    assert_eq!(b.seen[from].field, Field::Heartbeat);
    assert_eq!(b.seen[from].bytes, [1]);
}

/// What a block holds after a reconnect is unknown: rows that are not part of the answer are cleared.
#[test]
fn old_rows_of_a_returned_controller_are_cleared() {
    let mut b = Bench::new();
    b.set(Field::Project, 1);
    b.call(101);
    b.call(102);
    b.handshake.handle_disconnect();
    b.block.set_int(Field::TargetLabel, 30, 77);
    b.block.set_real(Field::TargetPose, 39 * 6, 1.0);
    b.connect();
    b.call(101);
    assert_eq!(b.call(102), 1100);
    assert_eq!(b.block.int(Field::TargetLabel, 1), 2);
    assert_eq!(b.block.int(Field::TargetLabel, 30), 0);
    assert_eq!(b.block.real(Field::TargetPose, 39 * 6), 0.0);
}
