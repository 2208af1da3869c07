use super::file;
use crate::*;

fn errors(text: &str) -> Vec<String> {
    let error = ChannelConfig::read(text).expect_err("a bad file");
    error.diagnostics.iter().map(ToString::to_string).collect()
}

#[test]
fn every_key_is_read() {
    let text = r#"<?xml version="1.0" encoding="UTF-8"?>
<!-- a robot that is the server -->
<ETHERNETKRL>
  <CONFIGURATION>
    <EXTERNAL><TYPE>Client</TYPE></EXTERNAL>
    <INTERNAL>
      <ENVIRONMENT>Submit</ENVIRONMENT>
      <BUFFERING Mode="LIFO" Limit="512"/>
      <BUFFSIZE Limit="65534"/>
      <TIMEOUT Connect="60000"/>
      <ALIVE Set_Flag="873" Set_Out="4" Ping="200"/>
      <IP>192.168.1.100</IP><PORT>54600</PORT>
      <PROTOCOL>TCP</PROTOCOL>
      <MESSAGES Logging="error" Display="disabled"/>
    </INTERNAL>
  </CONFIGURATION>
  <RECEIVE><RAW><ELEMENT Tag="Line" Type="STREAM" EOS="13,10" Set_Flag="2" Mode="FIFO"/></RAW></RECEIVE>
  <SEND><RAW><ELEMENT Tag="Out" Type="BYTE" Size="660"/></RAW></SEND>
</ETHERNETKRL>"#;
    let ReadConfig { config, warnings } = ChannelConfig::read(text).unwrap();
    assert_eq!(warnings, []);
    let flag = |number| SignalTarget {
        kind: SignalKind::Flag,
        number,
    };
    assert_eq!(
        config,
        ChannelConfig {
            peer: Peer::Client,
            external_ip: String::new(),
            external_port: 0,
            internal_ip: "192.168.1.100".into(),
            internal_port: 54600,
            environment: Environment::Submit,
            buffering: Buffering {
                mode: BufferMode::Lifo,
                limit: 512
            },
            buffer_bytes: 65534,
            connect_timeout_ms: 60000,
            alive: Alive {
                signals: vec![
                    flag(873),
                    SignalTarget {
                        kind: SignalKind::Output,
                        number: 4
                    }
                ],
                ping_s: Some(200)
            },
            show_errors: false,
            receive: ReceiveFormat::Raw(RawElement {
                tag: "Line".into(),
                size: None,
                end: vec![13, 10],
                signals: vec![flag(2)],
                mode: BufferMode::Fifo,
            }),
            send: SendFormat::Raw(RawElement {
                tag: "Out".into(),
                size: Some(660),
                end: vec![],
                signals: vec![],
                mode: BufferMode::Lifo,
            }),
        }
    );
}

#[test]
fn what_is_not_said_has_the_controllers_values() {
    let config = ChannelConfig::read(&file("", "", "")).unwrap().config;
    assert_eq!(config.external_ip, "10.0.0.2");
    assert_eq!(config.external_port, 50000);
    assert_eq!(
        (
            config.buffering.limit,
            config.buffer_bytes,
            config.connect_timeout_ms
        ),
        (16, 16384, 2000)
    );
    assert_eq!(config.environment, Environment::Program);
    assert_eq!(config.receive, ReceiveFormat::Nothing);
}

#[test]
fn errors_name_line_and_key() {
    let text = file(
        "\n<BUFFERING Limit=\"513\"/>\n<TIMEOUT Connect=\"x\"/>",
        "<RAW><ELEMENT Tag=\"R\" Type=\"BYTE\"/></RAW>",
        "<XML>\n<ELEMENT Tag=\"A/B\"/>\n<ELEMENT Tag=\"A/B\"/>\n<ELEMENT Tag=\"A//B\"/></XML>",
    );
    assert_eq!(
        errors(&text),
        [
            "line 5: CONFIGURATION/INTERNAL/BUFFERING/@Limit: expected a whole number from 1 to 512, found \"513\"",
            "line 6: CONFIGURATION/INTERNAL/TIMEOUT/@Connect: expected a whole number from 0 to 65534, found \"x\"",
            "line 8: RECEIVE/RAW/ELEMENT/@Size: missing: bytes of a record of Type BYTE",
            "line 11: SEND/XML/ELEMENT/@Tag: A/B is there twice",
            "line 12: SEND/XML/ELEMENT/@Tag: expected a path such as Root/Part/Name or Root/Part/@Attribute, found \"A//B\"",
        ]
    );
}

#[test]
fn a_server_to_connect_to_must_have_an_address() {
    assert_eq!(
        errors("<ETHERNETKRL/>"),
        ["line 1: CONFIGURATION/EXTERNAL/IP: missing: the address of the server to connect to"]
    );
    assert_eq!(
        errors(
            "\n<ETHERNETKRL><CONFIGURATION><EXTERNAL><TYPE>Client</TYPE></EXTERNAL></CONFIGURATION></ETHERNETKRL>"
        ),
        [
            "line 2: CONFIGURATION/INTERNAL/PORT: missing: the port to listen on, because EXTERNAL/TYPE is Client"
        ]
    );
}

#[test]
fn unknown_keys_are_warned_of() {
    let text = file("\n<Buffering Limit=\"1\"/><ALIVE Flag=\"1\"/>", "", "");
    let warnings = ChannelConfig::read(&text).unwrap().warnings;
    let lines: Vec<_> = warnings.iter().map(ToString::to_string).collect();
    assert_eq!(
        lines,
        [
            "line 5: CONFIGURATION/INTERNAL/Buffering: unknown element, ignored: names are case-sensitive, BUFFERING is meant",
            "line 5: CONFIGURATION/INTERNAL/ALIVE/@Flag: unknown attribute, ignored; known here: Set_Flag, Set_Out, Ping",
        ]
    );
}

#[test]
fn files_that_are_no_configuration() {
    assert_eq!(errors(""), ["line 1: no element"]);
    assert_eq!(
        errors("<HTML/>"),
        ["line 1: HTML: expected ETHERNETKRL as the root element"]
    );
    assert!(errors("<ETHERNETKRL>\n<A>\n</B></A></ETHERNETKRL>")[0].starts_with("line 3: "));
    assert_eq!(
        errors("<!DOCTYPE x><ETHERNETKRL/>"),
        ["line 1: DOCTYPE is refused"]
    );
    assert_eq!(
        errors("<ETHERNETKRL/>\n<ETHERNETKRL/>"),
        ["line 2: a second root element"]
    );
    assert_eq!(
        errors(&file("<PROTOCOL>UDP</PROTOCOL>", "", "")),
        ["line 4: CONFIGURATION/INTERNAL/PROTOCOL: UDP is not supported: only TCP"]
    );
    assert_eq!(
        errors(&file(
            "",
            "<RAW><ELEMENT Tag=\"A\" Type=\"BYTE\" Size=\"1\"/></RAW><XML><ELEMENT Tag=\"B\"/></XML>",
            ""
        )),
        ["line 6: RECEIVE/XML: only one of RAW and XML can have elements; line 6 has some, too"]
    );
}
