//! How this crate reads files.

use std::io;

use crate::embedded;
use crate::missing::with_advice;

/// Gives the text of a path; paths that begin with `embedded:` name files inside the program.
pub type Resolver<'a> = &'a dyn Fn(&str) -> io::Result<String>;

/// Reads a text file, or an embedded one for `embedded:PATH`.
///
/// # Errors
/// Not found, not readable, not UTF-8; with what to try instead, where that is known.
pub fn read_text(path: &str) -> io::Result<String> {
    match path.strip_prefix(EMBEDDED) {
        Some(name) => embedded::text(name).map(str::to_owned).ok_or_else(|| {
            io::Error::new(io::ErrorKind::NotFound, "no such file inside the program")
        }),
        None => std::fs::read_to_string(path).map_err(|error| with_advice(path, error)),
    }
}

/// The mark of a file inside the program.
pub(crate) const EMBEDDED: &str = "embedded:";

/// The path of `written`, which stands in the file `from`: relative paths begin at the file's folder.
pub(crate) fn beside(from: &str, written: &str) -> String {
    if written.starts_with('/') || written.starts_with(EMBEDDED) {
        return written.to_owned();
    }
    let (mark, from) = match from.strip_prefix(EMBEDDED) {
        Some(rest) => (EMBEDDED, rest),
        None => ("", from),
    };
    let folder = from.rfind('/').map_or("", |end| &from[..=end]);
    let path = format!("{folder}{written}");
    if mark.is_empty() {
        return path;
    }
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop();
            }
            part => parts.push(part),
        }
    }
    format!("{mark}{}", parts.join("/"))
}
