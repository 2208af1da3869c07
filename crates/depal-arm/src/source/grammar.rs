//! What may and must stand in a description.

/// What an attribute must be.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    Any,
    Text,
    Number,
    Numbers(usize),
    JointType,
}

/// Path below `<robot>`, attribute, what it must be, whether it must be there. Other attributes are nobody's business.
pub(super) const ATTRIBUTES: &[(&str, &str, Kind, bool)] = &[
    ("link", "name", Kind::Text, true),
    ("link/inertial/origin", "xyz", Kind::Numbers(3), false),
    ("link/inertial/origin", "rpy", Kind::Numbers(3), false),
    ("link/inertial/mass", "value", Kind::Number, true),
    ("link/inertial/inertia", "ixx", Kind::Number, true),
    ("link/inertial/inertia", "ixy", Kind::Number, true),
    ("link/inertial/inertia", "ixz", Kind::Number, true),
    ("link/inertial/inertia", "iyy", Kind::Number, true),
    ("link/inertial/inertia", "iyz", Kind::Number, true),
    ("link/inertial/inertia", "izz", Kind::Number, true),
    ("link/BODY/origin", "xyz", Kind::Numbers(3), false),
    ("link/BODY/origin", "rpy", Kind::Numbers(3), false),
    ("link/BODY/geometry/box", "size", Kind::Numbers(3), true),
    ("link/BODY/geometry/cylinder", "radius", Kind::Number, true),
    ("link/BODY/geometry/cylinder", "length", Kind::Number, true),
    ("link/BODY/geometry/capsule", "radius", Kind::Number, true),
    ("link/BODY/geometry/capsule", "length", Kind::Number, true),
    ("link/BODY/geometry/sphere", "radius", Kind::Number, true),
    ("link/BODY/geometry/mesh", "filename", Kind::Text, true),
    ("link/BODY/geometry/mesh", "scale", Kind::Numbers(3), false),
    ("link/BODY/material", "name", Kind::Any, true),
    ("link/BODY/material/color", "rgba", Kind::Numbers(4), true),
    ("material", "name", Kind::Text, true),
    ("material/color", "rgba", Kind::Numbers(4), true),
    ("joint", "name", Kind::Text, true),
    ("joint", "type", Kind::JointType, true),
    ("joint/parent", "link", Kind::Text, true),
    ("joint/child", "link", Kind::Text, true),
    ("joint/origin", "xyz", Kind::Numbers(3), false),
    ("joint/origin", "rpy", Kind::Numbers(3), false),
    ("joint/axis", "xyz", Kind::Numbers(3), true),
    ("joint/limit", "lower", Kind::Number, false),
    ("joint/limit", "upper", Kind::Number, false),
    ("joint/limit", "velocity", Kind::Number, false),
    ("joint/limit", "effort", Kind::Number, false),
    ("joint/dynamics", "damping", Kind::Number, false),
    ("joint/dynamics", "friction", Kind::Number, false),
    ("joint/mimic", "joint", Kind::Text, true),
    ("joint/mimic", "multiplier", Kind::Number, false),
    ("joint/mimic", "offset", Kind::Number, false),
];

/// Path below `<robot>`, and the elements that must stand in it once.
pub(super) const NEEDED: &[(&str, &[&str])] = &[
    ("joint", &["parent", "child"]),
    ("link/inertial", &["mass", "inertia"]),
    ("link/BODY", &["geometry"]),
];

/// Path below `<robot>`, and the elements that may stand in it once at most.
pub(super) const ONCE: &[(&str, &[&str])] = &[
    (
        "joint",
        &[
            "parent", "child", "origin", "axis", "limit", "mimic", "dynamics",
        ],
    ),
    ("link", &["inertial"]),
    ("link/inertial", &["origin", "mass", "inertia"]),
    ("link/BODY", &["origin", "geometry", "material"]),
];

pub(super) const SHAPES: [&str; 5] = ["box", "cylinder", "capsule", "sphere", "mesh"];
