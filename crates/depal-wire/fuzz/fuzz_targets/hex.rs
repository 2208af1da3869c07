#![no_main]

#[path = "../checks.rs"]
mod checks;

use checks::check;
use depal_wire::Encoding;

libfuzzer_sys::fuzz_target!(|data: &[u8]| { check(Encoding::HexLittleEndian, data); check(Encoding::HexBigEndian, data) });
