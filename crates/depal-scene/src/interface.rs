//! The robot-facing interface of the vision server, and how long things take on the way.

use depal_interface::FaultScript;
use serde_json::{Value as Json, json};

use crate::choice::{choice, one_of};
use crate::document::{Node, Value};
use crate::reader::{Reader, Rule, section};
use crate::rules::{Flag, ListOf, Maybe, Text, number, table, whole};

choice! {
    /// How the server writes and reads cells on the wire.
    pub enum WireEncoding {
        /// Numbers as text, separated by commas.
        Ascii = "ascii",
        /// Binary cells of four bytes, least significant byte first.
        HexLe = "hex-le",
        /// Binary cells of four bytes, most significant byte first.
        HexBe = "hex-be",
        /// Found out from the first bytes of each connection.
        Auto = "auto",
        /// An S7 data block that the server polls at the controller of `[plc]`.
        S7 = "s7",
    }
}

choice! {
    /// Version of the interface that the server speaks.
    pub enum InterfaceProfile {
        /// Version 1.5 and older.
        V1_5 = "v1_5",
        /// Versions 1.6 and 1.7.
        V1_7 = "v1_7",
        /// Version 1.8.
        V1_8 = "v1_8",
        /// Versions 2.0 and 2.1.
        V2_1 = "v2_1",
        /// Version 2.2.
        V2_2 = "v2_2",
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

choice! {
    /// What ends a reply in text.
    pub enum ReplyTerminator {
        /// Nothing.
        None = "none",
        /// Carriage return.
        Cr = "cr",
        /// Line feed.
        Lf = "lf",
        /// Both.
        CrLf = "crlf",
    }
}

choice! {
    /// How long a binary reply is.
    pub enum ReplyLength {
        /// Always as long as a full one.
        Fixed = "fixed",
        /// Just its cells.
        Exact = "exact",
    }
}

choice! {
    /// The last cell of a point.
    pub enum LastCell {
        /// Velocity in percent.
        Velocity = "velocity",
        /// Number of the tool.
        ToolId = "tool_id",
    }
}

choice! {
    /// What 901 answers when all is well.
    pub enum ReadyReply {
        /// 1101.
        Ready = "ready",
        /// 9100 and three flags.
        Fields = "fields",
    }
}

choice! {
    /// How whole numbers among the plan values are packed.
    pub enum PlanCells {
        /// All in single precision.
        SinglePrecision = "single_precision",
        /// Labels, counts and orientations as integers.
        IntegerCounts = "integer_counts",
    }
}

choice! {
    /// What 102 answers when every point has been fetched.
    pub enum AllFetched {
        /// 1002, no result.
        NoResult = "1002",
        /// 1008, as older versions said.
        AlreadySent = "1008",
    }
}

choice! {
    /// What a global variable holds.
    pub enum VariableContent {
        /// A number (504).
        Number = "number",
        /// A list of numbers (505).
        Numbers = "numbers",
        /// A text (506).
        Text = "text",
        /// A list of texts (507).
        Texts = "texts",
    }
}

section! {
    /// A global variable that commands 504 to 507 may set.
    pub struct Variable {
        /// Its name, without commas.
        name: String, Text, required;
        /// What it holds.
        /// Default number.
        kind: VariableContent, one_of(), default(VariableContent::Number);
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
        /// How long a message waits for 601, s.
        /// Default: 1, from v2_2 on 3.
        notify_hold_s: Option<f64>, Maybe(number(0.0, 3600.0)), default(None);
        /// What ends a reply in text.
        /// Default: cr, in v1_5 none.
        ascii_terminator: Option<ReplyTerminator>, Maybe(one_of()), default(None);
        /// A comma after the last field of a reply in text.
        /// Default: only in v1_5.
        ascii_trailing_comma: Option<bool>, Maybe(Flag), default(None);
        /// Most decimals of a real number in text.
        /// Default: 4.
        ascii_decimals: Option<u32>, Maybe(whole(1, 9)), default(None);
        /// Bytes of a binary request, unless a connection shows another length.
        /// Default: 64, in v1_5 56. KUKA sends 660, which is found out.
        hex_request_len: Option<u32>, Maybe(whole(56, 660)), default(None);
        /// How long a binary reply is.
        /// Default: fixed; a reader of fixed lengths needs it.
        hex_reply: Option<ReplyLength>, Maybe(one_of()), default(None);
        /// The last cell of a point.
        /// Default: velocity, from v2_1 on tool_id.
        point_cell8: Option<LastCell>, Maybe(one_of()), default(None);
        /// What 901 answers when all is well.
        /// Default: ready, in v2_2 fields.
        state_reply: Option<ReadyReply>, Maybe(one_of()), default(None);
        /// Whether 111 tells the velocity.
        /// Default: true, in v2_2 false.
        vision_plan_velocity: Option<bool>, Maybe(Flag), default(None);
        /// How whole numbers among the plan values of 111 and 210 are packed in binary.
        /// Default: single_precision; no source says.
        hex_plan_cells: Option<PlanCells>, Maybe(one_of()), default(None);
        /// Whether 210 ends waypoints that pick nothing with a count of 0.
        /// Default: false.
        pads_plan_points: Option<bool>, Maybe(Flag), default(None);
        /// What 102 answers when every point has been fetched.
        /// Default: 1002, in v1_5 1008.
        all_fetched: Option<AllFetched>, Maybe(one_of()), default(None);
        /// Solutions that 104 may switch to; a switch is noted and changes nothing else.
        /// Default: none.
        solutions: Vec<u16>, ListOf(whole(1, 999), 0, 99), default(Vec::new());
        /// Global variables that 504 to 507 may set; a value is noted and changes nothing else.
        /// Default: none.
        variable: Vec<Variable>, ListOf(table(), 0, 99), default(Vec::new());
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
