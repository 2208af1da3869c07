//! The robot-facing interface of the vision server, and how long things take on the way.

use depal_interface::FaultScript;
use serde_json::{Value as Json, json};

use crate::choice::{choice, one_of};
use crate::document::{Node, Value};
use crate::reader::{Reader, Rule, section};
use crate::rules::{number, whole};

choice! {
    /// How the server writes and reads cells on the wire.
    pub enum WireEncoding {
        /// Numbers as text, separated by commas.
        Ascii = "ascii",
        /// Binary cells of four bytes, least significant byte first.
        HexLe = "hex-le",
        /// Binary cells of four bytes, most significant byte first.
        HexBe = "hex-be",
    }
}

choice! {
    /// Version of the interface that the server speaks.
    pub enum InterfaceProfile {
        /// Version 1.8.
        V1_8 = "v1_8",
    }
}

choice! {
    /// Make of the robot: decides the order of Euler angles.
    pub enum RobotBrand {
        /// ABB.
        Abb = "abb",
        /// FANUC.
        Fanuc = "fanuc",
        /// KUKA.
        Kuka = "kuka",
    }
}

section! {
    /// The server's side of the Standard Interface. The robot's side is what its program sends.
    pub struct Interface {
        /// How cells are written.
        /// Default hex-le: what ABB and KUKA modules use in the field.
        encoding: WireEncoding, one_of(), default(WireEncoding::HexLe);
        /// Version that is spoken.
        /// Default v1_8: what the module inside the program is written for.
        profile: InterfaceProfile, one_of(), default(InterfaceProfile::V1_8);
        /// Make of the robot.
        /// Default abb: the arm of the demo.
        brand: RobotBrand, one_of(), default(RobotBrand::Abb);
        /// Port that the robot program connects to.
        /// Default 50000: the port of the interface's own examples.
        port: u16, whole(1, 65_535), default(50_000);
        /// Poses in one reply; more are sent in parts.
        /// Default 20, the interface's own; at most 30 fit into a robot's receive buffer.
        pose_cap: u32, whole(1, 30), default(20);
        /// Longest wait of a request for a result, s, before it is answered with a timeout status.
        /// Default 10: the interface's own.
        timeout_s: f64, number(0.0, 3600.0), default(10.0);
        /// Faults on demand, to try a program's error handling, as in status=1019@command=102,n=2.
        /// Also no_points@pick=4, camera_lost@t=10s, delay=12s@command=205, drop_connection@reply=7, split_replies.
        /// Default none: nothing goes wrong by itself.
        inject: Vec<String>, Faults, default(Vec::new());
    }
}

/// Faults, one or several in each text.
struct Faults;

impl Rule for Faults {
    type Output = Vec<String>;

    fn read(&self, node: &Node, key: &str, reader: &mut Reader<'_>) -> Option<Vec<String>> {
        let Value::List(items) = &node.value else {
            reader.unexpected(node, key, "a list of faults, as in [\"no_points@pick=4\"]");
            return None;
        };
        let mut faults = Vec::new();
        for (place, item) in items.iter().enumerate() {
            let key = format!("{key}[{place}]");
            let Value::Text(text) = &item.value else {
                reader.unexpected(item, &key, "a fault, as in \"no_points@pick=4\"");
                continue;
            };
            match FaultScript::parse(&[text]) {
                Ok(_) => faults.push(text.clone()),
                Err(mut error) => {
                    let hint = error.hint.take();
                    reader.problem(&item.place, &key, error.to_string(), hint);
                }
            }
        }
        (faults.len() == items.len()).then_some(faults)
    }

    fn schema(&self) -> Json {
        json!({"type": "array", "items": {"type": "string"}})
    }
}

section! {
    /// How much simulated time the computing takes. Real computing time never enters a run.
    pub struct Latency {
        /// From the picture to the poses, s.
        /// Default 0.3: a usual time of box detection on an industrial computer.
        vision_s: f64, number(0.0, 60.0), default(0.3);
        /// From the poses to the path, s.
        /// Default 0.1: one pick on an industrial computer; not our own computing time.
        planning_s: f64, number(0.0, 60.0), default(0.1);
        /// One way on the network, ms.
        /// Default 1: a switch and two interrupt handlers.
        network_ms: f64, number(0.0, 10_000.0), default(1.0);
    }
}
