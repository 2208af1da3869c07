//! Points, paths and outputs are fetched, stored and given out.

use super::*;

/// A waypoint of the Viz transcripts: the second one, 210 in all its formats and 205.
#[test]
fn paths_are_fetched_and_stored() {
    let text = golden!("210_get_plan_data.txt");
    let all = exchanges(text);
    for format in 1..=4u8 {
        let rounds: Vec<_> = all
            .iter()
            .filter(|(request, answer)| {
                request[0] == 210 && request[4] == format && answer[4..6] == 2100u16.to_le_bytes()
            })
            .take(3)
            .cloned()
            .collect();
        assert_eq!(rounds.len(), 3, "format {format}");
        for version in VERSIONS {
            let store = if format % 2 == 1 {
                "MM_Get_PlanJps 2,1,j,a,b,c;"
            } else {
                "MM_Get_PlanPose 2,2,p,a,b,c;"
            };
            let statements = format!("MM_get_plandata 0,{format},n,v,st;\n{store}");
            let (machine, _) = call(version, &statements, &rounds);
            let found = ["n", "v", "st", "a", "b", "c"].map(|name| num(&machine, name));
            assert_eq!(
                found,
                [3.0, 2.0, 2100.0, 2.0, 1.0, 40.0],
                "{} {format}",
                version.name
            );
            let target = if format % 2 == 1 { "j" } else { "p" };
            let Value::Record(fields) = global(&machine, target) else {
                panic!("a record");
            };
            let Value::Record(first) = &fields[0] else {
                panic!("robax or trans");
            };
            let expected = if format % 2 == 1 { 1.5 } else { 600.0 };
            assert_eq!(first[0].as_number(), Some(expected));
            if format > 2 {
                let Value::Array(plan) = global(&machine, "MM_Plan_Results") else {
                    panic!("an array");
                };
                let plan: Vec<_> = plan.iter().filter_map(Value::as_number).collect();
                assert_eq!(plan[..2], [3.0, 3.0]);
                assert_eq!(plan[18..], [600.0, 400.0, 200.0]);
            }
        }
    }
    let text = golden!("dialogue_f_heads.txt");
    let path = exchanges(text)
        .into_iter()
        .find(|(r, a)| r[0] == 205 && a[4..6] == 2100u16.to_le_bytes());
    let path = [path.expect("a path")];
    for version in VERSIONS {
        let statements = "MM_Get_VizData 1,n,v,st;\nMM_Get_Jps 2,j,a,b;";
        let (machine, _) = call(version, statements, &path);
        let found = ["n", "v", "st", "a", "b"].map(|name| num(&machine, name));
        assert_eq!(found, [3.0, 2.0, 2100.0, 3.0, 40.0], "{}", version.name);
    }
}

/// Points in several parts are joined; labels and the place of the Vision Move count over all.
#[test]
fn points_are_fetched_and_stored() {
    for (text, code, status, statement) in [
        (
            golden!("102_get_vision_points.txt"),
            102u8,
            1100u16,
            "MM_Get_VisData 1,n,st;",
        ),
        (
            golden!("105_get_vision_path.txt"),
            105,
            1103,
            "MM_Get_VisPath",
        ),
    ] {
        // From the first part up to the one that says that it is the last.
        let all = exchanges(text);
        let mut parts = Vec::new();
        for (request, answer) in all {
            if request[0] == code && answer[4..6] == status.to_le_bytes() {
                let last = answer[8] == 1;
                parts.push((request, answer));
                if last {
                    break;
                }
            }
        }
        assert!(!parts.is_empty());
        let cell = |frame: &[u8], index: usize| {
            i32::from_le_bytes(frame[4 * index..4 * index + 4].try_into().expect("four"))
        };
        let request = &parts[0].0;
        let (job, kind) = (cell(request, 1), cell(request, 2));
        let statement = if code == 105 {
            format!("{statement} {job},{kind},n,v,st;")
        } else {
            statement.replace(" 1,", &format!(" {job},"))
        };
        let count: i32 = parts.iter().map(|(_, answer)| cell(answer, 3)).sum();
        let (_, last) = parts.last().expect("a part");
        let label_at = 5 + 8 * (cell(last, 3) as usize - 1) + 6;
        let label = cell(last, label_at);
        for version in VERSIONS {
            let store = if code == 105 && kind == 1 {
                "MM_Get_Jps n,j,a,b;"
            } else {
                "MM_Get_Pose n,p,a,b;"
            };
            let (machine, _) = call(version, &format!("{statement}\n{store}"), &parts);
            assert_eq!(num(&machine, "n"), f64::from(count), "{}", version.name);
            assert_eq!(num(&machine, "st"), f64::from(status));
            assert_eq!(num(&machine, "a"), f64::from(label));
        }
    }
}

#[test]
fn the_do_list_switches_on_its_bits() {
    let text = golden!("dialogue_f_heads.txt");
    let list = exchanges(text)
        .into_iter()
        .find(|(request, _)| request[0] == 206);
    let list = [list.expect("a list")];
    for version in VERSIONS {
        // DO 1 and 3 of the list; the group begins with 0.
        let statements = if version.status {
            "MM_Get_DoList 0,0,st;\nMM_Set_DoList 1,1,go_zone;"
        } else {
            "MM_Get_DoList 0;\nMM_Set_DoList 1,go_zone;"
        };
        let (_, system) = call(version, statements, &list);
        assert_eq!(system.signals["go_zone"], 10.0, "{}", version.name);
    }
    // In rounds of one slot: only the second slot's DO 3.
    let mut asked = list.clone();
    asked[0].0[4] = 1;
    let statements = "MM_Get_DoList 0,1,st;\nMM_Set_DoList 2,1,go_zone;";
    let (_, system) = call(VERSIONS[2], statements, &asked);
    assert_eq!(system.signals["go_zone"], 8.0);
}
