//! Frames written by hand from the published layouts (RFC 1006, ISO 8073, the S7 telegram headers).

use crate::s7::*;

fn bytes(hex: &str) -> Vec<u8> {
    hex.split_whitespace()
        .map(|pair| u8::from_str_radix(pair, 16).expect("two digits"))
        .collect()
}

/// One packet and its frame, both ways.
fn check_packet(packet: CotpPacket, hex: &str) {
    let frame = bytes(hex);
    assert_eq!(packet.emit(), frame);
    let mut reader = TelegramReader::new(480);
    reader.push(&frame);
    assert_eq!(reader.poll(), Ok(Some(packet)));
    assert_eq!(reader.poll(), Ok(None));
}

/// One telegram and its bytes, both ways.
fn check(reference: u16, body: S7Body, hex: &str) {
    let telegram = bytes(hex);
    let message = S7Message { reference, body };
    assert_eq!(message.emit(), telegram);
    assert_eq!(S7Message::parse(&telegram), Ok(message));
}

#[test]
fn connect() {
    check_packet(
        CotpPacket::ConnectRequest(CotpConnect {
            destination: 0,
            source: 1,
            tpdu_size: Some(10),
            calling: Some(Tsap::LOCAL),
            called: Some(Tsap::of_place(0, 1)),
        }),
        "03 00 00 16  11 e0 00 00 00 01 00  c0 01 0a  c1 02 01 00  c2 02 01 01",
    );
    check_packet(
        CotpPacket::ConnectConfirm(CotpConnect {
            destination: 1,
            source: 0x4431,
            tpdu_size: Some(10),
            calling: Some(Tsap::LOCAL),
            called: Some(Tsap::of_place(0, 2)),
        }),
        "03 00 00 16  11 d0 00 01 44 31 00  c0 01 0a  c1 02 01 00  c2 02 01 02",
    );
    check_packet(
        CotpPacket::DisconnectRequest { reason: 2 },
        "03 00 00 0b  06 80 00 00 00 00 02",
    );
    check_packet(
        CotpPacket::Reject { cause: 1 },
        "03 00 00 09  04 70 00 00 01",
    );
    check_packet(CotpPacket::data(vec![0x32]), "03 00 00 08  02 f0 80  32");
    assert_eq!(Tsap::of_place(2, 3), Tsap(0x0143));
}

#[test]
fn setup() {
    let setup = |pdu| Setup {
        calling_jobs: 1,
        called_jobs: 1,
        pdu,
    };
    check(
        0,
        S7Body::SetupRequest(setup(480)),
        "32 01 00 00 00 00 00 08 00 00  f0 00 00 01 00 01 01 e0",
    );
    check(
        0,
        S7Body::SetupReply(setup(240)),
        "32 03 00 00 00 00 00 08 00 00 00 00  f0 00 00 01 00 01 00 f0",
    );
}

#[test]
fn read() {
    check(
        5,
        S7Body::ReadRequest(vec![VarAddress::bytes(1, 0, 108)]),
        "32 01 00 00 00 05 00 0e 00 00  04 01  12 0a 10 02 00 6c 00 01 84 00 00 00",
    );
    check(
        6,
        S7Body::ReadRequest(vec![
            VarAddress::bit(1, 202, 0),
            VarAddress::bytes(1, 9694, 2),
        ]),
        "32 01 00 00 00 06 00 1a 00 00  04 02  12 0a 10 01 00 01 00 01 84 00 06 50 \
         12 0a 10 02 00 02 00 01 84 01 2e f0",
    );
    // An odd value is filled up unless it is the last; a failed item has no value.
    check(
        6,
        S7Body::ReadReply(vec![
            Ok(VarData::bit(true)),
            Err(ReturnCode::BAD_ADDRESS),
            Ok(VarData::bytes(&[4, 0x4e, 9])),
        ]),
        "32 03 00 00 00 06 00 02 00 11 00 00  04 03  ff 03 00 01 01 00  05 00 00 00 \
         ff 04 00 18 04 4e 09",
    );
}

#[test]
fn write() {
    check(
        7,
        S7Body::WriteRequest(vec![
            (VarAddress::bytes(1, 202, 1), VarData::bytes(&[1])),
            (VarAddress::bytes(1, 200, 2), VarData::bytes(&[4, 0x4e])),
        ]),
        "32 01 00 00 00 07 00 1a 00 0c  05 02  12 0a 10 02 00 01 00 01 84 00 06 50 \
         12 0a 10 02 00 02 00 01 84 00 06 40  00 04 00 08 01 00  00 04 00 10 04 4e",
    );
    check(
        7,
        S7Body::WriteReply(vec![ReturnCode::OK, ReturnCode::ACCESS_DENIED]),
        "32 03 00 00 00 07 00 02 00 02 00 00  05 02  ff 03",
    );
    check(
        9,
        S7Body::Refusal {
            class: 0x81,
            code: 0x04,
        },
        "32 02 00 00 00 09 00 00 00 00 81 04",
    );
}

/// Capacities as measured with two other implementations: 462 bytes a read at a length of 480.
#[test]
fn capacities() {
    assert_eq!((read_capacity(480), write_capacity(480)), (462, 452));
    assert_eq!((read_capacity(64), write_capacity(64)), (46, 36));
    assert_eq!((read_capacity(1), write_capacity(0)), (0, 0));
    let full = S7Message {
        reference: 1,
        body: S7Body::WriteRequest(vec![(
            VarAddress::bytes(1, 0, 452),
            VarData::bytes(&[0; 452]),
        )]),
    };
    assert_eq!(full.emit().len(), 480);
    let full = S7Message {
        reference: 1,
        body: S7Body::ReadReply(vec![Ok(VarData::bytes(&[0; 462]))]),
    };
    assert_eq!(full.emit().len(), 480);
}

/// Telegrams that lie: what is wrong with each.
#[test]
fn lies_are_refused() {
    let cases = [
        // Claims 4 bytes, carries 2.
        (
            "32 03 00 00 00 01 00 02 00 06 00 00  04 01  ff 04 00 20 01 02",
            "value of an item: expected 8 bytes, found 6",
        ),
        // Carries more than the item claims.
        (
            "32 03 00 00 00 01 00 02 00 09 00 00  04 01  ff 04 00 10 01 02 03 04 05",
            "bytes after the values: expected 0 bytes, found 3",
        ),
        // More items than claimed, fewer than claimed.
        (
            "32 03 00 00 00 01 00 02 00 06 00 00  04 02  ff 04 00 10 01 02",
            "value of an item: expected 4 bytes, found 0",
        ),
        (
            "32 03 00 00 00 01 00 02 00 01 00 00  05 02  ff",
            "verdicts of a write: expected 2 bytes, found 1",
        ),
        // Lengths in the header that do not add up.
        (
            "32 03 00 00 00 01 ff ff ff ff 00 00  04 01",
            "telegram: expected 131082 bytes, found 14",
        ),
        (
            "32 03 00 00 00 01 00",
            "telegram: expected 10 bytes, found 7",
        ),
        (
            "32 03 00 00 00 01 00 00 00 00",
            "telegram: expected 12 bytes, found 10",
        ),
        (
            "72 01 00 00 00 05 00 00 00 00",
            "protocol of a telegram: expected 0x32, found 0x72",
        ),
        // A symbolic address.
        (
            "32 01 00 00 00 05 00 0e 00 00  04 01  12 0e b2 02 00 6c 00 01 84 00 00 00",
            "address item: expected 0x0a, found 0x0e",
        ),
        // An unknown function, and user data.
        (
            "32 01 00 00 00 05 00 01 00 00  29",
            "telegram 5: kind 1, function 0x29 is not supported",
        ),
        (
            "32 07 00 00 00 05 00 01 00 00  00",
            "telegram 5: kind 7, function 0x00 is not supported",
        ),
        // A value without any byte for a read that was fine.
        (
            "32 03 00 00 00 01 00 02 00 04 00 00  04 01  ff 00 00 00",
            "value of an item: expected 5 bytes, found 4",
        ),
    ];
    for (hex, message) in cases {
        let error = S7Message::parse(&bytes(hex)).expect_err(hex);
        assert_eq!(error.to_string(), message, "{hex}");
    }
}

/// Frames that no reader may wait for.
#[test]
fn frames_are_bounded() {
    let cases = [
        ("03 00 00 00", "frame of 0 bytes, expected 7 to 487"),
        ("03 00 00 03", "frame of 3 bytes, expected 7 to 487"),
        ("03 00 00 04", "frame of 4 bytes, expected 7 to 487"),
        ("03 00 ff ff", "frame of 65535 bytes, expected 7 to 487"),
        ("02", "expected ISO on TCP (version 3), found version 2"),
        (
            "48 54 54 50",
            "expected ISO on TCP (version 3), found version 72",
        ),
        (
            "03 00 00 07 02 c0 80",
            "COTP packet of kind 0xc0 is unknown",
        ),
        (
            "03 00 00 07 09 f0 80",
            "COTP header: expected 10 bytes, found 3",
        ),
        (
            "03 00 00 07 00 f0 80",
            "COTP header: expected 2 bytes, found 3",
        ),
        (
            "03 00 00 09 04 e0 00 00 00",
            "COTP connect: expected 7 bytes, found 5",
        ),
    ];
    for (hex, message) in cases {
        let mut reader = TelegramReader::new(480);
        reader.push(&bytes(hex));
        let error = reader.poll().expect_err(hex);
        assert_eq!(error.to_string(), message, "{hex}");
    }
    // A telegram in endless pieces.
    let mut reader = TelegramReader::new(480);
    let piece = CotpPacket::Data {
        is_last: false,
        payload: vec![0; 200],
    };
    let mut result = Ok(None);
    for _ in 0..3 {
        reader.push(&piece.emit());
        result = reader.poll();
    }
    let error = result.expect_err("too long");
    assert_eq!(
        error.to_string(),
        "telegram in pieces: expected 480 bytes, found 600"
    );
}
