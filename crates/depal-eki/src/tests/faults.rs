//! What a bad peer can do: documents cut, nested, multiplied, mistyped, in other encodings.

use super::{XML, connected, ms};
use crate::*;

/// The error that ends the connection.
fn refusal(bytes: &[u8]) -> EkiError {
    let mut channel = connected("", XML, "");
    let error = channel.receive(bytes, ms(0)).expect_err("refused");
    assert!(!channel.is_connected());
    error
}

fn malformed(bytes: &[u8]) -> String {
    match refusal(bytes) {
        EkiError::Malformed { message, .. } => message,
        other => panic!("expected malformed, found {other}"),
    }
}

/// Text that a channel keeps although it goes on; the document is dropped.
fn dropped(bytes: &[u8]) -> String {
    let mut channel = connected("", XML, "");
    channel.receive(bytes, ms(0)).expect("the connection stays");
    assert_eq!(channel.check_buffer("Plc").buff, 0);
    match channel.take_events().as_slice() {
        [Event::Refused(error)] => error.to_string(),
        other => panic!("expected one refusal, found {other:?}"),
    }
}

#[test]
fn a_document_cut_anywhere_is_waited_for_then_given_up() {
    let document = b"<Plc><Part id='a&amp;b'><Count>1</Count></Part></Plc>";
    for length in 1..document.len() {
        let mut channel = connected("", XML, "");
        channel.receive(&document[..length], ms(100)).unwrap();
        channel.poll(ms(10_099)).unwrap();
        let error = channel.poll(ms(10_100)).unwrap_err();
        assert_eq!(error.number(), 1026, "cut at {length}");
        assert!(!channel.is_connected());
        let (_, status) = channel.get("Plc/Speed", ElementType::Real);
        assert_eq!(status.message_number(), 1026);
    }
    let mut channel = connected("", XML, "");
    channel.receive(document, ms(0)).unwrap();
    channel.poll(ms(99_999)).unwrap();
}

#[test]
fn two_documents_in_one_segment_and_one_in_many() {
    let mut channel = connected("", XML, "");
    channel
        .receive(b"<Plc><Go>1</Go></Plc><Plc><Go>0</Go></Plc>", ms(0))
        .unwrap();
    assert_eq!(channel.check_buffer("Plc/Go").buff, 2);
    let document = format!("<Plc><Speed>1{}</Speed></Plc>", "0".repeat(700));
    for byte in document.replace('0', " ").as_bytes() {
        channel.receive(&[*byte], ms(0)).unwrap();
    }
    assert_eq!(channel.check_buffer("Plc/Speed").buff, 1);
}

#[test]
fn document_types_and_entities_are_refused() {
    let bomb = b"<!DOCTYPE x [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;\">]><Plc><Speed>&b;</Speed></Plc>";
    assert_eq!(malformed(bomb), "DOCTYPE is refused");
    let external = b"<!DOCTYPE x SYSTEM \"file:///etc/passwd\"><Plc/>";
    assert_eq!(malformed(external), "DOCTYPE is refused");
    assert_eq!(
        malformed(b"<Plc><Speed>&bomb;</Speed></Plc>"),
        "unknown entity &bomb;"
    );
    assert!(malformed(b"<Plc a='&bomb;'/>").contains("bomb"));
    assert!(malformed(b"<Plc>&#0;</Plc>").contains("character"));
}

fn attributes(count: usize) -> String {
    let one = |n| format!(" a{n}='1'");
    (0..count).map(one).collect::<Vec<_>>().concat()
}

#[test]
fn depth_attributes_and_size_have_an_end() {
    let deep = "<a>".repeat(100_000);
    assert!(malformed(deep.as_bytes()).contains("16 deep"));
    let wide = format!("<Plc{}/>", attributes(50_000));
    assert!(malformed(wide.as_bytes()).contains("64 attributes"));
    let long = format!("<Plc><Speed>{}</Speed></Plc>", "1".repeat(1_000_000));
    assert_eq!(refusal(long.as_bytes()).number(), 1281);
    // Just inside, everything is read.
    let names = attributes(64);
    let deep = format!(
        "<Plc{names}>{}{}<Speed>1</Speed></Plc>",
        "<a>".repeat(15),
        "</a>".repeat(15)
    );
    let mut channel = connected("", XML, "");
    channel.receive(deep.as_bytes(), ms(0)).unwrap();
    assert_eq!(channel.check_buffer("Plc/Speed").buff, 1);
}

#[test]
fn ill_formed_documents_end_the_connection() {
    malformed(b"<Plc><Speed>1</Plc></Speed>");
    malformed(b"<Plc><Speed>1</Go></Plc>");
    malformed(b"</Plc>");
    malformed(b"<Plc>\0</Plc>");
    malformed(b"<Plc a='1' a='2'/>");
    malformed(b"<Plc a=1/>");
    malformed(b"<Plc a='<'/>");
    malformed(b"hello");
    malformed(b"<Plc/>hello");
    malformed(b"< Plc/>");
    malformed(b"<Plc><![cdata[x]]></Plc>");
    malformed(b"<![CDATA[x]]><Plc/>");
    // A whole document before it counts; what follows needs a new connection.
    let mut channel = connected("", XML, "");
    let both = b"<Plc><Go>1</Go></Plc><Plc><Go>1</Plc></Go>";
    assert_eq!(channel.receive(both, ms(0)).unwrap_err().number(), 1024);
    assert_eq!(
        channel
            .receive(b"<Plc><Go>1</Go></Plc>", ms(0))
            .unwrap_err(),
        EkiError::NotConnected
    );
    channel.connect(ms(0));
    assert_eq!(channel.check_buffer("Plc/Go").message_number(), 1024);
    assert_eq!(channel.check_buffer("Plc/Go").buff, 1);
    channel.receive(b"<Plc><Go>0</Go></Plc>", ms(0)).unwrap();
    assert_eq!(channel.check_buffer("Plc/Go").buff, 2);
}

#[test]
fn documents_that_do_not_fit_are_dropped_whole_and_named() {
    assert_eq!(
        dropped(b"<Wrong><Speed>1</Speed></Wrong>"),
        "received document: element Wrong: unknown root element"
    );
    assert_eq!(
        dropped(b"<Plc><Go>1</Go><Speed>nan</Speed></Plc>"),
        "received document: element Plc/Speed: expected a finite number, found \"nan\""
    );
    assert_eq!(
        dropped(b"<Plc><Part><Count>1.5</Count></Part></Plc>"),
        "received document: element Plc/Part/Count: expected a whole number of 32 bits, found \"1.5\""
    );
    assert_eq!(
        dropped(b"<Plc><Pos X='1'/></Plc>"),
        "received document: element Plc/Pos: missing attribute Y of a frame"
    );
    assert!(dropped(b"<Plc><Part><Count>2147483648</Count></Part></Plc>").contains("32 bits"));
    assert!(dropped(b"<Plc><Go>yes</Go></Plc>").contains("0, 1, TRUE or FALSE"));
    // An element that is not there leaves its memory alone, and reading names it.
    let mut channel = connected("", XML, "");
    channel.receive(b"<Plc><Go>1</Go></Plc>", ms(0)).unwrap();
    let (_, status) = channel.get("Plc/Speed", ElementType::Real);
    let error = status.error.expect("empty");
    assert_eq!(
        (error.number(), error.to_string().as_str()),
        (15, "the memory of element Plc/Speed is empty")
    );
}

#[test]
fn other_encodings_are_refused_clearly() {
    assert!(malformed(b"\xFF\xFE<\0P\0").contains("UTF-16"));
    assert!(malformed(b"\xFE\xFF\0<\0P").contains("UTF-16"));
    assert!(malformed(b"<\0P\0").contains("zero byte"));
    assert!(malformed(b"<?xml version='1.0' encoding='ISO-8859-1'?><Plc/>").contains("ISO-8859-1"));
    assert!(malformed(b"<Other><Text>\xE4</Text></Other>").contains("not UTF-8"));
    let mut channel = connected("", XML, "");
    let marked =
        b"\xEF\xBB\xBF<?xml version='1.0' encoding='utf-8'?><Other><Text>\xC3\xA4</Text></Other>";
    channel.receive(marked, ms(0)).unwrap();
    let (text, _) = channel.get("Other/Text", ElementType::String);
    assert_eq!(text, Some(ElementValue::String("\u{e4}".into())));
}

#[test]
fn a_short_record_waits_and_a_long_one_shifts() {
    let receive = r#"<RAW><ELEMENT Tag="MMRecv" Type="BYTE" Size="660" Set_Flag="871"/></RAW>"#;
    let mut channel = connected("", receive, "");
    channel.receive(&[1; 659], ms(0)).unwrap();
    assert_eq!(channel.take_events(), []);
    assert_eq!(channel.check_buffer("MMRecv").buff, 0);
    assert_eq!(channel.poll(ms(10_000)).unwrap_err().number(), 1026);
    channel.connect(ms(10_000));
    let _ = channel.check_buffer("MMRecv");
    channel.receive(&[2; 661], ms(10_000)).unwrap();
    assert_eq!(channel.check_buffer("MMRecv").buff, 1);
    channel.receive(&[3; 659], ms(10_001)).unwrap();
    let (values, _) = channel.get_many("MMRecv", ElementType::String, 9);
    let mut second = vec![2];
    second.extend([3; 659]);
    assert_eq!(values[1], ElementValue::Bytes(second));
}

#[test]
fn a_reconnect_without_clearing_is_told_once_and_sends_nothing_old() {
    let mut channel = connected("", XML, "<XML><ELEMENT Tag=\"R/A\"/></XML>");
    channel
        .receive(b"<Plc><Speed>1</Speed></Plc><Plc><Sp", ms(0))
        .unwrap();
    channel.set("R/A", ElementValue::Int(1));
    channel.send("R");
    channel.lose_connection();
    channel.connect(ms(50));
    assert_eq!(channel.take_outgoing(), []);
    channel
        .receive(b"<Plc><Speed>2</Speed></Plc>", ms(60))
        .unwrap();
    let (_, status) = channel.get("Plc/Speed", ElementType::Real);
    assert_eq!((status.message_number(), status.connected), (512, true));
    let (values, status) = channel.get_many("Plc/Speed", ElementType::Real, 9);
    assert_eq!(values, [1.0, 2.0].map(ElementValue::Real));
    assert_eq!(status.message_number(), 0);
    // Cleared, nothing is told and nothing is left.
    channel.lose_connection();
    channel.clear();
    channel.connect(ms(70));
    assert_eq!(
        channel
            .get("Plc/Speed", ElementType::Real)
            .1
            .message_number(),
        15
    );
}
