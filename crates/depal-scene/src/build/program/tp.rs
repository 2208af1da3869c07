use depal_cell::spec::CellSpec;
use depal_frames::EulerConvention;
use depal_tp::{ByteOrder, Options};
use depal_vm::SourceFile;

use super::Translated;
use crate::robot::{HexByteOrder, Robot};

/// TP listings; tool 1 is the scene's gripper.
pub(super) fn load(
    sources: &[SourceFile],
    robot: &Robot,
    spec: &CellSpec,
    entry: &str,
) -> Translated {
    let tool = spec.gripper.flange_from_tcp;
    let options = Options {
        byte_order: match robot.hex_byte_order {
            HexByteOrder::Big => ByteOrder::BigEndian,
            HexByteOrder::Little => ByteOrder::LittleEndian,
        },
        tools: vec![(1, EulerConvention::FanucWpr.mm_deg_from_pose(&tool))],
        ..Options::default()
    };
    let loaded = depal_tp::load(sources, &options, entry);
    Translated {
        program: loaded.program,
        diagnostics: loaded.diagnostics,
        task_name: "MAIN",
    }
}
