//! Reading a file of planning problems: every fault is told with the file, the key and what stands there.

use std::path::Path;

use depal_arm::{Arm, ArmWarning, Load};
use depal_frames::{
    JointPositions, PlacedShape, Point, Pose, Rotation, Vector, nalgebra::Quaternion,
};
use depal_planner::TransferScene;
use serde_json::Value;

use crate::failure::{Failure, cannot_read};
use crate::robot_files::mesh_files;

/// Acceleration limits that are left out: full speed in this time, s.
const RAMP_S: f64 = 0.5;
/// A quaternion may be this much longer or shorter than 1; it is then made one.
const UNIT_SLACK: f64 = 1e-2;

/// Where to go, as it stands in the file.
pub(super) enum Goal {
    Joints(Vec<f64>),
    Tcp(Pose),
}

pub(super) struct Problem {
    pub id: Value,
    pub start: Vec<f64>,
    pub goal: Goal,
}

/// A value of the file and the way to it.
struct At<'a> {
    file: &'a str,
    key: String,
    value: &'a Value,
}

impl<'a> At<'a> {
    fn fault(&self, message: &str) -> Failure {
        let key = if self.key.is_empty() {
            String::new()
        } else {
            format!("{}: ", self.key)
        };
        Failure::Input(format!("{}: {key}{message}", self.file))
    }

    fn unexpected(&self, expected: &str) -> Failure {
        let mut found = self.value.to_string();
        if found.chars().count() > 60 {
            found = found.chars().take(57).collect::<String>() + "...";
        }
        self.fault(&format!("expected {expected}, found {found}"))
    }

    fn inside(&self, key: &str, value: &'a Value) -> At<'a> {
        let dot = if self.key.is_empty() { "" } else { "." };
        At {
            file: self.file,
            key: format!("{}{dot}{key}", self.key),
            value,
        }
    }

    /// A key that may be missing; `null` counts as missing.
    fn optional(&self, key: &str) -> Result<Option<At<'a>>, Failure> {
        let object = self
            .value
            .as_object()
            .ok_or_else(|| self.unexpected("an object"))?;
        let found = object.get(key).filter(|value| !value.is_null());
        Ok(found.map(|value| self.inside(key, value)))
    }

    fn required(&self, key: &str) -> Result<At<'a>, Failure> {
        self.optional(key)?
            .ok_or_else(|| self.fault(&format!("the key '{key}' is missing")))
    }

    fn unknown_keys(&self, known: &[&str]) -> Vec<String> {
        let object = self.value.as_object();
        let keys = object.into_iter().flat_map(serde_json::Map::keys);
        keys.filter(|k| !known.contains(&k.as_str()))
            .cloned()
            .collect()
    }

    /// Keys that nobody reads are told, not obeyed.
    fn warn_unknown(&self, known: &[&str]) {
        for key in self.unknown_keys(known) {
            let place = self.inside(&key, self.value).key;
            tell!("warning: {}: {place}: unknown key, left out", self.file);
        }
    }

    fn items(&self) -> Result<Vec<At<'a>>, Failure> {
        let array = self
            .value
            .as_array()
            .ok_or_else(|| self.unexpected("an array"))?;
        let item = |(i, value): (usize, &'a Value)| At {
            file: self.file,
            key: format!("{}[{i}]", self.key),
            value,
        };
        Ok(array.iter().enumerate().map(item).collect())
    }

    fn text(&self) -> Result<&'a str, Failure> {
        self.value.as_str().ok_or_else(|| self.unexpected("a text"))
    }

    fn number(&self) -> Result<f64, Failure> {
        self.value
            .as_f64()
            .filter(|v| v.is_finite())
            .ok_or_else(|| self.unexpected("a number"))
    }

    fn numbers(&self) -> Result<Vec<f64>, Failure> {
        self.items()?.iter().map(At::number).collect()
    }

    fn exactly<const N: usize>(&self) -> Result<[f64; N], Failure> {
        let numbers = self.numbers()?;
        let found = numbers.len();
        numbers
            .try_into()
            .map_err(|_| self.fault(&format!("expected {N} numbers, found {found}")))
    }

    fn limits(&self, joints: usize) -> Result<Vec<f64>, Failure> {
        let limits = self.items()?;
        if limits.len() != joints {
            let found = limits.len();
            return Err(self.fault(&format!(
                "expected {joints} numbers, one per joint of the robot, found {found}"
            )));
        }
        let positive = |limit: &At| match limit.number()? {
            value if value > 0.0 => Ok(value),
            _ => Err(limit.unexpected("a positive number")),
        };
        limits.iter().map(positive).collect()
    }

    fn rotation(&self) -> Result<Rotation, Failure> {
        let [w, i, j, k] = self.exactly::<4>()?;
        let quaternion = Quaternion::new(w, i, j, k);
        let length = quaternion.norm();
        if (length - 1.0).abs() > UNIT_SLACK {
            return Err(self.fault(&format!("quaternion of length {length}, expected 1")));
        }
        Ok(Rotation::from_quaternion(quaternion))
    }

    fn cuboid(&self, known: &[&str]) -> Result<PlacedShape, Failure> {
        let centre = self.required("center")?.exactly::<3>()?;
        let size_at = self.required("size")?;
        let size = size_at.exactly::<3>()?;
        if let Some(i) = size.iter().position(|s| *s <= 0.0) {
            return Err(size_at.fault(&format!(
                "side {i} is {} m, expected a positive length",
                size[i]
            )));
        }
        let turn = match self.optional("quat_wxyz")? {
            Some(at) => at.rotation()?,
            None => Rotation::identity(),
        };
        if let Some(key) = self.unknown_keys(known).first() {
            let known = known.join(", ");
            return Err(self.fault(&format!("unknown key '{key}', expected {known}")));
        }
        let pose = Pose::from_parts(Vector::from(centre).into(), turn);
        Ok(PlacedShape::cuboid(pose, Vector::from(size)))
    }

    fn goal(&self) -> Result<Goal, Failure> {
        if self.value.is_array() {
            return Ok(Goal::Joints(self.numbers()?));
        }
        if !self.value.is_object() {
            return Err(self.unexpected("an array of joints or {\"tcp_xyz\", \"tcp_quat_wxyz\"}"));
        }
        let known = ["tcp_xyz", "tcp_quat_wxyz"];
        let at = self.required(known[0])?.exactly::<3>()?;
        let turn = self.required(known[1])?.rotation()?;
        if let Some(key) = self.unknown_keys(&known).first() {
            return Err(self.fault(&format!("unknown key '{key}'")));
        }
        Ok(Goal::Tcp(Pose::from_parts(Vector::from(at).into(), turn)))
    }

    fn problem(&self) -> Result<Problem, Failure> {
        self.warn_unknown(&["id", "start", "goal"]);
        Ok(Problem {
            id: self.required("id")?.value.clone(),
            start: self.required("start")?.numbers()?,
            goal: self.required("goal")?.goal()?,
        })
    }
}

/// The scene and the problems of a file.
pub(super) fn read(path: &Path) -> Result<(TransferScene, Vec<Problem>), Failure> {
    let file = path.to_string_lossy();
    let value: Value = serde_json::from_str(&text(path)?)
        .map_err(|error| Failure::Input(format!("{file}: not JSON: {error}")))?;
    let root = At {
        file: &file,
        key: String::new(),
        value: &value,
    };
    let robot = root.required("robot")?;
    let arm = robot_at(path, &robot)?;
    root.warn_unknown(&[
        "robot",
        "tcp_link",
        "attached",
        "obstacles",
        "velocity_limits",
        "acceleration_limits",
        "allowed_pairs",
        "problems",
    ]);
    let speeds = match root.optional("velocity_limits")? {
        Some(limits) => limits.limits(arm.joint_count())?,
        None => arm.limits().iter().map(|l| l.max_speed).collect(),
    };
    let accelerations: Vec<f64> = if let Some(limits) = root.optional("acceleration_limits")? {
        limits.limits(arm.joint_count())?
    } else {
        tell!("warning: {file}: no acceleration_limits; full speed is taken to need {RAMP_S} s");
        speeds.iter().map(|v| v / RAMP_S).collect()
    };
    let arm = arm
        .with_rates(&speeds, &accelerations)
        .map_err(|error| root.fault(&error.to_string()))?;
    let scene = scene(&root, arm)?;
    let problems = root.required("problems")?.items()?;
    let problems: Result<Vec<Problem>, Failure> = problems.iter().map(At::problem).collect();
    Ok((scene, problems?))
}

/// Reads the description, relative to the problem file.
fn robot_at(path: &Path, robot: &At) -> Result<Arm, Failure> {
    let urdf = path.parent().unwrap_or(Path::new("")).join(robot.text()?);
    let name = urdf.to_string_lossy();
    let text =
        std::fs::read_to_string(&urdf).map_err(|error| robot.fault(&cannot_read(&urdf, error)))?;
    let meshes = mesh_files(&urdf);
    let arm = Arm::from_urdf_uniform_with_meshes(&text, &name, 1.0, &|mesh| meshes.bytes(mesh))
        .map_err(|error| Failure::Input(error.to_string()))?;
    for warning in arm.warnings() {
        // What is only to look at does not matter here.
        if !matches!(warning, ArmWarning::MeshSkipped { .. }) {
            tell!("warning: {warning}");
        }
    }
    Ok(arm)
}

fn scene(root: &At, arm: Arm) -> Result<TransferScene, Failure> {
    let link = |at: &At| {
        let name = at.text()?;
        let known = arm.links().iter().position(|l| l.name == name);
        known.ok_or_else(|| at.fault(&format!("the robot has no link '{name}'")))
    };
    let tcp_link = match root.optional("tcp_link")? {
        Some(at) => Some(link(&at)?),
        None => None,
    };
    let list = |key: &str| match root.optional(key)? {
        Some(at) => at.items(),
        None => Ok(Vec::new()),
    };
    let mut attached = Vec::new();
    let mut load = Load::NONE;
    for at in list("attached")? {
        let on = match (at.optional("link")?, tcp_link) {
            (Some(name), _) => link(&name)?,
            (None, Some(tcp)) => tcp,
            (None, None) => return Err(at.fault("the key 'link' is missing")),
        };
        let body = at.cuboid(&["center", "size", "quat_wxyz", "link", "mass_kg"])?;
        if let Some(mass) = at.optional("mass_kg")? {
            load = load.and(&weight(&arm, on, &body, &mass)?);
        }
        attached.push((on, body));
    }
    let mut obstacles = Vec::new();
    for at in list("obstacles")? {
        obstacles.push(at.cuboid(&["center", "size", "quat_wxyz"])?);
    }
    let mut allowed_pairs = Vec::new();
    for at in list("allowed_pairs")? {
        let pair = at.items()?;
        let [first, second] = pair.as_slice() else {
            return Err(at.unexpected("two link names"));
        };
        for name in [first, second] {
            if link(name).is_err() {
                let said = name.text()?;
                tell!(
                    "warning: {}: {}: the robot has no link '{said}'",
                    root.file,
                    name.key
                );
            }
        }
        allowed_pairs.push((first.text()?.to_owned(), second.text()?.to_owned()));
    }
    Ok(TransferScene {
        arm,
        attached,
        load,
        obstacles,
        allowed_pairs,
        tcp_link,
    })
}

/// A body's mass as a point in its middle, at the flange.
fn weight(arm: &Arm, link: usize, body: &PlacedShape, mass: &At) -> Result<Load, Failure> {
    let kilograms = mass.number()?;
    if kilograms < 0.0 {
        return Err(mass.unexpected("a mass of 0 kg or more"));
    }
    let offset = |joints: &JointPositions| {
        arm.base_from_flange(joints).inverse() * arm.base_from_links(joints)[link]
    };
    let mut bent = JointPositions::zeros(arm.joint_count());
    bent.fill(0.3);
    let flange_from_link = offset(&JointPositions::zeros(arm.joint_count()));
    let there = offset(&bent);
    let moved = (there.translation.vector - flange_from_link.translation.vector).norm();
    if moved > 1e-6 || there.rotation.angle_to(&flange_from_link.rotation) > 1e-6 {
        let name = &arm.links()[link].name;
        return Err(mass.fault(&format!(
            "only what is fixed to the flange may have a mass, and '{name}' moves against it"
        )));
    }
    let middle = flange_from_link * Point::from(body.pose.translation.vector);
    Ok(Load::point(kilograms, middle))
}

fn text(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path).map_err(|error| Failure::unread(path, error))
}
