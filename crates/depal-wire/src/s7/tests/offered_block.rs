//! What the offered block answers, without sockets.

use crate::s7::*;

fn ask(block: &mut DataBlock, request: S7Body) -> (S7Body, bool) {
    answer(block, &mut 480, request)
}

fn read(block: &mut DataBlock, address: VarAddress) -> Result<VarData, ReturnCode> {
    match ask(block, S7Body::ReadRequest(vec![address])).0 {
        S7Body::ReadReply(values) => values.into_iter().next().expect("one value"),
        other => panic!("{other:?}"),
    }
}

fn write(block: &mut DataBlock, address: VarAddress, value: VarData) -> ReturnCode {
    match ask(block, S7Body::WriteRequest(vec![(address, value)])).0 {
        S7Body::WriteReply(codes) => codes[0],
        other => panic!("{other:?}"),
    }
}

#[test]
fn setup_is_capped() {
    for (wanted, granted) in [
        (480, Some(480)),
        (960, Some(480)),
        (240, Some(240)),
        (63, None),
    ] {
        let mut pdu = 480;
        let setup = Setup {
            calling_jobs: 1,
            called_jobs: 1,
            pdu: wanted,
        };
        let (reply, is_written) =
            answer(&mut DataBlock::new(), &mut pdu, S7Body::SetupRequest(setup));
        assert!(!is_written);
        match (reply, granted) {
            (S7Body::SetupReply(setup), Some(granted)) => {
                assert_eq!((setup.pdu, pdu), (granted, granted));
            }
            (S7Body::Refusal { class: 0x85, .. }, None) => {}
            (reply, _) => panic!("{wanted}: {reply:?}"),
        }
    }
}

#[test]
fn addresses() {
    let block = &mut DataBlock::new();
    block.set_int(Field::Status, 0, 1102);
    block.set_bool(Field::PoseSent, true);
    assert_eq!(
        read(block, VarAddress::bytes(1, 200, 2)),
        Ok(VarData::bytes(&[4, 0x4e]))
    );
    assert_eq!(
        read(block, VarAddress::bit(1, 202, 0)),
        Ok(VarData::bit(true))
    );
    assert_eq!(
        read(block, VarAddress::bit(1, 202, 1)),
        Ok(VarData::bit(false))
    );
    let status = VarAddress {
        kind: 5,
        ..VarAddress::bytes(1, 200, 1)
    };
    assert_eq!(
        read(block, status),
        Ok(VarData {
            transport: DataTransport::Int,
            bytes: vec![4, 0x4e]
        })
    );
    let refused = [
        (VarAddress::bytes(2, 0, 1), ReturnCode::NO_OBJECT),
        (
            VarAddress {
                area: 0x83,
                ..VarAddress::bytes(1, 0, 1)
            },
            ReturnCode::NO_OBJECT,
        ),
        (VarAddress::bytes(1, 9695, 2), ReturnCode::BAD_ADDRESS),
        (VarAddress::bytes(1, 9696, 1), ReturnCode::BAD_ADDRESS),
        (
            VarAddress {
                first_bit: 0xff_ffff,
                ..VarAddress::bytes(1, 0, 1)
            },
            ReturnCode::BAD_ADDRESS,
        ),
        (
            VarAddress {
                first_bit: 3,
                ..VarAddress::bytes(1, 0, 1)
            },
            ReturnCode::BAD_ADDRESS,
        ),
        (VarAddress::bytes(1, 0, 0), ReturnCode::BAD_ADDRESS),
        (
            VarAddress {
                kind: 0x1c,
                ..VarAddress::bytes(1, 0, 1)
            },
            ReturnCode::BAD_TYPE,
        ),
        (
            VarAddress {
                count: 2,
                ..VarAddress::bit(1, 0, 0)
            },
            ReturnCode::BAD_TYPE,
        ),
    ];
    for (address, code) in refused {
        assert_eq!(read(block, address), Err(code), "{address:?}");
        let len = address.len().unwrap_or(1);
        let before = block.clone();
        assert_eq!(
            write(block, address, VarData::bytes(&vec![1; len])),
            code,
            "{address:?}"
        );
        assert_eq!(*block, before);
    }
    assert!(read(block, VarAddress::bytes(1, 9695, 1)).is_ok());
}

#[test]
fn writes() {
    let block = &mut DataBlock::new();
    assert_eq!(
        write(block, VarAddress::bytes(1, 2, 2), VarData::bytes(&[0, 101])),
        ReturnCode::OK
    );
    assert_eq!(block.int(Field::Command, 0), 101);
    // A single bit leaves its neighbours alone.
    block.write(0, &[0xf0]);
    assert_eq!(
        write(block, VarAddress::bit(1, 0, 0), VarData::bit(true)),
        ReturnCode::OK
    );
    assert_eq!(block.as_bytes()[0], 0xf1);
    assert_eq!(
        write(block, VarAddress::bit(1, 0, 4), VarData::bit(false)),
        ReturnCode::OK
    );
    assert_eq!(block.as_bytes()[0], 0xe1);
    assert_eq!(
        write(block, VarAddress::bytes(1, 2, 2), VarData::bytes(&[1])),
        ReturnCode::INCONSISTENT
    );
    // The whole block, up to its last byte, belongs to whoever writes.
    assert_eq!(
        write(block, VarAddress::bytes(1, 9695, 1), VarData::bytes(&[9])),
        ReturnCode::OK
    );
    assert_eq!(
        write(block, VarAddress::bytes(1, 200, 2), VarData::bytes(&[0, 7])),
        ReturnCode::OK
    );
    assert_eq!(block.int(Field::Status, 0), 7);
    // Several items: each has its own verdict.
    let items = vec![
        (VarAddress::bytes(1, 4, 2), VarData::bytes(&[0, 1])),
        (VarAddress::bytes(3, 4, 2), VarData::bytes(&[0, 1])),
    ];
    let (reply, is_written) = ask(block, S7Body::WriteRequest(items));
    assert_eq!(
        reply,
        S7Body::WriteReply(vec![ReturnCode::OK, ReturnCode::NO_OBJECT])
    );
    assert!(is_written);
}

#[test]
fn answers_fit_the_telegram() {
    let block = &mut DataBlock::new();
    assert!(read(block, VarAddress::bytes(1, 0, 462)).is_ok());
    for count in [464, 9696, 65_535] {
        let asked = S7Body::ReadRequest(vec![VarAddress::bytes(1, 0, count)]);
        let (reply, _) = ask(block, asked);
        assert!(
            matches!(reply, S7Body::Refusal { class: 0x85, .. }),
            "{count}: {reply:?}"
        );
    }
    let many = vec![VarAddress::bytes(1, 0, 200); 3];
    let (reply, _) = ask(block, S7Body::ReadRequest(many));
    assert!(
        matches!(reply, S7Body::Refusal { class: 0x85, .. }),
        "{reply:?}"
    );
    let (reply, _) = ask(block, S7Body::ReadReply(Vec::new()));
    assert!(
        matches!(
            reply,
            S7Body::Refusal {
                class: 0x81,
                code: 4
            }
        ),
        "{reply:?}"
    );
}
