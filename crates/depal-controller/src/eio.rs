use crate::configuration::{ConfigurationError, Entry, entries, required};
use crate::{CrossConnection, SignalKind, SignalSpec};

/// What an I/O configuration file of a controller backup (EIO.cfg) says about signals.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct EioConfiguration {
    /// The signals of `EIO_SIGNAL`, in the order of the file.
    pub signals: Vec<SignalSpec>,
    /// The cross connections of `EIO_CROSS`.
    pub connections: Vec<CrossConnection>,
}

impl EioConfiguration {
    /// Reads the text of an EIO.cfg. Sections other than `EIO_SIGNAL` and `EIO_CROSS` are passed over.
    ///
    /// # Errors
    /// All entries that cannot be understood.
    pub fn parse(text: &str) -> Result<Self, Vec<ConfigurationError>> {
        let mut read = Self::default();
        let mut lines = std::collections::BTreeMap::new();
        let mut connected = Vec::new();
        let mut errors = Vec::new();
        for entry in entries(text, "EIO")? {
            let result = match entry.section.as_str() {
                "EIO_SIGNAL" => signal(&entry).and_then(|s| {
                    let key = s.name.to_lowercase();
                    if let Some(first) = lines.insert(key, entry.line) {
                        return Err(format!(
                            "signal {} is defined already in line {first}",
                            s.name
                        ));
                    }
                    read.signals.push(s);
                    Ok(())
                }),
                "EIO_CROSS" => connection(&entry).map(|c| {
                    connected.push(entry.line);
                    read.connections.push(c);
                }),
                _ => Ok(()),
            };
            if let Err(message) = result {
                errors.push(ConfigurationError {
                    line: entry.line,
                    message,
                });
            }
        }
        for (connection, line) in read.connections.iter().zip(connected) {
            let actors = connection.actors.iter().map(|(name, _)| name);
            for name in std::iter::once(&connection.result).chain(actors) {
                if !lines.contains_key(&name.to_lowercase()) {
                    errors.push(ConfigurationError {
                        line,
                        message: format!("the cross connection to {} names the signal {name}, which is not defined", connection.result),
                    });
                }
            }
        }
        errors.sort_by_key(|error| error.line);
        if errors.is_empty() {
            Ok(read)
        } else {
            Err(errors)
        }
    }
}

fn signal(entry: &Entry) -> Result<SignalSpec, String> {
    let name = required(entry, "Name")?;
    let kind = required(entry, "SignalType")?;
    let bits = || group_bits(entry.fields.get("devicemap").map(String::as_str), name);
    let kind = match kind.to_uppercase().as_str() {
        "DI" => SignalKind::DigitalInput,
        "DO" => SignalKind::DigitalOutput,
        "GI" => SignalKind::GroupInput { bits: bits()? },
        "GO" => SignalKind::GroupOutput { bits: bits()? },
        "AI" => SignalKind::AnalogInput,
        "AO" => SignalKind::AnalogOutput,
        other => {
            return Err(format!(
                "signal {name}: -SignalType is {other}, expected DI, DO, GI, GO, AI or AO"
            ));
        }
    };
    let initial = match entry.fields.get("default") {
        None => 0.0,
        Some(text) => text
            .parse()
            .map_err(|_| format!("signal {name}: -Default is {text:?}, expected a number"))?,
    };
    Ok(SignalSpec {
        name: name.to_owned(),
        kind,
        initial,
    })
}

/// Number of bits of a map such as `0-3,5`. A group without a map is simulated with 23 bits, as many as a
/// group of the older controllers may have.
fn group_bits(map: Option<&str>, name: &str) -> Result<u8, String> {
    let Some(map) = map.filter(|map| !map.is_empty()) else {
        return Ok(23);
    };
    let wrong = || format!("signal {name}: -DeviceMap is {map:?}, expected bits such as 0-3,5");
    let mut bits = 0u32;
    for part in map.split(',') {
        let (first, last) = part.split_once('-').unwrap_or((part, part));
        let first: u32 = first.trim().parse().map_err(|_| wrong())?;
        let last: u32 = last.trim().parse().map_err(|_| wrong())?;
        bits = bits.saturating_add(first.abs_diff(last).saturating_add(1));
    }
    u8::try_from(bits)
        .ok()
        .filter(|bits| (1..=32).contains(bits))
        .ok_or_else(|| format!("signal {name} has {bits} bits, expected 1 to 32"))
}

fn connection(entry: &Entry) -> Result<CrossConnection, String> {
    let flag = |key: &str| entry.fields.contains_key(key);
    let mut connection = CrossConnection {
        result: required(entry, "Res")?.to_owned(),
        actors: vec![(required(entry, "Act1")?.to_owned(), flag("act1_invert"))],
        any: Vec::new(),
    };
    for index in 2..=5 {
        let Some(actor) = entry.fields.get(&format!("act{index}")) else {
            break;
        };
        let operator = entry
            .fields
            .get(&format!("oper{}", index - 1))
            .map_or("AND", String::as_str);
        connection.any.push(match operator.to_uppercase().as_str() {
            "AND" => false,
            "OR" => true,
            other => {
                return Err(format!("-Oper{} is {other}, expected AND or OR", index - 1));
            }
        });
        let inverted = flag(&format!("act{index}_invert"));
        connection.actors.push((actor.clone(), inverted));
    }
    Ok(connection)
}
