//! No text may make the front end panic or hang.

use depal_rapid::{check, load};
use depal_vm::SourceFile;
use proptest::prelude::*;

use crate::fake_system::signals;

const WORDS: [&str; 60] = [
    "MODULE",
    "ENDMODULE",
    "PROC",
    "ENDPROC",
    "FUNC",
    "ENDFUNC",
    "IF",
    "THEN",
    "ELSE",
    "ELSEIF",
    "ENDIF",
    "FOR",
    "FROM",
    "TO",
    "STEP",
    "DO",
    "ENDFOR",
    "WHILE",
    "ENDWHILE",
    "TEST",
    "CASE",
    "DEFAULT",
    "ENDTEST",
    "RETURN",
    "RAISE",
    "RETRY",
    "TRYNEXT",
    "ERROR",
    "VAR",
    "PERS",
    "CONST",
    "RECORD",
    "ENDRECORD",
    "LOCAL",
    "num",
    "robtarget",
    "a",
    "b",
    "main",
    "x",
    ":=",
    "(",
    ")",
    "{",
    "}",
    "[",
    "]",
    ",",
    ";",
    "\\",
    "?",
    "|",
    ".",
    "+",
    "-",
    "*",
    "=",
    "NOT",
    "1",
    "\"s\"",
];

fn throw(text: &str) {
    let source = [SourceFile::new("x.mod", text)];
    for diagnostic in check(&source).diagnostics {
        diagnostic.plain(&source);
    }
    load(&source, &signals(), "main");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        throw(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn any_words(words in prop::collection::vec(0..WORDS.len(), 0..120)) {
        let text: Vec<_> = words.iter().map(|i| WORDS[*i]).collect();
        throw(&text.join(" "));
        throw(&format!("MODULE m PROC main() {} ENDPROC ENDMODULE", text.join(" ")));
    }
}

#[test]
fn deep_nesting_is_an_error_and_not_a_crash() {
    for (open, close) in [("(", ")"), ("[", "]"), ("-", ""), ("NOT ", ""), ("a{", "}")] {
        let text = format!(
            "MODULE m\nPROC main()\nx := {}1{};\nENDPROC\nENDMODULE",
            open.repeat(50_000),
            close.repeat(50_000)
        );
        throw(&text);
    }
    throw(&format!(
        "MODULE m PROC main() {}",
        "IF a THEN ".repeat(20_000)
    ));
    throw(&format!(
        "MODULE m PROC main() x := {}1; ENDPROC ENDMODULE",
        "1 + ".repeat(3000)
    ));
    throw(&format!(
        "MODULE m PROC main() x := a{}; ENDPROC ENDMODULE",
        ".b".repeat(20_000)
    ));
    let chain: Vec<String> = (0..3000)
        .map(|i| format!("CONST num c{i} := c{};\n", i + 1))
        .collect();
    let chain = chain.concat();
    throw(&format!("MODULE m\n{chain}ENDMODULE"));
    throw("MODULE m CONST num a := a; VAR num b{a}; RECORD r r x; ENDRECORD ENDMODULE");
}
