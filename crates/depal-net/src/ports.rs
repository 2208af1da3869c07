use std::net::{SocketAddr, TcpListener};

use socket2::{Domain, Protocol, Socket, Type};

use crate::NetError;

/// Connections that may wait to be taken: enough for every robot of a hall to come back at once.
const BACKLOG: i32 = 1024;

/// Ports that are listened on; clients can connect already and are answered once [`crate::serve`] runs.
#[derive(Debug)]
pub struct Ports {
    pub(crate) listeners: Vec<TcpListener>,
    addresses: Vec<SocketAddr>,
}

impl Ports {
    /// Where they listen, in the order given to [`bind`]; port 0 has become a real one.
    pub fn addresses(&self) -> &[SocketAddr] {
        &self.addresses
    }
}

/// Listens on every address. A port that was served a moment ago can be had again at once.
pub fn bind(addresses: &[SocketAddr]) -> Result<Ports, NetError> {
    let mut ports = Ports {
        listeners: Vec::new(),
        addresses: Vec::new(),
    };
    for address in addresses {
        let failed = |source| NetError::Listen {
            address: *address,
            source,
        };
        let listener = listen(*address).map_err(failed)?;
        ports.addresses.push(listener.local_addr().map_err(failed)?);
        ports.listeners.push(listener);
    }
    Ok(ports)
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
