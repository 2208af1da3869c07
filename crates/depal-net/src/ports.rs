use std::net::{SocketAddr, TcpListener};

use socket2::{Domain, Protocol, Socket, Type};

use crate::NetError;
use crate::s7::PlcAddress;

/// Connections that may wait to be taken: enough for every robot of a hall to come back at once.
const BACKLOG: i32 = 1024;

/// What a port is to be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Listen {
    /// Commands as text or packed cells, as the station's session says.
    Commands(SocketAddr),
    /// The data block, offered to controllers and other S7 clients.
    S7Server(SocketAddr),
    /// The data block of a controller, which is polled there. It need not be reachable yet.
    S7Client(PlcAddress),
}

/// A port as it was opened.
#[derive(Debug)]
pub(crate) enum Listener {
    Commands(TcpListener),
    S7Server(TcpListener),
    S7Client(PlcAddress),
}

/// Ports that are listened on; clients can connect already and are answered once [`crate::serve`] runs.
#[derive(Debug)]
pub struct Ports {
    pub(crate) listeners: Vec<Listener>,
    addresses: Vec<SocketAddr>,
}

impl Ports {
    /// Where they listen, in the order given; port 0 has become a real one. For a controller: where it is.
    pub fn addresses(&self) -> &[SocketAddr] {
        &self.addresses
    }
}

/// Listens for commands on every address. A port that was served a moment ago can be had again at once.
pub fn bind(addresses: &[SocketAddr]) -> Result<Ports, NetError> {
    let ports: Vec<Listen> = addresses.iter().copied().map(Listen::Commands).collect();
    open(&ports)
}

/// Opens ports of any kind; the station has one session for each, in this order.
pub fn open(wanted: &[Listen]) -> Result<Ports, NetError> {
    let mut ports = Ports {
        listeners: Vec::new(),
        addresses: Vec::new(),
    };
    for listen in wanted {
        let (listener, address) = match listen {
            Listen::Commands(address) => {
                let (listener, address) = listen_on(*address)?;
                (Listener::Commands(listener), address)
            }
            Listen::S7Server(address) => {
                let (listener, address) = listen_on(*address)?;
                (Listener::S7Server(listener), address)
            }
            Listen::S7Client(plc) => (Listener::S7Client(*plc), plc.address),
        };
        ports.listeners.push(listener);
        ports.addresses.push(address);
    }
    Ok(ports)
}

fn listen_on(address: SocketAddr) -> Result<(TcpListener, SocketAddr), NetError> {
    let failed = |source| NetError::Listen { address, source };
    let listener = listen(address).map_err(failed)?;
    let found = listener.local_addr().map_err(failed)?;
    Ok((listener, found))
}

fn listen(address: SocketAddr) -> std::io::Result<TcpListener> {
    let socket = Socket::new(
        Domain::for_address(address),
        Type::STREAM,
        Some(Protocol::TCP),
    )?;
    // Elsewhere this option would let two servers share a port.
    #[cfg(unix)]
    socket.set_reuse_address(true)?;
    socket.bind(&address.into())?;
    socket.listen(BACKLOG)?;
    socket.set_nonblocking(true)?;
    Ok(socket.into())
}
