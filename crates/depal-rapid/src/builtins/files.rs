//! Files below the program's folder. Paths cannot leave it: `HOME:` and `TEMP:` are folders in it.

mod device;
mod folder;

use depal_vm::system::{Fault, System};
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::table::Entry;
use crate::errors::error;
use device::*;
use folder::*;

type Ran = Result<Outcome, RaisedError>;

pub(super) const ENTRIES: [Entry; 21] = [
    (
        "PROC Open(string Object \\string File, INOUT iodev IODevice \\switch Read | switch Write | switch Append \\switch Bin)",
        open,
    ),
    ("PROC Close(INOUT iodev IODevice)", close),
    (
        "PROC Write(INOUT iodev IODevice, string String \\num Num | bool Bool | pos Pos | orient Orient | dnum Dnum \\switch NoNewLine)",
        write,
    ),
    (
        "PROC WriteBin(INOUT iodev IODevice, num Buffer{*}, num NChar)",
        write_bin,
    ),
    (
        "PROC WriteStrBin(INOUT iodev IODevice, string Str)",
        write_str_bin,
    ),
    (
        "PROC WriteRawBytes(INOUT iodev IODevice, INOUT rawbytes RawData \\num NoOfBytes)",
        write_raw,
    ),
    (
        "PROC ReadRawBytes(INOUT iodev IODevice, INOUT rawbytes RawData \\num Time)",
        read_raw,
    ),
    (
        "FUNC string ReadStr(INOUT iodev IODevice \\string Delim \\switch RemoveCR \\switch DiscardHeaders \\num Time)",
        read_str,
    ),
    (
        "FUNC num ReadNum(INOUT iodev IODevice \\string Delim \\num Time)",
        read_num,
    ),
    (
        "FUNC num ReadBin(INOUT iodev IODevice \\num Time)",
        read_bin,
    ),
    (
        "FUNC string ReadStrBin(INOUT iodev IODevice, num NoOfChars \\num Time)",
        read_str_bin,
    ),
    ("PROC Rewind(INOUT iodev IODevice)", rewind),
    ("PROC ClearIOBuff(INOUT iodev IODevice)", clear),
    ("FUNC num FileSize(string Path)", file_size),
    (
        "FUNC bool IsFile(string Path \\switch Directory \\switch Fifo \\switch RegFile \\switch BlockSpec \\switch CharSpec)",
        is_file,
    ),
    ("PROC RemoveFile(string Path)", remove_file),
    (
        "PROC RenameFile(string OldPath, string NewPath)",
        rename_file,
    ),
    ("PROC CopyFile(string OldPath, string NewPath)", copy_file),
    ("PROC MakeDir(string Path)", make_dir),
    ("PROC RemoveDir(string Path)", remove_dir),
    (
        "FUNC num FSSize(string Name \\switch Total | switch Free)",
        disk_size,
    ),
];

fn done() -> Ran {
    Ok(Outcome::Done(Value::Absent))
}

/// The path in the folder: `HOME:` and nothing are the folder itself, other devices are refused, and so is a
/// way out of it.
fn inside(path: &str) -> Result<String, String> {
    let path = path.replace('\\', "/");
    let (device, rest) = match path.split_once(':') {
        Some((device, rest)) => (device.to_ascii_lowercase(), rest.to_owned()),
        None => (String::new(), path.clone()),
    };
    let mut parts: Vec<String> = match device.as_str() {
        "" | "home" | "diskhome" => Vec::new(),
        "temp" | "disktemp" => vec!["TEMP".to_owned()],
        other => {
            return Err(format!(
                "{path}: the device {other}: is not simulated, only HOME: and TEMP: are"
            ));
        }
    };
    let root = parts.len();
    for part in rest.split('/') {
        match part {
            "" | "." => {}
            ".." if parts.len() > root => {
                parts.pop();
            }
            ".." => return Err(format!("{path}: leads out of the program's folder")),
            part => parts.push(part.to_owned()),
        }
    }
    Ok(parts.join("/"))
}

fn path(context: &CallContext<'_>, index: usize) -> Result<String, RaisedError> {
    let text = context.string(index)?;
    inside(&text).map_err(|message| error("ERR_FILEACC", message))
}

fn read(system: &mut dyn System, path: &str) -> Result<Vec<u8>, RaisedError> {
    system
        .read_file(path)
        .map_err(|fault| error("ERR_FILNOTFND", message(&fault)))
}

fn store(system: &mut dyn System, path: &str, bytes: &[u8]) -> Result<(), RaisedError> {
    system
        .write_file(path, bytes)
        .map_err(|fault| error("ERR_FILEACC", message(&fault)))
}

fn message(fault: &Fault) -> String {
    match fault {
        Fault::File { message } => message.clone(),
        other => format!("{other:?}"),
    }
}

/// Whether something of this name, or below it, is there.
fn is_folder(system: &dyn System, path: &str) -> bool {
    let below = format!("{path}/");
    path.is_empty()
        || system
            .file_names()
            .iter()
            .any(|name| name.starts_with(&below))
}
