//! Where within a step a load changes its law by a sign that depends on the state.

use super::along::{Look, View, sign};
use super::stepper::Dense;
use crate::motion::loads::Switch;
use crate::motion::state::Phase;

/// A body that turns further than that in a step, in radians, may pass a zero twice, however it moves at the ends.
const LONG: f64 = 2.0;

/// The first change within the step that began at `from` in the state `before`: which switch, and the time since the start of the span,
/// which is `start`.
pub(super) fn first<E>(
    switches: &[Switch],
    stepper: &mut dyn Dense<Error = E>,
    start: f64,
    from: f64,
    before: &Phase,
) -> Result<Option<(usize, f64)>, E> {
    let mut first: Option<(usize, f64)> = None;
    for (index, switch) in switches.iter().enumerate() {
        if let Some(place) = of(switch, stepper, start, from, before)?
            && first.is_none_or(|(_, earlier)| place.abs() < earlier.abs())
        {
            first = Some((index, place));
        }
    }
    Ok(first)
}

fn of<E>(
    switch: &Switch,
    stepper: &mut dyn Dense<Error = E>,
    start: f64,
    from: f64,
    before: &Phase,
) -> Result<Option<f64>, E> {
    let to = stepper.elapsed();
    let turn = stepper.turn(to - from);
    let forward = (to - from).signum();
    let [[w, rate], [w_end, rate_end]] = [before, &stepper.phase()].map(|phase| {
        let [value, rate] = switch.value_and_rate(phase);
        [value, rate * forward]
    });
    // Just past a change rounding may have left it on the side it comes from.
    let ends_beyond = w_end < 0.0 && (w >= 0.0 || rate_end < 0.0);
    let may_dip = rate <= 0.0 && rate_end >= 0.0;
    if !(ends_beyond || may_dip || turn > LONG) {
        return Ok(None);
    }
    let mut view = View {
        function: &mut |_, phase| Ok(switch.value_and_rate(phase)[0]),
        stepper,
        start,
        end: to,
    };
    let mut last = Look {
        at: from,
        value: w.max(0.0),
    };
    for look in view.looks(last, turn)? {
        if look.value < 0.0 {
            if last.value <= 0.0 {
                return Ok(Some(last.at));
            }
            return view.locate([last, look], sign(last.value)).map(Some);
        }
        last = look;
    }
    Ok(None)
}
