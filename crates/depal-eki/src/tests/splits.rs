//! However the network cuts the stream, the memories are the same, and no bytes make the channel panic.

use proptest::prelude::*;

use super::{XML, connected, ms};
use crate::*;

const TAGS: [(&str, ElementType); 5] = [
    ("Plc/Speed", ElementType::Real),
    ("Plc/Part/Count", ElementType::Int),
    ("Plc/Part/@id", ElementType::String),
    ("Plc/Go", ElementType::Bool),
    ("Other/Text", ElementType::String),
];

/// Feeds pieces; gives all events, all values, and the end.
fn outcome(
    mut channel: Channel,
    stream: &[u8],
    cuts: &[usize],
) -> (Vec<Event>, Vec<Vec<ElementValue>>, Option<EkiError>) {
    let mut cuts: Vec<_> = cuts.iter().map(|cut| cut % (stream.len() + 1)).collect();
    cuts.push(0);
    cuts.push(stream.len());
    cuts.sort_unstable();
    let mut end = None;
    for pair in cuts.windows(2) {
        if let Err(error) = channel.receive(&stream[pair[0]..pair[1]], ms(0)) {
            end = Some(error);
            break;
        }
    }
    let events = channel.take_events();
    let mut values = Vec::new();
    channel.check_buffer("");
    for (tag, kind) in TAGS {
        values.push(channel.get_many(tag, kind, 999).0);
    }
    values.push(channel.get_many("In", ElementType::String, 999).0);
    (events, values, end)
}

fn document() -> impl Strategy<Value = String> {
    prop_oneof![
        (-1e6..1e6f64).prop_map(|v| format!("<Plc><Speed>{v}</Speed></Plc>\r\n")),
        any::<i32>().prop_map(|v| format!(
            "<?xml version='1.0'?><Plc><!-- <x> --><Part id='>\"'><Count>{v}</Count></Part><Go>0</Go></Plc>"
        )),
        "[a-z<>&\"']{0,9}".prop_map(|v| format!(
            "<Other><Text><![CDATA[{v}]]></Text></Other> "
        )),
        Just("<Other/>".to_owned()),
        Just("<Plc><Go>7</Go></Plc>".to_owned()),
    ]
}

/// Pieces of markup in any order: more nests and breaks than random bytes would.
fn markup() -> impl Strategy<Value = String> {
    let pieces = prop::sample::select(vec![
        "<",
        ">",
        "/",
        "</",
        "<Plc>",
        "</Plc>",
        "<Speed>",
        "</Speed>",
        "1.5",
        "nan",
        "\"",
        "'",
        "=",
        " a='1'",
        "<!--",
        "-->",
        "--",
        "<![CDATA[",
        "]]>",
        "<?",
        "?>",
        "<!DOCTYPE",
        "&amp;",
        "&x;",
        "&",
        "&#0;",
        "\u{e4}",
        "<Part id=",
        "\r\n",
        "<?xml version='1.0' encoding='x'?>",
        "<Other><Text/></Other>",
    ]);
    prop::collection::vec(pieces, 0..30).prop_map(|pieces| pieces.concat())
}

proptest! {
    #[test]
    fn xml_documents_do_not_feel_the_cuts(
        documents in prop::collection::vec(document(), 0..8),
        cuts in prop::collection::vec(any::<usize>(), 0..40),
    ) {
        let stream = documents.concat();
        let channel = connected("", XML, "");
        let whole = outcome(channel.clone(), stream.as_bytes(), &[]);
        prop_assert_eq!(&whole.2, &None);
        prop_assert_eq!(outcome(channel, stream.as_bytes(), &cuts), whole);
    }

    #[test]
    fn raw_records_do_not_feel_the_cuts(
        stream in prop::collection::vec(prop::sample::select(b"ab\r\n\0".to_vec()), 0..60),
        cuts in prop::collection::vec(any::<usize>(), 0..40),
    ) {
        for receive in [
            r#"<RAW><ELEMENT Tag="In" Type="BYTE" Size="5"/></RAW>"#,
            r#"<RAW><ELEMENT Tag="In" Type="STREAM" EOS="13,10"/></RAW>"#,
        ] {
            let channel = connected("<BUFFERING Limit=\"64\"/>", receive, "");
            let whole = outcome(channel.clone(), &stream, &[]);
            prop_assert_eq!(outcome(channel, &stream, &cuts), whole);
        }
    }

    #[test]
    fn bad_markup_ends_the_same_way_however_it_is_cut(
        stream in markup(),
        cuts in prop::collection::vec(any::<usize>(), 0..20),
    ) {
        let channel = connected("", XML, "");
        let whole = outcome(channel.clone(), stream.as_bytes(), &[]);
        prop_assert_eq!(outcome(channel, stream.as_bytes(), &cuts), whole);
    }

    #[test]
    fn no_bytes_make_it_panic(stream in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = outcome(connected("", XML, ""), &stream, &[]);
        let _ = ChannelConfig::read(&String::from_utf8_lossy(&stream));
    }

    #[test]
    fn no_markup_makes_a_file_panic(text in markup()) {
        let _ = ChannelConfig::read(&text);
        let _ = ChannelConfig::read(&super::file(&text, &text, &text));
    }
}
