//! What a server of the block answers: no sockets here.

use super::{
    AREA_DB, BLOCK_BYTES, CotpConnect, CotpPacket, DataBlock, DataTransport, MIN_PDU,
    PREFERRED_PDU, ReturnCode, S7Body, S7Error, S7Message, Setup, TelegramReader, VarAddress,
    VarData, read_capacity,
};

/// The one data block that is offered.
const DB: u16 = 1;
/// Telegram too long for what was agreed.
const TOO_LONG: S7Body = S7Body::Refusal {
    class: 0x85,
    code: 0x00,
};
/// No such function.
const NO_FUNCTION: S7Body = S7Body::Refusal {
    class: 0x81,
    code: 0x04,
};

/// One connection to a server of the block: any rack and slot, data block 1 only, the whole of it writable.
///
/// Call [`push`](Self::push) with what arrived, then [`poll`](Self::poll) until `None`.
/// After an error the connection has to be closed.
#[derive(Debug, Clone)]
pub struct BlockServer {
    reader: TelegramReader,
    pdu: u16,
    is_open: bool,
}

/// What answers one packet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Served {
    /// To be sent.
    pub frame: Vec<u8>,
    /// The block was written to.
    pub is_written: bool,
}

impl Default for BlockServer {
    fn default() -> Self {
        Self::new()
    }
}

impl BlockServer {
    /// Of a fresh connection.
    pub fn new() -> Self {
        Self {
            reader: TelegramReader::new(usize::from(PREFERRED_PDU)),
            pdu: PREFERRED_PDU,
            is_open: false,
        }
    }

    /// Takes what arrived.
    pub fn push(&mut self, bytes: &[u8]) {
        self.reader.push(bytes);
    }

    /// Whether a telegram has begun and not ended.
    pub fn is_inside(&self) -> bool {
        self.reader.is_inside()
    }

    /// Carries out the next whole telegram.
    pub fn poll(&mut self, block: &mut DataBlock) -> Result<Option<Served>, S7Error> {
        let Some(packet) = self.reader.poll()? else {
            return Ok(None);
        };
        let payload = match packet {
            CotpPacket::ConnectRequest(request) => {
                self.is_open = true;
                let confirm = CotpPacket::ConnectConfirm(CotpConnect {
                    destination: request.source,
                    source: 1,
                    ..request
                });
                return Ok(Some(Served {
                    frame: confirm.emit(),
                    is_written: false,
                }));
            }
            CotpPacket::Data { payload, .. } if self.is_open => payload,
            CotpPacket::DisconnectRequest { .. } => return Err(S7Error::Disconnected),
            _ => return Err(S7Error::OutOfOrder),
        };
        let (reference, (body, is_written)) = match S7Message::parse(&payload) {
            Ok(request) => (
                request.reference,
                answer(block, &mut self.pdu, request.body),
            ),
            Err(S7Error::Unsupported { reference, .. }) => (reference, (NO_FUNCTION, false)),
            Err(error) => return Err(error),
        };
        self.reader.set_limit(usize::from(self.pdu));
        let frame = CotpPacket::data(S7Message { reference, body }.emit()).emit();
        Ok(Some(Served { frame, is_written }))
    }
}

/// The answer to one request, and whether the block was written to. A setup changes `pdu`.
pub fn answer(block: &mut DataBlock, pdu: &mut u16, request: S7Body) -> (S7Body, bool) {
    match request {
        S7Body::SetupRequest(setup) if setup.pdu < MIN_PDU => (TOO_LONG, false),
        S7Body::SetupRequest(setup) => {
            *pdu = setup.pdu.min(PREFERRED_PDU);
            let granted = S7Body::SetupReply(Setup {
                calling_jobs: setup.calling_jobs.clamp(1, 8),
                called_jobs: setup.called_jobs.clamp(1, 8),
                pdu: *pdu,
            });
            (granted, false)
        }
        S7Body::ReadRequest(addresses) => {
            // Each value brings a header and perhaps a fill byte; one header is in the capacity.
            let lens = addresses.iter().map(|address| address.len().unwrap_or(0));
            let total: usize = lens.map(|len| 4 + len + len % 2).sum();
            if total > read_capacity(*pdu) + 4 + 1 {
                return (TOO_LONG, false);
            }
            let values = addresses.iter().map(|address| read(block, address));
            (S7Body::ReadReply(values.collect()), false)
        }
        S7Body::WriteRequest(items) => {
            let codes: Vec<ReturnCode> = items
                .iter()
                .map(|(address, value)| write(block, address, value))
                .collect();
            let is_written = codes.iter().any(|code| code.is_ok());
            (S7Body::WriteReply(codes), is_written)
        }
        _ => (NO_FUNCTION, false),
    }
}

/// Where an address lies in the block: first byte and length.
fn place(address: &VarAddress) -> Result<(usize, usize), ReturnCode> {
    if address.area != AREA_DB || address.db != DB {
        return Err(ReturnCode::NO_OBJECT);
    }
    let len = address.len().ok_or(ReturnCode::BAD_TYPE)?;
    if address.is_bits() && address.count > 1 {
        return Err(ReturnCode::BAD_TYPE);
    }
    let first = address.first_byte();
    let is_whole = address.is_bits() || address.first_bit.is_multiple_of(8);
    if address.is_empty() || !is_whole || first + len > BLOCK_BYTES {
        return Err(ReturnCode::BAD_ADDRESS);
    }
    Ok((first, len))
}

fn read(block: &DataBlock, address: &VarAddress) -> Result<VarData, ReturnCode> {
    let (first, len) = place(address)?;
    let bytes = block.bytes(first, len).ok_or(ReturnCode::BAD_ADDRESS)?;
    if address.is_bits() {
        return Ok(VarData::bit(bytes[0] >> (address.first_bit % 8) & 1 != 0));
    }
    Ok(VarData {
        transport: DataTransport::of_address(address),
        bytes: bytes.to_vec(),
    })
}

fn write(block: &mut DataBlock, address: &VarAddress, value: &VarData) -> ReturnCode {
    let (first, len) = match place(address) {
        Ok(place) => place,
        Err(code) => return code,
    };
    if value.bytes.len() != len {
        return ReturnCode::INCONSISTENT;
    }
    if !address.is_bits() {
        block.write(first, &value.bytes);
        return ReturnCode::OK;
    }
    let bit = 1 << (address.first_bit % 8);
    let old = block.as_bytes()[first];
    let is_set = value.bytes[0] & 1 != 0;
    block.write(first, &[if is_set { old | bit } else { old & !bit }]);
    ReturnCode::OK
}
