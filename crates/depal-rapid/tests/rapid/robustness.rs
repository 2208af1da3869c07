//! No text may make the front end panic or hang.

use std::path::Path;

use depal_vm::execution::Step;
use proptest::prelude::*;

use crate::generate::program;
use crate::thrown::{run_generated, throw};

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

/// A right program with some of it deleted, doubled or exchanged.
fn mutated(seed: &[u8], places: &[(u16, u8)]) -> String {
    let text = program(seed);
    let mut words: Vec<&str> = text
        .split_inclusive([' ', ';', '(', ')', '\n', ','])
        .collect();
    for (place, what) in places {
        let at = usize::from(*place) % words.len();
        match what % 4 {
            0 => {
                words.remove(at);
            }
            1 => words.insert(at, words[at]),
            2 => {
                let other = (at * 7 + 3) % words.len();
                words.swap(at, other);
            }
            _ => words.insert(at, WORDS[usize::from(*what) % WORDS.len()]),
        }
        if words.is_empty() {
            break;
        }
    }
    words.concat()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn right_programs_with_mistakes(
        seed in prop::collection::vec(any::<u8>(), 0..200),
        places in prop::collection::vec(any::<(u16, u8)>(), 1..8),
    ) {
        throw(&mutated(&seed, &places));
    }

    #[test]
    fn generated_programs_run(seed in prop::collection::vec(any::<u8>(), 0..400)) {
        run_generated(&seed);
    }
}

/// The generator reaches all ends, so that it is worth something.
#[test]
fn generated_programs_end_in_every_way() {
    let mut ends = [0; 4];
    for seed in 0u64..300 {
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        let bytes: Vec<u8> = (0..300)
            .map(|_| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (state >> 24) as u8
            })
            .collect();
        let kind = match run_generated(&bytes) {
            Step::Finished => 0,
            Step::Failed(_) => 1,
            Step::Ran => 2,
            _ => 3,
        };
        ends[kind] += 1;
    }
    assert!(ends.iter().take(3).all(|count| *count > 5), "{ends:?}");
}

/// Texts and byte strings that once were of interest, and one of each kind.
#[test]
fn the_corpus_is_replayed() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/corpus");
    let mut count = 0;
    for (folder, is_text) in [("text", true), ("machine", false)] {
        let entries = std::fs::read_dir(corpus.join(folder)).expect("the folder is there");
        let mut paths: Vec<_> = entries.flatten().map(|entry| entry.path()).collect();
        paths.sort();
        for path in paths {
            #[allow(clippy::disallowed_methods)] // The files are the test's data.
            let bytes = std::fs::read(&path).expect("just listed");
            if is_text {
                throw(&depal_rapid::decode(&bytes));
            } else {
                run_generated(&bytes);
            }
            count += 1;
        }
    }
    assert!(count >= 20, "{count}");
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
