use depal_cell::spec::{CellSpec, SectionSignals};
use depal_frames::EulerConvention;
use depal_tp::{ByteOrder, GroupOutput, Options, Tasks};
use depal_vm::SourceFile;

use super::Translated;
use crate::robot::{HexByteOrder, Robot};

/// Digital outputs that are the bits of a group signal of the gripper.
fn group((signal, place): (&String, u32)) -> GroupOutput {
    GroupOutput {
        signal: signal.clone(),
        first: place * 16,
        bits: 16,
    }
}

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
        groups: match &spec.wiring.sections {
            SectionSignals::Groups(groups) => groups.iter().zip(0..).map(group).collect(),
            SectionSignals::Single(_) => Vec::new(),
        },
        tools: vec![(1, EulerConvention::FanucWpr.mm_deg_from_pose(&tool))],
        ..Options::default()
    };
    let loaded = depal_tp::load(sources, &options, entry);
    Translated {
        program: loaded.program,
        diagnostics: loaded.diagnostics,
        task: |program| Box::new(Tasks::new(program, "MAIN")),
    }
}
