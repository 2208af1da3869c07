//! What stands on the floor: the pallet, the cartons on it and how untidy they are.

use crate::choice::{choice, one_of};
use crate::layout::footprint_mm;
use crate::reader::{Checker, section};
use crate::rules::above;
use crate::rules::{
    ANGLE_DEG, COORDINATE_MM, LENGTH_MM, ListOf, Maybe, Number, Numbers, Span, SpanOf, number,
    table, whole,
};
use crate::skin::{CartonSurface, CartonTape, check_skins};

/// Friction from ice to rubber.
const FRICTION: Number = number(0.0, 2.0);
const MASS_KG: Number = above(0.0, 1000.0);
/// From a sharp edge to far more than board can be folded at.
const EDGE_RADIUS_MM: Number = number(0.0, 50.0);

choice! {
    /// What the cartons stand on.
    pub enum SupportForm {
        /// A pallet of boards.
        Boards = "boards",
        /// A fixed platform: one solid block.
        Block = "block",
    }
}

section! {
    /// The pallet that is emptied, or a fixed platform in its place.
    pub struct Pallet {
        /// What it is made of.
        /// Default boards: a wooden pallet; block is a fixed platform.
        form: SupportForm, one_of(), default(SupportForm::Boards);
        /// Centre of its footprint on the floor, in the world, mm.
        xyz_mm: [f64; 3], Numbers::<3>(COORDINATE_MM), required;
        /// Turn about the world's Z, degrees, counter-clockwise seen from above.
        /// Default 0: its X along the world's X.
        yaw_deg: f64, ANGLE_DEG, default(0.0);
        /// Size along its own X, Y and Z, mm.
        /// Default: a EUR pallet (EN 13698-1) with the long side along Y.
        size_mm: [f64; 3], Numbers::<3>(LENGTH_MM), default([800.0, 1200.0, 144.0]);
        /// Coefficient of friction of its deck.
        /// Default 0.5: cardboard on planed wood; a lower one lets the stack slide.
        friction: f64, FRICTION, default(0.5);
    }
}

choice! {
    /// A direction of the pallet frame.
    pub enum PalletAxis {
        /// Along the pallet's X.
        X = "x",
        /// Along the pallet's Y.
        Y = "y",
    }
}

section! {
    /// How one layer is laid: a grid, every carton turned the same way.
    pub struct Pattern {
        /// Cartons side by side along the pallet's X.
        columns: u32, whole(1, 20), required;
        /// Cartons side by side along the pallet's Y.
        rows: u32, whole(1, 20), required;
        /// Where the cartons' long side points.
        /// Default x: the short side of a EUR pallet, across which two 400 mm cartons fit.
        long_side: PalletAxis, one_of(), default(PalletAxis::X);
    }
}

section! {
    /// A block of equal cartons, one of several on the pallet.
    pub struct CartonBlock {
        /// Middle of the block from the middle of the pallet, along the pallet's X and Y, mm.
        xy_mm: [f64; 2], Numbers::<2>(COORDINATE_MM), required;
        /// Two sides of the top face, in either order, and the height, mm.
        size_mm: [f64; 3], Numbers::<3>(LENGTH_MM), required;
        /// Number of layers.
        layers: u32, whole(1, 30), required;
        /// How a layer is laid.
        pattern: Pattern, table(), required;
        /// What the cartons' outside is made of.
        /// Default: that of `cartons.surface`.
        surface: Option<CartonSurface>, Maybe(one_of()), default(None);
        /// Tape over their flaps.
        /// Default: that of `cartons.tape`.
        tape: Option<CartonTape>, Maybe(one_of()), default(None);
        /// Width of the tape, mm.
        /// Default: that of `cartons.tape_width_mm`.
        tape_width_mm: Option<f64>, Maybe(LENGTH_MM), default(None);
        /// Sides of a label on the top, mm.
        /// Default: those of `cartons.label_mm`.
        label_mm: Option<[f64; 2]>, Maybe(Numbers::<2>(LENGTH_MM)), default(None);
    }
}

section! {
    /// Where one carton lies on the pallet or platform.
    pub struct CartonPlace {
        /// Middle of the carton in the world, mm.
        xy_mm: [f64; 2], Numbers::<2>(COORDINATE_MM), required;
        /// Where its long side points, degrees from the world's X, counter-clockwise seen from above.
        /// Default 0: along the world's X.
        yaw_deg: f64, ANGLE_DEG, default(0.0);
    }
}

section! {
    /// The cartons: all of one size, stacked in equal layers or lying one by one; or blocks of several sizes.
    pub struct Cartons {
        /// Two sides of the top face, in either order, and the height, mm; blocks have sizes of their own.
        size_mm: [f64; 3], Numbers::<3>(LENGTH_MM), required;
        /// Number of layers. With `pattern`, or `at` or `block` instead of both.
        /// Default: none, the cartons lie one by one.
        layers: Option<u32>, Maybe(whole(1, 30)), default(None);
        /// How a layer is laid.
        /// Default: none, the cartons lie one by one.
        pattern: Option<Pattern>, Maybe(table()), default(None);
        /// Cartons that lie one by one; nothing about them is random but their mass.
        /// Default: none, the cartons are stacked.
        at: Vec<CartonPlace>, ListOf(table(), 0, 500), default(Vec::new());
        /// Blocks of cartons side by side, each of its own size and height.
        /// Default: none, all cartons are of one size.
        block: Vec<CartonBlock>, ListOf(table(), 0, 64), default(Vec::new());
        /// Number of cartons; the last ones of the top layer are left out.
        /// Default: columns x rows x layers.
        count: Option<u32>, Maybe(whole(1, 12_000)), default(None);
        /// Mass of a carton, kg, or [smallest, largest] to draw each one's from the seed.
        /// Default [8, 20]: the usual range of mixed grocery cartons that people may still lift.
        mass_kg: Span, SpanOf(MASS_KG), default(Span { min: 8.0, max: 20.0 });
        /// Coefficient of friction between cartons.
        /// Default 0.45: cardboard on cardboard is 0.3 to 0.6; a lower one lets neighbours be dragged less.
        friction: f64, FRICTION, default(0.45);
        /// Radius of the edges and corners as the camera sees them, mm; at most half of the shortest side.
        /// Only the picture knows it: contacts are those of sharp boxes.
        /// Default 0: sharp, for which the estimation's figures are given. A fold of corrugated board is taken to be
        /// about as round as the board is thick: 3 mm (B flute) or 4 mm (C flute).
        edge_radius_mm: f64, EDGE_RADIUS_MM, default(0.0);
        /// What their outside is made of. Only the picture knows it: cups hold all of them alike.
        /// Default kraft: brown board, as most cartons are.
        surface: CartonSurface, one_of(), default(CartonSurface::Kraft);
        /// Tape over their flaps: a stripe along the long side over the middle of the top, and 60 mm down both short
        /// sides. Only the picture knows it: cups hold on it as on board.
        /// Default none: the estimation's figures are given for bare tops.
        tape: CartonTape, one_of(), default(CartonTape::None);
        /// Width of the tape, mm; with the edges' radius on both sides at most the short side of a top.
        /// Default 50: the roll that carton sealers take.
        tape_width_mm: f64, LENGTH_MM, default(50.0);
        /// Sides of a white label on every top, mm, the first along the carton's long side. It lies over the tape, where
        /// and how it is turned (5 degrees at most) comes from the seed; stream `cartons.label`.
        /// Only the picture knows it.
        /// Default: none.
        label_mm: Option<[f64; 2]>, Maybe(Numbers::<2>(LENGTH_MM)), default(None);
    }
    check check_cartons;
}

impl Cartons {
    /// The stack: number of layers and how one is laid; none if the cartons lie one by one.
    pub fn stack(&self) -> Option<(u32, &Pattern)> {
        Some((self.layers?, self.pattern.as_ref()?))
    }

    /// Number of cartons at the start.
    pub fn total(&self) -> u32 {
        let stacked = self.stack().map_or(0, |(layers, pattern)| {
            self.count
                .unwrap_or(pattern.columns * pattern.rows * layers)
        });
        let blocks = self.block.iter();
        let in_blocks: u32 = blocks
            .map(|block| block.pattern.columns * block.pattern.rows * block.layers)
            .sum();
        stacked + in_blocks + self.at.len() as u32
    }
}

/// Longer and shorter side of the top face, mm.
pub(crate) fn long_and_short_mm([a, b, _]: [f64; 3]) -> [f64; 2] {
    [a.max(b), a.min(b)]
}

fn check_cartons(cartons: &Cartons, checker: &mut Checker<'_, '_>) {
    check_edges(cartons, checker);
    check_skins(cartons, checker);
    let Some((layers, pattern)) = cartons.stack() else {
        if cartons.at.is_empty() && cartons.block.is_empty() {
            for (key, is_missing) in [
                ("layers", cartons.layers.is_none()),
                ("pattern", cartons.pattern.is_none()),
            ] {
                if is_missing {
                    checker.problem(
                        key,
                        "missing key".to_owned(),
                        Some("or give at = [...] or block = [...]"),
                    );
                }
            }
        } else if cartons.layers.is_some() || cartons.pattern.is_some() || cartons.count.is_some() {
            checker.problem(
                "at",
                "expected either a stack (layers, pattern, count) or at, found both".to_owned(),
                None,
            );
        } else if !cartons.at.is_empty() && !cartons.block.is_empty() {
            checker.problem(
                "block",
                "expected either block or at, found both".to_owned(),
                None,
            );
        }
        check_blocks(cartons, checker);
        check_apart(cartons, checker);
        return;
    };
    if !cartons.block.is_empty() {
        checker.problem(
            "block",
            "expected either a stack (layers, pattern, count) or block, found both".to_owned(),
            None,
        );
    }
    if !cartons.at.is_empty() {
        checker.problem(
            "at",
            "expected either a stack (layers, pattern, count) or at, found both".to_owned(),
            None,
        );
    }
    let per_layer = pattern.columns * pattern.rows;
    let most = per_layer * layers;
    let least = most - per_layer + 1;
    if let Some(count) = cartons.count
        && !(least..=most).contains(&count)
    {
        checker.problem(
            "count",
            format!(
                "expected {least} to {most} ({} x {} cartons in each of {} layers), found {count}",
                pattern.columns, pattern.rows, layers
            ),
            Some("change layers for a lower stack"),
        );
    }
}

/// No side is shorter than two edges are wide.
fn check_edges(cartons: &Cartons, checker: &mut Checker<'_, '_>) {
    let radius = cartons.edge_radius_mm;
    let own = cartons.block.is_empty().then_some(cartons.size_mm);
    let sizes = own
        .into_iter()
        .chain(cartons.block.iter().map(|block| block.size_mm));
    let shortest = sizes.flatten().fold(f64::INFINITY, f64::min);
    if 2.0 * radius > shortest {
        checker.problem(
            "edge_radius_mm",
            format!(
                "expected at most {} (half of the shortest side of a carton), found {radius}",
                0.5 * shortest
            ),
            None,
        );
    }
}

/// Blocks must not lie in one another.
fn check_blocks(cartons: &Cartons, checker: &mut Checker<'_, '_>) {
    for (position, block) in cartons.block.iter().enumerate() {
        let footprint = footprint_mm(block.size_mm, &block.pattern);
        let meets = |other: &CartonBlock| {
            let beside = footprint_mm(other.size_mm, &other.pattern);
            (0..2).all(|axis| {
                let apart = (block.xy_mm[axis] - other.xy_mm[axis]).abs();
                apart < 0.5 * (footprint[axis] + beside[axis]) - 1e-6
            })
        };
        if let Some(other) = cartons.block[..position].iter().position(meets) {
            checker.problem(
                "block",
                format!(
                    "expected blocks beside each other, found {other} and {position} in one place"
                ),
                None,
            );
        }
    }
}

/// Cartons that lie one by one must not lie in one another.
fn check_apart(cartons: &Cartons, checker: &mut Checker<'_, '_>) {
    for (position, place) in cartons.at.iter().enumerate() {
        let overlapped = cartons.at[..position]
            .iter()
            .position(|other| overlap(long_and_short_mm(cartons.size_mm), place, other));
        if let Some(other) = overlapped {
            checker.problem(
                "at",
                format!("expected cartons apart from each other, found {other} and {position} in one place"),
                None,
            );
        }
    }
}

/// Whether two turned rectangles share area: no side of either separates them.
fn overlap([long, short]: [f64; 2], a: &CartonPlace, b: &CartonPlace) -> bool {
    let axes = |place: &CartonPlace| {
        let (sin, cos) = place.yaw_deg.to_radians().sin_cos();
        [[cos, sin], [-sin, cos]]
    };
    let apart = [b.xy_mm[0] - a.xy_mm[0], b.xy_mm[1] - a.xy_mm[1]];
    let along = |u: [f64; 2], v: [f64; 2]| u[0] * v[0] + u[1] * v[1];
    let reach = |place: &CartonPlace, axis: [f64; 2]| {
        let [x, y] = axes(place);
        0.5 * (long * along(x, axis).abs() + short * along(y, axis).abs())
    };
    let separates = |axis: [f64; 2]| along(apart, axis).abs() >= reach(a, axis) + reach(b, axis);
    !axes(a).into_iter().chain(axes(b)).any(separates)
}

section! {
    /// How untidy the stack is; every draw comes from the seed, each key from its own stream.
    ///
    /// What a scene does not ask for is not random.
    pub struct Randomize {
        /// Clear distance between neighbours in a layer, mm, or [smallest, largest]; stream `cartons.gap`.
        /// Default 4: the middle of what case packers leave.
        gap_mm: Span, SpanOf(number(0.0, 500.0)), default(Span::of(4.0));
        /// Largest turn of a carton about Z, degrees, either way; stream `cartons.yaw`.
        /// Default 0: no turns.
        yaw_deg: f64, number(0.0, 20.0), default(0.0);
        /// Largest shift of a carton along the pallet's X and Y, mm, either way; stream `cartons.shift`.
        /// Between neighbours a shift is cut short where it would leave the range of `gap_mm`.
        /// Default 0: no shifts.
        shift_mm: f64, number(0.0, 100.0), default(0.0);
    }
}

section! {
    /// The belt that takes the cartons away. Its frame has X along the travel and Z up.
    pub struct Conveyor {
        /// Middle of the belt's upper surface, in the world, mm.
        xyz_mm: [f64; 3], Numbers::<3>(COORDINATE_MM), required;
        /// Direction of travel, degrees from the world's X, counter-clockwise seen from above.
        /// Default 0: along the world's X.
        yaw_deg: f64, ANGLE_DEG, default(0.0);
        /// Length along the travel, width, and thickness of the belt body, mm.
        /// Default [3000, 600, 100]: room for five cartons in a line.
        size_mm: [f64; 3], Numbers::<3>(LENGTH_MM), default([3000.0, 600.0, 100.0]);
        /// Speed of the belt, mm/s.
        /// Default 400: clears a 400 mm carton in a second, well below one pick's time.
        speed_mm_s: f64, number(0.0, 3000.0), default(400.0);
        /// Coefficient of friction of the belt.
        /// Default 0.6: a lower one lets cartons slip when they land.
        friction: f64, FRICTION, default(0.6);
        /// Where the middle of a carton's bottom is to be placed, in the world, mm.
        place_xyz_mm: [f64; 3], Numbers::<3>(COORDINATE_MM), required;
        /// Where a placed carton's long side points, degrees from the world's X.
        /// Default 0: along the world's X.
        place_yaw_deg: f64, ANGLE_DEG, default(0.0);
    }
    check check_conveyor;
}

fn check_conveyor(conveyor: &Conveyor, checker: &mut Checker<'_, '_>) {
    let [x, y, z] = [0, 1, 2].map(|axis| conveyor.place_xyz_mm[axis] - conveyor.xyz_mm[axis]);
    let (sin, cos) = conveyor.yaw_deg.to_radians().sin_cos();
    let along = cos * x + sin * y;
    let across = cos * y - sin * x;
    let [length, width, _] = conveyor.size_mm;
    if along.abs() > length / 2.0 || across.abs() > width / 2.0 {
        checker.problem(
            "place_xyz_mm",
            format!(
                "expected a place on the belt (at most {} mm along and {} mm across from its middle), \
                 found {along:.0} mm along and {across:.0} mm across",
                length / 2.0,
                width / 2.0
            ),
            None,
        );
    }
    if !(0.0..=500.0).contains(&z) {
        checker.problem(
            "place_xyz_mm",
            format!("expected 0 to 500 mm above the belt, found {z:.0} mm"),
            None,
        );
    }
}
