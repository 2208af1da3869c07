//! Replays the transcripts in `tests/golden/wire` byte by byte, in virtual time and without sockets.
//!
//! Each transcript is played three times: as text, packed little-endian as written, and big-endian with
//! the bytes of every cell reversed. Lines:
//!
//! - `# ...` a comment; `-> KIND ...` what the robot sends; `<- KIND ...` the next reply, KIND `ascii` or `hex-le`
//!   (`\r` escaped; bytes in hexadecimal, `|` between cells, `+N` for N zeros);
//! - `! setup projects=ID:poses|path|custom[:RECIPE+RECIPE],... branches=STEP:EXITS,... [index=STEP:PLACES,...]
//!   [parameters=STEP:KEY:VALUE,...] [solutions=N,...] [variables=NAME:KIND,...] [inputs=PROJECT:STEP,...]
//!   [calibration=POSES]`; `! property LINE ; LINE ...` right after it;
//! - `! wait MS`; `! vision X,Y,Z,TURN,LABEL ...` (top faces, mm and degrees); `! vision error CODE`;
//! - `! waypoint joint|linear pose P6 joints J6 tool T velocity V label L [plan 21 values]`, then
//!   `! viz [outputs N ... | N ...]` (rounds) or `! viz error CODE`, or the same with `! vision path`;
//! - `! custom PORT=V,V|V,V ...` and `! sections N` for the next result; `! vision custom X,Y,Z,TURN,LABEL ...`;
//! - `! notify MESSAGE`; `! at branch STEP`; `! expect branch STEP exit EXIT`; `! expect index STEP at INDEX`;
//!   `! expect capture NUMBER`.
//!
//! Replies must come exactly where they stand: after every other line nothing may be left over.

mod notation;
mod player;

use std::path::Path;

use depal_interface::Encoding;

use notation::{bytes_of, readable};
use player::Player;

// Transcripts are files on purpose: they are read by people and shared with other tests.
#[allow(clippy::disallowed_methods)]
#[test]
fn transcripts_replay_byte_by_byte() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden/wire");
    let mut files: Vec<_> = std::fs::read_dir(&folder)
        .expect("folder of transcripts")
        .map(|entry| entry.expect("entry").path())
        .collect();
    files.sort();
    let names: Vec<String> = files
        .iter()
        .map(|file| {
            file.file_name()
                .expect("name")
                .to_string_lossy()
                .into_owned()
        })
        .collect();
    for command in depal_wire::Request::CODES {
        let head = format!("{command}_");
        assert!(
            names.iter().any(|name| name.starts_with(&head)),
            "no transcript of {command}"
        );
    }
    for dialogue in ["a", "b", "c", "d", "e", "f"] {
        let head = format!("dialogue_{dialogue}_");
        assert!(
            names.iter().any(|name| name.starts_with(&head)),
            "no dialogue {dialogue}"
        );
    }
    for (file, name) in files.iter().zip(&names) {
        let text = std::fs::read_to_string(file).expect("readable transcript");
        for encoding in [
            Encoding::Ascii,
            Encoding::HexLittleEndian,
            Encoding::HexBigEndian,
        ] {
            play(name, &text, encoding);
        }
    }
}

fn play(name: &str, text: &str, encoding: Encoding) {
    let mut player: Option<Player> = None;
    for (number, line) in text.lines().enumerate() {
        let place = format!("{name}:{} ({})", number + 1, encoding.name());
        let (mark, rest) = line.split_once(' ').unwrap_or((line, ""));
        match mark {
            "" | "#" => {}
            "!" if rest.starts_with("setup ") => player = Some(Player::new(rest, "", encoding)),
            "!" if rest.starts_with("property ") => {
                let setup = player.expect("setup comes first").setup;
                let lines = rest["property ".len()..].replace(';', "\n");
                player = Some(Player::new(&setup, &lines, encoding));
            }
            "!" => {
                let player = player.as_mut().expect("setup comes first");
                player.settle(&place);
                player.act(rest, &place);
            }
            "->" | "<-" => {
                let player = player.as_mut().expect("setup comes first");
                let Some(bytes) = bytes_of(rest, encoding) else {
                    continue;
                };
                if mark == "->" {
                    player.settle(&place);
                    player.send(&bytes);
                } else {
                    let reply = player.replies.pop_front();
                    assert_eq!(reply.map(readable), Some(readable(bytes)), "{place}");
                }
            }
            _ => panic!("{place}: {line}"),
        }
    }
    player.expect("a setup line").settle(name);
}
