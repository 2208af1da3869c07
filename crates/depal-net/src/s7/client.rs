//! A client of one controller: whole telegrams, one question at a time.

use std::time::Duration;

use depal_wire::s7::{
    CotpConnect, CotpPacket, MIN_PDU, PREFERRED_PDU, S7Body, S7Message, Setup, TelegramReader,
    Tsap, VarAddress, VarData, read_capacity, write_capacity,
};
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
    reader: TelegramReader,
    plc: PlcAddress,
    pdu: u16,
    reference: u16,
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
        let mut client = Self {
            stream,
            reader: TelegramReader::new(usize::from(PREFERRED_PDU)),
            plc,
            pdu: PREFERRED_PDU,
            reference: 0,
        };
        client.open(deadline).await?;
        client.agree(deadline).await?;
        Ok(client)
    }

    /// Longest telegram, bytes.
    pub fn pdu(&self) -> u16 {
        self.pdu
    }

    /// Bytes of the block, in as many questions as it takes.
    pub async fn read(&mut self, first: usize, len: usize) -> Result<Vec<u8>, S7LinkError> {
        const WHAT: &str = "a read";
        let mut bytes = Vec::with_capacity(len);
        while bytes.len() < len {
            let from = first + bytes.len();
            let part = (len - bytes.len()).min(read_capacity(self.pdu));
            let address = self.bytes_at(from, part);
            let asked = S7Body::ReadRequest(vec![address]);
            let found = match self.ask(WHAT, asked).await? {
                S7Body::ReadReply(values) => values,
                other => return Err(self.misfit(WHAT, "values", &other)),
            };
            match <[_; 1]>::try_from(found) {
                Ok([Ok(value)]) if value.bytes.len() == part => bytes.extend(value.bytes),
                Ok([Ok(value)]) => {
                    return Err(S7LinkError::Answer {
                        what: WHAT,
                        expected: format!("{part} bytes"),
                        found: format!("{} bytes", value.bytes.len()),
                    });
                }
                Ok([Err(code)]) => return Err(self.item(from, part, code)),
                Err(found) => return Err(items(WHAT, found.len())),
            }
        }
        Ok(bytes)
    }

    /// Writes bytes of the block, in as many questions as it takes, in order.
    pub async fn write(&mut self, first: usize, bytes: &[u8]) -> Result<(), S7LinkError> {
        const WHAT: &str = "a write";
        let capacity = write_capacity(self.pdu);
        for (place, part) in bytes.chunks(capacity).enumerate() {
            let from = first + place * capacity;
            let address = self.bytes_at(from, part.len());
            let asked = S7Body::WriteRequest(vec![(address, VarData::bytes(part))]);
            let codes = match self.ask(WHAT, asked).await? {
                S7Body::WriteReply(codes) => codes,
                other => return Err(self.misfit(WHAT, "verdicts", &other)),
            };
            match codes.as_slice() {
                [code] if code.is_ok() => {}
                [code] => return Err(self.item(from, part.len(), *code)),
                codes => return Err(items(WHAT, codes.len())),
            }
        }
        Ok(())
    }

    async fn open(&mut self, deadline: Instant) -> Result<(), S7LinkError> {
        let request = CotpPacket::ConnectRequest(CotpConnect {
            destination: 0,
            source: 1,
            tpdu_size: Some(10),
            calling: Some(Tsap::LOCAL),
            called: Some(Tsap::of_place(self.plc.rack, self.plc.slot)),
        });
        self.send("connecting", &request, deadline).await?;
        let PlcAddress { rack, slot, .. } = self.plc;
        let refused = |reason| S7LinkError::Place { rack, slot, reason };
        match self.packet("connecting", deadline).await? {
            CotpPacket::ConnectConfirm(_) => Ok(()),
            CotpPacket::DisconnectRequest { reason } => Err(refused(reason)),
            CotpPacket::Reject { cause } => Err(refused(cause)),
            _ => Err(S7LinkError::Answer {
                what: "connecting",
                expected: "a confirmation".to_owned(),
                found: "another packet".to_owned(),
            }),
        }
    }

    async fn agree(&mut self, deadline: Instant) -> Result<(), S7LinkError> {
        const WHAT: &str = "the setup";
        let wanted = S7Body::SetupRequest(Setup {
            calling_jobs: 1,
            called_jobs: 1,
            pdu: PREFERRED_PDU,
        });
        let setup = match self.ask_until(WHAT, wanted, deadline).await? {
            S7Body::SetupReply(setup) => setup,
            other => return Err(self.misfit(WHAT, "a length of telegrams", &other)),
        };
        if setup.pdu < MIN_PDU {
            return Err(S7LinkError::Pdu { found: setup.pdu });
        }
        // More than we asked for is not for us.
        self.pdu = setup.pdu.min(PREFERRED_PDU);
        self.reader.set_limit(usize::from(self.pdu));
        Ok(())
    }

    async fn ask(&mut self, what: &'static str, body: S7Body) -> Result<S7Body, S7LinkError> {
        self.ask_until(what, body, Instant::now() + PATIENCE).await
    }

    /// Asks, and waits for the answer with the same number. Other numbers are late answers to somebody
    /// else's questions: they are skipped.
    async fn ask_until(
        &mut self,
        what: &'static str,
        body: S7Body,
        deadline: Instant,
    ) -> Result<S7Body, S7LinkError> {
        self.reference = self.reference.wrapping_add(1);
        let reference = self.reference;
        let packet = CotpPacket::data(S7Message { reference, body }.emit());
        self.send(what, &packet, deadline).await?;
        loop {
            let telegram = match self.packet(what, deadline).await? {
                CotpPacket::Data { payload, .. } => payload,
                CotpPacket::DisconnectRequest { .. } => return Err(S7LinkError::Closed),
                _ => {
                    return Err(S7LinkError::Answer {
                        what,
                        expected: "a telegram".to_owned(),
                        found: "another packet".to_owned(),
                    });
                }
            };
            let answer = S7Message::parse(&telegram)?;
            if answer.reference == reference {
                return Ok(answer.body);
            }
        }
    }

    async fn send(
        &mut self,
        what: &'static str,
        packet: &CotpPacket,
        deadline: Instant,
    ) -> Result<(), S7LinkError> {
        timeout_at(deadline, self.stream.write_all(&packet.emit()))
            .await
            .map_err(|_| silent(what))?
            .map_err(S7LinkError::Lost)
    }

    async fn packet(
        &mut self,
        what: &'static str,
        deadline: Instant,
    ) -> Result<CotpPacket, S7LinkError> {
        let mut chunk = [0; 1024];
        loop {
            if let Some(packet) = self.reader.poll()? {
                return Ok(packet);
            }
            let count = timeout_at(deadline, self.stream.read(&mut chunk))
                .await
                .map_err(|_| silent(what))?
                .map_err(S7LinkError::Lost)?;
            if count == 0 {
                return Err(S7LinkError::Closed);
            }
            self.reader.push(&chunk[..count]);
        }
    }

    fn bytes_at(&self, first: usize, len: usize) -> VarAddress {
        // Both are inside the block, and the block is far shorter than 64 KiB.
        VarAddress::bytes(self.plc.db, first as u16, len as u16)
    }

    fn item(&self, first: usize, len: usize, code: depal_wire::s7::ReturnCode) -> S7LinkError {
        S7LinkError::Item {
            db: self.plc.db,
            first,
            last: first + len - 1,
            code,
        }
    }

    fn misfit(&self, what: &'static str, expected: &str, found: &S7Body) -> S7LinkError {
        if let S7Body::Refusal { class, code } = *found {
            return S7LinkError::Refused {
                what,
                class,
                code,
                db: self.plc.db,
                rack: self.plc.rack,
                slot: self.plc.slot,
            };
        }
        S7LinkError::Answer {
            what,
            expected: expected.to_owned(),
            found: "an answer to something else".to_owned(),
        }
    }
}

fn silent(what: &'static str) -> S7LinkError {
    S7LinkError::Silent {
        what,
        seconds: PATIENCE.as_secs_f64(),
    }
}

fn items(what: &'static str, found: usize) -> S7LinkError {
    S7LinkError::Answer {
        what,
        expected: "1 item".to_owned(),
        found: format!("{found} items"),
    }
}
