//! `--listen KIND=PLACE`: what a port of the server is.

use std::net::{IpAddr, Ipv4Addr, SocketAddr, ToSocketAddrs};
use std::time::Duration;

use depal_cell::spec::PlcPort;
use depal_interface::{Encoding, PortSettings, plc_port};
use depal_net::Listen;
use depal_net::s7::PlcAddress;

use crate::failure::Failure;

/// Data blocks of controllers that one server works on.
const MOST_PLCS: usize = 4;
/// Slowest polling of a controller.
const SLOWEST_POLL_MS: u64 = 10_000;

/// Kind of a port, without its place.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Commands in an encoding.
    Commands(Encoding),
    /// Commands in the encoding that each client shows.
    Auto,
    /// A controller's data block.
    S7,
    /// The data block, offered.
    S7Server,
}

impl Kind {
    /// As on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Commands(encoding) => encoding.name(),
            Self::Auto => "auto",
            Self::S7 => "s7",
            Self::S7Server => "s7-server",
        }
    }

    /// The kind of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        match name.to_ascii_lowercase().replace('_', "-").as_str() {
            "auto" => Some(Self::Auto),
            "s7" => Some(Self::S7),
            "s7-server" => Some(Self::S7Server),
            other => Encoding::from_name(other).map(Self::Commands),
        }
    }

    /// The kind of a scene's own port.
    pub fn of_port(own: &PortSettings) -> Self {
        if own.detects_encoding {
            Self::Auto
        } else {
            Self::Commands(own.encoding)
        }
    }

    /// The session of such a port; all else as `own`.
    pub fn session(self, own: &PortSettings) -> PortSettings {
        match self {
            Self::Commands(encoding) => PortSettings {
                encoding,
                detects_encoding: false,
                ..own.clone()
            },
            Self::Auto => PortSettings {
                encoding: Encoding::Ascii,
                detects_encoding: true,
                ..own.clone()
            },
            Self::S7 | Self::S7Server => plc_port(own),
        }
    }
}

/// One `--listen`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Port {
    /// What it is.
    pub kind: Kind,
    /// Where.
    pub listen: Listen,
}

impl Port {
    /// Commands at an address.
    pub fn commands(kind: Kind, address: SocketAddr) -> Self {
        Self {
            kind,
            listen: Listen::Commands(address),
        }
    }

    /// The data block of a scene's controller, to be polled at an address.
    pub fn plc(plc: &PlcPort, address: SocketAddr) -> Self {
        let address = PlcAddress {
            db: plc.db,
            rack: plc.rack,
            slot: plc.slot,
            poll: Duration::from_nanos(plc.poll.as_nanos()),
            ..PlcAddress::new(address)
        };
        Self {
            kind: Kind::S7,
            listen: Listen::S7Client(address),
        }
    }
}

/// All ports of a server.
pub fn parse_listens(texts: &[String]) -> Result<Vec<Port>, Failure> {
    let ports = texts
        .iter()
        .map(|text| parse_listen(text))
        .collect::<Result<Vec<_>, _>>()?;
    let plcs = ports.iter().filter(|port| port.kind == Kind::S7).count();
    if plcs > MOST_PLCS {
        return Err(Failure::Input(format!(
            "--listen: at most {MOST_PLCS} ports of kind s7, found {plcs}"
        )));
    }
    Ok(ports)
}

/// KIND=ADDR:PORT; the address may be left out. For a controller options may follow a question mark.
fn parse_listen(text: &str) -> Result<Port, Failure> {
    let input = |message: String| Failure::Input(format!("--listen {text}: {message}"));
    let (kind, place) = text
        .split_once('=')
        .ok_or_else(|| input("expected KIND=ADDR:PORT, as in ascii=127.0.0.1:50000".to_owned()))?;
    let kind = Kind::from_name(kind).ok_or_else(|| {
        input(format!(
            "expected ascii, hex-le, hex-be, auto, s7 or s7-server, found {kind:?}"
        ))
    })?;
    let (place, options) = match place.split_once('?') {
        Some((place, options)) if kind == Kind::S7 => (place, options),
        _ => (place, ""),
    };
    let address = parse_place(place).map_err(input)?;
    let listen = match kind {
        Kind::Commands(_) | Kind::Auto => Listen::Commands(address),
        Kind::S7Server => Listen::S7Server(address),
        Kind::S7 if address.port() == 0 => {
            return Err(input("expected the controller's port, found 0".to_owned()));
        }
        Kind::S7 => Listen::S7Client(parse_options(address, options).map_err(input)?),
    };
    Ok(Port { kind, listen })
}

fn parse_place(place: &str) -> Result<SocketAddr, String> {
    let (host, port) = place.rsplit_once(':').unwrap_or(("", place));
    let digits = !port.is_empty() && port.bytes().all(|byte| byte.is_ascii_digit());
    if !digits {
        return Err(format!(
            "expected ADDR:PORT or PORT, as in 127.0.0.1:50000, found {place:?}"
        ));
    }
    let port: u16 = port
        .parse()
        .map_err(|_| format!("expected a port of 0 to {}, found {port}", u16::MAX))?;
    if host.is_empty() {
        return Ok(SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), port));
    }
    let addresses = place.to_socket_addrs();
    addresses
        .ok()
        .and_then(|mut found| found.next())
        .ok_or_else(|| format!("there is no address of the name {host:?}; give it as numbers, as in 127.0.0.1:{port}"))
}

/// `db=1&rack=0&slot=1&poll_ms=20`, in any order, each with a default.
fn parse_options(address: SocketAddr, options: &str) -> Result<PlcAddress, String> {
    let mut plc = PlcAddress::new(address);
    for option in options.split('&').filter(|option| !option.is_empty()) {
        let (key, value) = option
            .split_once('=')
            .ok_or_else(|| format!("expected KEY=VALUE, found {option:?}"))?;
        let number = |least: u64, most: u64| {
            let number = value.parse().ok().filter(|n| (least..=most).contains(n));
            number.ok_or_else(|| format!("{key}: expected {least} to {most}, found {value:?}"))
        };
        match key {
            "db" => plc.db = number(1, 65_535)? as u16,
            "rack" => plc.rack = number(0, 7)? as u8,
            "slot" => plc.slot = number(0, 31)? as u8,
            "poll_ms" => plc.poll = Duration::from_millis(number(1, SLOWEST_POLL_MS)?),
            _ => return Err(format!("expected db, rack, slot or poll_ms, found {key:?}")),
        }
    }
    Ok(plc)
}

#[cfg(test)]
mod tests;
