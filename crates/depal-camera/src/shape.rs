use depal_frames::{Pose, Shape};

/// How a surface answers to the projector's light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Share of the light that is scattered back, 0 (black) to 1 (white).
    pub albedo: f64,
}

impl Material {
    /// Brown corrugated board.
    pub const KRAFT: Self = Self { albedo: 0.5 };
    /// White paper label.
    pub const LABEL: Self = Self { albedo: 0.8 };
    /// Black adhesive tape.
    pub const BLACK_TAPE: Self = Self { albedo: 0.04 };
    /// Sawn pallet wood.
    pub const WOOD: Self = Self { albedo: 0.6 };
    /// Painted steel or a robot's lacquer.
    pub const PAINT: Self = Self { albedo: 0.4 };
    /// Concrete floor.
    pub const CONCRETE: Self = Self { albedo: 0.3 };
}

/// A solid to be drawn. The camera knows it by its id only.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderShape {
    /// Where the solid's own frame stands in the world, metres.
    pub world_from_shape: Pose,
    /// The solid in its own frame.
    pub shape: Shape,
    /// What [`Capture::ids`](crate::Capture::ids) shows where this solid is seen.
    /// Several shapes may share one id; `u32::MAX` is taken for "nothing".
    pub id: u32,
    /// Its surface.
    pub material: Material,
}
