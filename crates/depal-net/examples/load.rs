//! Load on the server, next to a trivial one in the same run:
//! `cargo run --release -p depal-net --example load [SECONDS]`.
//!
//! Servers run as processes of their own, started from this program, so that their memory and descriptors can be
//! counted. Every client sends a command, waits for its reply, and sends the next.
//!
//! - Short commands: 64 clients ask 901 of the demo's cell; meanwhile one polite client asks every 10 ms.
//! - Points: 64 clients, each on a port of its own, send 101 and 102 and get 20 points each time. Pictures are not computed here: vision is a
//!   stand-in that has its points at once, all else is the server as it is.
//! - A million commands leave memory flat, 10,000 reconnects leave no descriptor.
//!
//! Ends with exit code 1 if a required figure is missed. Needs Linux for memory and descriptors.

#[path = "load/clients.rs"]
mod clients;
#[path = "load/servers.rs"]
mod servers;

use std::time::Duration;

use clients::{Exchange, Figures, measure, reconnect};
use servers::{Role, Running};

const CLIENTS: usize = 64;
const SHORT: &[Exchange] = &[(b"901\r", b"901,1101\r")];
const POINTS: &[Exchange] = &[
    (b"101,1,0,0,0,0,0,0,0,0\r", b"101,1102\r"),
    (b"102,1\r", b"102,1100,1,20,0,"),
];
const MILLION: usize = 1_000_000;
const RECONNECTS: usize = 10_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let argument = std::env::args().nth(1);
    if let Some(role) = argument.as_deref().and_then(Role::from_name) {
        return servers::be(role);
    }
    let seconds: u64 = argument.map_or(Ok(3), |text| text.parse())?;
    let span = Duration::from_secs(seconds.clamp(1, 60));
    let mut verdict = Verdict::default();

    let echo = Running::start(Role::Echo)?;
    let cell = Running::start(Role::Cell)?;
    let (trivial, _) = measure(&echo.addresses, CLIENTS, span, SHORT)?;
    let (short, polite) = measure(&cell.addresses, CLIENTS, span, SHORT)?;
    println!("short commands, {CLIENTS} clients");
    print(&trivial, &short);
    println!(
        "  a polite client more         p50 {:?}, p99 {:?}",
        polite.p50, polite.p99
    );
    verdict.at_least("short commands/s", short.rate, 20_000.0);
    verdict.at_most("their p99, ms", short.p99.as_secs_f64() * 1e3, 10.0);
    verdict.at_most(
        "p99 of the polite client, ms",
        polite.p99.as_secs_f64() * 1e3,
        50.0,
    );

    let points = Running::start(Role::Points)?;
    let (trivial, _) = measure(&echo.addresses, CLIENTS, span, POINTS)?;
    let (long, _) = measure(&points.addresses, CLIENTS, span, POINTS)?;
    println!("101 and 102 with 20 points, {CLIENTS} clients");
    print(&trivial, &long);
    verdict.at_least("replies of 20 points/s", long.rate, 5_000.0);
    drop((points, echo));

    // Buffers grow to their size first.
    let each = Duration::from_secs(2);
    measure(&cell.addresses, CLIENTS, each, SHORT)?;
    if let (Some(before), Some(open)) = (cell.resident_kib(), cell.descriptors()) {
        let started = clients::now();
        let mut asked = 0;
        while asked < MILLION {
            asked += measure(&cell.addresses, CLIENTS, each, SHORT)?.0.count;
        }
        let after = cell.resident_kib().unwrap_or(u64::MAX);
        println!(
            "{asked} commands in {:.1} s: {before} KiB before, {after} KiB after",
            started.elapsed().as_secs_f64()
        );
        verdict.at_most(
            "growth of memory, KiB",
            after as f64 - before as f64,
            1024.0,
        );

        let started = clients::now();
        reconnect(cell.addresses[0], RECONNECTS)?;
        println!(
            "{RECONNECTS} reconnects in {:.1} s: {open} descriptors before, {} after",
            started.elapsed().as_secs_f64(),
            cell.descriptors_at_rest(open)
        );
        let left = cell.descriptors_at_rest(open) as f64 - open as f64;
        verdict.at_most("descriptors left", left, 0.0);
    }
    verdict.result()
}

fn print(trivial: &Figures, ours: &Figures) {
    println!("  trivial server {trivial}");
    println!("  depal          {ours}");
    println!("  ratio          {:.2}", ours.rate / trivial.rate);
}

/// Which of the required figures were missed.
#[derive(Default)]
struct Verdict {
    missed: Vec<String>,
}

impl Verdict {
    fn at_least(&mut self, what: &str, found: f64, wanted: f64) {
        if found < wanted {
            self.missed
                .push(format!("{what}: {found:.0}, at least {wanted:.0} wanted"));
        }
    }

    fn at_most(&mut self, what: &str, found: f64, wanted: f64) {
        if found > wanted {
            self.missed
                .push(format!("{what}: {found:.1}, at most {wanted:.1} wanted"));
        }
    }

    fn result(self) -> Result<(), Box<dyn std::error::Error>> {
        if self.missed.is_empty() {
            println!("all as required");
            Ok(())
        } else {
            Err(self.missed.join("; ").into())
        }
    }
}
