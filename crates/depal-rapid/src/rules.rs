//! Rules that the manuals leave open or that differ between versions, in one place.
//!
//! Where a controller turns out to do otherwise, this is where it is changed; [`OPEN_RULES`] is rendered to
//! `docs/open-rules.md` by its tests.

/// Whether AND and OR leave out their right side when the left one decides.
pub(crate) const SHORT_CIRCUIT: bool = true;

/// Whether a FOR without STEP whose start is above its end counts down.
pub(crate) const FOR_COUNTS_DOWN: bool = true;

/// A number with so many decimals, as `NumToStr` writes it: the exact value of the 32-bit number is rounded, ties to even.
pub(crate) fn with_decimals(value: f64, decimals: usize) -> String {
    format!("{value:.decimals$}")
}

/// A rule: what is open, what is done here, and a program that shows it.
pub struct OpenRule {
    /// The question.
    pub question: &'static str,
    /// What happens here.
    pub answer: &'static str,
    /// Statements of a program.
    pub example: &'static str,
    /// What they write.
    pub output: &'static [&'static str],
}

/// All of them.
pub const OPEN_RULES: [OpenRule; 11] = [
    OpenRule {
        question: "Does a FOR without STEP count down when its start is above its end?",
        answer: "Yes, by 1. FOR i FROM 1 TO 0 runs twice.",
        example: "FOR i FROM 1 TO 0 DO TPWrite ValToStr(i); ENDFOR",
        output: &["1", "0"],
    },
    OpenRule {
        question: "Do AND and OR evaluate their right side when the left one decides?",
        answer: "No.",
        example: "IF FALSE AND 1 DIV 0 = 0 TPWrite \"both\"; TPWrite \"no fault\";",
        output: &["no fault"],
    },
    OpenRule {
        question: "How does NumToStr round a tie?",
        answer: "The exact value of the 32-bit number is rounded, a tie to the even digit: 0.125 is a tie, 1.005 is none (it is 1.00499999523).",
        example: "TPWrite NumToStr(0.125, 2) + \" \" + NumToStr(0.375, 2) + \" \" + NumToStr(1.005, 2);",
        output: &["0.12 0.38 1.00"],
    },
    OpenRule {
        question: "What does the end of an ERROR clause do, without RETRY, TRYNEXT, RETURN or RAISE?",
        answer: "The error goes to the caller.",
        example: "given;\nERROR\nTPWrite \"main\";\nTRYNEXT;",
        output: &["given", "main"],
    },
    OpenRule {
        question: "Is an index with a fraction an error?",
        answer: "No, it is rounded, a half away from zero.",
        example: "TPWrite ValToStr(Dim(list, 1)); list{1.5} := 7; TPWrite ValToStr(list);",
        output: &["3", "[0,7,0]"],
    },
    OpenRule {
        question: "What width has a number literal that both num and dnum could hold?",
        answer: "That of the other side. Alone, a whole number above 8388608 is a dnum, every other a num.",
        example: "d := 16777217; TPWrite \"\" \\Dnum:=d; TPWrite ValToStr(16777217);",
        output: &["16777217", "16777217"],
    },
    OpenRule {
        question: "Which way does DIV cut, and what sign has MOD?",
        answer: "DIV cuts towards zero, MOD has the sign of its left side.",
        example: "TPWrite ValToStr(-7 DIV 2) + \" \" + ValToStr(-7 MOD 4);",
        output: &["-3 -3"],
    },
    OpenRule {
        question: "Does NOT bind tighter than AND?",
        answer: "No: NOT a AND b is NOT (a AND b), as the grammar has it.",
        example: "IF NOT FALSE AND FALSE TPWrite \"not of both\";",
        output: &["not of both"],
    },
    OpenRule {
        question: "When does a counting loop look at its bounds?",
        answer: "Once, before the first round; changing them inside has no effect.",
        example: "n := 2; FOR i FROM 1 TO n DO n := 9; TPWrite ValToStr(i); ENDFOR",
        output: &["1", "2"],
    },
    OpenRule {
        question: "With what do ISignalAI and ISignalAO compare a value by DeltaValue?",
        answer: "With the value at the last interrupt, before the first with that when it was ordered; the interrupt comes when the difference is larger and the condition holds.",
        example: "CONNECT i WITH t; ISignalAO ao_flow, AIO_ALWAYS, 0, 0, 1, i; SetAO ao_flow, 0.75; SetAO ao_flow, 1.5; SetAO ao_flow, 2.25; SetAO ao_flow, 3; SetAO ao_flow, 3.75; WaitTime 0.1;",
        output: &["1.5", "3"],
    },
    OpenRule {
        question: "How exactly must a joint stand in the quarter turn that the configuration data of a target name, while ConfJ or ConfL is on?",
        answer: "In it, or at most 45 degrees beside it. Both are on from the start, as on the controller; ConfJ \\Off and ConfL \\Off take the nearest solution. cfx is not looked at.",
        example: "ConfJ \\Off; ConfL \\On; TPWrite \"a line must end in its quarters, a joint move need not\";",
        output: &["a line must end in its quarters, a joint move need not"],
    },
];
