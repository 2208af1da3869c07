use depal_frames::JointPositions;

use super::notes::Notes;
use crate::{
    contact::Check,
    path::{Blocked, corner_states, touch_on_states, touch_on_way, ways},
    search::search,
    situation::Situation,
    world::World,
};

/// A joint move between two straight ones.
pub(super) struct FreeMove<'a> {
    pub check: Check<'a>,
    /// What counts at the corners with the straight moves: the close padding, and the box to be picked.
    pub beside: &'a World,
    pub from: JointPositions,
    /// The straight move before it, if there is one.
    pub before: Option<&'a [JointPositions]>,
    /// The straight move after it; it leads to the first of these.
    pub after: &'a [JointPositions],
    /// Largest lean of the tool, rad.
    pub upright: Option<f64>,
    /// Where all templates are blocked, a random search comes next.
    pub search: bool,
}

/// The fastest free joint way between two straight moves, their corners included; else what was met.
pub(super) fn free_way(
    situation: &Situation,
    free: &FreeMove,
) -> Result<Vec<JointPositions>, Notes> {
    let settings = situation.request.settings;
    let (check, from, to) = (&free.check, &free.from, &free.after[0]);
    let mut notes = Notes::default();
    let beside = Check {
        world: free.beside,
        ..*check
    };
    let corner = |a: &JointPositions, at: &JointPositions, b: &JointPositions| {
        let tool = |q: &JointPositions| situation.tool(q);
        touch_on_states(
            &beside,
            &corner_states(tool, a, at, b, settings.corner_zone),
        )
    };
    // The corners between this way and the straight moves beside it.
    let ends = |points: &[JointPositions]| {
        let last = points.len() - 1;
        let into = corner(&points[last - 1], to, &free.after[free.after.len() / 2]);
        into.or_else(|| {
            let half = free.before.map(|line| &line[line.len() / 2])?;
            corner(half, from, &points[1])
        })
    };
    for way in ways(situation.request.arm, from, to) {
        match touch_on_way(check, &way.points, free.upright, settings) {
            Err(Blocked::Touches(touch)) => notes.touched(touch),
            Err(Blocked::Leans) => {}
            Ok(()) => match ends(&way.points) {
                Some(touch) => notes.touched(touch),
                None => return Ok(way.points),
            },
        }
    }
    if free.search
        && let Some(way) = search(check, from, to, free.upright, settings)
    {
        match ends(&way) {
            Some(touch) => notes.touched(touch),
            None => return Ok(way),
        }
    }
    Err(notes)
}
