use std::collections::BTreeMap;

use depal_time::SimTime;
use depal_vm::system::Fault;

use crate::ControllerError;

/// What a signal carries and who sets it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SignalKind {
    /// 0 or 1, set by the cell.
    DigitalInput,
    /// 0 or 1, set by the program.
    DigitalOutput,
    /// An unsigned number of so many bits, set by the cell.
    GroupInput {
        /// 1 to 32.
        bits: u8,
    },
    /// An unsigned number of so many bits, set by the program.
    GroupOutput {
        /// 1 to 32.
        bits: u8,
    },
    /// Any finite number, set by the cell.
    AnalogInput,
    /// Any finite number, set by the program.
    AnalogOutput,
}

impl SignalKind {
    /// Whether the cell sets it.
    pub fn is_input(self) -> bool {
        matches!(
            self,
            Self::DigitalInput | Self::GroupInput { .. } | Self::AnalogInput
        )
    }

    pub(crate) fn check(self, value: f64) -> Result<(), String> {
        let highest = match self {
            Self::DigitalInput | Self::DigitalOutput => 1.0,
            Self::GroupInput { bits } | Self::GroupOutput { bits } => {
                2f64.powi(i32::from(bits)) - 1.0
            }
            Self::AnalogInput | Self::AnalogOutput => {
                return if value.is_finite() {
                    Ok(())
                } else {
                    Err(format!("{value} is not a finite number"))
                };
            }
        };
        if value.fract() == 0.0 && (0.0..=highest).contains(&value) {
            Ok(())
        } else {
            Err(format!("{value} is not a whole number from 0 to {highest}"))
        }
    }
}

/// The definition of a signal.
#[derive(Debug, Clone, PartialEq)]
pub struct SignalSpec {
    /// Unique, whatever the case of its letters.
    pub name: String,
    /// What it carries.
    pub kind: SignalKind,
    /// Value at the start.
    pub initial: f64,
}

impl SignalSpec {
    /// A signal that starts at 0.
    pub fn new(name: &str, kind: SignalKind) -> Self {
        Self {
            name: name.to_owned(),
            kind,
            initial: 0.0,
        }
    }
}

/// Numbered signals that exist without being defined one by one, as in `$OUT[7]`. They start at 0.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SignalFamily {
    /// What stands before the number in brackets, `$OUT`.
    pub name: String,
    /// What each of them carries.
    pub kind: SignalKind,
    /// They are numbered from 1 to this.
    pub highest: u32,
}

impl SignalFamily {
    /// Whether a signal of this name belongs to the family.
    pub fn has(&self, name: &str) -> bool {
        let number = name.strip_suffix(']').and_then(|rest| rest.split_once('['));
        let Some((family, number)) = number else {
            return false;
        };
        let is_number = !number.starts_with(['0', '+']);
        family.eq_ignore_ascii_case(&self.name)
            && is_number
            && number
                .parse::<u32>()
                .is_ok_and(|number| number <= self.highest)
    }
}

/// A signal with its value.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// Its definition.
    pub spec: SignalSpec,
    /// Now.
    pub value: f64,
    /// Last change.
    pub changed_at: SimTime,
}

/// A signal that follows others, whoever sets it otherwise.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CrossConnection {
    /// The digital signal that follows.
    pub result: String,
    /// The signals that it follows, each with whether it is inverted. Never empty.
    pub actors: Vec<(String, bool)>,
    /// Between one actor and the next: `true` either, `false` both. Taken from left to right.
    pub any: Vec<bool>,
}

/// All signals by name in lower case.
#[derive(Debug, Clone)]
pub(crate) struct SignalTable {
    signals: BTreeMap<String, Signal>,
    connections: Vec<CrossConnection>,
    /// Families, each with a signal that stands for those which nobody has set.
    families: Vec<(SignalFamily, Signal)>,
}

impl SignalTable {
    pub fn new(specs: &[SignalSpec]) -> Result<Self, ControllerError> {
        let mut signals = BTreeMap::new();
        for spec in specs {
            let name = spec.name.clone();
            if let SignalKind::GroupInput { bits } | SignalKind::GroupOutput { bits } = spec.kind
                && !(1..=32).contains(&bits)
            {
                return Err(ControllerError::GroupWidth { name, bits });
            }
            if let Err(message) = spec.kind.check(spec.initial) {
                return Err(ControllerError::InitialValue { name, message });
            }
            let signal = Signal {
                spec: spec.clone(),
                value: spec.initial,
                changed_at: SimTime::ZERO,
            };
            if signals.insert(key(&name), signal).is_some() {
                return Err(ControllerError::DuplicateSignal { name });
            }
        }
        Ok(Self {
            signals,
            connections: Vec::new(),
            families: Vec::new(),
        })
    }

    /// Adds numbered signals. One that is defined by itself stays as it is.
    pub fn add_families(&mut self, families: &[SignalFamily]) {
        for family in families {
            let unset = Signal {
                spec: SignalSpec::new(&family.name, family.kind),
                value: 0.0,
                changed_at: SimTime::ZERO,
            };
            self.families.push((family.clone(), unset));
        }
    }

    fn family(&self, name: &str) -> Option<&(SignalFamily, Signal)> {
        self.families.iter().find(|(family, _)| family.has(name))
    }

    /// Adds connections between signals that are there.
    pub fn connect(&mut self, connections: &[CrossConnection]) -> Result<(), ControllerError> {
        for connection in connections {
            let actors = connection.actors.iter().map(|(name, _)| name);
            for name in std::iter::once(&connection.result).chain(actors) {
                if !self.signals.contains_key(&key(name)) {
                    return Err(ControllerError::CrossConnection {
                        result: connection.result.clone(),
                        name: name.clone(),
                    });
                }
            }
        }
        self.connections.extend_from_slice(connections);
        Ok(())
    }

    /// Brings the connected signals up to date; name and value of those that changed.
    /// A ring of connections is followed once around at most, so that it cannot go on for ever.
    pub fn follow(&mut self, at: SimTime) -> Vec<(String, f64)> {
        let mut changed = Vec::new();
        for _ in 0..self.connections.len() {
            let before = changed.len();
            for connection in &self.connections {
                let actor = |(name, inverted): &(String, bool)| {
                    self.signals
                        .get(&key(name))
                        .is_some_and(|signal| (signal.value != 0.0) != *inverted)
                };
                let mut value = connection.actors.first().is_some_and(actor);
                for (next, any) in connection.actors.iter().skip(1).zip(&connection.any) {
                    let next = actor(next);
                    value = if *any { value || next } else { value && next };
                }
                let value = f64::from(u8::from(value));
                if let Some(signal) = self.signals.get_mut(&key(&connection.result))
                    && signal.value != value
                {
                    signal.value = value;
                    signal.changed_at = at;
                    changed.push((signal.spec.name.clone(), value));
                }
            }
            if changed.len() == before {
                break;
            }
        }
        changed
    }

    pub fn iter(&self) -> impl Iterator<Item = &Signal> {
        self.signals.values()
    }

    pub fn get(&self, name: &str) -> Result<&Signal, Fault> {
        self.signals
            .get(&key(name))
            .or_else(|| self.family(name).map(|(_, unset)| unset))
            .ok_or_else(|| Fault::UnknownSignal(name.to_owned()))
    }

    /// Sets a signal from the side of the cell (`input`) or of the program; whether it changed.
    pub fn set(
        &mut self,
        at: SimTime,
        name: &str,
        value: f64,
        input: bool,
    ) -> Result<Option<&Signal>, Fault> {
        let kind = self.get(name)?.spec.kind;
        let fault = |message| Fault::SignalValue {
            signal: name.to_owned(),
            message,
        };
        if kind.is_input() != input {
            return Err(fault(
                if input {
                    "is an output of the robot, the cell cannot set it"
                } else {
                    "is an input of the robot, the program cannot set it"
                }
                .to_owned(),
            ));
        }
        kind.check(value).map_err(fault)?;
        let signal = self.own(name)?;
        if signal.value == value {
            return Ok(None);
        }
        signal.value = value;
        signal.changed_at = at;
        Ok(Some(signal))
    }

    /// The signal itself; one of a family becomes a signal of its own.
    fn own(&mut self, name: &str) -> Result<&mut Signal, Fault> {
        let key = key(name);
        if !self.signals.contains_key(&key)
            && let Some((family, unset)) = self.family(name)
        {
            let mut signal = unset.clone();
            let number = &name[family.name.len()..];
            signal.spec.name = format!("{}{number}", family.name);
            self.signals.insert(key.clone(), signal);
        }
        self.signals
            .get_mut(&key)
            .ok_or_else(|| Fault::UnknownSignal(name.to_owned()))
    }
}

fn key(name: &str) -> String {
    name.to_lowercase()
}
