use depal_frames::{PlacedShape, Pose, Rotation, Shape, Vector};
use nalgebra::Translation3;
use urdf_rs::{Geometry, Robot};

use crate::{ArmError, Link};

/// Colour of a visual without material.
const GREY: [u8; 3] = [180, 180, 180];

pub(crate) struct Reader<'a> {
    pub file: &'a str,
}

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
    ) -> Result<Shape, ArmError> {
        let element = format!("link '{link}' <{kind}>");
        Ok(match geometry {
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
            Geometry::Mesh { filename, .. } => {
                return Err(ArmError::MeshUnsupported {
                    file: self.file.to_owned(),
                    link: link.to_owned(),
                    element: kind,
                    mesh: filename.clone(),
                });
            }
        })
    }

    pub fn link(&self, robot: &Robot, link: &urdf_rs::Link) -> Result<Link, ArmError> {
        let name = &link.name;
        let mass = link.inertial.mass.value;
        self.finite(&format!("link '{name}' <mass>"), &[mass])?;
        let tensor = &link.inertial.inertia;
        self.finite(
            &format!("link '{name}' <inertia>"),
            &[
                tensor.ixx, tensor.ixy, tensor.ixz, tensor.iyy, tensor.iyz, tensor.izz,
            ],
        )?;
        if mass < 0.0 {
            return Err(ArmError::NotPositive {
                file: self.file.to_owned(),
                element: format!("link '{name}' <mass>"),
                value: mass,
            });
        }
        let mut collision = Vec::new();
        for c in &link.collision {
            collision.push(PlacedShape {
                pose: self.pose(&format!("link '{name}' <collision>"), &c.origin)?,
                shape: self.shape(name, "collision", &c.geometry)?,
            });
        }
        let mut visual = Vec::new();
        for v in &link.visual {
            let placed = PlacedShape {
                pose: self.pose(&format!("link '{name}' <visual>"), &v.origin)?,
                shape: self.shape(name, "visual", &v.geometry)?,
            };
            visual.push((placed, colour(robot, v.material.as_ref())));
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
