//! The text of a description: where its elements stand, and what is wrong with its tags and attributes.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use quick_xml::{
    Reader,
    events::{BytesStart, Event},
};

use crate::ArmError;

mod grammar;

use grammar::{ATTRIBUTES, Kind, NEEDED, ONCE, SHAPES};

/// Elements inside each other beyond this are refused.
const DEEPEST: usize = 64;

/// A file, and a line in it where one is known. Reads `arm.urdf:12`, or `arm.urdf`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Place {
    /// Name of the source.
    pub file: String,
    /// From 1.
    pub line: Option<usize>,
}

impl Place {
    /// A whole file.
    pub(crate) fn file(name: &str) -> Self {
        Self {
            file: name.to_owned(),
            line: None,
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{}:{line}", self.file),
            None => f.write_str(&self.file),
        }
    }
}

/// An element that is not closed yet.
struct Open {
    tag: String,
    line: usize,
    /// Names of the elements from below `<robot>` on, `visual` and `collision` both as `BODY`.
    path: String,
    /// As messages call it.
    called: String,
    children: Vec<String>,
}

/// Where the elements of a description stand.
#[derive(Debug, Clone)]
pub(crate) struct Source {
    file: String,
    /// By the words with which messages name an element.
    lines: BTreeMap<String, usize>,
}

impl Source {
    /// Reads the tags.
    ///
    /// # Errors
    /// What an XML reader, or the table of attributes above, finds wrong.
    pub fn read(file: &str, text: &str) -> Result<Self, ArmError> {
        let mut source = Self {
            file: file.to_owned(),
            lines: BTreeMap::new(),
        };
        let mut reader = Reader::from_str(text);
        let mut open: Vec<Open> = Vec::new();
        let (mut line, mut counted) = (1, 0);
        let mut is_robot = false;
        loop {
            let start = (reader.buffer_position() as usize).min(text.len());
            let passed = text.get(counted..start).unwrap_or_default();
            line += passed.matches('\n').count();
            counted = start;
            let event = reader
                .read_event()
                .map_err(|e| source.unreadable(line, e.to_string()))?;
            match &event {
                Event::Start(tag) | Event::Empty(tag) => {
                    is_robot |= open.is_empty();
                    let element = source.element(tag, line, &mut open)?;
                    if matches!(event, Event::Empty(_)) {
                        source.whole(&element)?;
                    } else if open.len() > DEEPEST {
                        let reason = format!("more than {DEEPEST} elements inside each other");
                        return Err(source.unreadable(line, reason));
                    } else {
                        open.push(element);
                    }
                }
                Event::End(_) => {
                    if let Some(done) = open.pop() {
                        source.whole(&done)?;
                    }
                }
                Event::Eof => break,
                _ => {}
            }
        }
        if let Some(last) = open.last() {
            let reason = format!("<{}> is not closed; expected </{}>", last.tag, last.tag);
            return Err(source.unreadable(last.line, reason));
        }
        if !is_robot {
            return Err(source.unreadable(1, "no <robot> in it".to_owned()));
        }
        Ok(source)
    }

    /// The place of an element, as messages name it; words behind that (an attribute) do not matter.
    pub fn at(&self, element: &str) -> Place {
        let mut words = element.trim_end_matches(':');
        loop {
            if let Some(&line) = self.lines.get(words) {
                return Place {
                    file: self.file.clone(),
                    line: Some(line),
                };
            }
            match words.rsplit_once(' ') {
                Some((front, _)) => words = front.trim_end_matches(':'),
                None => return Place::file(&self.file),
            }
        }
    }

    fn unreadable(&self, line: usize, reason: String) -> ArmError {
        ArmError::Unreadable {
            at: Place {
                file: self.file.clone(),
                line: Some(line),
            },
            reason,
        }
    }

    fn malformed(&self, line: usize, element: &str, reason: String) -> ArmError {
        ArmError::Malformed {
            at: Place {
                file: self.file.clone(),
                line: Some(line),
            },
            element: element.to_owned(),
            reason,
        }
    }

    /// One tag: its place is noted, its attributes are looked at.
    fn element(
        &mut self,
        tag: &BytesStart,
        line: usize,
        open: &mut [Open],
    ) -> Result<Open, ArmError> {
        let name = String::from_utf8_lossy(tag.name().as_ref()).into_owned();
        let mut attributes: BTreeMap<String, String> = BTreeMap::new();
        for attribute in tag.attributes() {
            let attribute =
                attribute.map_err(|e| self.unreadable(line, format!("<{name}>: {e}")))?;
            let value = String::from_utf8_lossy(&attribute.value).into_owned();
            let key = String::from_utf8_lossy(attribute.key.as_ref()).into_owned();
            attributes.insert(key, value);
        }
        let in_text = open
            .get(1)
            .is_none_or(|top| matches!(top.tag.as_str(), "link" | "joint"));
        let is_macro = attributes.values().any(|v| v.contains("${")) && in_text;
        if is_macro || name.starts_with("xacro:") {
            let reason = format!(
                "<{name}> is a macro of xacro; expand the file first: xacro {} > arm.urdf",
                self.file
            );
            return Err(self.unreadable(line, reason));
        }
        let Some(parent) = open.last_mut() else {
            if name != "robot" {
                let reason = format!("the file begins with <{name}>; expected <robot>");
                return Err(self.unreadable(line, reason));
            }
            self.lines.insert("<robot>".to_owned(), line);
            return Ok(Open {
                tag: name,
                line,
                path: String::new(),
                called: String::new(),
                children: Vec::new(),
            });
        };
        parent.children.push(name.clone());
        let nth = parent.children.iter().filter(|c| **c == name).count();
        let part = match name.as_str() {
            "visual" | "collision" => "BODY",
            other => other,
        };
        let path = match parent.path.as_str() {
            "" => part.to_owned(),
            above => format!("{above}/{part}"),
        };
        let called = match (parent.called.as_str(), attributes.get("name")) {
            ("", Some(own)) => format!("{name} '{own}'"),
            ("", None) => format!("<{name}>"),
            // What holds the shape is not worth a word.
            (above, _) if name == "geometry" => above.to_owned(),
            (above, _) if name == "mass" || name == "inertia" => {
                format!("{} <{name}>", above.trim_end_matches(" <inertial>"))
            }
            (above, _) if nth > 1 => format!("{above} <{name}> {nth}"),
            (above, _) => format!("{above} <{name}>"),
        };
        if matches!(path.as_str(), "link" | "joint")
            && let Some(&first) = self.lines.get(&called)
        {
            return Err(ArmError::Duplicate {
                at: Place {
                    file: self.file.clone(),
                    line: Some(line),
                },
                element: called,
                first,
            });
        }
        self.lines.entry(called.clone()).or_insert(line);
        for (of, attribute, kind, needed) in ATTRIBUTES {
            if *of == path {
                self.attribute(
                    &called,
                    line,
                    attribute,
                    attributes.get(*attribute),
                    *kind,
                    *needed,
                )?;
            }
        }
        Ok(Open {
            tag: name,
            line,
            path,
            called,
            children: Vec::new(),
        })
    }

    fn attribute(
        &self,
        element: &str,
        line: usize,
        name: &str,
        value: Option<&String>,
        kind: Kind,
        needed: bool,
    ) -> Result<(), ArmError> {
        let Some(value) = value else {
            if needed {
                let reason = format!("the attribute '{name}' is missing");
                return Err(self.malformed(line, element, reason));
            }
            return Ok(());
        };
        let is_number = |word: &str| word.parse::<f64>().is_ok();
        let expected = match kind {
            Kind::Text if value.trim().is_empty() => "a text that is not empty".to_owned(),
            Kind::Number if !is_number(value.trim()) => "a number".to_owned(),
            Kind::Numbers(count)
                if value.split_whitespace().count() != count
                    || !value.split_whitespace().all(is_number) =>
            {
                format!("{count} numbers")
            }
            Kind::JointType
                if ![
                    "revolute",
                    "continuous",
                    "fixed",
                    "prismatic",
                    "floating",
                    "planar",
                    "spherical",
                ]
                .contains(&value.as_str()) =>
            {
                "revolute, continuous or fixed".to_owned()
            }
            _ => return Ok(()),
        };
        let reason = format!("{name}=\"{value}\" found, expected {expected}");
        Err(self.malformed(line, element, reason))
    }

    /// An element with all that stands in it.
    fn whole(&self, element: &Open) -> Result<(), ArmError> {
        let lacks = |reason: String| Err(self.malformed(element.line, &element.called, reason));
        let count = |name: &str| element.children.iter().filter(|c| *c == name).count();
        for (of, names) in NEEDED {
            if *of == element.path
                && let Some(name) = names.iter().find(|n| count(n) == 0)
            {
                return lacks(format!("<{name}> is missing"));
            }
        }
        for (of, names) in ONCE {
            if *of == element.path
                && let Some(name) = names.iter().find(|n| count(n) > 1)
            {
                return lacks(format!(
                    "<{name}> stands in it {} times, expected once",
                    count(name)
                ));
            }
        }
        if element.path == "link/BODY/geometry" {
            let known: BTreeSet<&str> = SHAPES.into();
            let shapes: Vec<&String> = element.children.iter().collect();
            let one = shapes.len() == 1 && known.contains(shapes[0].as_str());
            if !one {
                return lacks(format!(
                    "<geometry> holds {shapes:?}, expected one of box, cylinder, capsule, sphere or mesh"
                ));
            }
        }
        Ok(())
    }
}
