//! The calibration drives the arm from pose to pose.

use super::*;

/// The calibration: state, flange, joints there; the next pose back; the arm drives to each, and to the last.
#[test]
fn calibration_is_driven_to_its_end() {
    let text = golden!("dialogue_d_calibration.txt");
    let all = exchanges(text);
    let rounds: Vec<_> = {
        let mut rounds = Vec::new();
        for (request, answer) in all {
            if answer[..2] != 701u16.to_le_bytes() {
                continue;
            }
            let done = answer[8] == 1;
            rounds.push((request, answer));
            if done {
                break;
            }
        }
        rounds
    };
    assert!(rounds.len() >= 2);
    for version in VERSIONS {
        let main = "MM_Auto_Calib;";
        let text = format!("{}\n{AUTO_CALIB}", version.text);
        let mut machine = loaded(&text, main);
        let mut system = FakeSystem::default();
        arm(&mut system);
        system.peer.replies = rounds
            .iter()
            .map(|(_, answer)| (SimDuration::from_millis(5), answer.clone()))
            .collect();
        let end = run(&mut machine, &mut system);
        assert_eq!(end, Step::Finished, "{} {:?}", version.name, system.trace);
        assert_eq!(system.peer.sent.len(), rounds.len());
        for (sent, (expected, _)) in system.peer.sent.iter().zip(&rounds) {
            // Command and state; the arm of the fake stands still.
            assert_eq!(sent[..8], expected[..8], "{}", version.name);
            assert_eq!(sent.len(), 64);
        }
        // To the start, then to every pose that was given, the last one included.
        assert_eq!(system.moves.len(), rounds.len() + 1, "{}", version.name);
        let last = system.trace.last().map(String::as_str);
        assert!(
            system
                .trace
                .iter()
                .any(|line| line == "MM: calibration finished"),
            "{last:?}"
        );
    }
}

/// A pose that cannot be reached is told with state 2, and the refusal ends the calibration.
#[test]
fn calibration_tells_what_it_cannot_reach() {
    let mut first = exchanges(golden!("dialogue_d_calibration.txt")).remove(0).1;
    // X of the pose: 90 m.
    first[12..16].copy_from_slice(&90_000f32.to_le_bytes());
    let mut refusal = vec![0; 660];
    refusal[..2].copy_from_slice(&701u16.to_le_bytes());
    refusal[4..6].copy_from_slice(&7004u16.to_le_bytes());
    for version in VERSIONS {
        let statements = "MM_Calib 1,1,0;\nERROR\nIF ERRNO=MM_ERR_STATUS TRYNEXT;";
        let mut machine = loaded(version.text, statements);
        let replies =
            [first.clone(), refusal.clone()].map(|reply| (SimDuration::from_millis(5), reply));
        let mut system = FakeSystem {
            peer: Script::new(replies),
            ..FakeSystem::default()
        };
        assert_eq!(
            run(&mut machine, &mut system),
            Step::Finished,
            "{:?}",
            system.trace
        );
        assert_eq!(system.peer.sent.len(), 2);
        assert_eq!(system.peer.sent[1][4], 2, "state 2");
        assert!(system.moves.is_empty());
        assert_eq!(num(&machine, "MM_Last_Status"), 7004.0);
    }
}
