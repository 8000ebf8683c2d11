//! The loop over the steps of a run, through spans of time in which the load is smooth.

use std::ops::ControlFlow;

use super::closed_form_run::ClosedFormRun;
use super::events::{EventDetector, Events, PartOfStep};
use super::law_switches;
use super::runge_kutta_run::{FEW, MANY, MOVING, RungeKuttaRun, SOME, TURNING};
use super::splitting_run::SplittingRun;
use super::stepper::{Carry, Span, Stepper};
use crate::error::{Error, MotionFault};
use crate::motion::integrate::{Dop853, Radau, RungeKutta};
use crate::motion::loads::{LawSwitch, Load, Stiction};
use crate::motion::problem::limits::{HELD, check_steps, spans};
use crate::motion::problem::{End, Method, Run, Task};
use crate::motion::state::Phase;

impl<E> Run<E> {
    /// Goes by steps to the last time, or to where the run ends.
    pub(super) fn through<L: Load<Error = E>>(
        &mut self,
        method: Method,
        task: &Task<'_>,
        load: &mut L,
        events: &mut dyn Events<Error = E>,
        watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<End<E>, E>
    where
        E: From<Error>,
    {
        let last = task.times[task.times.len() - 1];
        let bounds = spans(task.times, load.breaks(task.times[0], last));
        for pair in bounds.windows(2) {
            load.enter(pair[0], pair[1])?; // refused before anything is computed
        }
        if let [from, to, ..] = bounds[..] {
            load.enter(from, to)?; // where the functions of events are looked at first
        }
        let (start, end) = (task.times[0], bounds[bounds.len() - 1]);
        let over_limit = |wheel| load.over_limit(wheel, start, &task.initial);
        let mut detector =
            EventDetector::new(events, start, &task.initial, end - start, &over_limit)?;
        let mut carry = Carry::default();
        // The ends of the spans to come, the next one last: what the load does at the start of a span may cut it.
        let mut ends: Vec<f64> = bounds.iter().skip(1).rev().copied().collect();
        let mut begin = start;
        while let Some(mut to) = ends.pop() {
            let mut from = begin;
            let is_last;
            (to, is_last) = self.begin_span(load, &mut detector, [from, to], &mut ends)?;
            if is_last {
                self.crossings = detector.crossings;
                return Ok(End::Event);
            }
            begin = to;
            // Where the law of the load changes with the state, by what.
            let mut flip: Option<(LawSwitch, f64)> = None;
            let mut flips_at_once = 0_usize;
            loop {
                let span = Span {
                    from,
                    to: flip.as_ref().map_or(to, |(_, time)| *time),
                    phase: self.phase.clone(),
                    carry,
                };
                let mut stepper = begin_stepper(method, task, &span, load)?;
                let before = self.effort;
                let mut watch = |elapsed: f64| watch((from - start + elapsed) / (end - start));
                let ended = self.span(
                    task,
                    &span,
                    &mut *stepper,
                    flip.is_none(),
                    &mut detector,
                    &mut watch,
                );
                let of_span = stepper.effort();
                self.effort.steps = before.steps + of_span.steps;
                self.effort.evaluations = before.evaluations + of_span.evaluations;
                carry = stepper.carry();
                drop(stepper);
                match ended {
                    Ok(SpanEnd::End) => {
                        // To the bit, where a start and a length of time would round.
                        self.time = span.to;
                        match flip.take() {
                            Some((change, time)) => {
                                self.change(&change, task, load);
                                if detector.note(&change, time, &self.phase) {
                                    self.crossings = detector.crossings;
                                    return Ok(End::Event);
                                }
                                from = time;
                            }
                            None => break,
                        }
                    }
                    Ok(SpanEnd::Flip { change, time }) => {
                        from = self.time;
                        if from == time {
                            // Here and now. A law that changes back each time holds the body where it changes.
                            self.change(&change, task, load);
                            if detector.note(&change, time, &self.phase) {
                                self.crossings = detector.crossings;
                                return Ok(End::Event);
                            }
                            flips_at_once += 1;
                            // Several wheels may stop and slip at once.
                            let most = HELD as usize * (1 + load.bearings().len());
                            if flips_at_once > most {
                                let step = 0.0;
                                return Err(Error::Motion(MotionFault::StepTooSmall {
                                    time,
                                    step,
                                })
                                .into());
                            }
                        } else {
                            flip = Some((change, time));
                            flips_at_once = 0;
                        }
                    }
                    Ok(SpanEnd::Over(end)) => {
                        self.crossings = detector.crossings;
                        return Ok(end);
                    }
                    Err(error) => {
                        self.crossings = detector.crossings;
                        return Err(error);
                    }
                }
            }
        }
        self.crossings = detector.crossings;
        Ok(End::Complete)
    }

    /// At the start of a span the states of the load jump, and the span may be cut, with the rest of it among the `ends` to come: its end
    /// then, and whether the run is to end here, since a thruster is switched.
    fn begin_span<L: Load<Error = E>>(
        &mut self,
        load: &mut L,
        detector: &mut EventDetector<'_, E>,
        [from, mut to]: [f64; 2],
        ends: &mut Vec<f64>,
    ) -> Result<(f64, bool), E>
    where
        E: From<Error>,
    {
        let fired = load.firing(from, true, &self.phase);
        load.enter(from, to)?;
        load.jump(from, &mut self.phase)?;
        if let Some(&cut) = load.cuts(from, to, &self.phase).first() {
            ends.push(to);
            to = cut;
            load.enter(from, to)?;
        }
        load.settle(from, &self.phase);
        let mut is_last = false;
        let fires = load.firing(from, false, &self.phase);
        for ((_, before), (state, after)) in fired.into_iter().zip(fires) {
            if before != after {
                is_last |= detector.note_pulse(state, after, from, &self.phase);
            }
        }
        Ok((to, is_last))
    }

    /// Takes the law of the load beyond a switch. The stopping time of a wheel is known only to rounding, so a small relative rate is left:
    /// set it to zero and keep the total angular momentum.
    fn change<L: Load<Error = E>>(&mut self, change: &LawSwitch, task: &Task<'_>, load: &mut L) {
        load.switch_law(change);
        if let Some(resting) = Stiction::of(&task.euler, load.bearings()) {
            resting.stop(&mut self.phase);
        }
    }

    /// Has come to this time and state, if that is one.
    fn reach(&mut self, time: f64, phase: Phase) -> Result<(), Error> {
        if !phase.is_finite() {
            return Err(Error::Motion(MotionFault::NotFiniteMotion { time }));
        }
        (self.time, self.phase) = (time, phase);
        Ok(())
    }

    /// Steps to the end of a span, or to where the law of the load changes if that `may_flip`, or where the run ends.
    fn span(
        &mut self,
        task: &Task<'_>,
        span: &Span,
        stepper: &mut dyn Stepper<Error = E>,
        may_flip: bool,
        detector: &mut EventDetector<'_, E>,
        watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<SpanEnd<E>, E>
    where
        E: From<Error>,
    {
        let (from, length) = (span.from, span.to - span.from);
        let changes = if may_flip {
            stepper.law_switches()
        } else {
            Vec::new()
        };
        // Looks for events within a step of many turns count as steps.
        let mut within_steps = 0;
        loop {
            let before = stepper.elapsed();
            if before == length {
                return Ok(SpanEnd::End);
            }
            stepper.advance()?;
            let flip = law_switches::find_first(&changes, stepper, from, before, &self.phase)?;
            if let Some((change, place)) = flip {
                // The step is made again, to end there.
                let time = from + place;
                return Ok(SpanEnd::Flip { change, time });
            }
            let reached = stepper.elapsed();
            let steps = self.effort.steps + stepper.effort().steps;
            let found = detector.search_step(stepper, from, [before, reached], |step, part| {
                let PartOfStep {
                    end,
                    is_last,
                    event,
                } = part;
                let has_ended = event.is_some();
                let (last, phase) = match event {
                    Some(event) => event,
                    None if end == reached => (end, step.phase()),
                    None => (end, step.within(end)?),
                };
                while let Some(&time) = task.times.get(self.samples.len())
                    && (time - from).abs() <= last.abs()
                {
                    let sample = if time - from == last {
                        phase.clone()
                    } else {
                        step.within(time - from)?
                    };
                    self.reach(time, sample.clone())?;
                    self.samples.push(sample);
                }
                self.reach(from + last, phase)?;
                if has_ended {
                    return Ok(ControlFlow::Break(End::Event));
                }
                if watch(end).is_break() {
                    return Ok(ControlFlow::Break(End::Stopped));
                }
                within_steps += u64::from(!is_last);
                let (start, last) = (task.times[0], task.times[task.times.len() - 1]);
                check_steps(
                    task.tolerance.most_steps,
                    steps + within_steps,
                    start,
                    self.time - start,
                    last - start,
                )?;
                Ok(ControlFlow::Continue(()))
            })?;
            if let ControlFlow::Break(end) = found {
                return Ok(SpanEnd::Over(end));
            }
        }
    }
}

/// What a span came to.
enum SpanEnd<E> {
    /// Its end.
    End,
    /// A step within which the law of the load changes: by what, and when.
    Flip { change: LawSwitch, time: f64 },
    /// The end of the run.
    Over(End<E>),
}

/// A method of steps at the start of `span`.
///
/// A stepper more is an arm more here, and its row in [`Method`].
pub(super) fn begin_stepper<'a, L: Load>(
    method: Method,
    task: &Task<'_>,
    span: &Span,
    load: &'a mut L,
) -> Result<Box<dyn Stepper<Error = L::Error> + 'a>, L::Error>
where
    L::Error: 'a,
{
    let moves = !task.body_at_point.pivoted && load.exerts_force();
    let states = span.phase.internal_state.len();
    if states > 0 {
        return match method {
            Method::Radau | Method::Dop853 | Method::Auto | Method::Taylor
                if states > MANY - MOVING =>
            {
                Err(Error::Motion(MotionFault::MethodCannotServe {
                    method: method.name(),
                    needs: "a load with 51 states of its own at most",
                    instead: "taylor",
                })
                .into())
            }
            Method::Exact | Method::Splitting => {
                Err(Error::Motion(MotionFault::MethodCannotServe {
                    method: method.name(),
                    needs: "a load without states of its own",
                    instead: "dop853",
                })
                .into())
            }
            Method::Radau if states <= FEW - MOVING => {
                begin_runge_kutta::<L, Radau<FEW>, FEW>(task, span, load)
            }
            Method::Radau if states <= SOME - MOVING => {
                begin_runge_kutta::<L, Radau<SOME>, SOME>(task, span, load)
            }
            Method::Radau => begin_runge_kutta::<L, Radau<MANY>, MANY>(task, span, load),
            _ if states <= FEW - MOVING => {
                begin_runge_kutta::<L, Dop853<FEW>, FEW>(task, span, load)
            }
            _ if states <= SOME - MOVING => {
                begin_runge_kutta::<L, Dop853<SOME>, SOME>(task, span, load)
            }
            _ => begin_runge_kutta::<L, Dop853<MANY>, MANY>(task, span, load),
        };
    }
    match method {
        Method::Exact => Ok(Box::new(ClosedFormRun::<L::Error>::new(
            task,
            span,
            load.analytic(),
        )?)),
        Method::Radau if moves => begin_runge_kutta::<L, Radau<MOVING>, MOVING>(task, span, load),
        Method::Radau => begin_runge_kutta::<L, Radau<TURNING>, TURNING>(task, span, load),
        Method::Splitting => Ok(Box::new(SplittingRun::new(task, span, load)?)),
        // Auto was settled, and a series has a driver of its own.
        Method::Auto | Method::Taylor | Method::Dop853 if moves => {
            begin_runge_kutta::<L, Dop853<MOVING>, MOVING>(task, span, load)
        }
        Method::Auto | Method::Taylor | Method::Dop853 => {
            begin_runge_kutta::<L, Dop853<TURNING>, TURNING>(task, span, load)
        }
    }
}

/// Not inlined: a run of few numbers is not to take the stack that many take.
#[inline(never)]
fn begin_runge_kutta<'a, L: Load, M: RungeKutta<N> + 'a, const N: usize>(
    task: &Task<'_>,
    span: &Span,
    load: &'a mut L,
) -> Result<Box<dyn Stepper<Error = L::Error> + 'a>, L::Error>
where
    L::Error: 'a,
{
    Ok(Box::new(RungeKuttaRun::<L, M, N>::new(task, span, load)?))
}
