//! Clients that ask as fast as they are answered.

use std::io::{Error, ErrorKind, Read, Result, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::{Duration, Instant};

/// A command, and how its reply has to begin.
pub type Exchange = (&'static [u8], &'static [u8]);

/// What came of one run.
pub struct Figures {
    pub count: usize,
    /// Exchanges a second; those of several commands count once.
    pub rate: f64,
    pub p50: Duration,
    pub p99: Duration,
    longest: Duration,
}

impl Figures {
    fn new(mut times: Vec<Duration>, span: Duration) -> Self {
        times.sort();
        let at = |share: f64| {
            let place = (times.len().saturating_sub(1) as f64 * share) as usize;
            times.get(place).copied().unwrap_or_default()
        };
        Self {
            count: times.len(),
            rate: times.len() as f64 / span.as_secs_f64(),
            p50: at(0.5),
            p99: at(0.99),
            longest: at(1.0),
        }
    }
}

impl std::fmt::Display for Figures {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{:>8.0}/s, p50 {:?}, p99 {:?}, longest {:?}",
            self.rate, self.p50, self.p99, self.longest
        )
    }
}

#[allow(clippy::disallowed_methods)] // A load bench measures wall-clock time.
pub fn now() -> Instant {
    Instant::now()
}

/// The figures of `clients` busy clients, and of one more that pauses for 10 ms after each reply.
/// They share the addresses among them.
pub fn measure(
    addresses: &[SocketAddr],
    clients: usize,
    span: Duration,
    exchanges: &'static [Exchange],
) -> Result<(Figures, Figures)> {
    let ask = |place: usize, pause| {
        let address = addresses[place % addresses.len()];
        std::thread::spawn(move || ask_for(address, span, exchanges, pause))
    };
    let polite = ask(clients, Duration::from_millis(10));
    let busy: Vec<_> = (0..clients)
        .map(|place| ask(place, Duration::ZERO))
        .collect();
    let mut times = Vec::new();
    for thread in busy {
        times.extend(thread.join().expect("clients return errors")?);
    }
    let polite = polite.join().expect("clients return errors")?;
    Ok((Figures::new(times, span), Figures::new(polite, span)))
}

/// The time of each exchange: all commands, one after the other.
fn ask_for(
    address: SocketAddr,
    span: Duration,
    exchanges: &[Exchange],
    pause: Duration,
) -> Result<Vec<Duration>> {
    let mut stream = TcpStream::connect(address)?;
    stream.set_nodelay(true)?;
    stream.set_read_timeout(Some(Duration::from_secs(10)))?;
    let mut buffer = vec![0; 16 * 1024];
    let mut times = Vec::new();
    let started = now();
    while started.elapsed() < span {
        let sent = now();
        for step in exchanges {
            exchange(&mut stream, *step, &mut buffer)?;
        }
        times.push(sent.elapsed());
        if !pause.is_zero() {
            std::thread::sleep(pause);
        }
    }
    Ok(times)
}

fn exchange(stream: &mut TcpStream, (command, begin): Exchange, buffer: &mut [u8]) -> Result<()> {
    stream.write_all(command)?;
    let mut is_first = true;
    loop {
        let count = stream.read(buffer)?;
        if count == 0 {
            return Err(ErrorKind::UnexpectedEof.into());
        }
        if is_first && !buffer[..count].starts_with(begin) {
            let reply = buffer[..count].escape_ascii();
            return Err(Error::other(format!("an unexpected reply: {reply}")));
        }
        is_first = false;
        if buffer[count - 1] == b'\r' {
            return Ok(());
        }
    }
}

/// Clients that come, ask and go.
pub fn reconnect(address: SocketAddr, times: usize) -> Result<()> {
    let mut buffer = vec![0; 1024];
    for _ in 0..times {
        let mut stream = TcpStream::connect(address)?;
        exchange(&mut stream, (b"901\r", b"901,1101\r"), &mut buffer)?;
    }
    Ok(())
}
