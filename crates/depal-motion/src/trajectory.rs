use std::sync::Arc;

use depal_arm::{Arm, Load};
use depal_frames::JointPositions;

use crate::cell::{Cell, CellLimits};
use crate::curve::{Curve, combine};
use crate::shape::{Shape, divided, measure};
use crate::timing::{brake, fastest};
use crate::torque::TorqueLimits;
use crate::{MotionError, Segment, SegmentId, Speed, Zone};

/// A growing path and the fastest law along it that ends at rest.
///
/// The clock is the caller's: times are seconds on one axis, and no call may name a `now` earlier than one before.
/// What lies before `now` is never changed; what comes after may be timed anew, without any step in position or
/// speed at `now`.
#[derive(Debug, Clone)]
pub struct Trajectory {
    pub(crate) arm: Arc<Arm>,
    pub(crate) cells: Vec<Cell>,
    /// Where the arm stands before the first of the cells.
    start: JointPositions,
    end: JointPositions,
    pub(crate) next: u64,
    pub(crate) last: Option<Last>,
    pub(crate) corner_failures: Vec<SegmentId>,
    /// Of segments to come; none where the arm has no torque limits.
    pub(crate) torque: Option<Arc<TorqueLimits>>,
}

/// The last segment, whose end may still become a corner.
#[derive(Debug, Clone)]
pub(crate) struct Last {
    pub(crate) id: SegmentId,
    pub(crate) shape: Shape,
    /// Rate in this segment's parameter over the rate at the end of what lies before it; 0 from a stand.
    entry_link: f64,
}

impl Trajectory {
    /// An arm standing at `start`, radians.
    pub fn new(arm: Arc<Arm>, start: JointPositions) -> Self {
        Self {
            torque: TorqueLimits::new(&arm, &Load::NONE, &Load::NONE).map(Arc::new),
            arm,
            cells: Vec::new(),
            start,
            end: start,
            next: 0,
            last: None,
            corner_failures: Vec::new(),
        }
    }

    /// What hangs on the flange in segments appended from now on, gripper and carton together; nothing at first.
    /// It matters only to an arm with torque limits, whose axes then obey them with the load and without it,
    /// so that it may be let go or lost anywhere; a heavier load at the same place never makes a move faster.
    pub fn set_load(&mut self, load: &Load) {
        self.set_tool_and_load(&Load::NONE, load);
    }

    /// As [`set_load`](Self::set_load), with the tool, which stays when the load is let go: the axes obey their limits
    /// with the tool alone and with both.
    pub fn set_tool_and_load(&mut self, tool: &Load, load: &Load) {
        if self.torque.as_ref().is_some_and(|t| t.differ(tool, load)) {
            self.torque = TorqueLimits::new(&self.arm, tool, load).map(Arc::new);
        }
    }

    /// Adds a segment after the last one and times the rest of the path anew from `now`.
    ///
    /// The corner before it is blended if its zone was not yet entered and the arm can still slow down for it;
    /// otherwise the arm stands at the corner and [`corner_failures`](Self::corner_failures) gains an entry.
    /// On an error the trajectory is as before.
    pub fn append(&mut self, now: f64, segment: &Segment) -> Result<SegmentId, MotionError> {
        let shape = Shape::new(&self.arm, &self.end, segment, self.torque.as_ref())?;
        let id = SegmentId(self.next);
        self.next += 1;
        let Some(shape) = shape else {
            // Nothing moves, and what follows starts from a stand.
            self.last = None;
            return Ok(id);
        };
        let last = self.last.take();
        let blended = last
            .as_ref()
            .and_then(|last| self.blend(now, last, id, &shape));
        if let (None, Some(last)) = (blended, &last)
            && last.shape.zone != Zone::Fine
        {
            self.corner_failures.push(last.id);
        }
        let entry_link = blended.unwrap_or(0.0);
        if entry_link == 0.0 {
            let mut cells = Vec::new();
            push_cells(&mut cells, &shape, id, (0.0, 1.0), 0.0);
            let laws = fastest(&cells, 0.0, self.duration().max(now))
                .expect("from a stand every path can be followed");
            for (cell, law) in cells.iter_mut().zip(laws) {
                cell.law = law;
            }
            self.cells.append(&mut cells);
        }
        self.end = shape.end;
        self.last = Some(Last {
            id,
            shape,
            entry_link,
        });
        Ok(id)
    }

    /// Tries to round the corner between the last segment and `next`; the link into `next` if it worked.
    fn blend(&mut self, now: f64, last: &Last, id: SegmentId, next: &Shape) -> Option<f64> {
        let (leave, enter) = last.shape.corner(next)?;
        // Where the corner before gives way to this segment.
        let own = self
            .cells
            .iter()
            .find(|cell| Arc::ptr_eq(&cell.curve, &last.shape.curve))?;
        let leave = leave.max(own.from);
        let (corner, limits) = self.corner(last, next, leave, enter)?;
        let free = self.divide(now);
        // The first cell of the last segment that reaches beyond the corner's beginning.
        let cut = self.cells.iter().position(|cell| {
            Arc::ptr_eq(&cell.curve, &last.shape.curve) && cell.to > leave + 1e-9
        })?;
        if cut < free {
            return None;
        }
        let removed = self.cells.split_off(cut);
        if leave - removed[0].from > 1e-7 {
            self.cells.push(removed[0].clone().cut_at(leave));
        }
        let (before, after) = (2.0 * (1.0 - leave), 2.0 * enter);
        let mut link = match self.cells.last() {
            Some(cell) if Arc::ptr_eq(&cell.curve, &last.shape.curve) => 1.0,
            // Two corners meet in the middle of the segment.
            _ => last.entry_link,
        } / before;
        let nodes = measure(&self.arm, &corner, corner.cells(), |u| {
            if u < 0.5 {
                &last.shape.flange_from_tcp
            } else {
                &next.flange_from_tcp
            }
        });
        let corner = Arc::new(corner);
        let even = nodes.windows(2).map(|pair| {
            let width = pair[1].parameter - pair[0].parameter;
            (
                (pair[0].parameter, pair[1].parameter),
                (
                    (pair[1].tcp - pair[0].tcp) / width,
                    (pair[1].turn - pair[0].turn) / width,
                ),
            )
        });
        let ends_standing = enter >= 1.0 - 1e-6;
        for (range, rates) in divided(even.collect(), link == 0.0, ends_standing) {
            self.cells.push(Cell::new(
                &corner,
                &limits[usize::from(range.0 >= 0.5)],
                last.id,
                range,
                rates,
                link,
            ));
            link = 1.0;
        }
        push_cells(&mut self.cells, next, id, (enter, 1.0), after);
        // What lies before the last stand stays as it is.
        let stand = (free..cut).rev().find(|i| self.cells[*i].link == 0.0);
        let free = stand.unwrap_or(free);
        let first = &self.cells[free];
        let (entry, start) = match free.checked_sub(1) {
            Some(i) if first.link > 0.0 => {
                let law = self.cells[i].law;
                let rate = law.end_rate() * first.link;
                (rate * rate, law.end())
            }
            _ => (0.0, first.law.start.max(now)),
        };
        if let Some(laws) = fastest(&self.cells[free..], entry, start) {
            for (cell, law) in self.cells[free..].iter_mut().zip(laws) {
                cell.law = law;
            }
            Some(after)
        } else {
            self.cells.truncate(cut);
            self.cells.extend(removed);
            None
        }
    }

    /// The curve of a corner and the limits of its two halves; none if it would leave the joint limits,
    /// or pass where the arm cannot hold its load.
    fn corner(
        &self,
        last: &Last,
        next: &Shape,
        leave: f64,
        enter: f64,
    ) -> Option<(Curve, [Arc<CellLimits>; 2])> {
        let p = last.shape.curve.position(leave);
        let q = next.curve.position(enter);
        let p_slope = last.shape.curve.derivatives(leave, leave - 1e-6).first;
        let q_slope = next.curve.derivatives(enter, enter + 1e-6).first;
        let third = 2.0 / 3.0;
        let curve = Curve::Corner {
            control: [
                p,
                combine(&[1.0, third * (1.0 - leave)], &[&p, &p_slope]),
                combine(&[1.0, -third * enter], &[&q, &q_slope]),
                q,
            ],
        };
        let count = curve.cells();
        let inside = (1..count).all(|i| {
            let at = curve.position(i as f64 / count as f64);
            let holds = |shape: &Shape| {
                let torque = shape.limits.torque.as_ref();
                torque.is_none_or(|torque| torque.check_holding(&at).is_ok())
            };
            self.arm.within_limits(&at) && holds(&last.shape) && holds(next)
        });
        inside.then(|| {
            (
                curve,
                [Arc::clone(&last.shape.limits), Arc::clone(&next.limits)],
            )
        })
    }

    /// Divides the cell in progress at `now`; the index of the first cell that is not yet begun.
    pub(crate) fn divide(&mut self, now: f64) -> usize {
        const SLIVER: f64 = 1e-12;
        let begun = self.cells.partition_point(|cell| cell.law.start < now);
        let Some(i) = begun.checked_sub(1) else {
            return 0;
        };
        let cell = &self.cells[i];
        let at = cell.parameter(now);
        if now >= cell.law.end() || at - cell.from < SLIVER || cell.to - at < SLIVER {
            return begun;
        }
        let (before, after) = cell.split(now);
        self.cells[i] = before;
        self.cells.insert(begun, after);
        begun
    }

    /// Stops as soon as the full joint accelerations allow, on the path, and drops the rest of it.
    /// The segments in progress and behind count as done when the arm stands.
    pub fn stop(&mut self, now: f64) {
        let free = self.divide(now);
        let rest = self.cells.split_off(free);
        self.last = None;
        let moving = self
            .cells
            .last()
            .filter(|cell| cell.law.end() >= now && cell.law.end_rate() > 0.0);
        if let (Some(cell), Some(first)) = (moving, rest.first()) {
            let rate = cell.law.end_rate() * first.link;
            let full = CellLimits::new(self.arm.limits(), &Speed::UNLIMITED).joint_acceleration;
            let (laws, stand) = brake(&rest, &full, rate * rate, cell.law.end());
            let count = laws.len();
            for (cell, law) in rest.into_iter().zip(laws) {
                self.cells.push(Cell { law, ..cell });
            }
            if count > 0
                && let Some(cell) = self.cells.pop()
            {
                self.cells.push(cell.cut_at(stand));
            }
        }
        self.end = self
            .cells
            .last()
            .map_or(self.start, |cell| cell.curve.position(cell.to));
    }

    /// Forgets what was over before `now`; [`sample`](Self::sample) is then valid from `now` on.
    pub fn forget_before(&mut self, now: f64) {
        let over = self.cells.partition_point(|cell| cell.law.end() < now);
        if let Some(i) = over.checked_sub(1) {
            self.start = self.cells[i].curve.position(self.cells[i].to);
            self.cells.drain(..over);
        }
    }

    fn cell_at(&self, time: f64) -> Option<&Cell> {
        let begun = self.cells.partition_point(|cell| cell.law.start <= time);
        begun.checked_sub(1).map(|i| &self.cells[i])
    }

    /// Joint positions at a time, radians; the start before the path begins, the end after it is over.
    pub fn sample(&self, time: f64) -> JointPositions {
        self.cell_at(time)
            .map_or(self.start, |cell| cell.curve.position(cell.parameter(time)))
    }

    /// Joint speeds at a time, rad/s.
    pub fn sample_speed(&self, time: f64) -> JointPositions {
        let zero = JointPositions::zeros(self.start.len());
        match self.cell_at(time) {
            Some(cell) if time <= cell.law.end() => {
                let u = cell.parameter(time);
                let rate = cell.law.rate + cell.law.acceleration * (time - cell.law.start);
                let slope = cell.curve.derivatives(u, 0.5 * (cell.from + cell.to)).first;
                combine(&[rate.max(0.0)], &[&slope])
            }
            _ => zero,
        }
    }

    /// Torques of the joints at a time, N m, with the load of the segment under way; `None` for an arm without
    /// torque limits, and while nothing moves.
    pub fn sample_torques(&self, time: f64) -> Option<JointPositions> {
        let cell = self.cell_at(time).filter(|c| time <= c.law.end())?;
        let torque = cell.limits.torque.as_ref()?;
        let u = cell.parameter(time);
        let rate = cell.law.rate + cell.law.acceleration * (time - cell.law.start);
        let at = cell.curve.derivatives(u, 0.5 * (cell.from + cell.to));
        let speeds = combine(&[rate], &[&at.first]);
        let accelerations = combine(
            &[cell.law.acceleration, rate * rate],
            &[&at.first, &at.second],
        );
        let joints = cell.curve.position(u);
        Some(
            self.arm
                .joint_torques(&joints, &speeds, &accelerations, torque.load()),
        )
    }

    /// When the arm stands at the end, seconds on the trajectory's axis; 0 if nothing is left to travel.
    pub fn duration(&self) -> f64 {
        self.cells.last().map_or(0.0, |cell| cell.law.end())
    }

    /// Joint positions at the end of the path, radians: where the next segment will begin.
    pub fn end_joints(&self) -> JointPositions {
        self.end
    }

    /// When the arm gets to the part of the path that is a segment's own, behind the corner before it.
    /// None if that is past and forgotten, or there is no such part.
    pub fn start_time(&self, segment: SegmentId) -> Option<f64> {
        let first = self.cells.partition_point(|cell| cell.segment < segment);
        self.cells
            .get(first)
            .filter(|cell| cell.segment == segment)
            .map(|cell| cell.law.start)
    }

    /// When a segment is over: the arm stands at its end, or its corner was left behind.
    /// None if that is past and forgotten, or there was no way to go.
    pub fn end_time(&self, segment: SegmentId) -> Option<f64> {
        let until = self.cells.partition_point(|cell| cell.segment <= segment);
        until.checked_sub(1).map(|i| self.cells[i].law.end())
    }

    /// Whether a segment is over at `time`.
    pub fn is_done(&self, segment: SegmentId, time: f64) -> bool {
        self.end_time(segment).is_none_or(|end| time >= end)
    }

    /// The segment under way at `time`, none while the arm stands.
    pub fn active(&self, time: f64) -> Option<SegmentId> {
        self.cell_at(time)
            .filter(|cell| time < cell.law.end())
            .map(|cell| cell.segment)
    }

    /// Segments that asked for a corner and became a stop, in order:
    /// the next one came too late, or left no room to slow down.
    pub fn corner_failures(&self) -> &[SegmentId] {
        &self.corner_failures
    }

    /// The arm.
    pub fn arm(&self) -> &Arc<Arm> {
        &self.arm
    }
}

/// Adds the cells of the part `from..=to` of a segment.
fn push_cells(
    cells: &mut Vec<Cell>,
    shape: &Shape,
    id: SegmentId,
    (from, to): (f64, f64),
    link: f64,
) {
    let mut link = link;
    for (range, rates) in shape.cells(from, to) {
        cells.push(Cell::new(
            &shape.curve,
            &shape.limits,
            id,
            range,
            rates,
            link,
        ));
        link = 1.0;
    }
}
