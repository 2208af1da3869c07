mod config;
mod faults;
mod raw;
mod splits;
mod xml;

use depal_time::{SimDuration, SimTime};

use crate::{Channel, ChannelConfig};

/// A file with these sections.
fn file(internal: &str, receive: &str, send: &str) -> String {
    format!(
        "<ETHERNETKRL>\n<CONFIGURATION>\n<EXTERNAL><IP>10.0.0.2</IP><PORT>50000</PORT></EXTERNAL>\n\
         <INTERNAL>{internal}</INTERNAL>\n</CONFIGURATION>\n<RECEIVE>{receive}</RECEIVE>\n<SEND>{send}</SEND>\n</ETHERNETKRL>"
    )
}

fn connected(internal: &str, receive: &str, send: &str) -> Channel {
    let read = ChannelConfig::read(&file(internal, receive, send)).expect("a good file");
    assert_eq!(read.warnings, []);
    let mut channel = Channel::new(read.config);
    channel.connect(SimTime::ZERO);
    channel
}

const XML: &str = r#"<XML>
    <ELEMENT Tag="Plc/Speed" Type="REAL"/>
    <ELEMENT Tag="Plc/Part/Count" Type="INT"/>
    <ELEMENT Tag="Plc/Part/@id" Type="STRING"/>
    <ELEMENT Tag="Plc/Go" Type="BOOL"/>
    <ELEMENT Tag="Plc/Pos" Type="FRAME"/>
    <ELEMENT Tag="Plc" Set_Flag="7"/>
    <ELEMENT Tag="Other/Text" Type="STRING" Set_Out="12"/>
</XML>"#;

fn ms(milliseconds: u64) -> SimTime {
    SimTime::ZERO + SimDuration::from_millis(milliseconds)
}
