//! Runs of vision projects: what comes back, and in which order it may be asked for.

use super::*;

#[test]
fn points_are_turned_down_and_come_once() {
    let mut bench = Bench::new();
    bench.check("101,1,0,0,0,0,0,0,0,0", "101,1102");
    let job = bench.job_id();
    bench
        .server
        .finish_vision(bench.now, job, Ok(vec![object(0.6)]));
    bench.check(
        "102,1",
        "102,1100,1,1,0,600.0,100.0,450.0,30.0,0.0,180.0,3,0",
    );
    bench.check("102,1", "102,1002");
}

#[test]
fn angles_follow_the_brand() {
    let mut bench = Bench::with_port(PortSettings {
        euler: EulerConvention::FanucWpr,
        ..PortSettings::default()
    });
    bench.check("101,1,0,0", "101,1102");
    let job = bench.job_id();
    bench
        .server
        .finish_vision(bench.now, job, Ok(vec![object(0.6)]));
    bench.check(
        "102,1",
        "102,1100,1,1,0,600.0,100.0,450.0,180.0,0.0,30.0,3,0",
    );
}

#[test]
fn order_rules_of_vision() {
    let mut bench = Bench::new();
    bench.check("102,1", "102,1020");
    bench.check("102,9", "102,1011");
    bench.check("102,2", "102,1016");
    bench.check("101,9,0,0,0,0,0,0,0,0", "101,1011");
    bench.check("101,1,0,9,0,0,0,0,0,0", "101,1005");
    bench.check("101,1,-1,0,0,0,0,0,0,0", "101,1018");
    bench.check("101,1,0,2,10001,0,0,0,0,0", "101,1006");
    bench.check("101,1,0,2,0,0,0,361,0,0", "101,1006");
    bench.check("103,1,3", "103,1012");
    bench.check("103,3,1", "103,1013");
    bench.check("103,1,2", "103,1107");
    bench.check("501,1,400,0,250", "501,1022");
    bench.check("501,1,400,300,nan", "501,1022");
    bench.check("501,1,300,400,250", "501,1108");
    bench.check("101,1,2,0,0,0,0,0,0,0", "101,1102");
    for refused in ["101,1,0,0", "103,1,1", "501,1,1,1,1"] {
        bench.check(refused, &format!("{},1007", &refused[..3]));
    }
    let Job::RunVision {
        job_id,
        recipe,
        box_size,
        pose,
        ..
    } = bench.job()
    else {
        panic!("not a vision job");
    };
    assert_eq!((recipe, pose), (Some(2), RobotPose::NotSent));
    assert_eq!(box_size, Some(BoxSize::from_mm([400.0, 300.0, 250.0])));
    bench.check("101,3,0,0", "101,1102");
    let found = vec![object(0.6), object(0.7), object(0.8)];
    bench.server.finish_vision(bench.now, job_id, Ok(found));
    bench.send(CLIENT, "102,1");
    assert!(
        bench.replies()[0].starts_with("102,1100,1,2,0,"),
        "count limits the points"
    );
    bench.check("101,1,0,0", "101,1102");
    assert!(matches!(bench.job(), Job::RunVision { project: 3, .. }));
    let job = bench.job_id();
    bench
        .server
        .finish_vision(bench.now, job, Err(Status::NoPointsInRegion));
    bench.check("102,1", "102,1003");
    bench.check("101,1,0,0", "101,1102");
    let job = bench.job_id();
    bench.server.finish_vision(bench.now, job, Ok(Vec::new()));
    bench.check("102,1", "102,1002");
}

#[test]
fn a_waiting_get_is_answered_by_the_run_or_the_timeout() {
    let mut bench = Bench::new();
    bench.check("101,1,0,0", "101,1102");
    let job = bench.job_id();
    bench.check("102,1", "");
    assert_eq!(
        bench.server.poll_timeout(),
        Some(SimTime::from_nanos(10_000_000_000))
    );
    bench.wait(9_999);
    assert_eq!(bench.replies(), Vec::<String>::new());
    bench.wait(1);
    assert_eq!(bench.replies(), ["102,1019"]);
    assert_eq!(bench.server.poll_timeout(), None);
    // The run lives on; two commands in the pipe are answered in order.
    bench.send(CLIENT, "102,1\r901");
    assert_eq!(bench.replies(), Vec::<String>::new());
    bench
        .server
        .finish_vision(bench.now, job, Ok(vec![object(0.6)]));
    let replies = bench.replies();
    assert!(
        replies[0].starts_with("102,1100,1,1,0,600.0"),
        "{replies:?}"
    );
    assert_eq!(replies[1..], ["901,1101"]);
}

#[test]
fn more_than_the_cap_comes_in_parts() {
    let mut bench = Bench::new();
    let job = bench.start_viz();
    bench.finish_viz(job, Ok(path(45, Some(22))));
    let mut heads = Vec::new();
    for _ in 0..4 {
        bench.send(CLIENT, "205,1");
        let reply = bench.replies().remove(0);
        heads.push(reply.split(',').take(6).collect::<Vec<_>>().join(","));
    }
    assert_eq!(
        heads,
        [
            "205,2100,0,20,23,1.0",
            "205,2100,0,20,3,21.0",
            "205,2100,1,5,0,41.0",
            "205,2022"
        ]
    );
}
