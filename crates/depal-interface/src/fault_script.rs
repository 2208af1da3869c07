//! Faults on demand: what a user writes, and what it means.
//!
//! A fault is `NAME[=VALUE][@KEY=VALUE,...]`; several are separated by `;`.
//!
//! | Fault | Effect |
//! |---|---|
//! | `no_points@pick=4` | the fourth picture shows no carton; without `pick`: every picture |
//! | `camera_lost@t=10s` | from then on no picture can be taken |
//! | `status=1019@command=102,n=2` | the second 102 is answered with 1019 and does nothing; without `n`: every 102 |
//! | `delay=12s@command=205` | a 205 is carried out as ever, but its reply leaves 12 s later |
//! | `drop_connection@reply=7` | instead of the seventh reply the connection is closed |
//! | `split_replies` | every reply leaves in three pieces, one tick apart |
//!
//! `delay`, `drop_connection` and `split_replies` take `reply=N` (the N-th reply of the port),
//! `command=C` (every reply to that command) or `command=C,n=N` (the N-th of them).
//! Every port counts for itself, over all its connections, from 1. Times are simulated time.

use depal_time::{SimDuration, SimTime};
use depal_wire::{Request, Status};

/// Longest time that a fault may name, seconds: a day.
const LONGEST_TIME_S: f64 = 86_400.0;
/// Names less alike than this are not suggested.
const LIKENESS: f64 = 0.7;

/// The faults of a server, in the order in which they were written.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FaultScript {
    pub(crate) faults: Vec<Fault>,
}

/// One fault.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Fault {
    pub(crate) effect: Effect,
    /// As the user wrote it.
    pub(crate) text: String,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Effect {
    NoPoints { pick: Option<u32> },
    CameraLost { from: SimTime },
    Status { status: Status, on: Occasion },
    Delay { time: SimDuration, on: Occasion },
    DropConnection { on: Occasion },
    SplitReplies { on: Occasion },
}

/// Which commands or replies a fault hits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Occasion {
    /// Only this command's.
    pub(crate) command: Option<i32>,
    /// Only the n-th of them, from 1.
    pub(crate) n: Option<u32>,
}

/// What is wrong with a fault as it was written.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("fault {fault:?}: {part}: expected {expected}, found {found}{}", hint.as_ref().map_or(String::new(), |h| format!("; {h}")))]
pub struct FaultError {
    /// The fault.
    pub fault: String,
    /// The part of it that is wrong.
    pub part: String,
    /// What may stand there.
    pub expected: String,
    /// What stands there.
    pub found: String,
    /// The nearest right word, or what to add.
    pub hint: Option<String>,
}

/// A kind of fault: its name, the value before the `@`, the keys after it.
struct Kind {
    name: &'static str,
    value: Option<&'static str>,
    keys: &'static [&'static str],
}

const KINDS: [Kind; 6] = [
    Kind {
        name: "no_points",
        value: None,
        keys: &["pick"],
    },
    Kind {
        name: "camera_lost",
        value: None,
        keys: &["t"],
    },
    Kind {
        name: "status",
        value: Some("an error code, as in status=1019@command=102"),
        keys: &["command", "n"],
    },
    Kind {
        name: "delay",
        value: Some("a time, as in delay=12s"),
        keys: &["command", "n", "reply"],
    },
    Kind {
        name: "drop_connection",
        value: None,
        keys: &["command", "n", "reply"],
    },
    Kind {
        name: "split_replies",
        value: None,
        keys: &["command", "n", "reply"],
    },
];

impl FaultScript {
    /// Reads faults; each text may hold several, separated by `;`.
    pub fn parse<T: AsRef<str>>(texts: &[T]) -> Result<Self, FaultError> {
        let mut script = Self::default();
        for text in texts {
            let parts: Vec<&str> = text.as_ref().split(';').map(str::trim).collect();
            if parts.iter().all(|part| part.is_empty()) {
                return Err(Written { fault: "" }.error("name", &names(), "nothing"));
            }
            for fault in parts.into_iter().filter(|part| !part.is_empty()) {
                script.faults.push(Fault {
                    effect: Written { fault }.effect()?,
                    text: fault.to_owned(),
                });
            }
        }
        Ok(script)
    }

    /// Adds the faults of another script behind these.
    pub fn extend(&mut self, other: Self) {
        self.faults.extend(other.faults);
    }

    /// Whether nothing shall go wrong.
    pub fn is_empty(&self) -> bool {
        self.faults.is_empty()
    }
}

fn names() -> String {
    format!("one of {}", KINDS.map(|kind| kind.name).join(", "))
}

/// One fault while it is read.
struct Written<'a> {
    fault: &'a str,
}

/// The keys behind the `@`.
type Keys<'a> = Vec<(&'a str, &'a str)>;

impl<'a> Written<'a> {
    fn error(&self, part: &str, expected: &str, found: &str) -> FaultError {
        FaultError {
            fault: self.fault.to_owned(),
            part: part.to_owned(),
            expected: expected.to_owned(),
            found: found.to_owned(),
            hint: None,
        }
    }

    fn effect(&self) -> Result<Effect, FaultError> {
        let (head, when) = match self.fault.split_once('@') {
            Some((head, when)) => (head.trim(), Some(when)),
            None => (self.fault, None),
        };
        let (name, value) = match head.split_once('=') {
            Some((name, value)) => (name.trim(), Some(value.trim())),
            None => (head, None),
        };
        let kind = KINDS
            .iter()
            .find(|kind| kind.name == name)
            .ok_or_else(|| FaultError {
                hint: nearest(name, &KINDS.map(|kind| kind.name)),
                ..self.error("name", &names(), &quoted(name))
            })?;
        let value = match (kind.value, value) {
            (None, Some(value)) => {
                return Err(self.error(name, "no value", &quoted(value)));
            }
            (Some(expected), None | Some("")) => {
                return Err(self.error(name, expected, "nothing"));
            }
            (_, value) => value.unwrap_or_default(),
        };
        let keys = self.keys(kind, when)?;
        Ok(match name {
            "no_points" => Effect::NoPoints {
                pick: self.count("pick", &keys)?,
            },
            "camera_lost" => Effect::CameraLost {
                from: match of("t", &keys) {
                    Some(text) => SimTime::ZERO + self.time("t", text)?,
                    None => SimTime::ZERO,
                },
            },
            "status" => Effect::Status {
                status: self.status(value)?,
                on: self.occasion(&keys, true)?,
            },
            "delay" => Effect::Delay {
                time: self.time("delay", value)?,
                on: self.occasion(&keys, false)?,
            },
            "drop_connection" => Effect::DropConnection {
                on: self.occasion(&keys, true)?,
            },
            _ => Effect::SplitReplies {
                on: self.occasion(&keys, false)?,
            },
        })
    }

    fn keys(&self, kind: &Kind, when: Option<&'a str>) -> Result<Keys<'a>, FaultError> {
        let mut keys: Keys<'a> = Vec::new();
        let allowed = match kind.keys {
            [only] => format!("{only}=..."),
            several => format!("one of {}", several.join(", ")),
        };
        for part in when.into_iter().flat_map(|when| when.split(',')) {
            let part = part.trim();
            let (key, value) = part
                .split_once('=')
                .map(|(key, value)| (key.trim(), value.trim()))
                .ok_or_else(|| self.error("after @", "KEY=VALUE", &quoted(part)))?;
            if !kind.keys.contains(&key) {
                return Err(FaultError {
                    hint: nearest(key, kind.keys),
                    ..self.error("key", &allowed, &quoted(key))
                });
            }
            if of(key, &keys).is_some() {
                return Err(self.error(key, "it once", "it twice"));
            }
            keys.push((key, value));
        }
        Ok(keys)
    }

    fn occasion(&self, keys: &Keys<'_>, is_needed: bool) -> Result<Occasion, FaultError> {
        let command = of("command", keys)
            .map(|text| self.command(text))
            .transpose()?;
        let (n, reply) = (self.count("n", keys)?, self.count("reply", keys)?);
        match (command, n, reply) {
            (None, None, None) if is_needed => Err(self.error(
                "after @",
                "which command or reply it hits, as in @command=102",
                "nothing",
            )),
            (None, Some(n), _) => Err(self.error(
                "n",
                "the command that it counts, as in command=102,n=2",
                &format!("n={n} alone"),
            )),
            (Some(_), _, Some(_)) => Err(self.error("reply", "it without command", "both")),
            (command, n, reply) => Ok(Occasion {
                command,
                n: n.or(reply),
            }),
        }
    }

    fn command(&self, text: &str) -> Result<i32, FaultError> {
        let code = text.parse().ok().filter(|code| Request::is_known(*code));
        code.ok_or_else(|| {
            let known: Vec<String> = Request::CODES.iter().map(i32::to_string).collect();
            let expected = format!("a command, one of {}", known.join(", "));
            self.error("command", &expected, &quoted(text))
        })
    }

    fn count(&self, key: &str, keys: &Keys<'_>) -> Result<Option<u32>, FaultError> {
        of(key, keys)
            .map(|text| {
                let count = text.parse().ok().filter(|count| *count > 0);
                count.ok_or_else(|| self.error(key, "a whole number from 1", &quoted(text)))
            })
            .transpose()
    }

    fn status(&self, text: &str) -> Result<Status, FaultError> {
        let expected = "the code of an error in the interface's table, as in 1019";
        let status = text.parse().ok().and_then(Status::from_code);
        match status {
            Some(status) if status.is_success() => {
                let found = format!("{text}, which is a success ({})", status.meaning());
                Err(self.error("status", expected, &found))
            }
            Some(status) => Ok(status),
            None => Err(self.error("status", expected, &quoted(text))),
        }
    }

    fn time(&self, part: &str, text: &str) -> Result<SimDuration, FaultError> {
        let units = [("ms", 1e-3), ("min", 60.0), ("s", 1.0)];
        let seconds = units.iter().find_map(|(unit, scale)| {
            let number: f64 = text.strip_suffix(unit)?.trim_end().parse().ok()?;
            Some(number * scale)
        });
        let seconds = seconds.filter(|seconds| (0.0..=LONGEST_TIME_S).contains(seconds));
        let expected = "a time of at most a day with its unit, as in 12s, 500ms or 2min";
        seconds
            .map(SimDuration::from_secs_f64)
            .ok_or_else(|| self.error(part, expected, &quoted(text)))
    }
}

fn of<'a>(key: &str, keys: &Keys<'a>) -> Option<&'a str> {
    keys.iter()
        .find(|(name, _)| *name == key)
        .map(|(_, value)| *value)
}

fn quoted(text: &str) -> String {
    if text.is_empty() {
        "nothing".to_owned()
    } else {
        format!("{text:?}")
    }
}

/// The word that was most likely meant.
fn nearest(word: &str, known: &[&str]) -> Option<String> {
    known
        .iter()
        .map(|candidate| (strsim::jaro_winkler(word, candidate), *candidate))
        .filter(|(likeness, _)| *likeness >= LIKENESS)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| format!("did you mean {candidate:?}?"))
}
