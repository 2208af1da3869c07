//! Vision against the truth: only the cell may compare the two.

use depal_frames::{Intrinsics, Point, Pose};

/// A true carton as the scorer sees it.
#[derive(Debug, Clone, Copy)]
pub struct TrueCarton {
    /// Its number, also its id in the camera's id image.
    pub id: u32,
    /// World pose of the geometric centre, X along the length.
    pub world_from_centre: Pose,
    /// Length, width, height, metres.
    pub size: [f64; 3],
}

impl TrueCarton {
    /// World pose of the top face's centre, Z up.
    pub fn world_from_top(&self) -> Pose {
        self.world_from_centre * Pose::translation(0.0, 0.0, self.size[2] * 0.5)
    }
}

/// A carton whose top shows at least this share must be found: the whole top, less edge pixels.
pub const PICKABLE_FRACTION: f64 = 0.95;
/// A report farther than this from every carton is a false one, metres.
pub const MATCH_DISTANCE: f64 = 0.02;

/// Share of a carton's top face that the camera really saw, by the id image: 0 to 1.
///
/// A grid of points on the face, 6 mm inside its border, is projected; a point counts when the pixel there
/// shows this carton.
pub fn visible_fraction(
    carton: &TrueCarton,
    camera_from_world: &Pose,
    intrinsics: &Intrinsics,
    ids: &[u32],
) -> f64 {
    const COLUMNS: usize = 24;
    const ROWS: usize = 18;
    let camera_from_top = camera_from_world * carton.world_from_top();
    let inset = 0.006;
    let mut seen = 0;
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let along = |i: usize, n: usize, side: f64| {
                (i as f64 / (n - 1) as f64 - 0.5) * (side - 2.0 * inset)
            };
            let point = camera_from_top
                * Point::new(
                    along(column, COLUMNS, carton.size[0]),
                    along(row, ROWS, carton.size[1]),
                    0.0,
                );
            if point.z <= 0.0 {
                continue;
            }
            let (u, v) = intrinsics.project(&point);
            let (u, v) = (u.round(), v.round());
            if u < 0.0 || v < 0.0 {
                continue;
            }
            let (u, v) = (u as usize, v as usize);
            if u < intrinsics.width
                && v < intrinsics.height
                && ids[v * intrinsics.width + u] == carton.id
            {
                seen += 1;
            }
        }
    }
    f64::from(seen) / (COLUMNS * ROWS) as f64
}

/// One report matched to the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Match {
    /// The carton.
    pub carton: u32,
    /// Distance of the top-face centres, metres.
    pub distance: f64,
    /// Angle between the frames, radians, modulo the half turn about the carton's own Z.
    pub angle: f64,
}

/// Matches reported top-face poses with true cartons, one to one, nearest pairs first.
pub fn match_reports(world_from_reports: &[Pose], cartons: &[TrueCarton]) -> Vec<Option<Match>> {
    let mut pairs = Vec::new();
    for (report, world_from_report) in world_from_reports.iter().enumerate() {
        for (index, carton) in cartons.iter().enumerate() {
            let world_from_top = carton.world_from_top();
            let distance =
                (world_from_report.translation.vector - world_from_top.translation.vector).norm();
            if distance < MATCH_DISTANCE {
                let half_turn =
                    depal_frames::Rotation::from_euler_angles(0.0, 0.0, std::f64::consts::PI);
                let angle = world_from_report
                    .rotation
                    .angle_to(&world_from_top.rotation)
                    .min(
                        world_from_report
                            .rotation
                            .angle_to(&(world_from_top.rotation * half_turn)),
                    );
                pairs.push((distance, report, index, angle));
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    let mut matches = vec![None; world_from_reports.len()];
    let mut taken = vec![false; cartons.len()];
    for (distance, report, index, angle) in pairs {
        if matches[report].is_none() && !taken[index] {
            taken[index] = true;
            matches[report] = Some(Match {
                carton: cartons[index].id,
                distance,
                angle,
            });
        }
    }
    matches
}
