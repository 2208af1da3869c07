use depal_frames::{PlacedShape, Pose, Rotation, Shape, Vector};
use nalgebra::Translation3;
use urdf_rs::{Geometry, Robot};

use crate::{ArmError, ArmWarning, Link, dynamics::Inertial, hull, mesh};

/// Colour of a visual without material.
const GREY: [u8; 3] = [180, 180, 180];

/// Gives the bytes of a mesh file by the name in the description, or says why not.
pub type MeshSource<'a> = dyn Fn(&str) -> Result<Vec<u8>, String> + 'a;

pub(crate) struct Reader<'a> {
    pub file: &'a str,
    /// None: meshes are left out.
    pub meshes: Option<&'a MeshSource<'a>>,
}

/// Smallest share of the largest moment of inertia by which a tensor may miss being possible.
const INERTIA_SLACK: f64 = 1e-6;

impl Reader<'_> {
    pub fn finite(&self, element: &str, values: &[f64]) -> Result<(), ArmError> {
        match values.iter().find(|v| !v.is_finite()) {
            None => Ok(()),
            Some(&value) => Err(ArmError::NotFinite {
                file: self.file.to_owned(),
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
                file: self.file.to_owned(),
                element: element.to_owned(),
                value,
            }),
        }
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
        geometry: &Geometry,
    ) -> Result<Result<(Pose, Shape), ArmWarning>, ArmError> {
        let element = format!("link '{link}' <{kind}>");
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
                        file: self.file.to_owned(),
                        element: format!("{element} <mesh> scale"),
                        value: 0.0,
                    });
                }
                return Ok(self.hull(link, kind, filename, scale));
            }
        };
        Ok(Ok((Pose::identity(), shape)))
    }

    /// The convex hull of a collision mesh.
    fn hull(
        &self,
        link: &str,
        element: &'static str,
        mesh: &str,
        scale: [f64; 3],
    ) -> Result<(Pose, Shape), ArmWarning> {
        let meshes = match self.meshes {
            Some(meshes) if element == "collision" => meshes,
            _ => {
                return Err(ArmWarning::MeshSkipped {
                    link: link.to_owned(),
                    element,
                    mesh: mesh.to_owned(),
                });
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
                Ok(hull::around(&points))
            }
            Err(reason) => Err(ArmWarning::MeshUnread {
                link: link.to_owned(),
                element,
                mesh: mesh.to_owned(),
                reason,
            }),
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
        let matrix = nalgebra::Matrix3::new(
            t.ixx, t.ixy, t.ixz, t.ixy, t.iyy, t.iyz, t.ixz, t.iyz, t.izz,
        );
        let mut moments = matrix.symmetric_eigenvalues();
        moments.as_mut_slice().sort_by(f64::total_cmp);
        let slack = moments[2].abs() * INERTIA_SLACK;
        // Zero tensors with a mass are common in drawings without dynamics: no inertia is given then.
        if values.iter().any(|v| *v != 0.0) && moments[0] < -slack {
            return Err(ArmError::NotPositive {
                file: self.file.to_owned(),
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
                file: self.file.to_owned(),
                element: format!("link '{name}' <mass>"),
                value: mass,
            });
        }
        self.inertia(name, mass, &link.inertial.inertia)?;
        let mut collision = Vec::new();
        for c in &link.collision {
            let pose = self.pose(&format!("link '{name}' <collision>"), &c.origin)?;
            match self.shape(name, "collision", &c.geometry)? {
                Ok((inside, shape)) => collision.push(PlacedShape {
                    pose: pose * inside,
                    shape,
                }),
                Err(warning) => warnings.push(warning),
            }
        }
        let mut visual = Vec::new();
        for v in &link.visual {
            let pose = self.pose(&format!("link '{name}' <visual>"), &v.origin)?;
            match self.shape(name, "visual", &v.geometry)? {
                Ok((inside, shape)) => visual.push((
                    PlacedShape {
                        pose: pose * inside,
                        shape,
                    },
                    colour(robot, v.material.as_ref()),
                )),
                Err(warning) => warnings.push(warning),
            }
        }
        Ok(Link {
            name: name.clone(),
            collision,
            visual,
            mass,
        })
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
