//! `depal exec` beside a running `depal serve`, as a user has them.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

const BINARY: &str = env!("CARGO_BIN_EXE_depal");

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

/// What it printed: stdout, stderr.
pub fn told(output: &Output) -> (String, String) {
    let text = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).expect("UTF-8");
    (text(&output.stdout), text(&output.stderr))
}

/// A vision server on a free port; killed when it goes out of scope.
pub struct Served {
    child: Child,
    /// Where the first port listens.
    pub address: String,
}

impl Served {
    /// Serves the scene in which every kind of project answers.
    pub fn start(kind: &str, brand: &str, more: &[&str]) -> Self {
        let scene = asset("scenes/interface.toml");
        let listen = format!("{kind}=127.0.0.1:0");
        let brand = format!("interface.brand={brand}");
        let mut child = Command::new(BINARY)
            .args(["serve", &scene, "--listen", &listen, "--set", &brand])
            .args(more)
            .arg("--json")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program starts");
        let mut line = String::new();
        BufReader::new(child.stdout.take().expect("piped"))
            .read_line(&mut line)
            .expect("a ready line");
        let ready: serde_json::Value = serde_json::from_str(&line).expect("one line of JSON");
        let address = ready["listening"][0]["addr"].as_str().expect("an address");
        Self {
            address: address.to_owned(),
            child,
        }
    }

    /// Sends connections to the address in the programs here.
    pub fn route(&self) -> String {
        format!("127.0.0.1:50000={}", self.address)
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
