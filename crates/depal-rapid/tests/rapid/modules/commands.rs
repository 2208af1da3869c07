//! Commands without data, messages, custom data, and those that open a connection of their own.

use super::*;

#[test]
fn commands_without_data() {
    let start = golden!("101_start_vision.txt");
    plain(start, 0, "MM_Start_Vis 1,0,0,jGolden", 1102.0);
    plain(start, 1, "MM_Start_Vis 1,0,1,jGolden", 1102.0);
    plain(start, 2, "MM_Start_Vis 1,0,2,jGolden", 1102.0);
    plain(start, 3, "MM_Start_Vis 1,5,3,jGolden", 1102.0);
    plain(
        golden!("103_switch_recipe.txt"),
        0,
        "MM_Switch_Model 1,2",
        1107.0,
    );
    let of = |text: &str, status: u16| {
        let found = exchanges(text)
            .into_iter()
            .position(|(_, answer)| answer[4..6] == status.to_le_bytes());
        found.expect("a success in the transcript")
    };
    let at = |text: &str, status: u16| {
        exchanges(text)
            .into_iter()
            .nth(of(text, status))
            .expect("just found")
            .0
    };
    let cell = |frame: &[u8], index: usize| {
        i32::from_le_bytes(
            frame[4 * index..4 * index + 4]
                .try_into()
                .expect("four bytes"),
        )
    };
    let real = |frame: &[u8], index: usize| {
        f32::from_le_bytes(
            frame[4 * index..4 * index + 4]
                .try_into()
                .expect("four bytes"),
        )
    };
    for (text, status, name, ints) in [
        (golden!("203_set_branch.txt"), 2105, "MM_Set_Branch", 2),
        (golden!("204_set_index.txt"), 2106, "MM_Set_Index", 2),
    ] {
        let frame = at(text, status);
        let arguments: Vec<_> = (1..=ints).map(|i| cell(&frame, i).to_string()).collect();
        plain(
            text,
            of(text, status),
            &format!("{name} {}", arguments.join(",")),
            f64::from(status),
        );
    }
    let boxes = golden!("501_set_box_size.txt");
    let frame = at(boxes, 1108);
    let call = format!(
        "MM_Set_BoxSize {},{},{},{}",
        cell(&frame, 1),
        real(&frame, 2),
        real(&frame, 3),
        real(&frame, 4)
    );
    plain(boxes, of(boxes, 1108), &call, 1108.0);
    let viz = golden!("201_start_viz.txt");
    for (index, (frame, answer)) in exchanges(viz).iter().enumerate() {
        if answer[4..6] == 2103u16.to_le_bytes() {
            plain(
                viz,
                index,
                &format!("MM_Start_Viz {},jGolden", cell(frame, 1)),
                2103.0,
            );
        }
    }
    for version in VERSIONS {
        for (text, status, name) in [
            (golden!("202_stop_viz.txt"), 2104, "MM_Stop_Viz st;"),
            (golden!("901_get_state.txt"), 1101, "MM_Get_Status st;"),
        ] {
            let at = of(text, status);
            let (machine, _) = call_one(version, name, text, at);
            assert_eq!(num(&machine, "st"), f64::from(status));
        }
        let text = golden!("208_write_parameter.txt");
        let index = of(text, 2108);
        let id = cell(&exchanges(text)[index].0, 1);
        let (machine, _) = call_one(version, &format!("MM_Set_Property {id},st;"), text, index);
        assert_eq!(num(&machine, "st"), 2108.0);
        let text = golden!("207_read_parameter.txt");
        let index = of(text, 2109);
        let (request, answer) = &exchanges(text)[index];
        let (machine, _) = call_one(
            version,
            &format!("MM_Get_Property {},st,v;", cell(request, 1)),
            text,
            index,
        );
        assert_eq!(num(&machine, "v"), f64::from(real(answer, 2)));
    }
}

#[test]
fn messages_and_custom_data() {
    let text = golden!("601_get_notify.txt");
    let found = exchanges(text)
        .into_iter()
        .find(|(request, answer)| request[..2] == 601u16.to_le_bytes() && answer[4] != 0);
    let notify = [found.expect("a message")];
    let message = i32::from_le_bytes(notify[0].1[4..8].try_into().expect("four"));
    for version in VERSIONS {
        let (machine, _) = call(version, &call_of(version, "MM_Get_Notify v"), &notify);
        assert_eq!(num(&machine, "v"), f64::from(message));
    }
    let text = golden!("110_get_custom_data.txt");
    let mut parts = Vec::new();
    for (request, answer) in exchanges(text) {
        if answer[4..6] == 1100u16.to_le_bytes() {
            let last = answer[8] == 1;
            parts.push((request, answer));
            if last {
                break;
            }
        }
    }
    let cell = |frame: &[u8], index: usize| {
        i32::from_le_bytes(frame[4 * index..4 * index + 4].try_into().expect("four"))
    };
    let job = cell(&parts[0].0, 1);
    let (_, last) = parts.last().expect("a part");
    let elements = cell(last, 3) as usize;
    let first = f32::from_le_bytes(last[4 * 11..4 * 12].try_into().expect("four"));
    assert!(elements > 0);
    for version in VERSIONS {
        let statements = format!("MM_Get_DyData {job},n,st;\nMM_Get_DyPose n,p,a;");
        let (machine, _) = call(version, &statements, &parts);
        assert_eq!(num(&machine, "n"), parts.len() as f64);
        let Value::Array(data) = global(&machine, "MM_UserData") else {
            panic!("an array");
        };
        assert_eq!(
            data[0].as_number(),
            Some(f64::from(first)),
            "{}",
            version.name
        );
        assert_eq!(data[elements].as_number(), Some(0.0), "the rest is cleared");
    }
}

/// Both one-shot commands: what they send holds the arm, what they get is stored.
#[test]
fn one_shot_commands() {
    for (text, code) in [
        (golden!("100_run_vision.txt"), 100u8),
        (golden!("200_run_viz.txt"), 200),
    ] {
        let success = if code == 100 { 1100u16 } else { 2100 };
        let found = exchanges(text)
            .into_iter()
            .find(|(request, answer)| request[0] == code && answer[4..6] == success.to_le_bytes());
        let one = [found.expect("a success")];
        let cell = |index: usize| {
            i32::from_le_bytes(one[0].0[4 * index..4 * index + 4].try_into().expect("four"))
        };
        let name = if code == 100 {
            "MM_Lite_Vis"
        } else {
            "MM_Lite_Viz"
        };
        let statements = format!(
            "{name} {},{},{},st,\\Pos_Num:=n,\\VisPos_Num:=v;",
            cell(1),
            cell(2),
            cell(3)
        );
        let count = i32::from_le_bytes(one[0].1[12..16].try_into().expect("four"));
        for version in VERSIONS {
            // The transcript's arm stands elsewhere: only the head is compared.
            let mut machine = loaded(
                version.text,
                &format!(
                    "{}\n{statements}",
                    match (version.each, version.status) {
                        (true, _) => "",
                        (_, true) => "MM_Open_Socket st;",
                        _ => "MM_Open_Socket;",
                    }
                ),
            );
            let mut system = FakeSystem::default();
            arm(&mut system);
            system
                .peer
                .replies
                .push_back((SimDuration::from_millis(5), one[0].1.clone()));
            assert_eq!(
                run(&mut machine, &mut system),
                Step::Finished,
                "{:?}",
                system.trace
            );
            assert_eq!(
                system.peer.sent[0][..16],
                one[0].0[..16],
                "{}",
                version.name
            );
            same(&system.peer.sent[0][16..40], &joints_cells(), version.name);
            assert_eq!(num(&machine, "st"), f64::from(success));
            if cell(3) != 2 || code == 200 {
                assert_eq!(num(&machine, "n"), f64::from(count));
            }
        }
    }
}

fn joints_cells() -> Vec<u8> {
    [0.0f32, -20.0, 10.0, 0.0, 60.0, 0.0]
        .iter()
        .flat_map(|v| v.to_le_bytes())
        .collect()
}
