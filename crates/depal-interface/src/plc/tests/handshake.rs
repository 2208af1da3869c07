//! Trigger, Acknowledge, heartbeat, and the order of writes.

use depal_wire::s7::Field;

use super::bench::*;

#[test]
fn one_execution_for_one_edge() {
    let mut b = Bench::new();
    b.set(Field::Project, 1);
    b.set(Field::Command, 101);
    b.trigger(true);
    b.run(ms(5_000));
    assert_eq!(b.int(Field::Status), 1102);
    assert!(
        b.is_set(Field::Acknowledge),
        "Acknowledge stays until Trigger falls"
    );
    assert_eq!(b.run_count(), 1);
    // Another command without an edge is none.
    b.set(Field::Command, 102);
    b.run(ms(1_000));
    assert_eq!((b.int(Field::Status), b.run_count()), (1102, 1));
    b.trigger(false);
    let fell = b.run_until("Acknowledge falls", |b| !b.is_set(Field::Acknowledge));
    assert!(fell <= ms(22), "{fell:?}");
    assert_eq!(
        b.int(Field::Status),
        1102,
        "Status stays until the next edge"
    );
    b.trigger(true);
    b.run_until("the points", |b| b.is_set(Field::PoseSent));
    assert_eq!(b.int(Field::Status), 1100);
}

/// Acknowledge comes at once, and falls with Trigger although the result is not there yet.
#[test]
fn acknowledge_does_not_wait_for_the_result() {
    let mut b = Bench::new();
    b.results.latency = ms(1_500);
    b.set(Field::Project, 1);
    b.call(101);
    b.set(Field::Command, 102);
    b.trigger(true);
    let raised = b.run_until("Acknowledge", |b| b.is_set(Field::Acknowledge));
    assert!(raised <= ms(22), "{raised:?}");
    b.trigger(false);
    let fell = b.run_until("Acknowledge falls", |b| !b.is_set(Field::Acknowledge));
    assert!(fell <= ms(22), "{fell:?}");
    assert_eq!(b.int(Field::Status), 0);
    b.run_until("the result", |b| b.is_set(Field::PoseSent));
    assert_eq!(b.int(Field::Status), 1100);
}

/// A controller that does not wait for its result: each edge is executed, one after another.
#[test]
fn an_early_edge_waits_for_the_result_before_it() {
    let mut b = Bench::new();
    b.results.latency = ms(1_500);
    b.set(Field::Project, 1);
    b.call(101);
    b.set(Field::Command, 102);
    b.trigger(true);
    b.run_until("Acknowledge", |b| b.is_set(Field::Acknowledge));
    b.trigger(false);
    b.run_until("Acknowledge falls", |b| !b.is_set(Field::Acknowledge));
    b.set(Field::Command, 901);
    b.trigger(true);
    b.run(ms(500));
    assert!(
        !b.is_set(Field::Acknowledge),
        "102 still waits for its points"
    );
    let from = b.seen.len();
    b.run_until("901", |b| b.int(Field::Status) == 1101);
    use Field::*;
    assert_eq!(
        b.order_since(from),
        [
            TargetPose,
            TargetLabel,
            PoseCount,
            Status,
            PoseSent,
            Status,
            Acknowledge,
            Status
        ]
    );
}

#[test]
fn flags_are_cleared_at_the_edge_and_rise_last() {
    let mut b = Bench::new();
    b.call(201);
    b.set(Field::PoseType, 3);
    assert_eq!(b.call(210), 2100);
    let from = b.seen.len();
    b.set(Field::PoseType, 0);
    b.call(201);
    assert!(
        !b.is_set(Field::PoseSent),
        "cleared though the controller did not"
    );
    b.set(Field::PoseType, 3);
    b.call(210);
    use Field::*;
    let clear = [Status, Acknowledge];
    let mut expected = clear.to_vec();
    // Trigger falls meanwhile: 201 is answered before the controller sees Acknowledge.
    expected.extend([Status, Acknowledge]);
    expected.extend(clear);
    expected.extend([Acknowledge]);
    expected.extend([
        TargetPose,
        TargetLabel,
        TargetTool,
        CustomOutput,
        IsVisionMove,
        MoveType,
        Speed,
        PlanResult,
        PoseCount,
        Status,
        PoseSent,
    ]);
    expected.dedup();
    assert_eq!(b.order_since(from), expected);
    let flags = b.seen.iter().filter(|seen| seen.field == PoseSent);
    assert!(flags.clone().all(|seen| seen.bytes == [1]) && flags.count() == 2);
}

/// Trigger that comes and goes within a poll is not seen; one that goes before it is read is none.
#[test]
fn flicker() {
    let mut b = Bench::new();
    b.run(ms(50));
    b.set(Field::Command, 901);
    for _ in 0..10 {
        b.trigger(true);
        b.trigger(false);
        b.run(ms(20));
    }
    assert_eq!(b.order_since(0), []);
    // 1-0-1 while Acknowledge is 1, within a poll: the same edge.
    b.set(Field::Project, 1);
    b.set(Field::Command, 101);
    b.trigger(true);
    b.run(ms(200));
    assert_eq!(b.run_count(), 1);
    b.trigger(false);
    b.trigger(true);
    b.run(ms(200));
    assert_eq!(b.run_count(), 1);
}

#[test]
fn heartbeat() {
    let mut b = Bench::new();
    b.results.latency = ms(1_900);
    b.set(Field::Project, 1);
    b.call(101);
    b.call(102);
    b.set(Field::PoseType, 3);
    b.call(201);
    b.call(210);
    b.run(ms(10_000));
    let beats: Vec<_> = b
        .seen
        .iter()
        .filter(|seen| seen.field == Field::Heartbeat)
        .collect();
    assert!(beats.len() > 12, "{}", beats.len());
    for (place, beat) in beats.iter().enumerate() {
        assert_eq!(beat.bytes, [u8::from(place % 2 == 0)]);
        // A beat a second from the first on, whatever else goes on.
        let since_first = beat.at.saturating_since(beats[0].at);
        assert_eq!(since_first, ms(1_000 * place as u64));
    }
}

/// The controller forgets to take Trigger back: people are told once, and nothing runs.
#[test]
fn stuck_trigger() {
    let mut b = Bench::new();
    b.set(Field::Command, 901);
    b.trigger(true);
    b.run(ms(9_900));
    assert_eq!(b.notices.len(), 0);
    b.run(ms(20_000));
    assert_eq!(b.notices.len(), 1);
    assert!(
        b.notices[0].starts_with("Command Trigger is still 1"),
        "{:?}",
        b.notices
    );
    b.trigger(false);
    b.run_until("Acknowledge falls", |b| !b.is_set(Field::Acknowledge));
    assert_eq!(b.call(901), 1101);
}

/// Nothing is written without an edge: data that the controller has not read stay, and a flag that it has
/// reset stays reset.
#[test]
fn unread_data_stay() {
    let mut b = Bench::new();
    b.set(Field::Project, 1);
    b.call(101);
    b.call(102);
    let (from, block) = (b.seen.len(), b.block.clone());
    b.run(ms(30_000));
    assert_eq!(b.order_since(from), []);
    b.block
        .set_bool(Field::Heartbeat, block.bool(Field::Heartbeat));
    assert_eq!(b.block, block);
    b.block.set_bool(Field::PoseSent, false);
    b.set(Field::Notify, 0);
    b.run(ms(3_000));
    assert_eq!(b.order_since(from), []);
    assert!(!b.is_set(Field::PoseSent));
}
