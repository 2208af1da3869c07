//! The languages that robot programs are written in.

use depal_controller::{SignalFamily, SignalKind};

/// A robot language.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Language {
    /// ABB RAPID: `.mod`, `.sys`, `.prg`, `.modx`, `.sysx`.
    Rapid,
    /// KUKA KRL: `.src`, `.dat`, `.sub`, and `.xml` for an Ethernet channel.
    Krl,
    /// FANUC TP: `.ls`.
    Tp,
}

impl Language {
    /// The language of a file, by the end of its name.
    pub fn of(path: &str) -> Option<Self> {
        let name = path.rsplit(['/', '\\']).next().unwrap_or(path);
        let (_, extension) = name.rsplit_once('.')?;
        match extension.to_ascii_lowercase().as_str() {
            "mod" | "sys" | "prg" | "modx" | "sysx" => Some(Self::Rapid),
            "src" | "dat" | "sub" | "xml" => Some(Self::Krl),
            "ls" => Some(Self::Tp),
            _ => None,
        }
    }

    /// For people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rapid => "RAPID",
            Self::Krl => "KRL",
            Self::Tp => "TP",
        }
    }

    /// The numbered signals that a controller of this language has without anybody defining them: none in RAPID.
    pub fn signal_families(self) -> Vec<SignalFamily> {
        use SignalKind::{AnalogInput, AnalogOutput, DigitalInput, DigitalOutput};
        let group_input = SignalKind::GroupInput { bits: 16 };
        let group_output = SignalKind::GroupOutput { bits: 16 };
        let rows: &[(&str, SignalKind, u32)] = match self {
            Self::Rapid => &[],
            Self::Krl => &[
                ("$IN", DigitalInput, 8192),
                ("$OUT", DigitalOutput, 8192),
                ("$ANIN", AnalogInput, 32),
                ("$ANOUT", AnalogOutput, 32),
            ],
            Self::Tp => &[
                ("DI", DigitalInput, 512),
                ("DO", DigitalOutput, 512),
                ("RI", DigitalInput, 8),
                ("RO", DigitalOutput, 8),
                ("UI", DigitalInput, 20),
                ("UO", DigitalOutput, 24),
                ("SI", DigitalInput, 16),
                ("SO", DigitalOutput, 16),
                ("GI", group_input, 100),
                ("GO", group_output, 100),
                ("AI", AnalogInput, 64),
                ("AO", AnalogOutput, 64),
            ],
        };
        let family = |&(name, kind, highest): &(&str, SignalKind, u32)| SignalFamily {
            name: name.to_owned(),
            kind,
            highest,
        };
        rows.iter().map(family).collect()
    }

    /// The interface module inside the program that robot programs of this language call, if they call one.
    pub(crate) fn embedded_module(self) -> &'static [&'static str] {
        match self {
            Self::Rapid => &["embedded:assets/rapid/MM_Module.mod"],
            Self::Krl => &[
                "embedded:assets/krl/mm_module.src",
                "embedded:assets/krl/mm_module.dat",
                "embedded:assets/krl/XML_Kuka_MMIND.xml",
            ],
            // The vision calls of TP are built in.
            Self::Tp => &[],
        }
    }
}
