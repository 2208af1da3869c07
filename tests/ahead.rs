//! The next round is planned while the arm is still at the place: SendPos_Type 2 tells where it will start from.

use serde_json::Value;

use crate::runner::{Finished, root, run_demo};

const HALF_A_MINUTE: (&str, &str) = ("run.max_sim_s", "30");
/// From a 201 to its path: picture 0.5 s, vision 0.3 s, planning 0.1 s, of which none may be left to wait for.
const ROUND_TRIP_S: f64 = 0.9;

struct Timeline(Vec<(f64, Value)>);

impl Timeline {
    fn of(finished: &Finished) -> Self {
        let event = |line: &String| {
            let event: Value = serde_json::from_str(line).unwrap();
            (event["t_ns"].as_f64().unwrap() * 1e-9, event)
        };
        Self(finished.log.iter().map(event).collect())
    }

    fn times(&self, is_it: impl Fn(&Value) -> bool) -> Vec<f64> {
        let found = self.0.iter().filter(|(_, event)| is_it(event));
        found.map(|(time, _)| *time).collect()
    }

    /// Requests for a path.
    fn requests(&self) -> Vec<f64> {
        self.times(|event| event["from"] == "robot" && event["command"] == 201)
    }

    /// Mean time from one grip to the next, seconds.
    fn cycle(&self) -> f64 {
        let grips = self.times(|event| event["event"] == "pick_started");
        assert!(grips.len() >= 4, "{} picks prove nothing", grips.len());
        (grips[grips.len() - 1] - grips[0]) / (grips.len() - 1) as f64
    }
}

#[test]
fn the_next_pick_is_planned_while_the_arm_comes_back_from_the_place() {
    let ahead = Timeline::of(&run_demo(1, &[HALF_A_MINUTE]));
    let paths = ahead.times(|event| event["event"] == "plan");
    let moves = ahead.times(|event| event["event"] == "move_started");
    let releases = ahead.times(|event| event["name"] == "goVacuum" && event["value"] == 0.0);
    for (round, (&request, &path)) in ahead.requests().iter().zip(&paths).enumerate().skip(1) {
        let released = releases.iter().rfind(|&&time| time <= request);
        let released = released.expect("a carton is let go first");
        assert!(request - released < 0.02, "at the place, round {round}");
        // Up and home: two moves begin after the request; the third one is the new path's first.
        let later: Vec<&f64> = moves.iter().filter(|&&time| time > request).collect();
        let [_, home, first, ..] = later[..] else {
            break;
        };
        assert!(path > *home && path < *first, "on the way home: {path}");
    }
    let texts = ahead.0.iter().filter_map(|(_, event)| {
        let is_request = event["from"] == "robot" && event["command"] == 201;
        is_request.then(|| event["text"].as_str()).flatten()
    });
    for text in texts {
        // The joints at home, where it is not yet.
        assert!(text.starts_with("201,2,90.0,-20.0,20.0,0.0,90.0,0.0"));
    }

    // The counterpart: who asks at home stands and waits for the whole round trip.
    let program = std::fs::read_to_string(root().join("scenes/demo.mod")).unwrap();
    let home = "MoveAbsJ jHome\\NoEOffs,Speed(100),zFree,tGripper\\WObj:=wobj0;";
    let asks_at_home = program
        .replace("MM_Start_Viz 2,jHome;\n    WaitDI", "WaitDI")
        .replace(home, &home.replace("zFree", "fine"))
        .replace(
            "    RETURN bHeld;",
            "    MM_Start_Viz 2,jHome;\n    RETURN bHeld;",
        );
    assert_ne!(program, asks_at_home);
    let file = std::env::temp_dir().join(format!("asks_at_home_{}.mod", std::process::id()));
    std::fs::write(&file, asks_at_home).unwrap();
    let late = run_demo(
        1,
        &[HALF_A_MINUTE, ("robot.program", &file.to_string_lossy())],
    );
    std::fs::remove_file(&file).unwrap();
    let waited = Timeline::of(&late).cycle() - ahead.cycle();
    assert!(
        (ROUND_TRIP_S..ROUND_TRIP_S + 0.3).contains(&waited),
        "{waited:.3} s"
    );
}
