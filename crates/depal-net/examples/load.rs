//! Load on a running server, next to a trivial line server in the same run:
//! `depal serve --listen ascii=127.0.0.1:50000 2>/dev/null &`, then
//! `cargo run --release -p depal-net --example load -- 127.0.0.1:50000 [CLIENTS] [SECONDS] [COMMAND]`.
//!
//! Every client sends a command, waits for its reply, and sends the next.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::time::{Duration, Instant};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut args = std::env::args().skip(1);
    let address: SocketAddr = args
        .next()
        .ok_or("usage: load ADDR:PORT [CLIENTS] [SECONDS] [COMMAND]")?
        .parse()?;
    let clients: usize = args.next().map_or(Ok(64), |n| n.parse())?;
    let seconds: u64 = args.next().map_or(Ok(3), |n| n.parse())?;
    let command = args.next().unwrap_or_else(|| "901".to_owned()) + "\r";
    let span = Duration::from_secs(seconds.clamp(1, 60));

    let echo = trivial_server()?;
    let trivial = measure(echo, clients, span, &command)?;
    println!("trivial server  {trivial}");
    let ours = measure(address, clients, span, &command)?;
    println!("depal serve     {ours}");
    println!("ratio           {:.2}", ours.rate / trivial.rate);
    Ok(())
}

struct Figures {
    rate: f64,
    p50: Duration,
    p99: Duration,
    longest: Duration,
}

impl std::fmt::Display for Figures {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{:>8.0} replies/s, p50 {:?}, p99 {:?}, longest {:?}",
            self.rate, self.p50, self.p99, self.longest
        )
    }
}

fn measure(
    address: SocketAddr,
    clients: usize,
    span: Duration,
    command: &str,
) -> std::io::Result<Figures> {
    let threads: Vec<_> = (0..clients)
        .map(|_| {
            let command = command.as_bytes().to_vec();
            std::thread::spawn(move || ask_for(address, span, &command))
        })
        .collect();
    let mut times = Vec::new();
    for thread in threads {
        times.extend(thread.join().expect("clients return errors")?);
    }
    times.sort();
    let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
    Ok(Figures {
        rate: times.len() as f64 / span.as_secs_f64(),
        p50: at(0.5),
        p99: at(0.99),
        longest: at(1.0),
    })
}

/// The time of each exchange.
fn ask_for(address: SocketAddr, span: Duration, command: &[u8]) -> std::io::Result<Vec<Duration>> {
    let mut stream = TcpStream::connect(address)?;
    stream.set_nodelay(true)?;
    let mut buffer = vec![0; 16 * 1024];
    let mut times = Vec::new();
    let started = Instant::now();
    while started.elapsed() < span {
        let sent = Instant::now();
        stream.write_all(command)?;
        loop {
            let count = stream.read(&mut buffer)?;
            if count == 0 {
                return Err(std::io::ErrorKind::UnexpectedEof.into());
            }
            if buffer[count - 1] == b'\r' {
                break;
            }
        }
        times.push(sent.elapsed());
    }
    Ok(times)
}

/// Answers every line with nine bytes, on one thread.
fn trivial_server() -> std::io::Result<SocketAddr> {
    let listener = TcpListener::bind("127.0.0.1:0")?;
    let address = listener.local_addr()?;
    listener.set_nonblocking(true)?;
    std::thread::spawn(move || {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .expect("an event loop");
        runtime.block_on(async {
            use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
            let listener = tokio::net::TcpListener::from_std(listener).expect("a listener");
            while let Ok((mut stream, _)) = listener.accept().await {
                tokio::spawn(async move {
                    let _ = stream.set_nodelay(true);
                    let mut buffer = vec![0; 4096];
                    while let Ok(count) = stream.read(&mut buffer).await {
                        if count == 0 {
                            break;
                        }
                        for _ in buffer[..count].iter().filter(|byte| **byte == b'\r') {
                            if stream.write_all(b"901,1101\r").await.is_err() {
                                return;
                            }
                        }
                    }
                });
            }
        });
    });
    Ok(address)
}
