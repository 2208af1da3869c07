//! How long small loops take, beside the same loops in Python on this computer.
//!
//! `cargo bench -p depal-rapid --bench loops`. The cabinet here grants statements as the real one does: 200 fit
//! into a cycle of 4 ms. Where there is no `python3` only our times are printed.
#![allow(clippy::disallowed_methods)] // A stop watch is what a bench is for.

use std::process::Command;
use std::time::Instant;

use depal_syntax::SourceFile;
use depal_vm::execution::{RobotTask, Step};
use depal_vm::testing::EmptyCabinet;
use depal_vm::{Machine, Value};

/// Each case: name, module data and routines, statements of main with the result in `s`, and the same in Python.
const CASES: [(&str, &str, &str, &str); 6] = [
    (
        "10 million additions, FOR",
        "",
        "FOR i FROM 1 TO 10000000 DO s := s + 1; ENDFOR",
        "for i in range(1, 10000001):\n  s = s + 1",
    ),
    (
        "10 million additions, WHILE",
        "VAR num i;",
        "WHILE i < 5000000 DO s := s + 1; i := i + 1; ENDWHILE",
        "i = 0\n while i < 5000000:\n  s = s + 1\n  i = i + 1",
    ),
    (
        "10 million additions, routine data",
        "FUNC num work()\nVAR num t;\nFOR i FROM 1 TO 10000000 DO t := t + i MOD 7; ENDFOR\nRETURN t;\nENDFUNC",
        "s := work();",
        "for i in range(1, 10000001):\n  s = s + i % 7",
    ),
    (
        "a sieve, 20 times 10000",
        "VAR num a{10000};",
        "FOR k FROM 1 TO 20 DO FOR i FROM 1 TO 10000 DO a{i} := 0; ENDFOR FOR i FROM 2 TO 100 DO IF a{i} = 0 THEN FOR j FROM i * i TO 10000 STEP i DO a{j} := 1; ENDFOR ENDIF ENDFOR ENDFOR FOR i FROM 2 TO 10000 DO IF a{i} = 0 s := s + 1; ENDFOR",
        "for k in range(20):\n  a = [0] * 10001\n  for i in range(1, 10001):\n   a[i] = 0\n  for i in range(2, 101):\n   if a[i] == 0:\n    for j in range(i * i, 10001, i):\n     a[j] = 1\n for i in range(2, 10001):\n  if a[i] == 0:\n   s = s + 1",
    ),
    (
        "branches and truth values, 1 million",
        "VAR bool odd;",
        "FOR i FROM 1 TO 1000000 DO odd := i MOD 2 = 1; IF odd AND NOT i > 900000 THEN s := s + 1; ELSEIF i < 10 OR i > 999990 THEN s := s - 1; ENDIF ENDFOR",
        "for i in range(1, 1000001):\n  odd = i % 2 == 1\n  if odd and not i > 900000:\n   s = s + 1\n  elif i < 10 or i > 999990:\n   s = s - 1",
    ),
    (
        "calls, fib(27)",
        "FUNC num fib(num n)\nIF n < 2 RETURN n;\nRETURN fib(n - 1) + fib(n - 2);\nENDFUNC",
        "s := fib(27);",
        "def fib(n):\n  if n < 2: return n\n  return fib(n - 1) + fib(n - 2)\n s = fib(27)",
    ),
];

/// Statements that fit into a cycle of 4 ms.
const PER_CYCLE: u32 = 200;

/// Runs to the end: seconds, statements, and the number in `s`.
fn ours(data: &str, statements: &str) -> (f64, u64, f64) {
    let text =
        format!("MODULE m\nVAR num s;\n{data}\nPROC main()\n{statements}\nENDPROC\nENDMODULE\n");
    let source = [SourceFile::new("bench.mod", text)];
    let loaded = depal_rapid::load(&source, &[], "main");
    let program = loaded.program.expect("the programs of the bench are right");
    let mut machine = Machine::new(program, "T_ROB1");
    let mut system = EmptyCabinet::new(PER_CYCLE);
    let begun = Instant::now();
    while machine.step(&mut system) == Step::Ran {}
    let seconds = begun.elapsed().as_secs_f64();
    let result = machine.global("s").and_then(Value::as_number);
    (seconds, system.statements(), result.unwrap_or(f64::NAN))
}

/// The same in Python: seconds and result.
fn python(body: &str) -> Option<(f64, f64)> {
    let script = format!(
        "import time\ndef work():\n s = 0.0\n {body}\n return s\nbegun = time.perf_counter()\ns = work()\nprint(time.perf_counter() - begun, s)"
    );
    let output = Command::new("python3")
        .args(["-c", &script])
        .output()
        .ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    let (seconds, result) = text.trim().split_once(' ')?;
    Some((seconds.parse().ok()?, result.parse().ok()?))
}

fn main() {
    // `cargo test --all-targets` builds it and starts it without this argument.
    if !std::env::args().any(|argument| argument == "--bench") {
        return;
    }
    // A word of the name runs the cases that have it.
    let wanted = std::env::args().skip(1).find(|a| !a.starts_with('-'));
    for (name, data, statements, body) in CASES {
        if wanted.as_ref().is_some_and(|word| !name.contains(word)) {
            continue;
        }
        let (seconds, count, result) = ours(data, statements);
        let each = seconds / count as f64 * 1e9;
        print!("{name:38} {seconds:7.3} s  {each:5.1} ns a statement  result {result}");
        match python(body) {
            Some((theirs, result)) => println!(
                "  python3 {theirs:7.3} s (result {result}), ours / theirs {:.2}",
                seconds / theirs
            ),
            None => println!("  no python3 here"),
        }
    }
}
