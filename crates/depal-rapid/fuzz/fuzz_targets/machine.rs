//! Bytes choose a right program, which runs for a while. Seeds: `../tests/corpus/machine`.
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

fuzz_target!(|bytes: &[u8]| {
    thrown::run_generated(bytes);
});
