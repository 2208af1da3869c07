//! A camera on the flange is where the robot says that the flange is: a run without it does not begin.

use super::*;

/// As [`Bench::new`], the camera on the flange.
fn bench() -> Bench {
    let mut bench = Bench::new();
    let settings = ServerSettings {
        projects: vec![VisionProject::default()],
        needs_robot_pose: true,
        ..ServerSettings::default()
    };
    bench.server = Server::new(settings).unwrap();
    bench.server.handle_connect(bench.now, PORT, CLIENT);
    bench
}

const JOINTS: &str = "0,-20,10,0,60,0";
const FLANGE: &str = "1000,0,1500,0,0,180";
const ZEROS: &str = "0,0,0,0,0,0";

fn told(job: Job) -> (bool, bool) {
    let (Job::RunVision { pose, .. } | Job::StartViz { pose, .. }) = job else {
        panic!("{job:?} is no run");
    };
    match pose {
        RobotPose::Current {
            joints,
            base_from_flange,
        } => (joints.is_some(), base_from_flange.is_some()),
        other => panic!("{other:?} tells nothing"),
    }
}

#[test]
fn vision_runs_without_it_are_refused() {
    let mut b = bench();
    b.check("101,1,0,0,0,0,0,0,0,0", "101,1006");
    b.check(&format!("101,1,0,3,{JOINTS}"), "101,1006");
    b.check(&format!("100,1,0,1,{ZEROS},{ZEROS}"), "100,1006");
    b.check("102,1", "102,1020");
    assert!(b.server.poll_job().is_none());
    // A wrong type and an unknown project are told first.
    b.check("101,1,0,4,0,0,0,0,0,0", "101,1005");
    b.check("101,9,0,0,0,0,0,0,0,0", "101,1011");
}

#[test]
fn joints_or_flange_will_do() {
    for (request, expected) in [
        (format!("101,1,0,1,{JOINTS},{FLANGE}"), (true, true)),
        (format!("101,1,0,1,{JOINTS},{ZEROS}"), (true, false)),
        (format!("101,1,0,2,{FLANGE}"), (false, true)),
    ] {
        let mut b = bench();
        b.check(&request, "101,1102");
        assert_eq!(told(b.job()), expected, "{request}");
    }
    for (request, expected) in [
        (format!("201,1,{JOINTS},{FLANGE}"), (true, true)),
        (format!("201,1,{JOINTS},{ZEROS}"), (true, false)),
    ] {
        let mut b = bench();
        b.check(&request, "201,2103");
        assert_eq!(told(b.job()), expected, "{request}");
    }
    let mut b = bench();
    b.send(CLIENT, &format!("200,0,0,1,{ZEROS},{FLANGE}"));
    assert_eq!(told(b.job()), (false, true));
}

#[test]
fn path_runs_without_it_are_refused() {
    let mut b = bench();
    b.check(&format!("201,0,{ZEROS}"), "201,2013");
    b.check(&format!("201,2,{JOINTS}"), "201,2013");
    b.check(&format!("200,0,0,1,{ZEROS},{ZEROS}"), "200,2013");
    // Nothing is made up for a flange that cannot be.
    b.check(&format!("201,1,{JOINTS},20000,0,0,0,0,0"), "201,2013");
    b.check("205,1", "205,2022");
    assert!(b.server.poll_job().is_none());
}

#[test]
fn a_camera_on_a_stand_asks_for_nothing() {
    let mut b = Bench::new();
    b.check("101,1,0,0,0,0,0,0,0,0", "101,1102");
    b.check(&format!("201,1,{JOINTS},20000,0,0,0,0,0"), "201,2103");
    b.job();
    assert_eq!(told(b.job()), (true, false), "left aside");
}
