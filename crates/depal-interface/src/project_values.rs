//! Values that robots hand to projects or read from them: commands 104, 207, 208, 502 and 504 to 507.

use depal_wire::{
    ReadParameter, Reply, SetNumber, SetNumbers, SetOuterPose, SetText, SetTexts, Status,
    SwitchSolution, WriteParameter,
};

use crate::job::{Job, VariableValue};
use crate::property_config::PropertyValue;
use crate::session::Session;
use crate::settings::VariableKind;
use crate::vision_run::VisionRun;
use crate::viz_run::VizRun;

impl Session {
    pub(crate) fn switch_solution(&mut self, request: &SwitchSolution) -> Status {
        let runs = matches!(self.viz, VizRun::Running { .. })
            || self.vision.values().any(VisionRun::is_running);
        if runs || !self.solutions.contains(&request.solution) {
            return Status::SolutionNotSwitched;
        }
        self.jobs.push_back(Job::SwitchSolution {
            port: self.port,
            solution: request.solution,
        });
        Status::SolutionSwitched
    }

    pub(crate) fn read_parameter(&self, request: &ReadParameter) -> Reply {
        let refuse = |status| Reply::status(207, status);
        let Some(line) = self.property_config.read(request.id) else {
            return refuse(Status::UnknownConfigId);
        };
        let found = self.parameters.get(&(line.step, line.key.clone()));
        found.map_or_else(
            || refuse(Status::StepParameterNotRead),
            |parameter| Reply::Parameter(parameter.value),
        )
    }

    /// All lines of the id, or none of them.
    pub(crate) fn write_parameter(&mut self, request: &WriteParameter) -> Status {
        let Some(lines) = self.property_config.writes(request.id) else {
            return Status::UnknownConfigId;
        };
        let mut writes = Vec::new();
        for line in lines {
            let place = (line.step, line.key.clone());
            let PropertyValue::Number(value) = line.value else {
                return Status::StepParameterNotSet;
            };
            let range = self.parameters.get(&place).and_then(|p| p.writable);
            if !range.is_some_and(|range| range.holds(value)) {
                return Status::StepParameterNotSet;
            }
            writes.push((place, value));
        }
        for ((step, key), value) in writes {
            self.jobs.push_back(Job::WriteParameter {
                port: self.port,
                step,
                key: key.clone(),
                value,
            });
            if let Some(parameter) = self.parameters.get_mut(&(step, key)) {
                parameter.value = value;
            }
        }
        Status::StepParameterSet
    }

    pub(crate) fn set_outer_pose(&mut self, request: &SetOuterPose) -> Status {
        let Some(base_from_tcp) = self.near_pose(&request.pose) else {
            return Status::InvalidVizPose;
        };
        self.jobs.push_back(Job::SetOuterPose {
            port: self.port,
            base_from_tcp,
        });
        Status::OuterPoseSet
    }

    pub(crate) fn set_number(&mut self, request: &SetNumber) -> Status {
        let value = VariableValue::Number(request.value);
        self.set_variable(&request.name, VariableKind::Number, value)
    }

    pub(crate) fn set_numbers(&mut self, request: &SetNumbers) -> Status {
        let value = VariableValue::Numbers(request.values.clone());
        self.set_variable(&request.name, VariableKind::Numbers, value)
    }

    pub(crate) fn set_text(&mut self, request: &SetText) -> Status {
        let value = VariableValue::Text(request.value.clone());
        self.set_variable(&request.name, VariableKind::Text, value)
    }

    pub(crate) fn set_texts(&mut self, request: &SetTexts) -> Status {
        let value = VariableValue::Texts(request.values.clone());
        self.set_variable(&request.name, VariableKind::Texts, value)
    }

    fn set_variable(&mut self, name: &str, kind: VariableKind, value: VariableValue) -> Status {
        let known = self.variables.iter().find(|known| known.name == name);
        if known.is_none_or(|known| known.kind != kind) {
            return Status::VariableNotSet;
        }
        self.jobs.push_back(Job::SetVariable {
            port: self.port,
            name: name.to_owned(),
            value,
        });
        Status::VariableSet
    }
}
