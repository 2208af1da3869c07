//! What goes wrong has its code, and the communication test says so.

use super::*;

/// Answers of another byte order, of another command, in pieces, and none.
#[test]
fn trouble_has_its_codes() {
    let good = exchanges(golden!("901_get_state.txt")).remove(0);
    let one = |reply: Vec<u8>| [(good.0.clone(), reply)];
    for version in VERSIONS {
        let state = |reply: Vec<u8>| {
            let (machine, _) = call(version, "MM_Get_Status st;", &one(reply));
            num(&machine, "st")
        };
        let mut swapped = good.1.clone();
        swapped[4..8].reverse();
        assert_eq!(state(swapped), 3096.0);
        let mut other = good.1.clone();
        other[0] = 101;
        assert_eq!(state(other), 3096.0);
        assert_eq!(state(Vec::new()), 3098.0, "nothing came");
        assert_eq!(state(good.1[..600].to_vec()), 3098.0, "too little came");
        assert_eq!(state(good.1.clone()), 1101.0);
    }
    // Refused: an error in 1.x, a status in 2.x.
    let refused = exchanges(golden!("103_switch_recipe.txt"))
        .into_iter()
        .find(|(_, a)| a[4..6] != 1107u16.to_le_bytes());
    let refused = [refused.expect("a refusal")];
    let cell = |index: usize| {
        i32::from_le_bytes(
            refused[0].0[4 * index..4 * index + 4]
                .try_into()
                .expect("four"),
        )
    };
    let code = i32::from_le_bytes(refused[0].1[4..8].try_into().expect("four"));
    let name = format!("MM_Switch_Model {},{}", cell(1), cell(2));
    let (machine, _) = call(VERSIONS[2], &format!("{name},st;"), &refused);
    assert_eq!(num(&machine, "st"), f64::from(code));
    for version in &VERSIONS[..2] {
        let handled = format!("{name};\nERROR\nIF ERRNO=MM_ERR_STATUS TRYNEXT;");
        let (machine, _) = call(*version, &handled, &refused);
        assert_eq!(num(&machine, "MM_Last_Status"), f64::from(code));
    }
}

#[test]
fn the_communication_test_tells_what_is_wrong() {
    let good = exchanges(golden!("901_get_state.txt")).remove(0).1;
    let result = |reply: Option<Vec<u8>>, connects: bool| {
        let main = "MODULE user\nPROC main()\nMM_Com_Test;\nENDPROC\nENDMODULE\n";
        let sources = [
            SourceFile::new("t.mod", COM_TEST),
            SourceFile::new("u.mod", main),
        ];
        let loaded = load(&sources, &[], "main");
        let shown: Vec<_> = loaded
            .diagnostics
            .iter()
            .map(|d| d.plain(&sources))
            .collect();
        assert!(shown.is_empty(), "{}", shown.join("\n"));
        let mut machine = Machine::new(loaded.program.expect("no errors"), "T_ROB1");
        let mut system = FakeSystem::default();
        if !connects {
            system.connect_after = None;
        }
        system.peer.replies = reply
            .into_iter()
            .map(|reply| (SimDuration::from_millis(12), reply))
            .collect();
        assert_eq!(
            run(&mut machine, &mut system),
            Step::Finished,
            "{:?}",
            system.trace
        );
        if connects {
            assert_eq!(system.peer.sent[0].len(), 64);
            assert_eq!(system.peer.sent[0][..4], 901u32.to_le_bytes());
        }
        (num(&machine, "MM_Com_Result"), system.trace)
    };
    let (passed, trace) = result(Some(good.clone()), true);
    assert_eq!(passed, 0.0, "{trace:?}");
    assert!(
        trace
            .iter()
            .any(|line| line == "MM test: passed, status 1101"),
        "{trace:?}"
    );
    assert_eq!(result(None, false).0, 1.0);
    assert_eq!(result(None, true).0, 2.0);
    let mut swapped = good.clone();
    swapped[4..8].reverse();
    assert_eq!(result(Some(swapped), true).0, 4.0);
    let mut busy = good;
    busy[4..6].copy_from_slice(&1007u16.to_le_bytes());
    assert_eq!(result(Some(busy), true).0, 5.0);
}
