//! Where within a step a load changes its law by a sign that depends on the state.

use std::ops::ControlFlow;

use super::roots_in_step::{Look, MOST_LOOKS, RootSearch, sign};
use super::stepper::Dense;
use crate::error::Error;
use crate::motion::loads::LawSwitch;
use crate::motion::state::Phase;

/// A body that turns further than that in a step, in radians, may pass a zero twice, however it moves at the ends.
const LONG: f64 = 2.0;

/// The first change within the step that began at `from` in the state `before`, and the time since the start of the span, which is
/// `start`.
pub(super) fn find_first<E: From<Error>>(
    law_switches: &[LawSwitch],
    stepper: &mut dyn Dense<Error = E>,
    start: f64,
    from: f64,
    before: &Phase,
) -> Result<Option<(LawSwitch, f64)>, E> {
    let mut first: Option<(LawSwitch, f64)> = None;
    for law_switch in law_switches {
        if let Some(place) = find_switch(law_switch, stepper, start, from, before)?
            && first
                .as_ref()
                .is_none_or(|(_, earlier)| place.abs() < earlier.abs())
        {
            first = Some((law_switch.clone(), place));
        }
    }
    if let Some((LawSwitch::Stop(limit), place)) = &first
        && limit.is_limit()
    {
        let place = *place;
        let limit = limit.on_side(&phase_at(stepper, from, before, place)?);
        return Ok(Some((LawSwitch::Stop(limit), place)));
    }
    if let Some((LawSwitch::Slip(bearing), place)) = &first {
        let place = *place;
        // The way that the wheel turns then is against what held it.
        let phase = phase_at(stepper, from, before, place)?;
        let slipping = bearing.in_slip(stepper.bearing_torque(bearing, place, &phase)?);
        return Ok(Some((LawSwitch::Slip(slipping), place)));
    }
    Ok(first)
}

/// The state at a time within the step that began at `from`.
fn phase_at<E>(
    stepper: &mut dyn Dense<Error = E>,
    from: f64,
    before: &Phase,
    place: f64,
) -> Result<Phase, E> {
    if place == from {
        Ok(before.clone())
    } else {
        stepper.within(place)
    }
}

/// A function that is negative beyond the change.
fn until_switch<E>(
    law_switch: &LawSwitch,
    stepper: &mut dyn Dense<Error = E>,
    start: f64,
    at: f64,
    phase: &Phase,
) -> Result<f64, E> {
    Ok(match law_switch {
        LawSwitch::Sign(switch) => switch.value_and_rate(start + at, phase)[0],
        LawSwitch::Stop(bearing) => bearing.until_stop(phase),
        LawSwitch::Slip(bearing) => bearing.until_slip(stepper.bearing_torque(bearing, at, phase)?),
    })
}

fn find_switch<E: From<Error>>(
    law_switch: &LawSwitch,
    stepper: &mut dyn Dense<Error = E>,
    start: f64,
    from: f64,
    before: &Phase,
) -> Result<Option<f64>, E> {
    let to = stepper.elapsed();
    let turn = stepper.turn(to - from);
    let value = until_switch(law_switch, stepper, start, from, before)?;
    if let LawSwitch::Sign(switch) = law_switch {
        let forward = (to - from).signum();
        let [[w, rate], [w_end, rate_end]] =
            [(from, before), (to, &stepper.phase())].map(|(at, phase)| {
                let [value, rate] = switch.value_and_rate(start + at, phase);
                [value, rate * forward]
            });
        // Just past a change rounding may have left it on the side it comes from.
        let ends_beyond = w_end < 0.0 && (w >= 0.0 || rate_end < 0.0);
        let may_dip = rate <= 0.0 && rate_end >= 0.0;
        if !(ends_beyond || may_dip || turn > LONG) {
            return Ok(None);
        }
    } else if value < 0.0 {
        return Ok(Some(from));
    }
    let mut search = RootSearch {
        function: &mut |stepper, at, phase| until_switch(law_switch, stepper, start, at, phase),
        event: None,
        stepper,
        start,
        end: to,
        longest: f64::INFINITY,
        halved: None,
        left: &mut MOST_LOOKS.clone(),
    };
    let mut last = Look {
        at: from,
        value: value.max(0.0),
    };
    let mut found = None;
    search.visit_looks(last, turn, &mut |search, look| {
        if look.value < 0.0 {
            found = Some(if last.value <= 0.0 {
                last.at
            } else {
                search.locate([last, look], sign(last.value))?
            });
            return Ok(ControlFlow::Break(()));
        }
        last = look;
        Ok(ControlFlow::Continue(()))
    })?;
    Ok(found)
}
