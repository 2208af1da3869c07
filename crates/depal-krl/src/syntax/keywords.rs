/// Words that cannot be names.
const KEYWORDS: &[&str] = &[
    "and",
    "b_and",
    "b_exor",
    "b_not",
    "b_or",
    "brake",
    "case",
    "circ",
    "circ_rel",
    "continue",
    "decl",
    "def",
    "default",
    "deffct",
    "defdat",
    "do",
    "else",
    "end",
    "enddat",
    "endfct",
    "endfor",
    "endif",
    "endloop",
    "endspline",
    "endswitch",
    "endwhile",
    "enum",
    "exit",
    "exor",
    "ext",
    "extfct",
    "false",
    "for",
    "global",
    "goto",
    "halt",
    "if",
    "import",
    "interrupt",
    "lin",
    "lin_rel",
    "loop",
    "not",
    "or",
    "ptp",
    "ptp_rel",
    "repeat",
    "resume",
    "return",
    "scirc",
    "signal",
    "slin",
    "spline",
    "sptp",
    "struc",
    "switch",
    "then",
    "to",
    "trigger",
    "true",
    "until",
    "wait",
    "while",
];

/// Words that end a block or begin its next part.
pub(super) const ENDERS: &[&str] = &[
    "endif",
    "else",
    "endfor",
    "endwhile",
    "until",
    "endloop",
    "case",
    "default",
    "endswitch",
];

/// Words at which a routine must be over.
pub(super) const ROUTINE_ENDERS: &[&str] = &["end", "endfct", "enddat", "def", "deffct", "defdat"];

/// Instructions that are known and not simulated.
pub(super) const REFUSED: &[&str] = &[
    "spline",
    "ptp_spline",
    "scirc_rel",
    "sptp_rel",
    "slin_rel",
    "asypto",
    "asyptp",
    "asycont",
    "asystop",
    "anin",
    "anout",
    "import",
    "on_error_proceed",
    "cwrite",
    "cread",
    "copen",
    "cclose",
    "channel",
    "movesearch",
];

pub(super) fn is_keyword(word: &str) -> bool {
    KEYWORDS.iter().any(|k| k.eq_ignore_ascii_case(word))
}

pub(super) fn is_any(word: &str, words: &[&str]) -> bool {
    words.iter().any(|w| w.eq_ignore_ascii_case(word))
}
