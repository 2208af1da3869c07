use depal_frames::{Pose, Shape};

/// How a surface answers to the projector's light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Material {
    /// Share of the light that is scattered back, 0 (black) to 1 (white).
    pub albedo: f64,
    /// Strength of the mirror image of the projector, 0 (matt) to 1 (mirror). Where it reaches the
    /// camera the pattern is over-exposed: depth is lost and intensity is bright.
    pub gloss: f64,
    /// Factor on the axial noise: light that is scattered within the material (film) or bent by its
    /// folds. 1 = an opaque, matt surface.
    pub noise_factor: f64,
    /// Share of the pixels on it that are lost, 0 to 1.
    pub dropout: f64,
}

impl Material {
    /// A matt, opaque surface.
    pub const fn matt(albedo: f64) -> Self {
        Self {
            albedo,
            gloss: 0.0,
            noise_factor: 1.0,
            dropout: 0.0,
        }
    }

    /// Brown corrugated board.
    pub const KRAFT: Self = Self::matt(0.5);
    /// White paper label.
    pub const LABEL: Self = Self::matt(0.8);
    /// Black adhesive tape: swallows the pattern.
    pub const BLACK_TAPE: Self = Self {
        albedo: 0.04,
        gloss: 0.0,
        noise_factor: 2.0,
        dropout: 0.6,
    };
    /// Clear or brown adhesive tape with a glossy back.
    pub const GLOSSY_TAPE: Self = Self {
        albedo: 0.4,
        gloss: 0.7,
        noise_factor: 1.5,
        dropout: 0.05,
    };
    /// Stretch film over board: folds and scatter.
    pub const FILM: Self = Self {
        albedo: 0.35,
        gloss: 0.4,
        noise_factor: 3.0,
        dropout: 0.15,
    };
    /// Sawn pallet wood.
    pub const WOOD: Self = Self::matt(0.6);
    /// Painted steel or a robot's lacquer.
    pub const PAINT: Self = Self::matt(0.4);
    /// Concrete floor.
    pub const CONCRETE: Self = Self::matt(0.3);
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
    /// Radius to which the edges and corners of a box are rounded, metres; 0 = sharp. The box keeps its
    /// size: it is a smaller box and all that is within the radius of it. At most half of the shortest
    /// side counts, less than 0.01 mm is sharp, and solids of other kinds have none.
    pub edge_radius: f64,
}
