//! Clients that come and go leave nothing behind. Alone in its process, because it counts descriptors.
#![allow(missing_docs, clippy::disallowed_methods, dead_code)]
#![cfg(target_os = "linux")]

#[path = "sockets/served.rs"]
mod served;

use std::io::Write;
use std::time::{Duration, Instant};

use served::{Client, ascii};

fn descriptors() -> usize {
    std::fs::read_dir("/proc/self/fd").expect("a list").count()
}

/// Memory of this process, KiB.
fn resident_kib() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("a text");
    let line = status.lines().find(|line| line.starts_with("VmRSS:"));
    let number = line.and_then(|line| line.split_whitespace().nth(1)?.parse().ok());
    number.expect("VmRSS in kB")
}

fn come_and_go(served: &served::Served, times: usize) {
    for time in 0..times {
        let mut robot = served.client();
        match time % 4 {
            // Asks and goes, goes at once, goes with a reply unread, goes in the middle of a command.
            0 => robot.check("901", "901,1101"),
            1 => {}
            2 => robot.send(b"901\r901\r"),
            _ => robot.0.write_all(b"10").expect("sent"),
        }
    }
}

/// Waits until all clients are seen to be gone.
fn settled(wanted: usize) -> usize {
    let started = Instant::now();
    loop {
        let count = descriptors();
        if count <= wanted || started.elapsed() > Duration::from_secs(10) {
            return count;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

#[test]
fn two_thousand_reconnects_leave_no_descriptor_and_no_memory_behind() {
    let served = ascii();
    // The server is up, with all that it opens for itself, and the client that saw it is gone.
    served.client().check("901", "901,1101");
    std::thread::sleep(Duration::from_millis(500));
    let before = descriptors();
    // Buffers of the system and the allocator grow to their size first.
    come_and_go(&served, 400);
    settled(before);
    let memory = resident_kib();
    come_and_go(&served, 2000);
    assert_eq!(settled(before), before);
    let grown = resident_kib().saturating_sub(memory);
    assert!(grown < 4096, "{grown} KiB more than before");
    let mut robot: Client = served.client();
    robot.check("901", "901,1101");
    assert!(descriptors() > before, "an open one is counted");
}
