//! `scenes/interface.toml` as its users rely on it: every kind of project, by its commands, in simulated time.

use crate::runner::scene;
use crate::talk::Talk;

const ZEROS: &str = "0,0,0,0,0,0";

fn talk() -> Talk {
    let ascii = [("interface.encoding", "ascii")];
    Talk::new(scene("interface", &ascii, None).cell_spec().unwrap())
}

#[test]
fn custom_data_go_out_in_the_order_of_their_names() {
    let mut talk = talk();
    talk.says(&format!("101,3,0,0,{ZEROS}"), 1102);
    for point in 0..8 {
        let row = talk.ask("110,3");
        assert_eq!(row[1], f64::from(u8::from(point == 7)), "{row:?}");
        assert_eq!(row[2], 5.0);
        assert_eq!(row[10..], [1.0, 2.0, 3.0, 7.5, -8.0]);
    }
    talk.says("110,3", 1002);
    talk.says(&format!("101,4,0,0,{ZEROS}"), 1102);
    talk.says("102,4", 1003);
}

#[test]
fn a_vision_project_plans_one_pick() {
    let mut talk = talk();
    talk.says("105,2,1", 1020);
    talk.says(&format!("101,2,0,0,{ZEROS}"), 1102);
    let path = talk.ask("105,2,2");
    assert_eq!((path[0], path[1]), (1103.0, 1.0));
    assert!(path[2] >= 4.0 && path[3] >= 2.0, "{path:?}");
    let pick = &path[4 + (path[3] as usize - 1) * 8..];
    assert!((pick[2] - 400.0).abs() < 6.0, "on the top face: {pick:?}");
    let outputs = talk.ask("106,2");
    let on: Vec<f64> = outputs[1..].iter().copied().filter(|d| *d >= 0.0).collect();
    assert!(!on.is_empty() && on.iter().all(|d| [1.0, 3.0, 5.0, 6.0].contains(d)));
}

#[test]
fn the_whole_picture_is_one_path_of_eight_rounds() {
    let mut talk = talk();
    talk.says(&format!("101,5,0,0,{ZEROS}"), 1102);
    let (mut waypoints, mut picks, mut parts) = (0, 0, 0);
    loop {
        let part = talk.ask("111,5,1");
        assert_eq!(part[0], 1103.0);
        waypoints += 1;
        if part[2] == 1.0 {
            picks += 1;
            // Ten labels, then how many so far.
            assert_eq!(part[12 + 10], f64::from(picks));
        }
        parts += 1;
        if part[1] == 1.0 || parts > 200 {
            break;
        }
    }
    assert_eq!(picks, 8);
    assert!(waypoints > 20);
    let outputs = talk.ask("106,5");
    for round in outputs[1..].chunks(4).take(8) {
        assert!(round[0] > 0.0 && round[3] == -1.0, "{round:?}");
    }
    assert!(outputs[33..].iter().all(|d| *d == -1.0));
}

#[test]
fn the_planning_project_takes_index_branch_and_properties() {
    let mut talk = talk();
    assert_eq!(talk.ask("207,6"), [2109.0, 400.0]);
    talk.says("207,9", 2041);
    talk.says("208,2", 2016);
    talk.says("208,1", 2108);
    assert_eq!(talk.ask("207,7"), [2109.0, 20.0]);
    // The change holds from the next run on: index 4 is the second place of the second row.
    talk.says("201,2,0,-20,10,0,60,0", 2103);
    assert_eq!(talk.ask("601"), [1000.0]);
    talk.says("204,3,5", 2106);
    talk.says("203,1,1", 2105);
    let mut last = talk.ask("210,4");
    let mut seen = vec![last.clone()];
    while last[1] == 0.0 {
        last = talk.ask("210,4");
        seen.push(last.clone());
    }
    let pick = seen.iter().find(|point| point[2] == 1.0).unwrap();
    assert_eq!(pick[11], 40.0, "80 % of 50 %");
    assert_eq!(pick[34..], [1.0, 2.0, 3.0, 7.5, -8.0]);
    assert_eq!(last[3..6], [910.0, -1480.0, 900.0]);
    assert_eq!(talk.ask("206")[0], 2102.0);

    talk.says(&format!("201,0,{ZEROS}"), 2103);
    talk.says("203,1,2", 2105);
    let path = talk.ask("205,1");
    assert_eq!(path[..4], [2100.0, 1.0, 1.0, 0.0]);
    assert_eq!(path[4..10], [1e-4; 6], "never all zero");
    assert_eq!(path[11], 30.0);
}

/// Eight cartons of 400 x 300 mm lie there, and the robot asks for others.
#[test]
fn a_wrong_box_size_fails_the_size_check() {
    let mut talk = talk();
    let start = format!("101,1,0,0,{ZEROS}");
    talk.says("501,1,300,200,200", 1108);
    talk.says(&start, 1102);
    talk.says("102,1", 1049);
    talk.says("501,1,400,300,250", 1108);
    talk.says(&start, 1102);
    talk.says("102,1", 1100);
    // The second recipe is the same wrong size; a path for what is not there is none.
    talk.says("501,2,300,200,200", 1108);
    talk.says(&format!("101,2,0,0,{ZEROS}"), 1102);
    talk.says("105,2,1", 1049);
}

#[test]
fn labels_go_out_as_the_project_names_them() {
    let said = |labels: &str| {
        let keys = [
            ("interface.encoding", "ascii"),
            ("vision.project.0.labels", labels),
        ];
        let mut talk = Talk::new(scene("interface", &keys, None).cell_spec().unwrap());
        talk.says(&format!("101,1,0,0,{ZEROS}"), 1102);
        talk.ask("102,1")
    };
    let points = said(r#"["12"]"#);
    assert_eq!(points[..3], [1100.0, 1.0, 8.0]);
    assert!(points[4..].chunks(8).all(|point| point[6] == 12.0));
    assert_eq!(said(r#"["a12"]"#), [1017.0]);
}

/// Without the branch's command the run waits; the reply gives up, the run does not.
#[test]
fn a_run_outlives_the_wait_for_its_branch() {
    let mut talk = talk();
    talk.says(&format!("201,0,{ZEROS}"), 2103);
    talk.says("205,2", 2025);
    talk.says("203,1,1", 2105);
    talk.says("205,2", 2100);
}
