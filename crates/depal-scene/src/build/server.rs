//! The vision server of a scene: its port, and what it must know of the projects.

use depal_frames::EulerConvention;
use depal_interface::{
    AsciiTerminator, BranchStep, Encoding, FaultScript, HexPlanCells, HexReplyLength, IndexStep,
    OutputPort, ParameterRange, PointCell8, PortSettings, Profile, ServerSettings, StateReply,
    Status, StepParameter, Variable, VariableKind, VisionProject, VizProject,
};
use depal_time::SimDuration;
use depal_workflow::{Project, Writable};

use crate::interface::{
    AllFetched, Interface, InterfaceProfile, LastCell, PlanCells, ReadyReply, ReplyLength,
    ReplyTerminator, RobotBrand, VariableContent, WireEncoding,
};
use crate::scene::Scene;
use crate::vision::ProjectOutput;

/// One port, and what the server must know of the projects.
pub(super) fn server(scene: &Scene, workflow: &Project) -> ServerSettings {
    let projects = scene.vision.project.iter().map(|project| VisionProject {
        id: i32::from(project.id),
        recipes: project.recipes.iter().map(|r| i32::from(r.id)).collect(),
        output: match project.output {
            ProjectOutput::Poses => OutputPort::Poses,
            ProjectOutput::Custom => OutputPort::Custom,
            ProjectOutput::Path => OutputPort::Path,
        },
        input_steps: project.input_steps.clone(),
    });
    let variables = scene.interface.variable.iter().map(|variable| Variable {
        name: variable.name.clone(),
        kind: match variable.kind {
            VariableContent::Number => VariableKind::Number,
            VariableContent::Numbers => VariableKind::Numbers,
            VariableContent::Text => VariableKind::Text,
            VariableContent::Texts => VariableKind::Texts,
        },
    });
    ServerSettings {
        ports: vec![port(&scene.interface)],
        projects: projects.collect(),
        viz: Some(viz(workflow)),
        solutions: scene
            .interface
            .solutions
            .iter()
            .map(|s| i32::from(*s))
            .collect(),
        variables: variables.collect(),
        property_config: scene.viz.property_config.clone().unwrap_or_default(),
        faults: FaultScript::parse(&scene.interface.inject)
            .expect("the reader refuses wrong faults"),
        ..ServerSettings::default()
    }
}

/// The profile's rules, with the switches that the scene sets by themselves.
fn port(interface: &Interface) -> PortSettings {
    let profile = match interface.profile {
        InterfaceProfile::V1_5 => Profile::v1_5(),
        InterfaceProfile::V1_7 => Profile::v1_7(),
        InterfaceProfile::V1_8 => Profile::v1_8(),
        InterfaceProfile::V2_1 => Profile::v2_1(),
        InterfaceProfile::V2_2 => Profile::v2_2(),
    };
    let own = PortSettings::of_profile(profile.clone());
    PortSettings {
        encoding: match interface.encoding {
            WireEncoding::Ascii | WireEncoding::Auto => Encoding::Ascii,
            WireEncoding::HexLe | WireEncoding::S7 => Encoding::HexLittleEndian,
            WireEncoding::HexBe => Encoding::HexBigEndian,
        },
        detects_encoding: interface.encoding == WireEncoding::Auto,
        euler: match interface.brand {
            RobotBrand::Abb => EulerConvention::AbbZyx,
            RobotBrand::Kuka => EulerConvention::KukaAbc,
            RobotBrand::Fanuc => EulerConvention::FanucWpr,
        },
        timeout: SimDuration::from_secs_f64(interface.timeout_s),
        all_fetched: interface
            .all_fetched
            .map_or(own.all_fetched, |code| match code {
                AllFetched::NoResult => Status::NoVisionResult,
                AllFetched::AlreadySent => Status::VisionDoListMissing,
            }),
        notify_hold: interface
            .notify_hold_s
            .map_or(own.notify_hold, SimDuration::from_secs_f64),
        profile: switched(profile, interface),
    }
}

fn switched(profile: Profile, interface: &Interface) -> Profile {
    Profile {
        ascii_terminator: interface.ascii_terminator.map_or(
            profile.ascii_terminator,
            |terminator| match terminator {
                ReplyTerminator::None => AsciiTerminator::None,
                ReplyTerminator::Cr => AsciiTerminator::Cr,
                ReplyTerminator::Lf => AsciiTerminator::Lf,
                ReplyTerminator::CrLf => AsciiTerminator::CrLf,
            },
        ),
        ascii_trailing_comma: interface
            .ascii_trailing_comma
            .unwrap_or(profile.ascii_trailing_comma),
        ascii_decimals: interface
            .ascii_decimals
            .map_or(profile.ascii_decimals, |most| most as usize),
        hex_request_len: interface
            .hex_request_len
            .map_or(profile.hex_request_len, |bytes| bytes as usize),
        hex_reply: interface
            .hex_reply
            .map_or(profile.hex_reply, |length| match length {
                ReplyLength::Fixed => HexReplyLength::Fixed,
                ReplyLength::Exact => HexReplyLength::Exact,
            }),
        pose_cap: interface.pose_cap as usize,
        point_cell8: interface
            .point_cell8
            .map_or(profile.point_cell8, |cell| match cell {
                LastCell::Velocity => PointCell8::Velocity,
                LastCell::ToolId => PointCell8::ToolId,
            }),
        state_reply: interface
            .state_reply
            .map_or(profile.state_reply, |reply| match reply {
                ReadyReply::Ready => StateReply::Ready,
                ReadyReply::Fields => StateReply::Fields,
            }),
        has_vision_plan_velocity: interface
            .vision_plan_velocity
            .unwrap_or(profile.has_vision_plan_velocity),
        hex_plan_cells: interface.hex_plan_cells.map_or(
            profile.hex_plan_cells,
            |cells| match cells {
                PlanCells::SinglePrecision => HexPlanCells::SinglePrecision,
                PlanCells::IntegerCounts => HexPlanCells::IntegerCounts,
            },
        ),
        pads_plan_points: interface
            .pads_plan_points
            .unwrap_or(profile.pads_plan_points),
        ..profile
    }
}

fn viz(workflow: &Project) -> VizProject {
    let branches = workflow.branches().into_iter();
    let index_steps = workflow.index_steps().into_iter();
    let parameters = workflow.parameters().into_iter();
    VizProject {
        branches: branches
            .map(|(step, exits)| BranchStep {
                step,
                exits: exits as i32,
            })
            .collect(),
        index_steps: index_steps
            .map(|(step, places)| IndexStep {
                step,
                places: places as i32,
            })
            .collect(),
        parameters: parameters
            .map(|parameter| StepParameter {
                step: parameter.step,
                key: parameter.key.to_owned(),
                value: parameter.value,
                writable: parameter.writable.map(range),
            })
            .collect(),
    }
}

fn range(writable: Writable) -> ParameterRange {
    let (low, high) = writable.bounds();
    ParameterRange {
        low,
        excludes_low: writable == Writable::Velocity,
        high,
        is_whole: writable == Writable::Count,
    }
}
