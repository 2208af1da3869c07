//! Runs of the planning project: orders, branches, and what is never sent.

use super::*;

#[test]
fn order_rules_of_viz() {
    let mut bench = Bench::new();
    bench.check("202", "202,2104");
    bench.check("205,1", "205,2022");
    bench.check("210,1", "210,2022");
    bench.check("206", "206,2011");
    bench.check("203,7,1", "203,2022");
    bench.check("203,7,0", "203,2018");
    bench.check("203,7,3", "203,2018");
    bench.check("203,99,1", "203,2024");
    bench.check("201,9,0,0,0,0,0,0", "201,2006");
    bench.check("201,2,0,0,0,0,0,nan", "201,2013");
    let job = bench.start_viz();
    bench.check("201,0", "201,2002");
    bench.check("205,3", "205,2012");
    bench.check("210,5", "210,2012");
    bench.check("206", "206,2011");
    bench.finish_viz(job, Ok(path(3, Some(1))));
    let list = format!("206,2102,1,3{}", ",-1".repeat(62));
    bench.check("206", &list);
    bench.check("210,1", "210,2100,0,0,1.0,0.0,0.0,0.0,0.0,0.0,1,1,80");
    bench.check("205,1", "205,2042");
    bench.check("210,1", "210,2100,0,1,2.0,0.0,0.0,0.0,0.0,0.0,1,1,80,0");
    bench.check("210,1", "210,2100,1,0,3.0,0.0,0.0,0.0,0.0,0.0,1,1,80");
    bench.check("210,1", "210,2022");
    bench.check("206,4", &list);
    bench.check("203,7,1", "203,2022");
    let job = bench.start_viz();
    bench.finish_viz(job, Err(Status::VizNoPointsInRegion));
    bench.check("203,7,1", "203,2105");
    bench.check("205,1", "205,2038");
    bench.check("206", "206,2011");
}

#[test]
fn stop_gives_the_run_up() {
    let mut bench = Bench::new();
    let job = bench.start_viz();
    bench.check("205,1", "");
    let other = ConnectionId(2);
    bench.server.handle_connect(bench.now, PORT, other);
    bench.send(other, "202");
    assert_eq!(bench.replies(), ["202,2104", "205,2022"]);
    assert_eq!(bench.job(), Job::StopViz { job_id: job });
    // Too late: the run is no longer wanted.
    bench.finish_viz(job, Ok(path(2, Some(0))));
    bench.check("205,1", "205,2022");
}

#[test]
fn a_branch_exit_is_latched_until_its_step_is_reached() {
    let mut bench = Bench::new();
    let job = bench.start_viz();
    bench.check("203,7,2", "203,2105");
    assert_eq!(bench.server.poll_job(), None);
    bench.server.viz_waiting_at_branch(bench.now, job, 7);
    let go_on = Job::SetBranch {
        job_id: job,
        step: 7,
        exit: 1,
    };
    assert_eq!(bench.job(), go_on);
    // The other way round, and with a timeout in between.
    bench.check("202", "202,2104");
    bench.job();
    let job = bench.start_viz();
    bench.server.viz_waiting_at_branch(bench.now, job, 7);
    assert_eq!(bench.server.poll_job(), None, "every run needs its own 203");
    bench.check("205,2", "");
    bench.wait(10_000);
    assert_eq!(bench.replies(), ["205,2025"]);
    bench.check("203,7,1", "203,2105");
    assert_eq!(
        bench.job(),
        Job::SetBranch {
            job_id: job,
            step: 7,
            exit: 0
        }
    );
    bench.finish_viz(job, Ok(path(1, None)));
    bench.check("205,2", "205,2100,1,1,0,600.0,100.0,450.0,0.0,0.0,0.0,0,80");
}

#[test]
fn all_zero_joints_are_never_sent() {
    let mut bench = Bench::new();
    let job = bench.start_viz();
    let mut zero = path(1, None);
    zero.points[0].joints = JointPositions::zeros(6);
    bench.finish_viz(job, Ok(zero));
    bench.check(
        "205,1",
        &format!("205,2100,1,1,0{},0,80", ",0.0001".repeat(6)),
    );
}
