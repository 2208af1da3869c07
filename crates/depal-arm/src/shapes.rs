use depal_frames::{PlacedShape, Pose, Rotation, Shape, Vector};
use nalgebra::Translation3;
use urdf_rs::{Geometry, Robot};

use crate::{ArmError, ArmWarning, Link, dynamics::Inertial, hull, mesh, source::Source};

/// Colour of a visual without material.
const GREY: [u8; 3] = [180, 180, 180];

/// Gives the bytes of a mesh file by the name in the description, or says why not.
pub type MeshSource<'a> = dyn Fn(&str) -> Result<Vec<u8>, String> + 'a;

pub(crate) struct Reader<'a> {
    pub source: &'a Source,
    /// None: meshes are left out.
    pub meshes: Option<&'a MeshSource<'a>>,
}

/// Longest way from joint to joint, and largest mesh, m: beyond it the file counts in millimetres.
const LONGEST: f64 = 20.0;
/// What to do about a mesh in millimetres.
const IN_MILLIMETRES: &str = " (a mesh in millimetres needs scale=\"0.001 0.001 0.001\")";

/// Smallest share of the largest moment of inertia by which a tensor may miss being possible.
const INERTIA_SLACK: f64 = 1e-6;

impl Reader<'_> {
    pub fn finite(&self, element: &str, values: &[f64]) -> Result<(), ArmError> {
        match values.iter().find(|v| !v.is_finite()) {
            None => Ok(()),
            Some(&value) => Err(ArmError::NotFinite {
                at: self.source.at(element),
                element: element.to_owned(),
                value,
            }),
        }
    }

    pub fn positive(&self, element: &str, values: &[f64]) -> Result<(), ArmError> {
        self.finite(element, values)?;
        match values.iter().find(|v| **v <= 0.0) {
            None => Ok(()),
            Some(&value) => Err(ArmError::NotPositive {
                at: self.source.at(element),
                element: element.to_owned(),
                value,
            }),
        }
    }

    /// No arm is longer than [`LONGEST`].
    pub fn length(&self, element: &str, length: f64, hint: &'static str) -> Result<(), ArmError> {
        if length <= LONGEST {
            return Ok(());
        }
        Err(ArmError::TooLong {
            at: self.source.at(element),
            element: element.to_owned(),
            length,
            most: LONGEST,
            hint,
        })
    }

    pub fn pose(&self, element: &str, pose: &urdf_rs::Pose) -> Result<Pose, ArmError> {
        self.finite(&format!("{element} <origin> xyz"), &pose.xyz.0)?;
        self.finite(&format!("{element} <origin> rpy"), &pose.rpy.0)?;
        let [x, y, z] = pose.xyz.0;
        let [roll, pitch, yaw] = pose.rpy.0;
        Ok(Pose::from_parts(
            Translation3::new(x, y, z),
            Rotation::from_euler_angles(roll, pitch, yaw),
        ))
    }

    fn shape(
        &self,
        link: &str,
        kind: &'static str,
        element: &str,
        geometry: &Geometry,
    ) -> Result<Result<(Pose, Shape), ArmWarning>, ArmError> {
        let shape = match geometry {
            Geometry::Box { size } => {
                self.positive(&format!("{element} <box> size"), &size.0)?;
                Shape::Cuboid {
                    half_extents: Vector::from(size.0) * 0.5,
                }
            }
            Geometry::Cylinder { radius, length } => {
                self.positive(&format!("{element} <cylinder>"), &[*radius, *length])?;
                Shape::Cylinder {
                    half_length: length * 0.5,
                    radius: *radius,
                }
            }
            Geometry::Capsule { radius, length } => {
                self.positive(&format!("{element} <capsule>"), &[*radius, *length])?;
                Shape::Capsule {
                    half_length: length * 0.5,
                    radius: *radius,
                }
            }
            Geometry::Sphere { radius } => {
                self.positive(&format!("{element} <sphere>"), &[*radius])?;
                Shape::Sphere { radius: *radius }
            }
            Geometry::Mesh { filename, scale } => {
                let scale = scale.map_or([1.0; 3], |s| s.0);
                self.finite(&format!("{element} <mesh> scale"), &scale)?;
                if scale.contains(&0.0) {
                    return Err(ArmError::NotPositive {
                        at: self.source.at(&format!("{element} <mesh>")),
                        element: format!("{element} <mesh> scale"),
                        value: 0.0,
                    });
                }
                return self.hull(link, kind, element, filename, scale);
            }
        };
        Ok(Ok((Pose::identity(), shape)))
    }

    /// The convex hull of a collision mesh.
    fn hull(
        &self,
        link: &str,
        kind: &'static str,
        element: &str,
        mesh: &str,
        scale: [f64; 3],
    ) -> Result<Result<(Pose, Shape), ArmWarning>, ArmError> {
        let at = || self.source.at(&format!("{element} <mesh>"));
        let meshes = match self.meshes {
            Some(meshes) if kind == "collision" => meshes,
            _ => {
                return Ok(Err(ArmWarning::MeshSkipped {
                    at: at(),
                    link: link.to_owned(),
                    element: kind,
                    mesh: mesh.to_owned(),
                }));
            }
        };
        let points = meshes(mesh).and_then(|bytes| mesh::points(mesh, &bytes));
        match points {
            Ok(mut points) => {
                for point in &mut points {
                    for (value, scale) in point.iter_mut().zip(scale) {
                        *value *= scale;
                    }
                }
                let size = hull::size(&points);
                self.length(&format!("{element} <mesh> '{mesh}'"), size, IN_MILLIMETRES)?;
                Ok(Ok(hull::around(&points)))
            }
            Err(reason) => Ok(Err(ArmWarning::MeshUnread {
                at: at(),
                link: link.to_owned(),
                element: kind,
                mesh: mesh.to_owned(),
                reason,
            })),
        }
    }

    /// Where a mass sits must be finite, and a tensor that is given must belong to a body.
    fn inertia(&self, name: &str, mass: f64, tensor: &urdf_rs::Inertia) -> Result<(), ArmError> {
        let t = tensor;
        let values = [t.ixx, t.ixy, t.ixz, t.iyy, t.iyz, t.izz];
        self.finite(&format!("link '{name}' <inertia>"), &values)?;
        if mass == 0.0 && values.iter().all(|v| *v == 0.0) {
            return Ok(());
        }
        if mass == 0.0 {
            return Err(ArmError::NotPositive {
                at: self.source.at(&format!("link '{name}' <mass>")),
                element: format!("link '{name}' <mass>"),
                value: mass,
            });
        }
        let matrix = nalgebra::Matrix3::new(
            t.ixx, t.ixy, t.ixz, t.ixy, t.iyy, t.iyz, t.ixz, t.iyz, t.izz,
        );
        let mut moments = matrix.symmetric_eigenvalues();
        moments.as_mut_slice().sort_by(f64::total_cmp);
        let slack = moments[2].abs() * INERTIA_SLACK;
        // Zero tensors with a mass are common in drawings without dynamics: no inertia is given then.
        if values.iter().any(|v| *v != 0.0) && moments[0] < -slack {
            return Err(ArmError::NotPositive {
                at: self.source.at(&format!("link '{name}' <inertia>")),
                element: format!("link '{name}' <inertia>: smallest principal moment, kg m2"),
                value: moments[0],
            });
        }
        Ok(())
    }

    /// Mass, centre and inertia in the link's own frame.
    pub fn inertial(&self, link: &urdf_rs::Link) -> Result<Inertial, ArmError> {
        let element = format!("link '{}' <inertial>", link.name);
        let pose = self.pose(&element, &link.inertial.origin)?;
        let t = &link.inertial.inertia;
        let own = nalgebra::Matrix3::new(
            t.ixx, t.ixy, t.ixz, t.ixy, t.iyy, t.iyz, t.ixz, t.iyz, t.izz,
        );
        let turn = pose.rotation.to_rotation_matrix();
        let turn = turn.matrix();
        Ok(Inertial {
            mass: link.inertial.mass.value,
            centre: pose.translation.vector,
            inertia: turn * own * turn.transpose(),
        })
    }

    pub fn link(
        &self,
        robot: &Robot,
        link: &urdf_rs::Link,
        warnings: &mut Vec<ArmWarning>,
    ) -> Result<Link, ArmError> {
        let name = &link.name;
        let mass = link.inertial.mass.value;
        self.finite(&format!("link '{name}' <mass>"), &[mass])?;
        if mass < 0.0 {
            return Err(ArmError::NotPositive {
                at: self.source.at(&format!("link '{name}' <mass>")),
                element: format!("link '{name}' <mass>"),
                value: mass,
            });
        }
        self.inertia(name, mass, &link.inertial.inertia)?;
        let mut collision = Vec::new();
        for (nth, c) in link.collision.iter().enumerate() {
            let element = numbered(name, "collision", nth);
            let pose = self.pose(&element, &c.origin)?;
            match self.shape(name, "collision", &element, &c.geometry)? {
                Ok((inside, shape)) => collision.push(PlacedShape {
                    pose: pose * inside,
                    shape,
                }),
                Err(warning) => warnings.push(warning),
            }
        }
        let mut visual = Vec::new();
        let mut undrawn = None;
        for (nth, v) in link.visual.iter().enumerate() {
            let element = numbered(name, "visual", nth);
            let pose = self.pose(&element, &v.origin)?;
            match self.shape(name, "visual", &element, &v.geometry)? {
                Ok((inside, shape)) => visual.push((
                    PlacedShape {
                        pose: pose * inside,
                        shape,
                    },
                    colour(robot, v.material.as_ref()),
                )),
                Err(warning) => {
                    undrawn = Some(colour(robot, v.material.as_ref()));
                    warnings.push(warning);
                }
            }
        }
        // What would not be seen at all is drawn as the solids that stand for it.
        if let (true, Some(colour)) = (visual.is_empty(), undrawn) {
            visual.extend(collision.iter().cloned().map(|solid| (solid, colour)));
        }
        Ok(Link {
            name: name.clone(),
            collision,
            visual,
            mass,
        })
    }
}

/// How messages call the nth body of a kind.
fn numbered(link: &str, kind: &str, nth: usize) -> String {
    match nth {
        0 => format!("link '{link}' <{kind}>"),
        _ => format!("link '{link}' <{kind}> {}", nth + 1),
    }
}

/// The material's own colour, else the one of that name at the top of the file.
fn colour(robot: &Robot, material: Option<&urdf_rs::Material>) -> [u8; 3] {
    let Some(material) = material else {
        return GREY;
    };
    let color = material.color.as_ref().or_else(|| {
        robot
            .materials
            .iter()
            .find(|m| m.name == material.name)
            .and_then(|m| m.color.as_ref())
    });
    color.map_or(GREY, |c| {
        [0, 1, 2].map(|i| (c.rgba.0[i].clamp(0.0, 1.0) * 255.0).round() as u8)
    })
}
