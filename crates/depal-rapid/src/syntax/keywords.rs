//! Words that mean something to the grammar.

/// What else a reserved word is, as bits.
pub(crate) type Class = u8;

/// A statement list of any kind ends there.
pub(crate) const BLOCK_END: Class = 1;
/// The statements of a routine end there.
pub(crate) const ROUTINE_END: Class = 2;
/// It can only begin something new: reading goes on there after a mistake.
pub(crate) const FRESH_START: Class = 4;
/// It begins a declaration of a module, or ends the module.
pub(crate) const DECLARATION: Class = 8;

/// Attributes of a module.
pub(crate) const MODULE_ATTRIBUTES: [&str; 5] =
    ["SYSMODULE", "NOSTEPIN", "VIEWONLY", "READONLY", "NOVIEW"];

/// Reserved words, which cannot be names.
const KEYWORDS: [(&str, Class); 54] = [
    ("ALIAS", DECLARATION),
    ("AND", 0),
    ("BACKWARD", BLOCK_END | ROUTINE_END),
    ("CASE", BLOCK_END | FRESH_START),
    ("CONNECT", 0),
    ("CONST", BLOCK_END | FRESH_START | DECLARATION),
    ("DEFAULT", BLOCK_END | FRESH_START),
    ("DIV", 0),
    ("DO", 0),
    ("ELSE", BLOCK_END | FRESH_START),
    ("ELSEIF", BLOCK_END | FRESH_START),
    ("ENDFOR", BLOCK_END | FRESH_START),
    ("ENDFUNC", BLOCK_END | ROUTINE_END | FRESH_START),
    ("ENDIF", BLOCK_END | FRESH_START),
    (
        "ENDMODULE",
        BLOCK_END | ROUTINE_END | FRESH_START | DECLARATION,
    ),
    ("ENDPROC", BLOCK_END | ROUTINE_END | FRESH_START),
    ("ENDRECORD", BLOCK_END | ROUTINE_END),
    ("ENDTEST", BLOCK_END | FRESH_START),
    ("ENDTRAP", BLOCK_END | ROUTINE_END | FRESH_START),
    ("ENDUNDO", 0),
    ("ENDWHILE", BLOCK_END | FRESH_START),
    ("ERROR", BLOCK_END | ROUTINE_END | FRESH_START),
    ("EXIT", 0),
    ("FALSE", 0),
    ("FOR", FRESH_START),
    ("FROM", 0),
    ("FUNC", BLOCK_END | ROUTINE_END | FRESH_START | DECLARATION),
    ("GOTO", FRESH_START),
    ("IF", FRESH_START),
    ("INOUT", 0),
    ("LOCAL", BLOCK_END | ROUTINE_END | FRESH_START | DECLARATION),
    ("MOD", 0),
    (
        "MODULE",
        BLOCK_END | ROUTINE_END | FRESH_START | DECLARATION,
    ),
    ("NOT", 0),
    ("OR", 0),
    ("PERS", BLOCK_END | FRESH_START | DECLARATION),
    ("PROC", BLOCK_END | ROUTINE_END | FRESH_START | DECLARATION),
    ("RAISE", FRESH_START),
    (
        "RECORD",
        BLOCK_END | ROUTINE_END | FRESH_START | DECLARATION,
    ),
    ("RETRY", FRESH_START),
    ("RETURN", FRESH_START),
    ("STEP", 0),
    ("TASK", DECLARATION),
    ("TEST", FRESH_START),
    ("THEN", BLOCK_END),
    ("TO", 0),
    ("TRAP", BLOCK_END | ROUTINE_END | FRESH_START | DECLARATION),
    ("TRUE", 0),
    ("TRYNEXT", FRESH_START),
    ("UNDO", BLOCK_END | ROUTINE_END | FRESH_START),
    ("VAR", BLOCK_END | FRESH_START | DECLARATION),
    ("WHILE", FRESH_START),
    ("WITH", 0),
    ("XOR", 0),
];

/// What a word is; none for one that is not reserved.
pub(crate) fn class(word: &str) -> Option<Class> {
    let mut found = KEYWORDS.iter();
    found
        .find(|(known, _)| known.eq_ignore_ascii_case(word))
        .map(|(_, class)| *class)
}

/// Whether a word is reserved.
pub(crate) fn is_keyword(word: &str) -> bool {
    class(word).is_some()
}
