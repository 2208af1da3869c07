//! `depal exec` beside a running `depal serve`, as a user has them.
#![allow(dead_code)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use served::{BINARY, Served};

#[path = "../served/mod.rs"]
mod served;

/// A file of the repository.
pub fn asset(path: &str) -> String {
    format!("{}/../../{path}", env!("CARGO_MANIFEST_DIR"))
}

/// A folder of this test with these files.
pub fn folder(test: &str, files: &[(&str, &str)]) -> PathBuf {
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
    std::fs::create_dir_all(&path).expect("a writable target folder");
    for (name, text) in files {
        std::fs::write(path.join(name), text).expect("a writable target folder");
    }
    path
}

/// Runs `depal` to its end.
pub fn depal(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(BINARY)
        .args(arguments)
        .current_dir(folder)
        .output()
        .expect("the program starts")
}

/// What it printed.
pub fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("UTF-8")
}

/// What it told people.
pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).expect("UTF-8")
}

/// Both.
pub fn told(output: &Output) -> (String, String) {
    (stdout(output), stderr(output))
}

/// What it printed, as one document.
pub fn json(output: &Output) -> serde_json::Value {
    serde_json::from_str(&stdout(output)).unwrap_or_else(|_| panic!("{}", stderr(output)))
}

/// Serves the scene in which every kind of project answers.
pub fn serve(kind: &str, brand: &str, more: &[&str]) -> Served {
    let scene = asset("scenes/interface.toml");
    let listen = format!("{kind}=127.0.0.1:0");
    let brand = format!("interface.brand={brand}");
    let args = [&scene, "--listen", &listen, "--set", &brand];
    Served::start(&[&args[..], more].concat())
}

/// Sends connections to the address in the programs here.
pub fn route(served: &Served) -> String {
    format!("127.0.0.1:50000={}", served.address(0))
}
