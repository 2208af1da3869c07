//! A robot's side of a connection, in text.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

/// Connected, with patience.
pub fn client(address: SocketAddr) -> TcpStream {
    let stream = TcpStream::connect(address).expect("it listens");
    stream.set_nodelay(true).expect("a socket");
    stream
        .set_read_timeout(Some(Duration::from_secs(15)))
        .expect("a socket");
    stream
}

/// One reply, without its CR.
pub fn reply(stream: &mut TcpStream) -> String {
    let mut text = Vec::new();
    let mut byte = [0];
    loop {
        stream.read_exact(&mut byte).expect("a reply");
        if byte[0] == b'\r' {
            return String::from_utf8(text).expect("text");
        }
        text.push(byte[0]);
    }
}

/// The reply to a command in text.
pub fn ask(stream: &mut TcpStream, command: &str) -> String {
    stream.write_all(command.as_bytes()).expect("sent");
    stream.write_all(b"\r").expect("sent");
    reply(stream)
}

/// Whether the server has closed, by FIN or by RST; what it still says is read.
pub fn is_closed(stream: &mut TcpStream) -> bool {
    let mut rest = Vec::new();
    match stream.read_to_end(&mut rest) {
        Ok(_) => true,
        Err(error) => error.kind() == ErrorKind::ConnectionReset,
    }
}

/// What a packed request is answered with: the first two cells.
pub fn packed(address: SocketAddr, order: fn([u8; 4]) -> i32, command: [u8; 4]) -> [i32; 2] {
    let mut stream = client(address);
    let mut request = [0; 64];
    request[..4].copy_from_slice(&command);
    stream.write_all(&request).expect("sent");
    let mut head = [0; 8];
    stream.read_exact(&mut head).expect("a reply");
    let cell = |place: usize| order(head[place..place + 4].try_into().expect("four bytes"));
    [cell(0), cell(4)]
}
