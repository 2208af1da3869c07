//! RAPID programs on the cabinet with an arm: what the arm and the outputs do, and when.

mod costs;
mod dialogs;
mod files;
mod free;
mod harness;
mod information;
mod moves;
mod path;
mod samples;
mod search;
mod settings;
mod shared_data;
mod tasks;
mod transcripts;
mod triggers;
mod vision_peer;
