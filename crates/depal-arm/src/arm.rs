use depal_frames::{JointPositions, PlacedShape, Pose};

use crate::{
    ArmError, ArmWarning,
    chain::{Chain, Motion},
    dynamics::Dynamics,
    opw::Solver,
    palletizer::Palletizer,
    shapes::MeshSource,
    source::Place,
    urdf::{self, Accelerations},
    verify::check_forward,
};

mod inverse;

/// What one joint may do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointLimit {
    /// Smallest position, rad.
    pub lower: f64,
    /// Largest position, rad.
    pub upper: f64,
    /// Largest speed either way, rad/s.
    pub max_speed: f64,
    /// Largest acceleration either way, rad/s2; not part of a URDF.
    pub max_acceleration: f64,
}

/// One rigid part of the arm. Shapes are in the link's own frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Link {
    /// As in the file.
    pub name: String,
    /// Solids for physics and planning.
    pub collision: Vec<PlacedShape>,
    /// Solids for cameras and viewers, with their colour (sRGB).
    pub visual: Vec<(PlacedShape, [u8; 3])>,
    /// Mass, kg; 0 when the file gives none.
    pub mass: f64,
}

/// An arm: constant geometry and limits. See the crate's first page.
#[derive(Debug, Clone)]
pub struct Arm {
    name: String,
    joint_names: Vec<String>,
    limits: Vec<JointLimit>,
    links: Vec<Link>,
    pub(crate) chain: Chain,
    pub(crate) dynamics: Dynamics,
    inverse: Inverse,
    /// To the frame in which the closed form is.
    model_from_base: Pose,
    tip: String,
    warnings: Vec<ArmWarning>,
}

/// How joints are found for a flange pose.
#[derive(Debug, Clone)]
pub(crate) enum Inverse {
    /// Six axes, ortho-parallel with a spherical wrist.
    Wrist(Box<Solver>),
    /// Four axes with a parallelogram.
    Palletizer(Palletizer),
    Numeric,
}

/// A solution may lie outside a limit by this much, rad; it is then put onto the limit.
const LIMIT_SLACK: f64 = 1e-9;

impl Arm {
    /// Reads a URDF.
    ///
    /// `source_name` stands in error messages. `max_accelerations` in rad/s2, one per joint from base to flange.
    ///
    /// # Errors
    /// See [`ArmError`]: every fault names file and element.
    pub fn from_urdf(
        text: &str,
        source_name: &str,
        max_accelerations: &[f64],
    ) -> Result<Self, ArmError> {
        Self::load(
            text,
            source_name,
            &Accelerations::PerJoint(max_accelerations),
            None,
        )
    }

    /// The same with collision meshes: `meshes` gives the bytes of a file by its name in the description
    /// (`package://...`, a relative path), or says why it does not.
    ///
    /// STL (binary and text), Wavefront OBJ and COLLADA files are read, by their ending; each becomes its convex hull.
    /// A mesh that cannot be had leaves a warning in [`Arm::warnings`], as does every visual mesh.
    ///
    /// # Errors
    /// See [`ArmError`].
    pub fn from_urdf_with_meshes(
        text: &str,
        source_name: &str,
        max_accelerations: &[f64],
        meshes: &MeshSource,
    ) -> Result<Self, ArmError> {
        let accelerations = Accelerations::PerJoint(max_accelerations);
        Self::load(text, source_name, &accelerations, Some(meshes))
    }

    /// [`Arm::from_urdf_with_meshes`] with the same acceleration limit for every joint, rad/s2.
    ///
    /// # Errors
    /// See [`ArmError`].
    pub fn from_urdf_uniform_with_meshes(
        text: &str,
        source_name: &str,
        max_acceleration: f64,
        meshes: &MeshSource,
    ) -> Result<Self, ArmError> {
        let accelerations = Accelerations::Uniform(max_acceleration);
        Self::load(text, source_name, &accelerations, Some(meshes))
    }

    /// Reads a URDF and gives every joint the same acceleration limit, rad/s2: for questions of geometry,
    /// or until [`Arm::with_rates`] sets true ones.
    ///
    /// # Errors
    /// See [`ArmError`]: every fault names file and element.
    pub fn from_urdf_uniform(
        text: &str,
        source_name: &str,
        max_acceleration: f64,
    ) -> Result<Self, ArmError> {
        let accelerations = Accelerations::Uniform(max_acceleration);
        Self::load(text, source_name, &accelerations, None)
    }

    fn load(
        text: &str,
        source_name: &str,
        accelerations: &Accelerations,
        meshes: Option<&MeshSource>,
    ) -> Result<Self, ArmError> {
        let loaded = urdf::load(text, source_name, accelerations, meshes)?;
        let mut warnings = loaded.warnings.clone();
        let names = &loaded.joint_names;
        let model_from_base = loaded.chain.model_from_base(names.len());
        let chain = &loaded.chain.seen_from(&model_from_base);
        let inverse = if let Some(palletizer) = Palletizer::recognise(chain, names) {
            Inverse::Palletizer(palletizer)
        } else {
            match Solver::recognise(chain, names) {
                Ok(solver) => Inverse::Wrist(Box::new(solver)),
                Err(mut reason) => {
                    let at = loaded.source.at(&reason);
                    reason += match names.len() {
                        0..=5 => {
                            "; with fewer than six joints only the poses that it can reach exactly have solutions"
                        }
                        6 => "",
                        _ => {
                            "; with more than six joints every pose has endlessly many solutions, of which up to 24 are given"
                        }
                    };
                    warnings.push(ArmWarning::NumericInverse { at, reason });
                    Inverse::Numeric
                }
            }
        };
        check_forward(&loaded, &inverse, &model_from_base, source_name)?;
        Ok(Self {
            name: loaded.robot.name,
            joint_names: loaded.joint_names,
            limits: loaded.limits,
            links: loaded.links,
            chain: loaded.chain,
            dynamics: loaded.dynamics,
            inverse,
            model_from_base,
            tip: loaded.tip,
            warnings,
        })
    }

    /// The same arm with other limits of speed (rad/s) and acceleration (rad/s2), base to flange.
    ///
    /// # Errors
    /// [`ArmError::AccelerationCount`] when a list does not fit the joints, [`ArmError::NotPositive`].
    pub fn with_rates(
        mut self,
        max_speeds: &[f64],
        max_accelerations: &[f64],
    ) -> Result<Self, ArmError> {
        for values in [max_speeds, max_accelerations] {
            if values.len() != self.limits.len() {
                return Err(ArmError::AccelerationCount {
                    at: Place::file(&self.name),
                    found: values.len(),
                    expected: self.limits.len(),
                });
            }
        }
        for (i, limit) in self.limits.iter_mut().enumerate() {
            for (what, value) in [
                ("speed", max_speeds[i]),
                ("acceleration", max_accelerations[i]),
            ] {
                if !(value > 0.0 && value.is_finite()) {
                    return Err(ArmError::NotPositive {
                        at: Place::file(&self.name),
                        element: format!("{what} limit of joint '{}'", self.joint_names[i]),
                        value,
                    });
                }
            }
            limit.max_speed = max_speeds[i];
            limit.max_acceleration = max_accelerations[i];
        }
        Ok(self)
    }

    /// What was left out of the description: meshes, joints beside the chain, a closed form.
    pub fn warnings(&self) -> &[ArmWarning] {
        &self.warnings
    }

    /// Name of the flange link.
    pub fn tip(&self) -> &str {
        &self.tip
    }

    /// Name of the robot in the file.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of driven joints between base and flange.
    pub fn joint_count(&self) -> usize {
        self.limits.len()
    }

    /// Joint names, base to flange.
    pub fn joint_names(&self) -> &[String] {
        &self.joint_names
    }

    /// Joint limits, base to flange.
    pub fn limits(&self) -> &[JointLimit] {
        &self.limits
    }

    /// All links, parents before children: the base is first.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// Whether every joint lies inside its limits (1e-9 rad of slack).
    pub fn within_limits(&self, joints: &JointPositions) -> bool {
        joints.len() == self.limits.len()
            && joints
                .iter()
                .zip(&self.limits)
                .all(|(&q, limit)| q >= limit.lower - LIMIT_SLACK && q <= limit.upper + LIMIT_SLACK)
    }

    /// Pose of the flange in the base frame.
    ///
    /// # Panics
    /// If `joints` has fewer entries than the arm.
    pub fn base_from_flange(&self, joints: &JointPositions) -> Pose {
        self.chain.base_from_tip(joints)
    }

    /// Pose of every link in the base frame, in the order of [`Arm::links`].
    ///
    /// # Panics
    /// If `joints` has fewer entries than the arm.
    pub fn base_from_links(&self, joints: &JointPositions) -> Vec<Pose> {
        self.chain.base_from_links(joints)
    }

    /// Number of joints between the base and a link, by its index in [`Arm::links`]: 0 for what never moves.
    ///
    /// # Panics
    /// If there is no such link.
    pub fn joints_below(&self, link: usize) -> usize {
        let mut count = 0;
        let mut node = Some(link);
        while let Some(index) = node {
            count += usize::from(matches!(
                self.chain.nodes[index].motion,
                Motion::Revolute { .. }
            ));
            node = self.chain.nodes[index].parent;
        }
        count
    }

    /// For every joint, how far links turn in sum for one radian of it: 1 without mimics. A palletizer's mimics turn back
    /// what their masters turn, so that nothing turns farther than the master: 1 as well.
    pub fn turn_gains(&self) -> Vec<f64> {
        let mut gains = vec![0.0; self.limits.len()];
        for node in &self.chain.nodes {
            if let Motion::Revolute {
                index, multiplier, ..
            } = &node.motion
            {
                gains[*index] += multiplier.abs();
            }
        }
        if matches!(self.inverse, Inverse::Palletizer(_)) {
            gains.fill(1.0);
        }
        gains
    }
}
