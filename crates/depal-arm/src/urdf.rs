use std::{collections::BTreeMap, f64::consts::TAU};

use depal_frames::{MAX_JOINTS, Pose, Vector};
use nalgebra::Unit;
use urdf_rs::{Joint, JointType, Robot};

use crate::{
    ArmError, ArmWarning, JointLimit, Link,
    chain::{Chain, Motion, Node},
    dynamics::Dynamics,
    shapes::{MeshSource, Reader},
    source::{Place, Source},
};

mod mimic;

use mimic::{check_mimics, driver};

/// A limit beyond this was written in degrees, rad: 16 turns.
const MOST_TURNED: f64 = 100.0;

/// Everything read from the file, checked.
pub(crate) struct Loaded {
    pub robot: Robot,
    pub joint_names: Vec<String>,
    pub limits: Vec<JointLimit>,
    pub links: Vec<Link>,
    pub chain: Chain,
    pub dynamics: Dynamics,
    pub tip: String,
    pub warnings: Vec<ArmWarning>,
    pub source: Source,
}

/// Accelerations, which a URDF does not have.
pub(crate) enum Accelerations<'a> {
    /// rad/s2, one per joint from base to flange.
    PerJoint(&'a [f64]),
    /// rad/s2, all the same.
    Uniform(f64),
}

pub(crate) fn load(
    text: &str,
    file: &str,
    accelerations: &Accelerations,
    meshes: Option<&MeshSource>,
) -> Result<Loaded, ArmError> {
    let source = Source::read(file, text)?;
    let robot = urdf_rs::read_from_string(text).map_err(|e| ArmError::Unreadable {
        at: Place::file(file),
        reason: e.to_string(),
    })?;
    let reader = Reader {
        source: &source,
        meshes,
    };
    check_mimics(&robot, &source)?;
    let order = link_order(&robot, &source)?;
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

    // Joints on the way, base first, and those of them that are driven: the others follow one of these.
    let on_way: Vec<usize> = path
        .iter()
        .filter_map(|&n| order[n].1)
        .filter(|&j| robot.joints[j].joint_type != JointType::Fixed)
        .collect();
    for &joint in &on_way {
        check_kind(&robot.joints[joint], &source)?;
        driver(&robot, joint, &source)?;
    }
    let chain_joints: Vec<usize> = on_way
        .iter()
        .copied()
        .filter(|&j| robot.joints[j].mimic.is_none())
        .collect();
    let count = chain_joints.len();
    if count == 0 || count > MAX_JOINTS {
        return Err(ArmError::JointCount {
            at: source.at(&format!("link '{}'", robot.links[order[tip].0].name)),
            base: robot.links[order[0].0].name.clone(),
            tip: robot.links[order[tip].0].name.clone(),
            found: count,
        });
    }
    let uniform;
    let max_accelerations = match *accelerations {
        Accelerations::PerJoint(values) => values,
        Accelerations::Uniform(value) => {
            uniform = vec![value; count];
            &uniform
        }
    };
    if max_accelerations.len() != count {
        return Err(ArmError::AccelerationCount {
            at: Place::file(file),
            found: max_accelerations.len(),
            expected: count,
        });
    }
    let mut warnings = Vec::new();

    let mut limits = Vec::new();
    for (&joint, &acceleration) in chain_joints.iter().zip(max_accelerations) {
        limits.push(limit(&reader, &robot.joints[joint], acceleration)?);
    }
    let mut nodes = Vec::new();
    let mut links = Vec::new();
    let mut inertials = Vec::new();
    for (node, (link, joint)) in order.iter().enumerate() {
        links.push(reader.link(&robot, &robot.links[*link], &mut warnings)?);
        inertials.push(reader.inertial(&robot.links[*link])?);
        let Some(joint) = *joint else {
            nodes.push(Node {
                parent: None,
                origin: Pose::identity(),
                motion: Motion::Fixed,
            });
            continue;
        };
        let element = &robot.joints[joint];
        let called = format!("joint '{}'", element.name);
        let origin = reader.pose(&called, &element.origin)?;
        reader.length(
            &format!("{called} <origin>"),
            origin.translation.vector.norm(),
            "",
        )?;
        let driven = driver(&robot, joint, &source)?.and_then(|d| {
            let index = chain_joints.iter().position(|&j| j == d.joint)?;
            Some((index, d))
        });
        let motion = match driven {
            Some((index, d))
                if matches!(
                    element.joint_type,
                    JointType::Revolute | JointType::Continuous
                ) =>
            {
                Motion::Revolute {
                    axis: axis(&reader, element)?,
                    index,
                    multiplier: d.multiplier,
                    offset: d.offset,
                }
            }
            _ => {
                if element.joint_type != JointType::Fixed {
                    warnings.push(ArmWarning::JointFrozen {
                        at: source.at(&format!("joint '{}'", element.name)),
                        joint: element.name.clone(),
                    });
                }
                Motion::Fixed
            }
        };
        nodes.push(Node {
            parent: parent_of(node),
            origin,
            motion,
        });
    }
    let efforts: Vec<f64> = chain_joints
        .iter()
        .map(|&j| robot.joints[j].limit.effort)
        .collect();
    let chain = Chain { nodes, path };
    Ok(Loaded {
        dynamics: Dynamics::new(&chain, inertials, &efforts),
        joint_names: chain_joints
            .iter()
            .map(|&j| robot.joints[j].name.clone())
            .collect(),
        limits,
        links,
        chain,
        tip: robot.links[order[tip].0].name.clone(),
        warnings,
        robot,
        source,
    })
}

/// Links with the joint that carries each, parents first, siblings in file order.
fn link_order(robot: &Robot, source: &Source) -> Result<Vec<(usize, Option<usize>)>, ArmError> {
    let by_name: BTreeMap<&str, usize> = robot
        .links
        .iter()
        .enumerate()
        .map(|(i, l)| (l.name.as_str(), i))
        .collect();
    let find = |name: &str| by_name.get(name).copied();
    let mut parent_joint: Vec<Option<usize>> = vec![None; robot.links.len()];
    let mut children: Vec<Vec<(usize, usize)>> = vec![Vec::new(); robot.links.len()];
    for (j, joint) in robot.joints.iter().enumerate() {
        let named = |role, name: &str| {
            find(name).ok_or_else(|| ArmError::UnknownLink {
                at: source.at(&format!("joint '{}' <{role}>", joint.name)),
                joint: joint.name.clone(),
                role,
                link: name.to_owned(),
            })
        };
        let parent = named("parent", &joint.parent.link)?;
        let child = named("child", &joint.child.link)?;
        if let Some(first) = parent_joint[child] {
            return Err(ArmError::TwoParents {
                at: source.at(&format!("joint '{}'", joint.name)),
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
            at: source.at(&format!("link '{}'", robot.links[roots[1]].name)),
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
            at: source.at(&format!("link '{}'", robot.links[link].name)),
            link: robot.links[link].name.clone(),
        });
    }
    if order.is_empty() {
        return Err(ArmError::Unreadable {
            at: source.at("<robot>"),
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

fn check_kind(joint: &Joint, source: &Source) -> Result<(), ArmError> {
    let what = match joint.joint_type {
        JointType::Revolute | JointType::Continuous | JointType::Fixed => return Ok(()),
        ref other => format!("type {other:?}").to_lowercase(),
    };
    Err(ArmError::UnsupportedJoint {
        at: source.at(&format!("joint '{}'", joint.name)),
        joint: joint.name.clone(),
        what,
    })
}

fn axis(reader: &Reader, joint: &Joint) -> Result<Unit<Vector>, ArmError> {
    reader.finite(&format!("joint '{}' <axis>", joint.name), &joint.axis.xyz.0)?;
    Unit::try_new(Vector::from(joint.axis.xyz.0), 1e-9).ok_or_else(|| ArmError::ZeroAxis {
        at: reader.source.at(&format!("joint '{}' <axis>", joint.name)),
        joint: joint.name.clone(),
    })
}

fn limit(reader: &Reader, joint: &Joint, acceleration: f64) -> Result<JointLimit, ArmError> {
    let urdf_rs::JointLimit {
        lower,
        upper,
        velocity,
        effort,
    } = joint.limit;
    let element = format!("joint '{}' <limit>", joint.name);
    reader.finite(&element, &[lower, upper, velocity, effort])?;
    // Endless joints may turn once either way: postures stay countable.
    let (lower, upper) = match joint.joint_type {
        JointType::Continuous if lower == 0.0 && upper == 0.0 => (-TAU, TAU),
        _ => (lower, upper),
    };
    if lower == 0.0 && upper == 0.0 && velocity == 0.0 {
        return Err(ArmError::MissingLimit {
            at: reader.source.at(&element),
            joint: joint.name.clone(),
        });
    }
    if lower >= upper {
        return Err(ArmError::LimitOrder {
            at: reader.source.at(&element),
            joint: joint.name.clone(),
            lower,
            upper,
        });
    }
    if lower < -MOST_TURNED || upper > MOST_TURNED {
        return Err(ArmError::LimitInDegrees {
            at: reader.source.at(&element),
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
