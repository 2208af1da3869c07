//! A client of one controller over TCP, one question at a time.

use std::time::Duration;

use depal_wire::s7::{BlockClient, BlockClientError, BlockDone};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::time::{Instant, timeout_at};

use super::{PlcAddress, S7LinkError};

/// For connecting, and for one question and its answer. A controller needs some 10 ms; together with the
/// longest pause between attempts this bounds how long a controller that is back is not noticed.
const PATIENCE: Duration = Duration::from_millis(2_500);

/// A connection to a controller. Any error ends its usefulness: drop it and connect again.
#[derive(Debug)]
pub struct S7Client {
    stream: TcpStream,
    client: BlockClient,
}

impl S7Client {
    /// Connects to the processor in its rack and slot, and agrees on a length of telegrams.
    pub async fn connect(plc: PlcAddress) -> Result<Self, S7LinkError> {
        let deadline = Instant::now() + PATIENCE;
        let stream = timeout_at(deadline, TcpStream::connect(plc.address))
            .await
            .map_err(|_| silent("connecting"))?
            .map_err(S7LinkError::Connect)?;
        stream.set_nodelay(true).map_err(S7LinkError::Connect)?;
        let client = BlockClient::new(plc.db, plc.rack, plc.slot);
        let mut link = Self { stream, client };
        link.client.connect();
        loop {
            if let Some(BlockDone::Connected) = link.exchange(deadline).await? {
                return Ok(link);
            }
        }
    }

    /// Longest telegram, bytes.
    pub fn pdu(&self) -> u16 {
        self.client.pdu()
    }

    /// Bytes of the block, in as many questions as it takes.
    pub async fn read(&mut self, first: usize, len: usize) -> Result<Vec<u8>, S7LinkError> {
        self.client.read(first, len);
        loop {
            let deadline = Instant::now() + PATIENCE;
            if let Some(BlockDone::Read(bytes)) = self.exchange(deadline).await? {
                return Ok(bytes);
            }
        }
    }

    /// Writes bytes of the block, in as many questions as it takes, in order.
    pub async fn write(&mut self, first: usize, bytes: Vec<u8>) -> Result<(), S7LinkError> {
        self.client.write(first, bytes);
        loop {
            let deadline = Instant::now() + PATIENCE;
            if let Some(BlockDone::Written) = self.exchange(deadline).await? {
                return Ok(());
            }
        }
    }

    /// Sends the question that is due and takes what arrives, until something is done or the next question is due.
    async fn exchange(&mut self, deadline: Instant) -> Result<Option<BlockDone>, S7LinkError> {
        let what = self.client.asked();
        let Self { stream, client } = self;
        if let Some(bytes) = client.poll_output() {
            timeout_at(deadline, stream.write_all(&bytes))
                .await
                .map_err(|_| silent(what))?
                .map_err(S7LinkError::Lost)?;
        }
        let mut chunk = [0; 1024];
        loop {
            let done = client.poll()?;
            if done.is_some() || client.has_output() {
                return Ok(done);
            }
            let count = timeout_at(deadline, stream.read(&mut chunk))
                .await
                .map_err(|_| silent(what))?
                .map_err(S7LinkError::Lost)?;
            if count == 0 {
                return Err(BlockClientError::Closed.into());
            }
            client.push(&chunk[..count]);
        }
    }
}

fn silent(what: &'static str) -> S7LinkError {
    S7LinkError::Silent {
        what,
        seconds: PATIENCE.as_secs_f64(),
    }
}
