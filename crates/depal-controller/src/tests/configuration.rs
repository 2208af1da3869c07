use crate::{
    ConfigurationError, EioConfiguration, SioConfiguration, SysConfiguration, configuration_domain,
};

use super::*;

/// In the form of a backup: head, other sections, continued entries, flags, comments between.
const EIO: &str = r#"EIO:CFG_1.0:6:1::

#
SYSSIG_OUT:

      -Status "AutoOn" -Signal "do_auto"
#
EIO_SIGNAL:

      -Name "do_auto" -SignalType "DO"
      -Name "di_part" -SignalType "DI" -Device "board1"\
      -Label "Part there" -DeviceMap "0" -Category "cell"\
      -Access "ReadOnly"
      -Name "go_zone" -SignalType "GO" -DeviceMap "0-3,8" -Default 5
      -Name "gi_free" -SignalType "GI"
      -Name "ao_flow" -SignalType "AO" -MaxLog 10 -Default -2.5
      -Name "ai_flow" -SignalType "ai"
      -Name "do_both" -SignalType "DO"
#
EIO_CROSS:

      -Name "c1" -Res "do_both" -Act1 "di_part" -Act1_invert -Oper1 "OR"\
      -Act2 "do_auto" -Oper2 "AND" -Act3 "di_part"
"#;

fn errors(text: &str) -> Vec<String> {
    let read = EioConfiguration::parse(text);
    let errors = read.expect_err("mistakes");
    errors.iter().map(ToString::to_string).collect()
}

#[test]
fn signals_of_all_kinds_are_read() {
    let read = EioConfiguration::parse(EIO).unwrap();
    let found: Vec<_> = read
        .signals
        .iter()
        .map(|s| (s.name.as_str(), s.kind, s.initial))
        .collect();
    assert_eq!(
        found,
        [
            ("do_auto", SignalKind::DigitalOutput, 0.0),
            ("di_part", SignalKind::DigitalInput, 0.0),
            ("go_zone", SignalKind::GroupOutput { bits: 5 }, 5.0),
            ("gi_free", SignalKind::GroupInput { bits: 23 }, 0.0),
            ("ao_flow", SignalKind::AnalogOutput, -2.5),
            ("ai_flow", SignalKind::AnalogInput, 0.0),
            ("do_both", SignalKind::DigitalOutput, 0.0),
        ]
    );
}

/// (not di_part or do_auto) and di_part, from left to right.
#[test]
fn cross_connections_are_read_and_followed() {
    let read = EioConfiguration::parse(EIO).unwrap();
    assert_eq!(read.connections.len(), 1);
    assert_eq!(read.connections[0].any, [true, false]);
    let expected = [("di_part", true), ("do_auto", false), ("di_part", false)];
    let expected = expected.map(|(name, inverted)| (name.to_owned(), inverted));
    assert_eq!(read.connections[0].actors, expected);
    let mut spec = spec();
    spec.signals = read.signals;
    spec.connections = read.connections;
    let script = Script::new().set("do_auto", 1.0);
    let mut controller = Controller::new(spec).unwrap();
    controller.set_task(Box::new(script));
    run(&mut controller, &mut NoNetwork, 2);
    assert_eq!(controller.signal("do_both"), Ok(0.0));
    controller.set_input("di_part", 1.0).unwrap();
    assert_eq!(controller.signal("DO_BOTH"), Ok(1.0));
    controller.set_input("di_part", 0.0).unwrap();
    assert_eq!(controller.signal("do_both"), Ok(0.0));
}

#[test]
fn mistakes_are_told_all_at_once_with_their_lines() {
    let text = "EIO:CFG_1.0:6:1::\n#\nEIO_SIGNAL:\n\n -Name \"a\" -SignalType \"DX\"\n -SignalType \"DI\"\n -Name \"b\" -SignalType \"GO\" -DeviceMap \"0-x\"\n -Name \"c\" -SignalType \"GO\" -DeviceMap \"0-40\"\n -Name \"d\" -SignalType \"DO\" -Default \"on\"\n -Name \"E\" -SignalType \"DO\"\n -Name \"e\" -SignalType \"DI\"\n#\nEIO_CROSS:\n -Res \"E\" -Act1 \"nothing\"\n -Res \"E\" -Act1 \"E\" -Oper1 \"XOR\" -Act2 \"E\"\n";
    assert_eq!(
        errors(text),
        [
            "line 5: signal a: -SignalType is DX, expected DI, DO, GI, GO, AI or AO",
            "line 6: the EIO_SIGNAL entry has no -Name",
            "line 7: signal b: -DeviceMap is \"0-x\", expected bits such as 0-3,5",
            "line 8: signal c has 41 bits, expected 1 to 32",
            "line 9: signal d: -Default is \"on\", expected a number",
            "line 11: signal e is defined already in line 10",
            "line 14: the cross connection to E names the signal nothing, which is not defined",
            "line 15: -Oper1 is XOR, expected AND or OR",
        ]
    );
    assert_eq!(
        errors("SYS:CFG_1.0:6:0::\n#\n"),
        ["line 1: this is a configuration of SYS, expected EIO"]
    );
}

#[test]
fn the_domain_stands_in_the_head() {
    assert_eq!(configuration_domain(EIO).as_deref(), Some("EIO"));
    assert_eq!(
        configuration_domain("\n moc:CFG_1.0:6:0::").as_deref(),
        Some("MOC")
    );
    assert_eq!(configuration_domain("MODULE m"), None);
    assert_eq!(configuration_domain(""), None);
}

const SYS: &str = r#"SYS:CFG_1.0:6:0::
#
CAB_TASKS:

      -Name "T_ROB1" -Type "NORMAL" -MotionTask
      -Name "T_WATCH" -Entry "watch"
#
CAB_TASK_MODULES:

      -File "RELEASE:/options/base.sys" -Hidden
      -File "HOME:/user.sys" -Task "T_ROB1"
#
CAB_EXEC_HOOKS:

      -Routine "second" -Shelf "START" -OrderNo 20
      -Routine "first" -Shelf "START" -Task "T_ROB1" -OrderNo 10
      -Routine "lights" -Shelf "POWER_ON" -Task "T_WATCH"
#
SYS_MISC:

      -Name "NoOfRetry" -Value "7"
      -Name "PowerFailRestart" -Value "NO"
"#;

#[test]
fn tasks_and_event_routines_are_read() {
    let read = SysConfiguration::parse(SYS).unwrap();
    let tasks: Vec<_> = read
        .tasks
        .iter()
        .map(|t| {
            (
                t.name.as_str(),
                t.entry.as_str(),
                t.moves_robot,
                t.is_background,
            )
        })
        .collect();
    assert_eq!(
        tasks,
        [
            ("T_ROB1", "main", true, false),
            ("T_WATCH", "watch", false, true)
        ]
    );
    assert_eq!(read.motion_task().map(|t| t.name.as_str()), Some("T_ROB1"));
    assert_eq!(read.modules.len(), 2);
    assert_eq!(read.modules[1].task, "T_ROB1");
    let names = |event, task| -> Vec<_> {
        let routines = read.routines(event, task).into_iter();
        routines.map(|event| event.routine.as_str()).collect()
    };
    assert_eq!(names("start", "T_ROB1"), ["first", "second"]);
    assert_eq!(names("START", "t_watch"), ["second"]);
    assert_eq!(names("POWER_ON", "T_WATCH"), ["lights"]);
    assert_eq!(read.retry_limit, Some(7));
    let wrong = "SYS:CFG_1.0:6:0::\n#\nCAB_TASKS:\n -Name \"a\" -Type \"FAST\"\n -Type \"NORMAL\"\n#\nCAB_EXEC_HOOKS:\n -Routine \"r\" -Shelf \"NOON\"\n";
    let errors: Vec<ConfigurationError> = SysConfiguration::parse(wrong).unwrap_err();
    let lines: Vec<_> = errors.iter().map(|e| e.line).collect();
    assert_eq!(lines, [4, 5, 8]);
}

#[test]
fn channels_are_read() {
    let text = "SIO:CFG_1.0:6:0::\n#\nCOM_PHY_CHANNEL:\n\n -Name \"LAN1\" -Connector \"LAN1\"\n#\nCOM_TRP:\n\n -Name \"TCPIP1\" -Type \"TCP/IP\" -RemoteAdress \"10.0.0.5\"\n -Type \"x\"\n";
    let errors = SioConfiguration::parse(text).unwrap_err();
    assert_eq!(errors.len(), 1);
    assert_eq!(errors[0].line, 10);
    let good = text.replace(" -Type \"x\"\n", "");
    let read = SioConfiguration::parse(&good).unwrap();
    assert_eq!(read.channels.len(), 2);
    assert_eq!(read.remotes, [("TCPIP1".to_owned(), "10.0.0.5".to_owned())]);
}
