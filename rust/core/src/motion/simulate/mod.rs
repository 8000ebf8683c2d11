//! The motion of a body under a load, sampled at the times asked for.
//!
//! `method` tells which method serves a run. Those of steps cut it into spans in which the load is smooth: `stepper` is
//! what a run needs of them, `equations` what they see of the mechanics, [`events`] what is looked for on the way.

mod equations;
pub mod events;
mod exact;
mod implicit;
mod kicked;
pub mod method;
mod stepper;
mod summed;

use std::ops::ControlFlow;

use self::events::Lookout;
pub use self::events::{Crossing, Direction, Events, NoEvents, Rule};
pub use self::method::{Method, closed_top};
use self::stepper::{Carry, Span, Stepper};
use super::euler_equations::EulerEquations;
use super::integrate::taylor;
use super::loads::{Load, Subject};
pub use super::state::{Phase, State};
use crate::error::{Error, all_finite, finite};
use crate::mass::RigidBody;

/// The tightest relative tolerance that float64 can serve.
pub const TIGHTEST: f64 = 10.0 * f64::EPSILON;
/// The tightest relative tolerance that numbers of twice the precision can serve.
pub const TIGHTEST_TWOFOLD: f64 = 1e-28;

/// How accurate each step is to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Of the attitude in radians (half), and of ω, position and velocity relative to the largest so far.
    pub relative: f64,
    /// Of ω, added to the relative one.
    pub absolute: f64,
}

impl Tolerance {
    /// Checked tolerances.
    ///
    /// # Errors
    /// When `relative` is not within [`TIGHTEST_TWOFOLD`]..0.1 or `absolute` is negative.
    pub fn new(relative: f64, absolute: f64) -> Result<Self, Error> {
        finite("rtol", relative)?;
        finite("atol", absolute)?;
        if !(TIGHTEST_TWOFOLD..=0.1).contains(&relative) {
            let law = "between 1e-28 and 0.1; below 2.3e-15 (ten units of rounding) method=\"taylor\" alone serves it";
            return Err(Error::OutOfDomain {
                what: "rtol",
                law,
                value: relative,
            });
        }
        if absolute < 0.0 {
            return Err(Error::OutOfDomain {
                what: "atol",
                law: "zero or more",
                value: absolute,
            });
        }
        Ok(Self { relative, absolute })
    }

    /// Whether it is tighter than doubles can serve.
    #[must_use]
    pub fn is_beyond_doubles(&self) -> bool {
        self.relative < TIGHTEST
    }
}

/// A body and the point its motion refers to: what all motions of the body have in common.
#[derive(Clone, Copy, Debug)]
pub struct Footing {
    /// The body and its reference point, as a load sees them.
    pub subject: Subject,
    /// Euler's equations about the reference point.
    pub euler: EulerEquations,
}

impl Footing {
    /// `body` free, its centre of mass the reference point, from the time `start` on.
    #[must_use]
    pub fn free(body: &RigidBody, start: f64) -> Self {
        Self::of(body, Subject::free(body, start))
    }

    /// `body` with the origin of its frame fixed in N, from the time `start` on.
    #[must_use]
    pub fn pivoted(body: &RigidBody, start: f64) -> Self {
        Self::of(body, Subject::pivoted(body, start))
    }

    fn of(body: &RigidBody, subject: Subject) -> Self {
        Self {
            subject,
            euler: EulerEquations::refined_about(body, &subject.point),
        }
    }
}

/// What is to be simulated: a body from a state through times, and how.
#[derive(Clone, Copy, Debug)]
pub struct Task<'a> {
    /// The body.
    pub body: &'a RigidBody,
    /// The body and its reference point, as a load sees them.
    pub subject: Subject,
    /// Euler's equations about the reference point.
    pub euler: EulerEquations,
    /// The state at the first time.
    pub initial: Phase,
    /// When the state is asked for, the start first; see [`check_times`].
    pub times: &'a [f64],
    /// How.
    pub method: Method,
    /// How accurately.
    pub tolerance: Tolerance,
}

impl<'a> Task<'a> {
    /// `body` free, its centre of mass the reference point.
    #[must_use]
    pub fn free(
        body: &'a RigidBody,
        initial: Phase,
        times: &'a [f64],
        method: Method,
        tolerance: Tolerance,
    ) -> Self {
        let start = times.first().copied().unwrap_or_default();
        let footing = Footing::free(body, start);
        Self::on(&footing, body, initial, times, method, tolerance)
    }

    /// `body` with the origin of its frame fixed in N.
    #[must_use]
    pub fn pivoted(
        body: &'a RigidBody,
        initial: Phase,
        times: &'a [f64],
        method: Method,
        tolerance: Tolerance,
    ) -> Self {
        let start = times.first().copied().unwrap_or_default();
        let footing = Footing::pivoted(body, start);
        Self::on(&footing, body, initial, times, method, tolerance)
    }

    /// `body` on a footing of its own, which starts at the first time.
    #[must_use]
    pub fn on(
        footing: &Footing,
        body: &'a RigidBody,
        initial: Phase,
        times: &'a [f64],
        method: Method,
        tolerance: Tolerance,
    ) -> Self {
        Self {
            body,
            subject: footing.subject,
            euler: footing.euler,
            initial,
            times,
            method,
            tolerance,
        }
    }
}

/// What an integration took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Accepted steps.
    pub steps: u64,
    /// Evaluations of the equations of motion.
    pub evaluations: u64,
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub enum End<E> {
    /// At the last time.
    Complete,
    /// At an event that ends it.
    Event,
    /// Where the watch asked for it.
    Stopped,
    /// Where the equations or the load failed.
    Failed(E),
}

/// What a run gave.
#[derive(Clone, Debug, PartialEq)]
pub struct Run<E> {
    /// The states at the times; not numbers after the end.
    pub samples: Vec<Phase>,
    /// The passages through zero, in the order of the run.
    pub crossings: Vec<Crossing>,
    /// What it took.
    pub effort: Effort,
    /// The time it came to.
    pub time: f64,
    /// The state then.
    pub phase: Phase,
    /// How it ended.
    pub end: End<E>,
}

/// Checks the output times of a simulation.
///
/// # Errors
/// When there is none, one is not finite, or they do not run strictly in one direction.
pub fn check_times(times: &[f64]) -> Result<(), Error> {
    let (Some(&first), Some(&last)) = (times.first(), times.last()) else {
        return Err(Error::Empty { what: "t" });
    };
    all_finite("t", times)?;
    finite("the span of t", last - first)?;
    for (k, pair) in times.windows(2).enumerate() {
        let forward = if last > first {
            pair[1] > pair[0]
        } else {
            pair[1] < pair[0]
        };
        if !forward {
            return Err(Error::NotMonotone {
                index: k + 1,
                previous: pair[0],
                next: pair[1],
            });
        }
    }
    Ok(())
}

/// The motion of `task` under `load`: `q̇ = ½ q∘ω`, `I_P ω̇ + ω×I_P ω = N_P`, and for a free body `m v̇ = F`.
///
/// Steps end where the load is not smooth; samples and events between the ends of steps come from the dense output. `watch`
/// is called with the fraction done after each step and may stop the run.
///
/// # Panics
/// When there are no times; see [`check_times`].
pub fn simulate<L: Load>(
    task: &Task<'_>,
    load: &mut L,
    events: &mut dyn Events<Error = L::Error>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Run<L::Error> {
    let mut run = Run::at_start(task, End::Complete);
    let (terms, has_events) = (load.analytic(), !events.rules().is_empty());
    let is_top = || closed_top(task.body).is_ok();
    let method = (task.method).serving(task.subject.pivoted, terms, &task.tolerance, is_top);
    run.end = match (method, terms) {
        (Err(error), _) => End::Failed(error.into()),
        (Ok(Method::Exact), Some(terms)) if !has_events => {
            exact::solve(task, terms, &mut run, watch).unwrap_or_else(End::Failed)
        }
        (Ok(Method::Taylor), Some(terms)) if has_events => {
            return summed::solve(task, terms, events, watch);
        }
        (Ok(Method::Taylor), Some(terms)) => {
            return taylor::solve_one(task, terms, watch).with_error(L::Error::from);
        }
        (Ok(method), _) => run
            .through(method, task, load, events, watch)
            .unwrap_or_else(End::Failed),
    };
    run
}

impl<E> Run<E> {
    /// One that has come no further than the first time.
    pub(crate) fn at_start(task: &Task<'_>, end: End<E>) -> Self {
        let mut samples = vec![Phase::nan(); task.times.len()];
        samples[0] = task.initial;
        Self {
            samples,
            crossings: Vec::new(),
            effort: Effort::default(),
            time: task.times[0],
            phase: task.initial,
            end,
        }
    }

    /// The same run, its error through `f`.
    #[must_use]
    pub fn with_error<F>(self, f: impl FnOnce(E) -> F) -> Run<F> {
        Run {
            samples: self.samples,
            crossings: self.crossings,
            effort: self.effort,
            time: self.time,
            phase: self.phase,
            end: match self.end {
                End::Complete => End::Complete,
                End::Event => End::Event,
                End::Stopped => End::Stopped,
                End::Failed(error) => End::Failed(f(error)),
            },
        }
    }

    fn through<L: Load<Error = E>>(
        &mut self,
        method: Method,
        task: &Task<'_>,
        load: &mut L,
        events: &mut dyn Events<Error = E>,
        watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<End<E>, E> {
        let bounds = spans(task.times, load.breaks());
        for pair in bounds.windows(2) {
            load.enter(pair[0], pair[1])?; // refused before anything is computed
        }
        let (start, end) = (task.times[0], bounds[bounds.len() - 1]);
        let mut lookout = Lookout::new(events, start, &task.initial, end > start)?;
        let mut next = 1;
        let mut carry = Carry::default();
        for pair in bounds.windows(2) {
            let [from, to] = [pair[0], pair[1]];
            load.enter(from, to)?;
            let span = Span {
                from,
                to,
                phase: self.phase,
                carry,
            };
            let mut stepper = stepper::start(method, task, &span, load)?;
            let before = self.effort;
            let mut watch = |elapsed: f64| watch((from - start + elapsed) / (end - start));
            let ended = self.span(
                task,
                &span,
                &mut *stepper,
                &mut next,
                &mut lookout,
                &mut watch,
            );
            let Effort { steps, evaluations } = stepper.effort();
            self.effort = Effort {
                steps: before.steps + steps,
                evaluations: before.evaluations + evaluations,
            };
            if let Some(end) = ended.transpose() {
                self.crossings = lookout.crossings;
                return end;
            }
            carry = stepper.carry();
        }
        self.crossings = lookout.crossings;
        Ok(End::Complete)
    }

    /// Steps to the end of a span; how the run ended if it did.
    fn span(
        &mut self,
        task: &Task<'_>,
        span: &Span,
        stepper: &mut dyn Stepper<Error = E>,
        next: &mut usize,
        lookout: &mut Lookout<'_, E>,
        watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Option<End<E>>, E> {
        let (from, length) = (span.from, span.to - span.from);
        loop {
            let before = stepper.elapsed();
            if before == length {
                return Ok(None);
            }
            stepper.advance()?;
            let reached = stepper.elapsed();
            let ended = lookout.look(stepper, from, before)?;
            let (last, phase) = ended.unwrap_or((reached, stepper.phase()));
            while let Some(elapsed) = task.times.get(*next).map(|t| t - from)
                && elapsed.abs() <= last.abs()
            {
                self.samples[*next] = if elapsed == last {
                    phase
                } else {
                    stepper.within(elapsed)?
                };
                *next += 1;
            }
            (self.time, self.phase) = (from + last, phase);
            if ended.is_some() {
                return Ok(Some(End::Event));
            }
            if watch(reached).is_break() {
                return Ok(Some(End::Stopped));
            }
        }
    }
}

/// The ends of the spans into which `breaks` cut the time from the first to the last of `times`.
pub(in crate::motion) fn spans(times: &[f64], mut breaks: Vec<f64>) -> Vec<f64> {
    let (start, end) = (times[0], times[times.len() - 1]);
    if start == end {
        return vec![start];
    }
    breaks.retain(|t| (t - start) * (t - end) < 0.0);
    breaks.extend([start, end]);
    breaks.sort_by(f64::total_cmp);
    breaks.dedup();
    if end < start {
        breaks.reverse();
    }
    breaks
}
#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::loads::{Analytic, Frame, Term};
    use nalgebra::{Matrix3, UnitQuaternion, Vector3};

    fn watch(_: f64) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn run(
        moments: [f64; 3],
        omega: Vector3<f64>,
        times: &[f64],
        load: &[Term],
        rtol: f64,
    ) -> Vec<Phase> {
        let body =
            RigidBody::from_principal(1.0, &moments, &Matrix3::identity(), &Vector3::zeros(), 0.0);
        let initial = Phase::in_place(&State {
            attitude: UnitQuaternion::identity(),
            omega,
        });
        let tolerance = Tolerance::new(rtol, 0.0).expect("tolerance");
        let body = body.expect("body");
        let task = Task::free(&body, initial, times, Method::Dop853, tolerance);
        let mut load = Analytic::new(load, task.subject);
        let run = simulate(&task, &mut load, &mut NoEvents::new(), &mut watch);
        assert_eq!(run.end, End::Complete);
        run.samples
    }

    #[test]
    fn nasa_check_case_2() {
        // NASA/TM-2015-218675, case 2: slug ft² and deg/s; the exact rates at 30 s by a series in 25 digits.
        let moments = [0.001_894_220, 0.006_211_019, 0.007_194_665];
        let exact = Vector3::new(
            12.618_390_775_914_22,
            -17.397_474_761_611_39,
            31.119_588_886_944_34,
        );
        for (rtol, allowed) in [(1e-13, 1e-11), (1e-10, 1e-8)] {
            let omega = Vector3::new(10.0, 20.0, 30.0).map(f64::to_radians);
            let end = run(moments, omega, &[0.0, 30.0], &[], rtol)[1]
                .omega
                .map(f64::to_degrees);
            assert!((end - exact).norm() < allowed, "{:e}", (end - exact).norm());
        }
    }

    #[test]
    fn symmetric_top_precesses_as_the_closed_form_says() {
        // I₁ = I₂ = I_t: ω_t turns with Ω = (I_s − I_t) ω_s / I_t in the body.
        let times: Vec<f64> = (0..=100).map(|k| 0.37 * f64::from(k)).collect();
        let (w_t, w_s) = (0.5, 2.0);
        for (t, state) in times.iter().zip(run(
            [1.0, 1.0, 1.6],
            Vector3::new(w_t, 0.0, w_s),
            &times,
            &[],
            1e-13,
        )) {
            let angle = 0.6 * w_s * t;
            let exact = Vector3::new(w_t * angle.cos(), w_t * angle.sin(), w_s);
            assert!(
                (state.omega - exact).norm() < 1e-11,
                "{t} {:e}",
                (state.omega - exact).norm()
            );
        }
    }

    #[test]
    fn constant_space_torque_about_a_principal_axis_spins_up() {
        let load =
            [Term::constant_torque(&Vector3::new(0.0, 0.0, 3.0), Frame::Space).expect("finite")];
        let end = run([1.0, 2.0, 2.5], Vector3::zeros(), &[0.0, 4.0], &load, 1e-12)[1];
        assert!((end.omega - Vector3::new(0.0, 0.0, 4.8)).norm() < 1e-11);
        assert!(
            end.attitude
                .angle_to(&UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 9.6))
                < 1e-10
        );
    }

    #[test]
    fn times_must_run_one_way() {
        assert!(check_times(&[0.0, 1.0, 0.5]).is_err() && check_times(&[]).is_err());
        assert!(check_times(&[2.0]).is_ok() && check_times(&[0.0, -1.0, -2.0]).is_ok());
    }
}
