//! Keywords by language of the listing, as a table: the word in the listing and the English one.

/// Other spellings of keywords: the localised word, in capitals, and the English one.
pub(crate) const LOCALISED: &[(&str, &str)] = &[
    // German listings.
    ("AUFRUF", "CALL"),
    ("SPRUNG", "JMP"),
    ("LABEL", "LBL"),
    ("WENN", "IF"),
    ("DANN", "THEN"),
    ("SONST", "ELSE"),
    ("ENDWENN", "ENDIF"),
    ("ENDE_WENN", "ENDIF"),
    ("WARTE", "WAIT"),
    ("AUSWAHL", "SELECT"),
    ("FÜR", "FOR"),
    ("FUER", "FOR"),
    ("ENDFÜR", "ENDFOR"),
    ("ENDFUER", "ENDFOR"),
    ("BIS", "TO"),
    ("ABWÄRTS", "DOWNTO"),
    ("ABWAERTS", "DOWNTO"),
    ("AN", "ON"),
    ("EIN", "ON"),
    ("AUS", "OFF"),
    ("UND", "AND"),
    ("ODER", "OR"),
    ("NICHT", "NOT"),
    ("PULS", "PULSE"),
    ("SEK", "SEC"),
    ("ENDE", "END"),
    ("ABBRUCH", "ABORT"),
    ("MELDUNG", "MESSAGE"),
    ("STARTE", "RUN"),
    ("TRAGLST", "PAYLOAD"),
    ("TRAGLAST", "PAYLOAD"),
    ("BENUTZER_NUM", "UFRAME_NUM"),
    ("WKZ_NUM", "UTOOL_NUM"),
    ("BENUTZER", "UFRAME"),
    ("WKZ", "UTOOL"),
    ("ZEIT", "TIME"),
    ("VOR", "BEFORE"),
    ("NACH", "AFTER"),
    ("ÜBERLAGERUNG", "OVERRIDE"),
    ("ABSTAND", "DISTANCE"),
    // Longer forms of English words.
    ("TIMEOUT_LBL", "TIMEOUT"),
    ("GRAD", "DEG"),
    ("GR", "DEG"),
];

/// Spellings of registers and signals in front of a bracket.
pub(crate) const LOCALISED_ITEMS: &[(&str, &str)] = &[
    ("I", "R"),
    ("A", "DO"),
    ("E", "DI"),
    ("GA", "GO"),
    ("GE", "GI"),
];

/// The English keyword of a word of the listing, in capitals.
pub(crate) fn canonical(word: &str) -> String {
    let upper = word.to_uppercase();
    match LOCALISED.iter().find(|(local, _)| *local == upper) {
        Some((_, english)) => (*english).to_owned(),
        None => upper,
    }
}

/// Words a statement may begin with, for "did you mean".
pub(crate) const STATEMENTS: &[&str] = &[
    "CALL",
    "RUN",
    "JMP",
    "LBL",
    "IF",
    "ELSE",
    "ENDIF",
    "SELECT",
    "FOR",
    "ENDFOR",
    "WAIT",
    "TIMER",
    "OVERRIDE",
    "PAYLOAD",
    "UALM",
    "MESSAGE",
    "PAUSE",
    "ABORT",
    "END",
    "UFRAME_NUM",
    "UTOOL_NUM",
    "UFRAME",
    "UTOOL",
    "SKIP",
    "OFFSET",
    "TOOL_OFFSET",
    "MONITOR",
    "LOCK",
    "UNLOCK",
    "J",
    "L",
    "C",
    "R",
    "PR",
    "SR",
    "DO",
    "GO",
    "RO",
    "AO",
    "F",
    "M",
];
