//! The threads and tasks of a server, from the first client to a clean end.

use std::net::SocketAddr;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::time::Duration;

use depal_interface::{ConnectionId, Encoding, HandshakeSettings, PortId, Profile};
use depal_time::SimDuration;
use socket2::{SockRef, TcpKeepalive};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{mpsc, oneshot, watch};
use tokio::task::JoinSet;

use crate::brain::{Brain, BrainLink, Notices, ToBrain};
use crate::client::Task;
use crate::journal::Journal;
use crate::ports::Listener;
use crate::s7::{SessionLink, Teller, poll_plc, serve_block};
use crate::{Limits, NetError, Notice, Ports, SessionHost};

/// After a failed accept (no descriptor left): then clients may have gone.
const ACCEPT_PAUSE: Duration = Duration::from_millis(50);

/// When a server shall end.
pub struct Stop {
    with_signals: bool,
    told: watch::Receiver<bool>,
    // Without anyone else to tell, this keeps the channel open.
    stopper: Stopper,
}

/// Ends a server.
#[derive(Debug, Clone)]
pub struct Stopper(Arc<watch::Sender<bool>>);

impl Stopper {
    /// Tells it. Replies that are being written are finished.
    pub fn stop(&self) {
        self.0.send_replace(true);
    }
}

impl Stop {
    /// At SIGINT or SIGTERM.
    pub fn on_signals() -> Self {
        let mut stop = Self::when_told();
        stop.with_signals = true;
        stop
    }

    /// When a [`Stopper`] says so.
    pub fn when_told() -> Self {
        let (sender, told) = watch::channel(false);
        Self {
            with_signals: false,
            told,
            stopper: Stopper(Arc::new(sender)),
        }
    }

    /// Tells this server to end, from any thread.
    pub fn stopper(&self) -> Stopper {
        self.stopper.clone()
    }
}

/// Answers clients until `stop`. The station (a [`depal_cell::station::Station`]) has one session for each port, in the same order.
/// `notices` is called from several threads and must not block.
pub fn serve(
    ports: Ports,
    station: impl SessionHost + 'static,
    limits: Limits,
    notices: impl Fn(Notice) + Send + Sync + 'static,
    journal: Option<Journal>,
    stop: Stop,
) -> Result<(), NetError> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .map_err(NetError::Start)?;
    let notices: Notices = Arc::new(notices);
    let encodings = station.encodings();
    let profiles = station.profiles();
    let (to_brain, letters) = BrainLink::new();
    let (brain_ended, brain_end) = oneshot::channel();
    let brain = Brain::new(station, journal, Arc::clone(&notices), letters);
    let thread = std::thread::Builder::new()
        .name("station".to_owned())
        .spawn(move || {
            let result = brain.run();
            let _ = brain_ended.send(());
            result
        })
        .map_err(NetError::Start)?;

    let server = Server {
        limits,
        notices,
        to_brain,
        next_client: AtomicU64::new(1),
    };
    let served =
        runtime.block_on(Arc::new(server).run(ports, encodings, profiles, stop, brain_end));
    // Tasks that are still writing are given up here.
    runtime.shutdown_background();
    served?;
    thread.join().map_err(|_| NetError::Died)?
}

struct Server {
    limits: Limits,
    notices: Notices,
    to_brain: BrainLink,
    next_client: AtomicU64,
}

impl Server {
    async fn run(
        self: Arc<Self>,
        ports: Ports,
        encodings: Vec<Encoding>,
        profiles: Vec<Profile>,
        mut stop: Stop,
        brain_end: oneshot::Receiver<()>,
    ) -> Result<(), NetError> {
        let (stopping, stop_seen) = watch::channel(false);
        let mut accepting = JoinSet::new();
        for (place, (listener, encoding)) in ports.listeners.into_iter().zip(encodings).enumerate()
        {
            let port = PortId(place as u16);
            let listener = match listener {
                Listener::Commands(listener) => listener,
                block => {
                    let profile = profiles[place].clone();
                    accepting.spawn(self.block(block, port, profile, stop_seen.clone())?);
                    continue;
                }
            };
            let listener = TcpListener::from_std(listener).map_err(NetError::Start)?;
            accepting.spawn(Arc::clone(&self).accept(listener, port, encoding, stop_seen.clone()));
        }
        let signal = signal(stop.with_signals)?;
        tokio::select! {
            () = signal => {}
            told = stop.told.wait_for(|told| *told) => { let _ = told; }
            _ = brain_end => {}
        }
        stopping.send_replace(true);
        let all = async { while accepting.join_next().await.is_some() {} };
        let _ = tokio::time::timeout(self.limits.shutdown, all).await;
        // Fails if the brain has ended by itself; its error is what counts then.
        self.to_brain.send(ToBrain::Stop);
        Ok(())
    }

    /// The task behind a data block, ours or a controller's.
    fn block(
        &self,
        listener: Listener,
        port: PortId,
        profile: Profile,
        stop: watch::Receiver<bool>,
    ) -> Result<Pin<Box<dyn Future<Output = ()> + Send>>, NetError> {
        let number = self.next_client.fetch_add(1, Ordering::Relaxed);
        let session = SessionLink::new((port, ConnectionId(number)), self.to_brain.clone());
        let teller = Teller {
            port,
            notices: Arc::clone(&self.notices),
        };
        let mut settings = HandshakeSettings {
            profile,
            ..HandshakeSettings::default()
        };
        Ok(match listener {
            Listener::S7Client(plc) => {
                settings.poll_period = SimDuration::from_nanos(plc.poll.as_nanos() as u64);
                Box::pin(poll_plc(plc, settings, session, teller, stop))
            }
            Listener::S7Server(listener) | Listener::Commands(listener) => {
                let listener = TcpListener::from_std(listener).map_err(NetError::Start)?;
                let limits = self.limits.clone();
                Box::pin(serve_block(
                    listener, settings, session, limits, teller, stop,
                ))
            }
        })
    }

    /// Takes clients until told to stop, then waits for those it has.
    async fn accept(
        self: Arc<Self>,
        listener: TcpListener,
        port: PortId,
        encoding: Encoding,
        mut stop: watch::Receiver<bool>,
    ) {
        let count = Arc::new(AtomicUsize::new(0));
        let mut clients = JoinSet::new();
        loop {
            tokio::select! {
                accepted = listener.accept() => match accepted {
                    Ok((stream, peer)) => {
                        let most = self.limits.clients_per_port;
                        if count.load(Ordering::Relaxed) >= most {
                            let reason = format!("{most} clients are connected already");
                            (self.notices)(Notice::Refused { port, peer, reason });
                            continue;
                        }
                        let Some(task) = self.task(stream, peer, port, encoding, stop.clone())
                        else {
                            continue;
                        };
                        count.fetch_add(1, Ordering::Relaxed);
                        let count = Arc::clone(&count);
                        clients.spawn(async move {
                            task.run().await;
                            count.fetch_sub(1, Ordering::Relaxed);
                        });
                    }
                    Err(_) => tokio::time::sleep(ACCEPT_PAUSE).await,
                },
                Some(_) = clients.join_next(), if !clients.is_empty() => {}
                _ = stop.changed() => break,
            }
        }
        drop(listener);
        while clients.join_next().await.is_some() {}
    }

    /// `None` if the client is gone already.
    fn task(
        &self,
        stream: TcpStream,
        peer: SocketAddr,
        port: PortId,
        encoding: Encoding,
        stop: watch::Receiver<bool>,
    ) -> Option<Task> {
        stream.set_nodelay(true).ok()?;
        let keepalive = TcpKeepalive::new()
            .with_time(self.limits.keepalive_after)
            .with_interval(self.limits.keepalive_interval)
            .with_retries(self.limits.keepalive_retries);
        SockRef::from(&stream).set_tcp_keepalive(&keepalive).ok()?;
        let number = self.next_client.fetch_add(1, Ordering::Relaxed);
        let client = (port, ConnectionId(number));
        let (sender, from_brain) = mpsc::unbounded_channel();
        let is_served = self.to_brain.send(ToBrain::Connected(client, peer, sender));
        is_served.then(|| Task {
            stream,
            client,
            encoding,
            limits: self.limits.clone(),
            to_brain: self.to_brain.clone(),
            from_brain,
            stop,
            is_deaf: false,
        })
    }
}

/// Ends at the first signal that asks the process to end.
fn signal(wanted: bool) -> Result<impl Future<Output = ()>, NetError> {
    #[cfg(unix)]
    let mut signals = {
        use tokio::signal::unix::{SignalKind, signal};
        if wanted {
            let on = |kind| signal(kind).map_err(NetError::Start);
            Some((on(SignalKind::interrupt())?, on(SignalKind::terminate())?))
        } else {
            None
        }
    };
    Ok(async move {
        #[cfg(unix)]
        if let Some((interrupt, terminate)) = &mut signals {
            tokio::select! {
                _ = interrupt.recv() => {}
                _ = terminate.recv() => {}
            }
            return;
        }
        #[cfg(not(unix))]
        if wanted && tokio::signal::ctrl_c().await.is_ok() {
            return;
        }
        std::future::pending::<()>().await;
    })
}
