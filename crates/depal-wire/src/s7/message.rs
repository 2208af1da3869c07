//! One telegram.

use super::items::{emit_item, parse_item};
use super::{ReturnCode, S7Error, VarAddress, VarData};

/// Longest telegram that we ask for, bytes: what the small controllers of the family grant.
pub const PREFERRED_PDU: u16 = 480;
/// Shortest agreed telegram that we work with, bytes: below it hardly a value fits.
pub const MIN_PDU: u16 = 64;

const PROTOCOL: u8 = 0x32;
const REQUEST: u8 = 1;
const ANSWER: u8 = 2;
const ANSWER_DATA: u8 = 3;
const SETUP: u8 = 0xf0;
const READ: u8 = 0x04;
const WRITE: u8 = 0x05;

/// Bytes that one answer to a read can carry.
pub fn read_capacity(pdu: u16) -> usize {
    usize::from(pdu).saturating_sub(12 + 2 + 4)
}

/// Bytes that one write of one item can carry.
pub fn write_capacity(pdu: u16) -> usize {
    usize::from(pdu).saturating_sub(10 + 2 + 12 + 4)
}

/// What both ends agree on first.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Setup {
    /// Requests that the caller may leave unanswered.
    pub calling_jobs: u16,
    /// The same for the called end.
    pub called_jobs: u16,
    /// Longest telegram, bytes.
    pub pdu: u16,
}

/// A telegram with the number that joins request and answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct S7Message {
    /// Chosen by who asks, repeated by who answers.
    pub reference: u16,
    /// The rest.
    pub body: S7Body,
}

/// What a telegram says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum S7Body {
    /// Asks for a length of telegrams.
    SetupRequest(Setup),
    /// Grants one.
    SetupReply(Setup),
    /// Asks for variables.
    ReadRequest(Vec<VarAddress>),
    /// Their values, or why not, one for each.
    ReadReply(Vec<Result<VarData, ReturnCode>>),
    /// Variables and their new values.
    WriteRequest(Vec<(VarAddress, VarData)>),
    /// One verdict for each.
    WriteReply(Vec<ReturnCode>),
    /// The whole request is refused.
    Refusal {
        /// Kind of error: 0x81 application, 0x85 resources, 0x87 access.
        class: u8,
        /// The error.
        code: u8,
    },
}

impl S7Message {
    /// Reads what a data packet carries. Never panics.
    pub fn parse(bytes: &[u8]) -> Result<Self, S7Error> {
        let short = |expected| S7Error::Length {
            what: "telegram",
            expected,
            found: bytes.len(),
        };
        let [protocol, kind, _, _, r0, r1, p0, p1, d0, d1, after @ ..] = bytes else {
            return Err(short(10));
        };
        if *protocol != PROTOCOL {
            return Err(S7Error::Value {
                what: "protocol of a telegram",
                expected: PROTOCOL,
                found: *protocol,
            });
        }
        let reference = u16::from_be_bytes([*r0, *r1]);
        let (error, rest) = match (*kind, after) {
            (ANSWER | ANSWER_DATA, [class, code, rest @ ..]) => ((*class, *code), rest),
            (ANSWER | ANSWER_DATA, _) => return Err(short(12)),
            (_, rest) => ((0, 0), rest),
        };
        let parameter_len = usize::from(u16::from_be_bytes([*p0, *p1]));
        let data_len = usize::from(u16::from_be_bytes([*d0, *d1]));
        if rest.len() != parameter_len + data_len {
            return Err(short(bytes.len() - rest.len() + parameter_len + data_len));
        }
        let (parameters, data) = rest.split_at(parameter_len);
        let body = match (*kind, parameters) {
            (ANSWER | ANSWER_DATA, _) if error != (0, 0) => S7Body::Refusal {
                class: error.0,
                code: error.1,
            },
            (REQUEST, [SETUP, setup @ ..]) => S7Body::SetupRequest(Setup::parse(setup)?),
            (ANSWER_DATA, [SETUP, setup @ ..]) => S7Body::SetupReply(Setup::parse(setup)?),
            (REQUEST, [READ, count, items @ ..]) => {
                expect_empty("data of a read", data)?;
                S7Body::ReadRequest(parse_addresses(*count, items)?)
            }
            (REQUEST, [WRITE, count, items @ ..]) => {
                let addresses = parse_addresses(*count, items)?;
                S7Body::WriteRequest(parse_writes(addresses, data)?)
            }
            (ANSWER_DATA, [READ, count]) => S7Body::ReadReply(parse_values(*count, data)?),
            (ANSWER_DATA, [WRITE, count]) => {
                if data.len() != usize::from(*count) {
                    return Err(S7Error::Length {
                        what: "verdicts of a write",
                        expected: usize::from(*count),
                        found: data.len(),
                    });
                }
                S7Body::WriteReply(data.iter().copied().map(ReturnCode).collect())
            }
            (kind, parameters) => {
                return Err(S7Error::Unsupported {
                    reference,
                    kind,
                    function: parameters.first().copied().unwrap_or(0),
                });
            }
        };
        Ok(Self { reference, body })
    }

    /// The telegram, to be put into a data packet. At most 255 items.
    pub fn emit(&self) -> Vec<u8> {
        let mut parameters = Vec::new();
        let mut data = Vec::new();
        let (kind, error) = match &self.body {
            S7Body::SetupRequest(setup) => {
                setup.emit(&mut parameters);
                (REQUEST, None)
            }
            S7Body::SetupReply(setup) => {
                setup.emit(&mut parameters);
                (ANSWER_DATA, Some([0, 0]))
            }
            S7Body::ReadRequest(addresses) => {
                parameters.extend([READ, addresses.len() as u8]);
                for address in addresses {
                    address.emit(&mut parameters);
                }
                (REQUEST, None)
            }
            S7Body::ReadReply(values) => {
                parameters.extend([READ, values.len() as u8]);
                for (place, value) in values.iter().enumerate() {
                    let is_last = place + 1 == values.len();
                    let code = value.as_ref().err().copied().unwrap_or(ReturnCode::OK);
                    emit_item(code, value.as_ref().ok(), is_last, &mut data);
                }
                (ANSWER_DATA, Some([0, 0]))
            }
            S7Body::WriteRequest(items) => {
                parameters.extend([WRITE, items.len() as u8]);
                for (place, (address, value)) in items.iter().enumerate() {
                    address.emit(&mut parameters);
                    let is_last = place + 1 == items.len();
                    emit_item(ReturnCode(0), Some(value), is_last, &mut data);
                }
                (REQUEST, None)
            }
            S7Body::WriteReply(codes) => {
                parameters.extend([WRITE, codes.len() as u8]);
                data.extend(codes.iter().map(|code| code.0));
                (ANSWER_DATA, Some([0, 0]))
            }
            S7Body::Refusal { class, code } => (ANSWER, Some([*class, *code])),
        };
        let mut out = vec![PROTOCOL, kind, 0, 0];
        out.extend(self.reference.to_be_bytes());
        out.extend((parameters.len() as u16).to_be_bytes());
        out.extend((data.len() as u16).to_be_bytes());
        out.extend(error.into_iter().flatten());
        out.extend(parameters);
        out.extend(data);
        out
    }
}

impl Setup {
    fn parse(bytes: &[u8]) -> Result<Self, S7Error> {
        let [_, a, b, c, d, e, f] = *bytes else {
            return Err(S7Error::Length {
                what: "setup",
                expected: 7,
                found: bytes.len(),
            });
        };
        Ok(Self {
            calling_jobs: u16::from_be_bytes([a, b]),
            called_jobs: u16::from_be_bytes([c, d]),
            pdu: u16::from_be_bytes([e, f]),
        })
    }

    fn emit(&self, out: &mut Vec<u8>) {
        out.extend([SETUP, 0]);
        out.extend(self.calling_jobs.to_be_bytes());
        out.extend(self.called_jobs.to_be_bytes());
        out.extend(self.pdu.to_be_bytes());
    }
}

fn expect_empty(what: &'static str, bytes: &[u8]) -> Result<(), S7Error> {
    if bytes.is_empty() {
        return Ok(());
    }
    Err(S7Error::Length {
        what,
        expected: 0,
        found: bytes.len(),
    })
}

fn parse_addresses(count: u8, mut items: &[u8]) -> Result<Vec<VarAddress>, S7Error> {
    let mut addresses = Vec::with_capacity(usize::from(count));
    for _ in 0..count {
        let (address, rest) = VarAddress::parse(items)?;
        addresses.push(address);
        items = rest;
    }
    expect_empty("bytes after the address items", items)?;
    Ok(addresses)
}

fn parse_writes(
    addresses: Vec<VarAddress>,
    mut data: &[u8],
) -> Result<Vec<(VarAddress, VarData)>, S7Error> {
    let count = addresses.len();
    let mut writes = Vec::with_capacity(count);
    for (place, address) in addresses.into_iter().enumerate() {
        let found = data.len();
        let (_, value, rest) = parse_item(data, place + 1 == count)?;
        let value = value.ok_or(S7Error::Length {
            what: "value of a write",
            expected: 5,
            found,
        })?;
        writes.push((address, value));
        data = rest;
    }
    expect_filled("bytes after the values", data)?;
    Ok(writes)
}

fn parse_values(count: u8, mut data: &[u8]) -> Result<Vec<Result<VarData, ReturnCode>>, S7Error> {
    let mut values = Vec::with_capacity(usize::from(count));
    for place in 0..count {
        let found = data.len();
        let (code, value, rest) = parse_item(data, place + 1 == count)?;
        values.push(match value {
            _ if !code.is_ok() => Err(code),
            Some(value) => Ok(value),
            None => {
                return Err(S7Error::Length {
                    what: "value of an item",
                    expected: 5,
                    found,
                });
            }
        });
        data = rest;
    }
    expect_filled("bytes after the values", data)?;
    Ok(values)
}

/// Nothing is left but the fill byte that some ends put after the last value, too.
fn expect_filled(what: &'static str, rest: &[u8]) -> Result<(), S7Error> {
    match rest {
        [0] => Ok(()),
        rest => expect_empty(what, rest),
    }
}
