//! The folder itself: names, sizes, copies, folders in it.

use depal_vm::system::System;
use depal_vm::{CallContext, Outcome, RaisedError, Value};

use super::{Ran, done, is_folder, message, path, read, store};
use crate::errors::error;

pub(super) fn file_size(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let path = path(context, 0)?;
    let bytes = read(system, &path)?;
    Ok(Outcome::Done(Value::Num(bytes.len() as f32)))
}

pub(super) fn is_file(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let path = path(context, 0)?;
    let folder = is_folder(system, &path);
    let file = system.read_file(&path).is_ok();
    let given = |index: usize| context.is_given(index);
    let any = !(1..=5).any(given);
    let found = (folder && (any || given(1))) || (file && (any || given(3)));
    Ok(Outcome::Done(Value::Bool(found)))
}

fn remove(system: &mut dyn System, path: &str) -> Result<(), RaisedError> {
    system
        .remove_file(path)
        .map_err(|fault| error("ERR_FILEACC", message(&fault)))
}

pub(super) fn remove_file(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let path = path(context, 0)?;
    remove(system, &path)?;
    done()
}

fn copy(context: &CallContext<'_>, system: &mut dyn System) -> Result<String, RaisedError> {
    let (from, to) = (path(context, 0)?, path(context, 1)?);
    let bytes = system
        .read_file(&from)
        .map_err(|fault| error("ERR_FILEACC", message(&fault)))?;
    if system.read_file(&to).is_ok() {
        return Err(error("ERR_FILEEXIST", format!("{to} is there already")));
    }
    store(system, &to, &bytes)?;
    Ok(from)
}

pub(super) fn rename_file(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let from = copy(context, system)?;
    remove(system, &from)?;
    done()
}

pub(super) fn copy_file(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    copy(context, system)?;
    done()
}

/// A folder without files is an entry whose name ends in a slash.
pub(super) fn make_dir(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let path = path(context, 0)?;
    if is_folder(system, &path) {
        return Err(error("ERR_FILEACC", format!("{path} is there already")));
    }
    store(system, &format!("{path}/"), &[])?;
    done()
}

pub(super) fn remove_dir(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    let path = path(context, 0)?;
    let own = format!("{path}/");
    let names = system.file_names();
    if names
        .iter()
        .any(|name| name.starts_with(&own) && *name != own)
    {
        return Err(error("ERR_FILEACC", format!("{path} is not empty")));
    }
    remove(system, &own)?;
    done()
}

/// Bytes of a small disk, so that num holds them exactly, less what the files hold.
pub(super) fn disk_size(context: &mut CallContext<'_>, system: &mut dyn System) -> Ran {
    const TOTAL: usize = 8_000_000;
    let mut used = 0;
    if context.is_given(2) {
        for name in system.file_names() {
            used += system.read_file(&name).map_or(0, |bytes| bytes.len());
        }
    }
    Ok(Outcome::Done(Value::Num(TOTAL.saturating_sub(used) as f32)))
}
