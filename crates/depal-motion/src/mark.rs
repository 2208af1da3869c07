//! Places on the path and when the TCP passes them.

use std::sync::Arc;

use crate::curve::Curve;
use crate::{SegmentId, Trajectory};

/// A place along a segment, by TCP path length in metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Along {
    /// So far before its end.
    BeforeEnd(f64),
    /// So far after its start.
    AfterStart(f64),
}

/// A place on the path. Of a corner, the first half belongs to the segment before and the second to the one
/// behind: the middle of the corner is the end of a fly-by segment.
#[derive(Debug, Clone)]
pub struct Mark {
    segment: SegmentId,
    curve: Option<Arc<Curve>>,
    parameter: f64,
}

/// When a place is passed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MarkTime {
    /// At this time, seconds on the trajectory's axis; later if what lies ahead is timed anew.
    /// Infinite while the path is held before it.
    At(f64),
    /// It lies in a part of the path that is forgotten.
    Passed,
}

impl Trajectory {
    /// A place on the segment that was appended last; its end if that did not move the arm.
    pub fn mark_last(&self, along: Along) -> Mark {
        let Some(last) = &self.last else {
            return Mark {
                segment: SegmentId(self.next.saturating_sub(1)),
                curve: None,
                parameter: 1.0,
            };
        };
        Mark {
            segment: last.id,
            curve: Some(Arc::clone(&last.shape.curve)),
            parameter: last.shape.parameter_at(along),
        }
    }

    /// When a place is passed.
    pub fn mark_time(&self, mark: &Mark) -> MarkTime {
        let Some(curve) = &mark.curve else {
            // Nothing moved: the place is passed when everything before it is over.
            let until = self
                .cells
                .partition_point(|cell| cell.segment <= mark.segment);
            return until
                .checked_sub(1)
                .map_or(MarkTime::Passed, |i| MarkTime::At(self.cells[i].law.end()));
        };
        let own = |index: usize| Arc::ptr_eq(&self.cells[index].curve, curve);
        let first = (0..self.cells.len()).find(|i| own(*i));
        let begin = self
            .cells
            .partition_point(|cell| cell.segment < mark.segment);
        let end = self
            .cells
            .partition_point(|cell| cell.segment <= mark.segment);
        let last = first.and_then(|first| (first..end).rev().find(|i| own(*i)));
        let (enter, leave) = match (first, last) {
            (Some(first), Some(last)) => (self.cells[first].from, self.cells[last].to),
            _ => (0.5, 0.5),
        };
        let u = mark.parameter;
        if let (Some(first), Some(last)) = (first, last)
            && (enter..=leave).contains(&u)
        {
            let cell = (first..=last)
                .map(|i| &self.cells[i])
                .find(|cell| u <= cell.to);
            return cell.map_or(MarkTime::Passed, |cell| MarkTime::At(cell.time_at(u)));
        }
        if u > leave {
            // In the first half of the corner that ends the segment.
            let behind = last.map_or(begin, |last| last + 1);
            let share = 0.5 * (u - leave) / (1.0 - leave);
            return self.corner_time(behind, end, share);
        }
        // In the second half of the corner of the segment before.
        let front = first.unwrap_or(begin);
        let mut corner = front;
        while corner > 0
            && self.cells[corner - 1].segment < mark.segment
            && self.cells[corner - 1].curve.is_corner()
            && (corner == front
                || Arc::ptr_eq(&self.cells[corner - 1].curve, &self.cells[corner].curve))
        {
            corner -= 1;
        }
        self.corner_time(corner, front, 0.5 + 0.5 * u / enter.max(1e-9))
    }

    /// When a share of the corner in the cells `from..to` is passed.
    fn corner_time(&self, from: usize, to: usize, share: f64) -> MarkTime {
        let cells = self.cells.get(from..to).unwrap_or_default();
        let inside = cells.iter().find(|cell| share <= cell.to);
        match (inside, cells.last()) {
            (Some(cell), _) => MarkTime::At(cell.time_at(share.max(cell.from))),
            (None, Some(last)) => MarkTime::At(last.law.end()),
            (None, None) => MarkTime::Passed,
        }
    }
}
