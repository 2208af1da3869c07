use std::collections::{BTreeMap, BTreeSet};

use depal_frames::{Pose, Vector};
use nalgebra::Unit;
use urdf_rs::{Joint, JointType, Robot};

use crate::{
    ArmError, JointLimit, Link,
    chain::{Chain, Motion, Node},
    shapes::Reader,
};

/// Everything read from the file, checked.
pub(crate) struct Loaded {
    pub robot: Robot,
    pub joint_names: Vec<String>,
    pub limits: Vec<JointLimit>,
    pub links: Vec<Link>,
    pub chain: Chain,
    pub tip: String,
}

pub(crate) fn load(text: &str, file: &str, max_accelerations: &[f64]) -> Result<Loaded, ArmError> {
    let robot = urdf_rs::read_from_string(text).map_err(|e| ArmError::Unreadable {
        file: file.to_owned(),
        reason: e.to_string(),
    })?;
    let reader = Reader { file };
    check_names(&robot, file)?;
    let order = link_order(&robot, file)?;
    let index_of: BTreeMap<&str, usize> = order
        .iter()
        .enumerate()
        .map(|(i, (link, _))| (robot.links[*link].name.as_str(), i))
        .collect();

    // The flange and the way to it.
    let tip = choose_tip(&robot, &order, &index_of);
    let parent_of = |node: usize| {
        order[node]
            .1
            .map(|joint| index_of[robot.joints[joint].parent.link.as_str()])
    };
    let mut path = Vec::new();
    let mut node = tip;
    while let Some(parent) = parent_of(node) {
        path.push(node);
        node = parent;
    }
    path.reverse();

    let revolute = |joint: &Joint| joint.joint_type != JointType::Fixed;
    let chain_joints: Vec<usize> = path
        .iter()
        .filter_map(|&n| order[n].1)
        .filter(|&j| revolute(&robot.joints[j]))
        .collect();
    for joint in &robot.joints {
        check_kind(joint, file)?;
    }
    let total = robot.joints.iter().filter(|j| revolute(j)).count();
    if chain_joints.len() != 6 || total != 6 {
        return Err(ArmError::NotSixRevolutes {
            file: file.to_owned(),
            base: robot.links[order[0].0].name.clone(),
            tip: robot.links[order[tip].0].name.clone(),
            found: chain_joints.len(),
            total,
        });
    }
    if max_accelerations.len() != chain_joints.len() {
        return Err(ArmError::AccelerationCount {
            file: file.to_owned(),
            found: max_accelerations.len(),
            expected: chain_joints.len(),
        });
    }

    let mut limits = Vec::new();
    for (&joint, &acceleration) in chain_joints.iter().zip(max_accelerations) {
        limits.push(limit(&reader, &robot.joints[joint], acceleration)?);
    }
    let mut nodes = Vec::new();
    let mut links = Vec::new();
    for (node, (link, joint)) in order.iter().enumerate() {
        links.push(reader.link(&robot, &robot.links[*link])?);
        let Some(joint) = *joint else {
            nodes.push(Node {
                parent: None,
                origin: Pose::identity(),
                motion: Motion::Fixed,
            });
            continue;
        };
        let element = &robot.joints[joint];
        let origin = reader.pose(&format!("joint '{}'", element.name), &element.origin)?;
        let motion = match chain_joints.iter().position(|&j| j == joint) {
            None => Motion::Fixed,
            Some(index) => Motion::Revolute {
                axis: axis(&reader, element)?,
                index,
            },
        };
        nodes.push(Node {
            parent: parent_of(node),
            origin,
            motion,
        });
    }
    Ok(Loaded {
        joint_names: chain_joints
            .iter()
            .map(|&j| robot.joints[j].name.clone())
            .collect(),
        limits,
        links,
        chain: Chain { nodes, path },
        tip: robot.links[order[tip].0].name.clone(),
        robot,
    })
}

fn check_names(robot: &Robot, file: &str) -> Result<(), ArmError> {
    let names = |kind: &'static str, names: Vec<&String>| {
        let mut seen = BTreeSet::new();
        match names.into_iter().find(|n| !seen.insert(n.as_str())) {
            None => Ok(()),
            Some(name) => Err(ArmError::Duplicate {
                file: file.to_owned(),
                element: format!("{kind} '{name}'"),
            }),
        }
    };
    names("link", robot.links.iter().map(|l| &l.name).collect())?;
    names("joint", robot.joints.iter().map(|j| &j.name).collect())
}

/// Links with the joint that carries each, parents first, siblings in file order.
fn link_order(robot: &Robot, file: &str) -> Result<Vec<(usize, Option<usize>)>, ArmError> {
    let find = |name: &str| robot.links.iter().position(|l| l.name == name);
    let mut parent_joint: Vec<Option<usize>> = vec![None; robot.links.len()];
    let mut children: Vec<Vec<(usize, usize)>> = vec![Vec::new(); robot.links.len()];
    for (j, joint) in robot.joints.iter().enumerate() {
        let named = |role, name: &str| {
            find(name).ok_or_else(|| ArmError::UnknownLink {
                file: file.to_owned(),
                joint: joint.name.clone(),
                role,
                link: name.to_owned(),
            })
        };
        let parent = named("parent", &joint.parent.link)?;
        let child = named("child", &joint.child.link)?;
        if let Some(first) = parent_joint[child] {
            return Err(ArmError::TwoParents {
                file: file.to_owned(),
                link: robot.links[child].name.clone(),
                first: robot.joints[first].name.clone(),
                second: joint.name.clone(),
            });
        }
        parent_joint[child] = Some(j);
        children[parent].push((child, j));
    }
    let roots: Vec<usize> = (0..robot.links.len())
        .filter(|&l| parent_joint[l].is_none())
        .collect();
    if roots.len() > 1 {
        return Err(ArmError::ManyRoots {
            file: file.to_owned(),
            roots: roots.iter().map(|&l| robot.links[l].name.clone()).collect(),
        });
    }
    let mut order: Vec<(usize, Option<usize>)> = roots.iter().map(|&r| (r, None)).collect();
    let mut next = 0;
    while next < order.len() {
        let link = order[next].0;
        order.extend(children[link].iter().map(|&(child, j)| (child, Some(j))));
        next += 1;
    }
    // What no root leads to hangs in a ring; a file without any link has nothing at all.
    if order.len() < robot.links.len() {
        let mut reached = vec![false; robot.links.len()];
        for &(link, _) in &order {
            reached[link] = true;
        }
        let link = reached.iter().position(|r| !r).unwrap_or(0);
        return Err(ArmError::Cycle {
            file: file.to_owned(),
            link: robot.links[link].name.clone(),
        });
    }
    if order.is_empty() {
        return Err(ArmError::Unreadable {
            file: file.to_owned(),
            reason: "no <link> in it".to_owned(),
        });
    }
    Ok(order)
}

/// `tool0`, else `flange`, else the link with the most joints above it (the first such in file order).
fn choose_tip(
    robot: &Robot,
    order: &[(usize, Option<usize>)],
    index_of: &BTreeMap<&str, usize>,
) -> usize {
    if let Some(&tip) = index_of.get("tool0").or_else(|| index_of.get("flange")) {
        return tip;
    }
    let mut depth = vec![0; order.len()];
    let mut best = 0;
    for (node, (_, joint)) in order.iter().enumerate() {
        if let Some(joint) = *joint {
            depth[node] = depth[index_of[robot.joints[joint].parent.link.as_str()]] + 1;
        }
        if depth[node] > depth[best] {
            best = node;
        }
    }
    best
}

fn check_kind(joint: &Joint, file: &str) -> Result<(), ArmError> {
    let what = match joint.joint_type {
        _ if joint.mimic.is_some() => "a mimic joint".to_owned(),
        JointType::Revolute | JointType::Fixed => return Ok(()),
        ref other => format!("type {other:?}").to_lowercase(),
    };
    Err(ArmError::UnsupportedJoint {
        file: file.to_owned(),
        joint: joint.name.clone(),
        what,
    })
}

fn axis(reader: &Reader, joint: &Joint) -> Result<Unit<Vector>, ArmError> {
    reader.finite(&format!("joint '{}' <axis>", joint.name), &joint.axis.xyz.0)?;
    Unit::try_new(Vector::from(joint.axis.xyz.0), 1e-9).ok_or_else(|| ArmError::ZeroAxis {
        file: reader.file.to_owned(),
        joint: joint.name.clone(),
    })
}

fn limit(reader: &Reader, joint: &Joint, acceleration: f64) -> Result<JointLimit, ArmError> {
    let urdf_rs::JointLimit {
        lower,
        upper,
        velocity,
        ..
    } = joint.limit;
    let element = format!("joint '{}' <limit>", joint.name);
    reader.finite(&element, &[lower, upper, velocity])?;
    if lower == 0.0 && upper == 0.0 && velocity == 0.0 {
        return Err(ArmError::MissingLimit {
            file: reader.file.to_owned(),
            joint: joint.name.clone(),
        });
    }
    if lower >= upper {
        return Err(ArmError::LimitOrder {
            file: reader.file.to_owned(),
            joint: joint.name.clone(),
            lower,
            upper,
        });
    }
    reader.positive(&format!("{element} velocity"), &[velocity])?;
    reader.positive(
        &format!("acceleration of joint '{}'", joint.name),
        &[acceleration],
    )?;
    Ok(JointLimit {
        lower,
        upper,
        max_speed: velocity,
        max_acceleration: acceleration,
    })
}
