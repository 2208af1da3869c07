use super::*;

fn plc(text: &str) -> PlcAddress {
    match parse_listen(text).expect(text).listen {
        Listen::S7Client(plc) => plc,
        other => panic!("{other:?}"),
    }
}

#[test]
fn controllers() {
    let address: SocketAddr = "127.0.0.1:10102".parse().expect("an address");
    assert_eq!(plc("s7=127.0.0.1:10102"), PlcAddress::new(address));
    assert_eq!(
        plc("s7=127.0.0.1:10102?db=7&rack=2&slot=3&poll_ms=5"),
        PlcAddress {
            address,
            db: 7,
            rack: 2,
            slot: 3,
            poll: Duration::from_millis(5),
        }
    );
    assert_eq!(plc("s7=:10102?slot=2").slot, 2);
    let server = parse_listen("s7-server=127.0.0.1:0").expect("a server");
    assert_eq!(server.kind, Kind::S7Server);
}

#[test]
fn mistakes() {
    let cases = [
        (
            "s7=127.0.0.1:102?db=0",
            "db: expected 1 to 65535, found \"0\"",
        ),
        (
            "s7=127.0.0.1:102?rack=8",
            "rack: expected 0 to 7, found \"8\"",
        ),
        (
            "s7=127.0.0.1:102?slot=x",
            "slot: expected 0 to 31, found \"x\"",
        ),
        (
            "s7=127.0.0.1:102?speed=1",
            "expected db, rack, slot or poll_ms, found \"speed\"",
        ),
        ("s7=127.0.0.1:102?db", "expected KEY=VALUE, found \"db\""),
        (
            "ascii=127.0.0.1:99999",
            "expected a port of 0 to 65535, found 99999",
        ),
        ("hex-le=70000", "expected a port of 0 to 65535, found 70000"),
        ("ascii=127.0.0.1", "expected ADDR:PORT or PORT"),
        ("ascii=[::1]:x", "expected ADDR:PORT or PORT"),
        (
            "ascii=no.such.name.invalid:50000",
            "there is no address of the name \"no.such.name.invalid\"",
        ),
        ("s7=127.0.0.1:0", "expected the controller's port, found 0"),
        (
            "s8=127.0.0.1:102",
            "expected ascii, hex-le, hex-be, auto, s7 or s7-server, found \"s8\"",
        ),
        ("s7-server=127.0.0.1:0?db=2", "found \"127.0.0.1:0?db=2\""),
    ];
    for (text, message) in cases {
        let Err(Failure::Input(found)) = parse_listen(text) else {
            panic!("{text} was taken");
        };
        assert!(found.contains(message), "{found}");
    }
    let five = vec!["s7=127.0.0.1:102".to_owned(); 5];
    assert!(parse_listens(&five[..4]).is_ok());
    assert!(parse_listens(&five).is_err());
}
