use depal_vm::{MachineFault, RaisedError};

/// Errors have no number that a program could ask for: they stop it.
pub(crate) fn raise(fault: &MachineFault) -> RaisedError {
    let message = match fault {
        MachineFault::NotPresent => "a variable is used that has no value yet".to_owned(),
        fault => fault.to_string(),
    };
    RaisedError {
        number: 0,
        name: String::new(),
        message,
    }
}
