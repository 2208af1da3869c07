//! Any bytes as a program text: lexer, parser, printer, checks. Seeds: `../tests/corpus/text`.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[allow(dead_code)]
#[path = "../../tests/rapid/fake_system.rs"]
mod fake_system;
#[allow(dead_code)]
#[path = "../../tests/rapid/generate.rs"]
mod generate;
#[allow(dead_code)]
#[path = "../../tests/rapid/thrown.rs"]
mod thrown;

fuzz_target!(|bytes: &[u8]| thrown::throw(&depal_rapid::decode(bytes)));
