use super::{connected, ms};
use crate::*;

const BYTE: &str = r#"<RAW><ELEMENT Tag="In" Type="BYTE" Size="4" Set_Flag="871"/></RAW>"#;
const STREAM: &str = r#"<RAW><ELEMENT Tag="In" Type="STREAM" EOS="13,10"/></RAW>"#;

fn records(channel: &mut Channel) -> Vec<Vec<u8>> {
    let (values, _) = channel.get_many("In", ElementType::String, 99);
    let bytes = |value| match value {
        ElementValue::Bytes(bytes) => bytes,
        other => panic!("not a raw record: {other:?}"),
    };
    values.into_iter().map(bytes).collect()
}

#[test]
fn fixed_records_are_counted_off() {
    let mut channel = connected("", BYTE, "");
    channel.receive(b"abc", ms(0)).unwrap();
    assert_eq!(channel.take_events(), []);
    channel.receive(b"defghi", ms(0)).unwrap();
    assert_eq!(channel.take_events().len(), 4);
    assert_eq!(records(&mut channel), [b"abcd", b"efgh"]);
}

#[test]
fn a_stream_ends_at_its_end_string() {
    let mut channel = connected("<BUFFSIZE Limit=\"8\"/>", STREAM, "");
    channel.receive(b"a\r", ms(0)).unwrap();
    channel.receive(b"\nb\rc\r\n\r\n", ms(0)).unwrap();
    assert_eq!(
        records(&mut channel),
        [b"a".to_vec(), b"b\rc".to_vec(), vec![]]
    );
    let error = channel.receive(b"123456789", ms(0)).unwrap_err();
    assert_eq!(error.number(), 1281);
}

#[test]
fn raw_records_are_filled_up_or_ended() {
    let mut channel = connected("", "", &BYTE.replace(" Set_Flag=\"871\"", ""));
    assert_eq!(channel.send_bytes(&[1, 0, 2]).message_number(), 0);
    assert_eq!(channel.take_outgoing(), [1, 0, 2, 0]);
    assert_eq!(channel.send_bytes(&[0; 5]).message_number(), 7);
    assert_eq!(channel.take_outgoing(), []);
    let mut channel = connected("", "", STREAM);
    channel.send_bytes(b"hello\0\0");
    assert_eq!(channel.take_outgoing(), b"hello\r\n");
}

#[test]
fn without_a_size_bytes_go_out_as_they_are() {
    let any_size = r#"<RAW><ELEMENT Tag="Out" Type="BYTE"/></RAW>"#;
    for send in [any_size, ""] {
        let mut channel = connected("", BYTE, send);
        assert_eq!(channel.send_bytes(&[1, 0, 2]).message_number(), 0);
        assert_eq!(channel.take_outgoing(), [1, 0, 2]);
    }
}
