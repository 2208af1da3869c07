//! What a client of the block asks, and how it takes the answers: no sockets here.

use super::{
    BlockClientError, CotpConnect, CotpPacket, MIN_PDU, PREFERRED_PDU, ReturnCode, S7Body,
    S7Message, Setup, TelegramReader, Tsap, VarAddress, VarData, read_capacity, write_capacity,
};

/// What a [`BlockClient`] has finished.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum BlockDone {
    /// The processor is there, and the length of telegrams is agreed on.
    Connected,
    /// The bytes of a read.
    Read(Vec<u8>),
    /// A write.
    Written,
}

/// One connection to the data block of a controller: whole telegrams, one question at a time.
///
/// Say what to do with [`connect`](Self::connect), [`read`](Self::read) or [`write`](Self::write), one after the
/// other. Send what [`poll_output`](Self::poll_output) gives, [`push`](Self::push) what arrives, and
/// [`poll`](Self::poll) until it is done. After an error, close and connect again.
#[derive(Debug, Clone)]
pub struct BlockClient {
    db: u16,
    rack: u8,
    slot: u8,
    reader: TelegramReader,
    stage: Stage,
    pdu: u16,
    reference: u16,
    output: Vec<u8>,
}

#[derive(Debug, Clone)]
enum Stage {
    Down,
    Connecting,
    Agreeing,
    Idle,
    /// What was read so far.
    Reading {
        first: usize,
        len: usize,
        read: Vec<u8>,
    },
    /// How many bytes are written.
    Writing {
        first: usize,
        bytes: Vec<u8>,
        written: usize,
    },
}

impl BlockClient {
    /// For data block `db` of the processor in `rack` and `slot`; not connected.
    pub fn new(db: u16, rack: u8, slot: u8) -> Self {
        Self {
            db,
            rack,
            slot,
            reader: TelegramReader::new(usize::from(PREFERRED_PDU)),
            stage: Stage::Down,
            pdu: PREFERRED_PDU,
            reference: 0,
            output: Vec::new(),
        }
    }

    /// Longest telegram, bytes.
    pub fn pdu(&self) -> u16 {
        self.pdu
    }

    /// Whether it is connected and nothing is asked.
    pub fn is_idle(&self) -> bool {
        matches!(self.stage, Stage::Idle)
    }

    /// What is asked, in words.
    pub fn asked(&self) -> &'static str {
        match self.stage {
            Stage::Down | Stage::Connecting => "connecting",
            Stage::Agreeing => "the setup",
            Stage::Idle => "nothing",
            Stage::Reading { .. } => "a read",
            Stage::Writing { .. } => "a write",
        }
    }

    /// A connection is there: asks for the processor in its rack and slot.
    pub fn connect(&mut self) {
        self.disconnect();
        self.stage = Stage::Connecting;
        let request = CotpPacket::ConnectRequest(CotpConnect {
            destination: 0,
            source: 1,
            tpdu_size: Some(10),
            calling: Some(Tsap::LOCAL),
            called: Some(Tsap::of_place(self.rack, self.slot)),
        });
        self.output = request.emit();
    }

    /// The connection is gone.
    pub fn disconnect(&mut self) {
        self.stage = Stage::Down;
        self.reader = TelegramReader::new(usize::from(PREFERRED_PDU));
        self.output.clear();
    }

    /// Asks for bytes of the block, in as many questions as it takes. At least one; only when [idle](Self::is_idle).
    pub fn read(&mut self, first: usize, len: usize) {
        debug_assert!(self.is_idle(), "one thing at a time");
        let read = Vec::with_capacity(len);
        self.stage = Stage::Reading { first, len, read };
        self.ask_next();
    }

    /// Writes bytes of the block, in as many questions as it takes, in order. As for [`read`](Self::read).
    pub fn write(&mut self, first: usize, bytes: Vec<u8>) {
        debug_assert!(self.is_idle(), "one thing at a time");
        self.stage = Stage::Writing {
            first,
            bytes,
            written: 0,
        };
        self.ask_next();
    }

    /// Whether there are bytes to send.
    pub fn has_output(&self) -> bool {
        !self.output.is_empty()
    }

    /// Bytes to send.
    pub fn poll_output(&mut self) -> Option<Vec<u8>> {
        self.has_output().then(|| std::mem::take(&mut self.output))
    }

    /// Takes what arrived.
    pub fn push(&mut self, bytes: &[u8]) {
        self.reader.push(bytes);
    }

    /// Works on what arrived, up to the next thing that is done. There may be more to send then.
    pub fn poll(&mut self) -> Result<Option<BlockDone>, BlockClientError> {
        while let Some(packet) = self.reader.poll()? {
            let done = match packet {
                packet if matches!(self.stage, Stage::Connecting) => self.take_place(&packet)?,
                CotpPacket::Data { payload, .. } => {
                    let message = S7Message::parse(&payload)?;
                    // Other numbers are late answers to somebody else's questions.
                    if self.is_idle() || message.reference != self.reference {
                        continue;
                    }
                    self.take(message.body)?
                }
                CotpPacket::DisconnectRequest { .. } => return Err(BlockClientError::Closed),
                _ => return Err(self.misfit("a telegram", "another packet")),
            };
            if done.is_some() {
                return Ok(done);
            }
        }
        Ok(None)
    }

    /// The answer to the question for the processor.
    fn take_place(&mut self, packet: &CotpPacket) -> Result<Option<BlockDone>, BlockClientError> {
        let (rack, slot) = (self.rack, self.slot);
        match *packet {
            CotpPacket::ConnectConfirm(_) => {
                self.stage = Stage::Agreeing;
                self.ask(S7Body::SetupRequest(Setup {
                    calling_jobs: 1,
                    called_jobs: 1,
                    pdu: PREFERRED_PDU,
                }));
                Ok(None)
            }
            CotpPacket::DisconnectRequest { reason } | CotpPacket::Reject { cause: reason } => {
                Err(BlockClientError::Place { rack, slot, reason })
            }
            _ => Err(self.misfit("a confirmation", "another packet")),
        }
    }

    fn take(&mut self, body: S7Body) -> Result<Option<BlockDone>, BlockClientError> {
        let expected = match (&self.stage, body) {
            (_, S7Body::Refusal { class, code }) => return Err(self.refused(class, code)),
            (Stage::Agreeing, S7Body::SetupReply(setup)) => return self.take_setup(&setup),
            (Stage::Reading { .. }, S7Body::ReadReply(values)) => return self.take_values(values),
            (Stage::Writing { .. }, S7Body::WriteReply(codes)) => return self.take_codes(&codes),
            (Stage::Agreeing, _) => "a length of telegrams",
            (Stage::Writing { .. }, _) => "verdicts",
            _ => "values",
        };
        Err(self.misfit(expected, "an answer to something else"))
    }

    fn take_setup(&mut self, setup: &Setup) -> Result<Option<BlockDone>, BlockClientError> {
        if setup.pdu < MIN_PDU {
            return Err(BlockClientError::Pdu { found: setup.pdu });
        }
        // More than we asked for is not for us.
        self.pdu = setup.pdu.min(PREFERRED_PDU);
        self.reader.set_limit(usize::from(self.pdu));
        self.stage = Stage::Idle;
        Ok(Some(BlockDone::Connected))
    }

    fn take_values(
        &mut self,
        values: Vec<Result<VarData, ReturnCode>>,
    ) -> Result<Option<BlockDone>, BlockClientError> {
        let (from, part) = self.part();
        let value = match <[_; 1]>::try_from(values) {
            Ok([Ok(value)]) => value.bytes,
            Ok([Err(code)]) => return Err(self.item(from, part, code)),
            Err(values) => return Err(self.misfit("1 item", &items(values.len()))),
        };
        if value.len() != part {
            let found = format!("{} bytes", value.len());
            return Err(self.misfit(&format!("{part} bytes"), &found));
        }
        if let Stage::Reading { len, read, .. } = &mut self.stage {
            read.extend(value);
            if read.len() == *len {
                let read = std::mem::take(read);
                self.stage = Stage::Idle;
                return Ok(Some(BlockDone::Read(read)));
            }
        }
        self.ask_next();
        Ok(None)
    }

    fn take_codes(&mut self, codes: &[ReturnCode]) -> Result<Option<BlockDone>, BlockClientError> {
        let (from, part) = self.part();
        match codes {
            [code] if code.is_ok() => {}
            [code] => return Err(self.item(from, part, *code)),
            codes => return Err(self.misfit("1 item", &items(codes.len()))),
        }
        if let Stage::Writing { bytes, written, .. } = &mut self.stage {
            *written += part;
            if *written == bytes.len() {
                self.stage = Stage::Idle;
                return Ok(Some(BlockDone::Written));
            }
        }
        self.ask_next();
        Ok(None)
    }

    /// First byte and length of the part that is asked.
    fn part(&self) -> (usize, usize) {
        match &self.stage {
            Stage::Reading { first, len, read } => {
                let part = (len - read.len()).min(read_capacity(self.pdu));
                (first + read.len(), part)
            }
            Stage::Writing {
                first,
                bytes,
                written,
            } => {
                let part = (bytes.len() - written).min(write_capacity(self.pdu));
                (first + written, part)
            }
            _ => (0, 0),
        }
    }

    /// Asks for the next part of the transfer.
    fn ask_next(&mut self) {
        let (from, part) = self.part();
        // Both are inside the block, and the block is far shorter than 64 KiB.
        let address = VarAddress::bytes(self.db, from as u16, part as u16);
        let body = match &self.stage {
            Stage::Writing { bytes, written, .. } => {
                let value = VarData::bytes(&bytes[*written..written + part]);
                S7Body::WriteRequest(vec![(address, value)])
            }
            _ => S7Body::ReadRequest(vec![address]),
        };
        self.ask(body);
    }

    fn ask(&mut self, body: S7Body) {
        self.reference = self.reference.wrapping_add(1);
        let reference = self.reference;
        let frame = CotpPacket::data(S7Message { reference, body }.emit()).emit();
        self.output.extend(frame);
    }

    fn item(&self, first: usize, len: usize, code: ReturnCode) -> BlockClientError {
        BlockClientError::Item {
            db: self.db,
            first,
            last: first + len - 1,
            code,
        }
    }

    fn refused(&self, class: u8, code: u8) -> BlockClientError {
        BlockClientError::Refused {
            what: self.asked(),
            class,
            code,
            db: self.db,
            rack: self.rack,
            slot: self.slot,
        }
    }

    fn misfit(&self, expected: &str, found: &str) -> BlockClientError {
        BlockClientError::Answer {
            what: self.asked(),
            expected: expected.to_owned(),
            found: found.to_owned(),
        }
    }
}

fn items(count: usize) -> String {
    format!("{count} items")
}
