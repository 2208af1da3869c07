use depal_vm::system::Fault;
use depal_vm::{MachineFault, RaisedError};

/// Names of errors that programs compare ERRNO with. The numbers are ours: programs use the names;
/// 1 to 90 belong to the user.
pub(crate) const ERRORS: &[(&str, i64)] = &[
    ("ERR_DIVZERO", 1001),
    ("ERR_OUTOFBND", 1002),
    ("ERR_STRTOOLNG", 1003),
    ("ERR_NOTPRES", 1004),
    ("ERR_EXCRTYMAX", 1005),
    ("ERR_ARGVALERR", 1006),
    ("ERR_RECURSION", 1007),
    ("ERR_NORETURN", 1008),
    ("ERR_ILLDIM", 1009),
    ("ERR_REFUNKPRC", 1010),
    ("ERR_INVDIM", 1011),
    ("ERR_NEGARG", 1012),
    ("ERR_SOCK_CLOSED", 1101),
    ("ERR_SOCK_TIMEOUT", 1102),
    ("ERR_SOCK_NOT_CONN", 1103),
    ("ERR_SOCK_IS_CONNECTED", 1104),
    ("ERR_SOCK_ADDR_INUSE", 1105),
    ("ERR_SOCK_ADDR_INVALID", 1106),
    ("ERR_SOCK_NET_UNREACH", 1107),
    ("ERR_SOCK_UNSPEC", 1108),
    ("ERR_ROBLIMIT", 1201),
    ("ERR_MOTIONSUP", 1202),
    ("ERR_OUTSIDE_REACH", 1203),
    ("ERR_COLL_STOP", 1204),
    ("ERR_PATH_STOP", 1205),
    ("ERR_ORIENT_VALUE", 1206),
    ("ERR_WAIT_MAXTIME", 1301),
    ("ERR_SIG_NOT_VALID", 1302),
    ("ERR_GO_LIM", 1303),
    ("ERR_NO_ALIASIO_DEF", 1304),
    ("ERR_NORUNUNIT", 1305),
    ("ERR_AO_LIM", 1306),
    ("ERR_OVERFLOW", 1307),
    ("ERR_RANYBIN_EOF", 1401),
    ("ERR_RAWBYTES", 1402),
    ("ERR_TP_NO_CLIENT", 1501),
    ("ERR_FILEACC", 1403),
    ("ERR_FILEOPEN", 1404),
    ("ERR_FILNOTFND", 1405),
    ("ERR_FILEEXIST", 1406),
    ("ERR_RCVDATA", 1407),
    ("ERR_TP_MAXTIME", 1502),
    ("ERR_TP_DIBREAK", 1503),
    ("ERR_ALIASIO_DEF", 1308),
    ("ERR_ALIASIO_TYPE", 1309),
    ("ERR_CALLPROC", 1013),
    ("ERR_WHLSEARCH", 1207),
    ("ERR_SIGSUPSEARCH", 1208),
    ("ERR_SPEED_REFRESH_LIM", 1209),
    ("ERR_ALRDYCNT", 1601),
    ("ERR_CNTNOTVAR", 1602),
    ("ERR_UNKINO", 1603),
    ("ERR_WAITSYNCTASK", 1701),
    ("ERR_SYNCMOVEON", 1702),
    ("ERR_SYNCMOVEOFF", 1703),
    ("ERR_SYM_ACCESS", 1014),
    ("ERR_SYMBOL_TYPE", 1015),
    ("ERR_CFG_NOTFND", 1016),
    ("ERR_CFG_ILLTYPE", 1017),
    ("LONG_JMP_ALL_ERR", 1999),
];

/// The error of this name.
pub(crate) fn error(name: &str, message: impl Into<String>) -> RaisedError {
    let number = ERRORS
        .iter()
        .find(|(known, _)| *known == name)
        .map_or(0, |(_, number)| *number);
    RaisedError {
        number,
        name: name.to_owned(),
        message: message.into(),
    }
}

/// Name of an error number.
pub(crate) fn error_name(number: i64) -> Option<&'static str> {
    ERRORS
        .iter()
        .find(|(_, known)| *known == number)
        .map(|(name, _)| *name)
}

/// The RAPID error of a fault.
pub(crate) fn raise(fault: &MachineFault) -> RaisedError {
    let name = match fault {
        MachineFault::System(Fault::UnknownSignal(_)) => "ERR_NO_ALIASIO_DEF",
        MachineFault::System(Fault::SignalValue { .. }) => "ERR_SIG_NOT_VALID",
        MachineFault::System(Fault::OutOfReach { .. } | Fault::Configuration { .. }) => {
            "ERR_ROBLIMIT"
        }
        MachineFault::System(Fault::MotionSupervision { .. }) => "ERR_MOTIONSUP",
        MachineFault::System(Fault::SocketClosed) => "ERR_SOCK_CLOSED",
        MachineFault::System(Fault::SocketState { .. }) => "ERR_SOCK_NOT_CONN",
        MachineFault::System(Fault::AddressInUse { .. }) => "ERR_SOCK_ADDR_INUSE",
        MachineFault::System(Fault::File { .. }) => "ERR_FILEACC",
        MachineFault::UnknownRoutine { .. } => "ERR_REFUNKPRC",
        MachineFault::WrongCall { .. } => "ERR_CALLPROC",
        MachineFault::IndexOutOfRange { .. } => "ERR_OUTOFBND",
        MachineFault::DivisionByZero => "ERR_DIVZERO",
        MachineFault::NotPresent => "ERR_NOTPRES",
        MachineFault::StringTooLong { .. } => "ERR_STRTOOLNG",
        MachineFault::RecursionLimit { .. } => "ERR_RECURSION",
        MachineFault::RetryLimit { .. } => "ERR_EXCRTYMAX",
        MachineFault::NoReturnValue { .. } => "ERR_NORETURN",
        _ => "ERR_ARGVALERR",
    };
    let mend = match fault {
        MachineFault::System(Fault::Configuration { .. }) => {
            "; teach the target anew, or take the nearest configuration with ConfJ \\Off or, for lines, ConfL \\Off"
        }
        _ => "",
    };
    error(name, format!("{fault}{mend}"))
}
