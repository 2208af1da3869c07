//! Corner points of a COLLADA file: its geometries where the nodes of the scene put them.

use std::collections::BTreeMap;

use depal_frames::{Point, Vector};
use nalgebra::{Matrix4, Rotation3, Unit};
use quick_xml::{Reader, events::Event};

use super::numbers;

/// Elements inside each other beyond this are refused.
const DEEPEST: usize = 256;

/// An XML element.
struct Element {
    name: String,
    attributes: BTreeMap<String, String>,
    children: Vec<Element>,
    text: String,
}

impl Element {
    fn all<'a>(&'a self, name: &'a str) -> impl Iterator<Item = &'a Element> {
        self.children.iter().filter(move |c| c.name == name)
    }

    fn child(&self, name: &str) -> Option<&Element> {
        self.children.iter().find(|c| c.name == name)
    }

    fn attribute(&self, name: &str) -> &str {
        self.attributes.get(name).map_or("", String::as_str)
    }

    /// An attribute that names another element's id.
    fn link(&self, name: &str) -> &str {
        self.attribute(name).trim_start_matches('#')
    }
}

/// The element at the top.
fn parse(text: &str) -> Result<Element, String> {
    let mut reader = Reader::from_str(text);
    let empty = |name: String| Element {
        name,
        attributes: BTreeMap::new(),
        children: Vec::new(),
        text: String::new(),
    };
    let mut open = vec![empty(String::new())];
    let name_of = |bytes: &[u8]| {
        let name = String::from_utf8_lossy(bytes);
        name.rsplit(':').next().unwrap_or("").to_owned()
    };
    loop {
        let event = reader.read_event().map_err(|e| e.to_string())?;
        match &event {
            Event::Start(tag) | Event::Empty(tag) => {
                let mut element = empty(name_of(tag.name().as_ref()));
                for attribute in tag.attributes() {
                    let attribute = attribute.map_err(|e| e.to_string())?;
                    let value = String::from_utf8_lossy(&attribute.value).into_owned();
                    let key = String::from_utf8_lossy(attribute.key.as_ref()).into_owned();
                    element.attributes.insert(key, value);
                }
                if matches!(event, Event::Start(_)) {
                    if open.len() > DEEPEST {
                        return Err(format!("more than {DEEPEST} elements inside each other"));
                    }
                    open.push(element);
                } else if let Some(parent) = open.last_mut() {
                    parent.children.push(element);
                }
            }
            Event::End(_) => {
                let (Some(done), Some(parent)) = (open.pop(), open.last_mut()) else {
                    return Err("an element is closed that was not opened".to_owned());
                };
                parent.children.push(done);
            }
            Event::Text(text) => {
                if let Some(element) = open.last_mut() {
                    element.text += &String::from_utf8_lossy(text);
                }
            }
            Event::Eof => break,
            _ => {}
        }
    }
    let top = open.pop().filter(|_| open.is_empty());
    top.and_then(|mut t| t.children.pop())
        .filter(|root| root.name == "COLLADA")
        .ok_or_else(|| "no whole <COLLADA> element".to_owned())
}

pub(super) fn points(text: &str) -> Result<Vec<Point>, String> {
    let root = parse(text)?;
    let mut points = Vec::new();
    let reader = Scene::new(&root)?;
    let scenes: Vec<&Element> = root
        .all("library_visual_scenes")
        .flat_map(|library| library.all("visual_scene"))
        .collect();
    let chosen = root
        .child("scene")
        .and_then(|s| s.child("instance_visual_scene"))
        .map(|i| i.link("url").to_owned());
    let to_metres = to_metres_z_up(&root)?;
    let scene = scenes
        .iter()
        .find(|s| Some(s.attribute("id")) == chosen.as_deref())
        .or(scenes.first());
    if let Some(scene) = scene {
        for node in scene.all("node") {
            reader.node(node, &to_metres, 0, &mut points)?;
        }
    }
    if points.is_empty() {
        // Without a scene the geometries stand where they are.
        for corners in reader.geometries.values() {
            points.extend(corners.iter().map(|p| to_metres.transform_point(p)));
        }
    }
    Ok(points)
}

/// The file's unit and upward axis.
fn to_metres_z_up(root: &Element) -> Result<Matrix4<f64>, String> {
    let asset = root.child("asset");
    let unit = asset.and_then(|a| a.child("unit"));
    let metre = match unit.map(|u| u.attribute("meter")) {
        None | Some("") => 1.0,
        Some(text) => numbers(text, 1)?[0],
    };
    if !(metre > 0.0 && metre.is_finite()) {
        return Err(format!("<unit meter> {metre}, expected a positive number"));
    }
    let up = asset
        .and_then(|a| a.child("up_axis"))
        .map_or("Y_UP", |e| e.text.trim());
    let turn = match up {
        "Z_UP" => Matrix4::identity(),
        "X_UP" => Rotation3::from_axis_angle(&Vector::y_axis(), -std::f64::consts::FRAC_PI_2)
            .to_homogeneous(),
        _ => Rotation3::from_axis_angle(&Vector::x_axis(), std::f64::consts::FRAC_PI_2)
            .to_homogeneous(),
    };
    Ok(turn * Matrix4::new_scaling(metre))
}

struct Scene<'a> {
    /// Corners by the geometry's id.
    geometries: BTreeMap<&'a str, Vec<Point>>,
    /// Nodes of the library that others stand for.
    nodes: BTreeMap<&'a str, &'a Element>,
}

impl<'a> Scene<'a> {
    fn new(root: &'a Element) -> Result<Self, String> {
        let mut geometries = BTreeMap::new();
        for geometry in root
            .all("library_geometries")
            .flat_map(|library| library.all("geometry"))
        {
            if let Some(mesh) = geometry.child("mesh") {
                geometries.insert(geometry.attribute("id"), corners(mesh)?);
            }
        }
        let nodes = root
            .all("library_nodes")
            .flat_map(|library| library.all("node"))
            .map(|n| (n.attribute("id"), n))
            .collect();
        Ok(Self { geometries, nodes })
    }

    fn node(
        &self,
        node: &Element,
        parent: &Matrix4<f64>,
        depth: usize,
        points: &mut Vec<Point>,
    ) -> Result<(), String> {
        if depth > DEEPEST {
            return Err("nodes stand for each other in a ring".to_owned());
        }
        let mut here = *parent;
        for child in &node.children {
            here *= match child.name.as_str() {
                "matrix" => Matrix4::from_row_slice(&numbers(&child.text, 16)?[..16]),
                "translate" => {
                    let n = numbers(&child.text, 3)?;
                    Matrix4::new_translation(&Vector::new(n[0], n[1], n[2]))
                }
                "scale" => {
                    let n = numbers(&child.text, 3)?;
                    Matrix4::new_nonuniform_scaling(&Vector::new(n[0], n[1], n[2]))
                }
                "rotate" => {
                    let n = numbers(&child.text, 4)?;
                    match Unit::try_new(Vector::new(n[0], n[1], n[2]), 1e-12) {
                        Some(axis) => {
                            Rotation3::from_axis_angle(&axis, n[3].to_radians()).to_homogeneous()
                        }
                        None => Matrix4::identity(),
                    }
                }
                _ => continue,
            };
        }
        for child in &node.children {
            match child.name.as_str() {
                "instance_geometry" => {
                    if let Some(corners) = self.geometries.get(child.link("url")) {
                        points.extend(corners.iter().map(|p| here.transform_point(p)));
                    }
                }
                "node" => self.node(child, &here, depth + 1, points)?,
                "instance_node" => {
                    if let Some(other) = self.nodes.get(child.link("url")) {
                        self.node(other, &here, depth + 1, points)?;
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }
}

/// The positions of a mesh.
fn corners(mesh: &Element) -> Result<Vec<Point>, String> {
    let positions = mesh
        .child("vertices")
        .and_then(|v| {
            v.all("input")
                .find(|i| i.attribute("semantic") == "POSITION")
        })
        .map_or("", |i| i.link("source"));
    let source = mesh
        .all("source")
        .find(|s| s.attribute("id") == positions)
        .ok_or_else(|| format!("<source id=\"{positions}\"> with the corners is missing"))?;
    let array = source
        .child("float_array")
        .ok_or_else(|| format!("<source id=\"{positions}\"> has no <float_array>"))?;
    let accessor = source
        .child("technique_common")
        .and_then(|t| t.child("accessor"));
    let stride = accessor.map_or("", |a| a.attribute("stride"));
    let stride = if stride.is_empty() {
        3
    } else {
        stride
            .parse::<usize>()
            .map_err(|e| format!("stride: {e}"))?
    };
    if stride < 3 {
        return Err(format!("stride {stride}, expected at least 3"));
    }
    let values = numbers(&array.text, 0)?;
    let corner = |n: &[f64]| Point::new(n[0], n[1], n[2]);
    Ok(values.chunks_exact(stride).map(corner).collect())
}
