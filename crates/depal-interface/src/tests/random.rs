//! Any order of requests and any bytes.

use proptest::prelude::*;

use super::*;

/// What a client or the cell may do in the random walk below.
fn action() -> impl Strategy<Value = (u8, String)> {
    let requests = prop::sample::select(vec![
        "101,1,0,0",
        "101,3,1,0",
        "102,1",
        "102,3",
        "103,1,1",
        "201,0",
        "202",
        "203,7,1",
        "205,1",
        "210,3",
        "206",
        "501,1,4,3,2",
        "901",
        "999",
        "x",
        "103,1",
    ]);
    (0u8..9, requests.prop_map(str::to_owned))
}

proptest! {
    /// Every request gets exactly one reply to its own command, in order, whatever the order of commands
    /// and the fate of the runs; the last ones after the timeout.
    #[test]
    fn every_request_is_answered_once(actions in prop::collection::vec(action(), 1..60)) {
        let mut bench = Bench::new();
        let mut jobs: Vec<Job> = Vec::new();
        let (mut asked, mut answered) = (Vec::new(), Vec::new());
        for (kind, request) in actions {
            match (kind, jobs.pop()) {
                (0, _) => bench.wait(3_000),
                (1, Some(Job::RunVision { job_id, .. })) => {
                    bench.server.finish_vision(bench.now, job_id, Ok(vec![object(0.5); 25]));
                }
                (1, Some(Job::StartViz { job_id, .. })) => bench.finish_viz(job_id, Ok(path(22, Some(3)))),
                (2, Some(Job::StartViz { job_id, .. })) => {
                    bench.finish_viz(job_id, Err(Status::VizUnreachable));
                }
                (_, job) => {
                    jobs.extend(job);
                    let command = request.split(',').next().unwrap_or_default();
                    asked.push(if command == "x" { "0".to_owned() } else { command.to_owned() });
                    bench.send(CLIENT, &request);
                }
            }
            jobs.extend(std::iter::from_fn(|| bench.server.poll_job()));
            answered.extend(bench.replies());
        }
        // Each one still in the pipe may wait for the whole timeout.
        for _ in 0..asked.len() {
            bench.wait(10_000);
            answered.extend(bench.replies());
        }
        let heads: Vec<_> = answered.iter().map(|r| r.split(',').next().unwrap().to_owned()).collect();
        prop_assert_eq!(heads, asked);
    }

    #[test]
    fn any_bytes_leave_the_server_alive(
        pieces in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..200), 0..10),
    ) {
        for encoding in [Encoding::Ascii, Encoding::HexLittleEndian, Encoding::HexBigEndian] {
            let mut bench = Bench::with_port(PortSettings { encoding, ..PortSettings::default() });
            for piece in &pieces {
                bench.server.handle_input(bench.now, PORT, CLIENT, piece);
                bench.wait(5);
            }
            bench.wait(60);
            while bench.server.poll_reply().is_some() {}
            let probe = ConnectionId(2);
            bench.server.handle_connect(bench.now, PORT, probe);
            let frame = depal_wire::Request::GetState(depal_wire::GetState)
                .encode(encoding, &Profile::v1_8());
            bench.server.handle_input(bench.now, PORT, probe, &frame);
            bench.wait(20);
            let reply = bench.server.poll_reply().unwrap();
            prop_assert_eq!(reply.status, Some(Status::VisionReady));
        }
    }
}
