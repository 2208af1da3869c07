//! How long the moves of a pick take. Single moves are compared by their trapezoids; the whole way is timed by the law
//! that moves the arm.

pub(crate) use depal_motion::Trapezoid;

/// Time of a chain of moves, seconds. Where the controller flies past the point between two moves,
/// the ramp down and the next ramp up run at the same time.
pub(crate) fn chain_time(moves: &[(Trapezoid, bool)]) -> f64 {
    let mut time = 0.0;
    for (i, (profile, stops)) in moves.iter().enumerate() {
        time += profile.duration;
        if let Some((next, _)) = moves.get(i + 1)
            && !stops
        {
            time -= profile.ramp.min(next.ramp);
        }
    }
    time
}
