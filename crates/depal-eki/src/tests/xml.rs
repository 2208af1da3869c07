use super::{XML, connected, ms};
use crate::*;

fn flag(number: u32, value: bool) -> Event {
    Event::Signal {
        target: SignalTarget {
            kind: SignalKind::Flag,
            number,
        },
        value,
    }
}

const DOCUMENT: &[u8] = b"<?xml version=\"1.0\"?>\r\n<Plc><Speed> 1.5 </Speed><Part id='a&amp;b'><Count>3</Count></Part>\
<Part id=\"c\"><Count>-4</Count></Part><Go>TRUE</Go><Pos X='1' Y='2' Z='3' A='4' B='5' C='6'/><Unknown/></Plc>\r\n";

#[test]
fn values_come_out_oldest_first_and_typed() {
    let mut channel = connected("<ALIVE Set_Flag=\"9\"/>", XML, "");
    assert_eq!(channel.take_events(), [flag(9, true)]);
    channel.receive(DOCUMENT, ms(20)).unwrap();
    channel
        .receive(b"<Plc><Speed>2</Speed></Plc>", ms(40))
        .unwrap();
    assert_eq!(
        channel.take_events(),
        [
            flag(7, true),
            Event::Arrived { counter: 1 },
            flag(7, true),
            Event::Arrived { counter: 2 }
        ]
    );
    let (value, status) = channel.get("Plc/Speed", ElementType::Real);
    assert_eq!(value, Some(ElementValue::Real(1.5)));
    assert_eq!(
        status,
        Status {
            buff: 1,
            read: 1,
            error: None,
            connected: true,
            counter: 1,
            timestamp_ms: 20
        }
    );
    let (value, status) = channel.get("Plc/Speed", ElementType::Real);
    assert_eq!(value, Some(ElementValue::Real(2.0)));
    assert_eq!(
        (status.buff, status.counter, status.timestamp_ms),
        (0, 2, 40)
    );
    let (counts, status) = channel.get_many("Plc/Part/Count", ElementType::Int, 5);
    assert_eq!(counts, [ElementValue::Int(3), ElementValue::Int(-4)]);
    assert_eq!(status.read, 2);
    let (id, _) = channel.get("Plc/Part/@id", ElementType::String);
    assert_eq!(id, Some(ElementValue::String("a&b".into())));
    let (go, _) = channel.get("Plc/Go", ElementType::Bool);
    assert_eq!(go, Some(ElementValue::Bool(true)));
    let (frame, _) = channel.get("Plc/Pos", ElementType::Frame);
    assert_eq!(
        frame,
        Some(ElementValue::Frame([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]))
    );
}

#[test]
fn lifo_gives_the_newest_first() {
    let mut channel = connected("<BUFFERING Mode=\"LIFO\" Limit=\"3\"/>", XML, "");
    for n in 1..=3 {
        let text = format!("<Plc><Speed>{n}</Speed></Plc>");
        channel.receive(text.as_bytes(), ms(0)).unwrap();
    }
    let (values, _) = channel.get_many("Plc/Speed", ElementType::Real, 9);
    let expected = [3.0, 2.0, 1.0].map(ElementValue::Real);
    assert_eq!(values, expected);
}

#[test]
fn a_full_memory_ends_the_connection_and_keeps_what_was_there() {
    let mut channel = connected("<BUFFERING Limit=\"2\"/><ALIVE Set_Flag=\"9\"/>", XML, "");
    let three =
        b"<Plc><Speed>1</Speed></Plc><Plc><Speed>2</Speed></Plc><Plc><Speed>3</Speed></Plc>";
    let error = channel.receive(three, ms(0)).unwrap_err();
    assert_eq!(error.number(), 1280);
    assert!(!channel.is_connected());
    assert_eq!(channel.take_events().last(), Some(&flag(9, false)));
    // The program hears it once, then reads what is there.
    let (_, status) = channel.get("Plc/Speed", ElementType::Real);
    assert_eq!(status.message_number(), 1280);
    let (values, status) = channel.get_many("Plc/Speed", ElementType::Real, 9);
    assert_eq!(values, [1.0, 2.0].map(ElementValue::Real));
    assert!(!status.connected);
}

#[test]
fn refusals_of_calls_have_their_numbers() {
    let mut channel = connected("", XML, "<XML><ELEMENT Tag=\"R/A\"/></XML>");
    let mut number = |tag: &str, kind| channel.get(tag, kind).1.message_number();
    assert_eq!(number("Plc/Speed", ElementType::Real), 15);
    assert_eq!(number("Plc/Speed", ElementType::Int), 16);
    assert_eq!(number("Plc/Nothing", ElementType::Int), 14);
    assert_eq!(number("Plc", ElementType::Int), 14);
    assert_eq!(
        channel.set("R/B", ElementValue::Int(1)).message_number(),
        14
    );
    let nan = ElementValue::Real(f64::NAN);
    assert_eq!(channel.set("R/A", nan).message_number(), 7);
    assert_eq!(channel.send("X").message_number(), 14);
    assert_eq!(channel.send_bytes(b"x").message_number(), 7);
    channel.close();
    assert_eq!(channel.send("R").message_number(), 10);
}

#[test]
fn buffers_are_counted_and_cleared_by_path() {
    let mut channel = connected("", XML, "<XML><ELEMENT Tag=\"R/A\"/></XML>");
    channel.receive(DOCUMENT, ms(0)).unwrap();
    assert_eq!(channel.check_buffer("Plc/Part/Count").buff, 2);
    assert_eq!(channel.check_buffer("Plc").buff, 2);
    assert_eq!(channel.check_buffer("Plc/Go").buff, 1);
    assert_eq!(channel.check_buffer("Pl").message_number(), 14);
    assert_eq!(channel.clear_buffer("Plc/Part").message_number(), 0);
    assert_eq!(channel.check_buffer("Plc/Part/Count").buff, 0);
    assert_eq!(channel.check_buffer("Plc/Go").buff, 1);
    channel.set("R/A", ElementValue::Int(5));
    channel.clear_buffer("R");
    channel.send("R");
    assert_eq!(channel.take_outgoing(), b"<R><A/></R>");
}

#[test]
fn one_document_holds_all_elements_of_the_root() {
    let send = r#"<XML><ELEMENT Tag="Robot/Data/X"/><ELEMENT Tag="Robot/Mode"/><ELEMENT Tag="Robot/Data/@n"/>
        <ELEMENT Tag="Robot/Data/Y"/><ELEMENT Tag="Robot/Pos"/><ELEMENT Tag="Log/Text"/></XML>"#;
    let mut channel = connected("", "", send);
    channel.set("Robot/Data/X", ElementValue::Real(-0.5));
    channel.set("Robot/Data/@n", ElementValue::Int(2));
    channel.set("Robot/Mode", ElementValue::String("a<b>&\"c\"".into()));
    channel.set("Robot/Data/Y", ElementValue::Bool(true));
    let frame = [1.0, 2.0, 3.0, 4.0, 5.0, -0.0];
    channel.set("Robot/Pos", ElementValue::Frame(frame));
    assert_eq!(channel.send("Robot").message_number(), 0);
    let text = String::from_utf8(channel.take_outgoing()).unwrap();
    assert_eq!(
        text,
        "<Robot><Data n=\"2\"><X>-0.500000</X><Y>1</Y></Data><Mode>a&lt;b&gt;&amp;&quot;c&quot;</Mode>\
         <Pos X=\"1.000000\" Y=\"2.000000\" Z=\"3.000000\" A=\"4.000000\" B=\"5.000000\" C=\"0.000000\"/></Robot>"
    );
    channel.send("Robot/Data");
    assert_eq!(
        channel.take_outgoing(),
        b"<Robot><Data n=\"2\"><X>-0.500000</X><Y>1</Y></Data></Robot>"
    );
    channel.send("Log");
    assert_eq!(channel.take_outgoing(), b"<Log><Text/></Log>");
}

#[test]
fn what_is_sent_can_be_received() {
    let elements = r#"<ELEMENT Tag="T/S" Type="STRING"/><ELEMENT Tag="T/@a" Type="STRING"/>"#;
    let send = r#"<XML><ELEMENT Tag="T/S"/><ELEMENT Tag="T/@a"/></XML>"#;
    let mut robot = connected("", "", send);
    let mut peer = connected("", &format!("<XML>{elements}</XML>"), "");
    for text in ["<![CDATA[x]]>", "&lt;", "a'\"b", " \u{e4} "] {
        robot.set("T/S", ElementValue::String(text.into()));
        robot.set("T/@a", ElementValue::String(text.into()));
        robot.send("T");
        peer.receive(&robot.take_outgoing(), ms(0)).unwrap();
        for tag in ["T/S", "T/@a"] {
            let (value, _) = peer.get(tag, ElementType::String);
            assert_eq!(value, Some(ElementValue::String(text.into())));
        }
    }
}

#[test]
fn a_lock_keeps_bytes_back() {
    let mut channel = connected("<BUFFSIZE Limit=\"100\"/>", XML, "");
    channel.lock();
    channel
        .receive(b"<Plc><Speed>1</Speed></Plc>", ms(0))
        .unwrap();
    assert_eq!(channel.check_buffer("Plc/Speed").buff, 0);
    channel.unlock(ms(0)).unwrap();
    assert_eq!(channel.check_buffer("Plc/Speed").buff, 1);
    channel.lock();
    let error = channel.receive(&[b' '; 101], ms(0)).unwrap_err();
    assert_eq!(error.number(), 1281);
}

#[test]
fn a_frame_fills_attributes_that_are_elements_of_their_own() {
    let parts: Vec<_> = ["X", "Y", "Z", "A", "B", "C"]
        .iter()
        .map(|name| format!("<ELEMENT Tag=\"R/Pos/@{name}\"/>"))
        .collect();
    let mut channel = connected("", "", &format!("<XML>{}</XML>", parts.concat()));
    let frame = ElementValue::Frame([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    assert_eq!(channel.set("R/Pos", frame.clone()).message_number(), 0);
    channel.send("R");
    let text = String::from_utf8(channel.take_outgoing()).unwrap();
    assert_eq!(
        text,
        "<R><Pos X=\"1.000000\" Y=\"2.000000\" Z=\"3.000000\" A=\"4.000000\" B=\"5.000000\" C=\"6.000000\"/></R>"
    );
    let mut channel = connected("", "", &format!("<XML>{}</XML>", parts[..5].concat()));
    assert_eq!(channel.set("R/Pos", frame).message_number(), 14);
}
