//! What a server of the block answers: no sockets here.

use depal_wire::s7::{
    AREA_DB, BLOCK_BYTES, DataBlock, DataTransport, MIN_PDU, PREFERRED_PDU, ReturnCode, S7Body,
    Setup, VarAddress, VarData, read_capacity,
};

/// The one data block that is offered.
const DB: u16 = 1;
/// Telegram too long for what was agreed.
const TOO_LONG: S7Body = S7Body::Refusal {
    class: 0x85,
    code: 0x00,
};
/// No such function.
pub(super) const NO_FUNCTION: S7Body = S7Body::Refusal {
    class: 0x81,
    code: 0x04,
};

/// The answer to one request, and whether the block was written to. A setup changes `pdu`.
pub(super) fn answer(block: &mut DataBlock, pdu: &mut u16, request: S7Body) -> (S7Body, bool) {
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
