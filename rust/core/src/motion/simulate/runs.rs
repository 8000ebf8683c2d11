//! One motion; and many, each a member of a batch: by the method that serves them all, on as many cores as may take part.

use std::ops::ControlFlow;
use std::slice;

use nalgebra::Vector3;

use super::events::Events;
use super::plan::{Ask, Plan};
use super::{closed_form_run, rolling_run, taylor_run_with_events};
use crate::error::{Error, MotionFault};
use crate::motion::integrate::taylor;
use crate::motion::loads::{BodyAtPoint, Load, Term};
use crate::motion::problem::{End, Method, Run, Task};
use crate::motion::rolling::{Contact, Law, LiftOff};
use crate::motion::state::Phase;
use crate::numerics::threads::fill_blocks;

/// The motion of `task` under `load`: `q̇ = ½ q∘ω`, `I_P ω̇ + ω×I_P ω = N_P`, and for a free body `m v̇ = F`.
///
/// Steps end where the load is not smooth; samples and events between the ends of steps come from the dense output. `watch`
/// is called with the fraction done after each step and may stop the run.
///
/// What is wrong with the times, the state at the start or the method ends the run before its first step: see [`Run::end`], or
/// [`Run::into_result`] for who wants all states or none.
pub fn simulate<L: Load>(
    task: &Task<'_>,
    load: &mut L,
    events: &mut dyn Events<Error = L::Error>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Run<L::Error> {
    if let Err(error) = task.check_start() {
        return Run::at_start(task, End::Failed(error.into()));
    }
    let plan = Plan::new(
        slice::from_ref(task.body),
        task.body_at_point.pivoted,
        task.times,
        task.method,
        task.tolerance,
        load.analytic(),
        &|_| ControlFlow::Continue(()),
    );
    match plan {
        Ok(plan) => {
            let task = Task {
                method: plan.method(),
                ..task.clone()
            };
            by_method(&task, load, events, watch)
        }
        Err(refusal) => Run::at_start(task, End::Failed(refusal.error.into())),
    }
}

/// Compute the motion of a body that rolls or slips on a plane under uniform gravity g, by Taylor series.
///
/// The start of `task` must touch the plane, as [`Contact::start`] makes it. Where the plane can do work, that work since the start is
/// the internal state of the samples. Events and `watch` as in [`simulate`].
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::rolling::{Contact, LiftOff, Surface};
/// use polhode::motion::simulate::{ContactExtremes, End, Method, NoEvents, Run, Task, Tolerance, roll};
/// use polhode::nalgebra::{UnitQuaternion, Vector3};
///
/// let ball = solids::sphere(0.5, Amount::Mass(2.0))?;
/// let surface = Surface::sphere(0.5, Vector3::zeros())?;
/// let incline = Vector3::new(0.6, 0.0, 0.8);
/// let contact = Contact::rolling(surface, incline, Vector3::zeros(), 0.0, LiftOff::Stop)?;
/// let start = contact.start(&ball, Vector3::zeros(), UnitQuaternion::identity(), None, None)?;
/// let times = [0.0, 2.0];
/// let task = Task::free(&ball, start, &times, Method::Auto, Tolerance::new(1e-12, 0.0)?);
/// let go_on = &mut |_| ControlFlow::Continue(());
/// let gravity = Vector3::new(0.0, 0.0, -9.81);
/// let run: Run<polhode::Error> = roll(&task, &contact, &gravity, &mut NoEvents::new(), go_on);
/// assert_eq!(run.end, End::Complete);
/// // A ball rolls down with 5/7 g sin α.
/// assert!((run.phase.velocity.norm() - 5.0 / 7.0 * 9.81 * 0.6 * 2.0).abs() < 1e-11);
/// let extremes: ContactExtremes = run.contact.unwrap();
/// assert!((extremes.normal_force[0] - 2.0 * 9.81 * 0.8).abs() < 1e-12);
/// # Ok::<(), polhode::Error>(())
/// ```
pub fn roll<E: From<Error>>(
    task: &Task<'_>,
    contact: &Contact,
    gravity: &Vector3<f64>,
    events: &mut dyn Events<Error = E>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Run<E> {
    match task
        .check_start()
        .and_then(|()| check_rolling(task, contact))
    {
        Ok(()) => rolling_run::solve(task, contact, gravity, events, watch),
        Err(error) => Run::at_start(task, End::Failed(error.into())),
    }
}

/// Check that a task is one of rolling.
fn check_rolling(task: &Task<'_>, contact: &Contact) -> Result<(), Error> {
    let is_backward = task.times.last() < task.times.first();
    let needs = if task.body_at_point.pivoted {
        "a body on a plane has no fixed point: its centre of mass is free"
    } else if !matches!(task.method, Method::Auto | Method::Taylor) {
        "the method \"taylor\" (or \"auto\") rolls; the others do not solve the constraint"
    } else if task.tolerance.is_beyond_doubles() {
        "an rtol of 2.3e-15 or more (ten units of rounding): series of rolling are in doubles"
    } else if (contact.law != Law::Rolling || contact.lift == LiftOff::Fly)
        && task.body.inertia().try_inverse().is_none()
    {
        "a body with three moments to slip or fly: one without a moment about an axis only rolls"
    } else if matches!(contact.law, Law::Dry(_)) && is_backward {
        "times that rise under the law \"dry\": from a body that rolls it is not known when it has slipped before"
    } else {
        return Ok(());
    };
    Err(Error::Motion(MotionFault::ContactCannotServe { needs }))
}

/// The motion of `task` by its method, which is known to serve.
pub(super) fn by_method<L: Load>(
    task: &Task<'_>,
    load: &mut L,
    events: &mut dyn Events<Error = L::Error>,
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Run<L::Error> {
    let carried = load.carried();
    let has_equations =
        task.body_without_wheels.is_some() && !task.initial.internal_state.is_empty();
    let completed;
    let task = if carried.is_empty() || has_equations {
        task
    } else {
        match task.clone().with_carried(carried.into_iter()) {
            Ok(task) => {
                completed = task;
                &completed
            }
            Err(error) => return Run::at_start(task, End::Failed(error.into())),
        }
    };
    let has_events = !events.rules().is_empty();
    if let (Method::Taylor, Some(terms)) = (task.method, load.analytic()) {
        return if has_events {
            taylor_run_with_events::solve(task, terms, events, watch)
        } else {
            taylor::solve_one(task, terms, watch).with_error(L::Error::from)
        };
    }
    let mut run = Run::at_start(task, End::Complete);
    let end = match (task.method, load.analytic()) {
        (Method::Exact, Some(terms)) if !has_events => {
            closed_form_run::solve(task, terms, &mut run, watch)
        }
        (method, _) => run.through(method, task, load, events, watch),
    };
    run.end = end.unwrap_or_else(End::Failed);
    run
}

/// What is called as members run, besides the analytic terms of their loads: other loads, and events.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CallbackPolicy {
    /// Nothing.
    Nothing,
    /// What any thread may call.
    OnAnyThread,
    /// What the calling thread alone may call.
    OnThisThread,
}

/// The members of a stack of motions: where each begins, what acts on it and what is looked for.
pub trait Batch: Sync {
    /// As of the loads.
    type Error: From<Error> + Send;

    /// What is called as they run.
    fn callbacks(&self) -> CallbackPolicy;

    /// The number of the body of a member, and its state at the first time with the attitude as given: of unit length to rounding
    /// alone.
    fn start(&self, member: usize) -> (usize, Phase);

    /// The analytic terms of the load on a member; their kinds are the same for all members.
    fn terms(&self, member: usize) -> &[Term];

    /// Run a member: call [`Member::integrate`] with what acts on it and with what is looked for.
    fn run(&self, member: Member<'_>) -> Run<Self::Error>;

    /// Whether no further member is begun after one that failed like this.
    fn ends_all(&self, error: &Self::Error) -> bool;
}

/// A member of a batch that is about to be run.
pub struct Member<'r> {
    /// Its number in the stack.
    pub number: usize,
    task: &'r Task<'r>,
    watch: &'r mut dyn FnMut(f64) -> ControlFlow<()>,
}

impl Member<'_> {
    /// What its load acts on.
    #[must_use]
    pub fn body(&self) -> BodyAtPoint {
        self.task.body_at_point
    }

    /// Its motion under `load`.
    pub fn integrate<L: Load>(
        self,
        load: &mut L,
        events: &mut dyn Events<Error = L::Error>,
    ) -> Run<L::Error> {
        by_method(self.task, load, events, self.watch)
    }

    /// Compute its motion on a plane under uniform gravity: see [`roll`].
    pub fn roll<E: From<Error>>(
        self,
        contact: &Contact,
        gravity: &Vector3<f64>,
        events: &mut dyn Events<Error = E>,
    ) -> Run<E> {
        roll(self.task, contact, gravity, events, self.watch)
    }
}

/// The motions of the members of `batch` as `plan` says, into `runs`; every one has the bits of its [`simulate`](super::simulate), in lanes of a
/// machine without fused multiply-add to rounding.
///
/// Members that call on this thread go one after the other, all others to all cores, and Taylor series that call nothing side by side
/// in the lanes of each core. `watch` gets the fraction done, but from within members on several cores none, and may stop all.
/// Then, and where a member [ends all](Batch::ends_all), no further member is begun, and those begun are kept. Lanes do not ask whether
/// a member ends all.
pub fn simulate_many<R: Batch>(
    plan: &Plan<'_>,
    batch: &R,
    runs: &mut [Option<Run<R::Error>>],
    watch: &Ask<'_>,
) {
    let (count, callbacks) = (runs.len(), batch.callbacks());
    let common = plan.common();
    let task = |member| {
        let (body, initial) = batch.start(member);
        plan.task(common.as_ref(), body, initial)
    };
    let fill = |member, slot: &mut Option<Run<R::Error>>, fraction: &dyn Fn(f64) -> Option<f64>| {
        let run = slot.insert(batch.run(Member {
            number: member,
            task: &task(member),
            watch: &mut |part| watch(fraction(part)),
        }));
        let is_over = match &run.end {
            End::Stopped => true,
            End::Failed(error) => batch.ends_all(error),
            End::Complete | End::Event | End::Contact(_) => false,
        };
        if is_over { Err(()) } else { Ok(()) }
    };
    if count == 1 || callbacks == CallbackPolicy::OnThisThread {
        for (member, slot) in runs.iter_mut().enumerate() {
            let fraction = |part| Some((member as f64 + part) / count as f64);
            if fill(member, slot, &fraction).is_err() {
                break;
            }
        }
    } else if callbacks == CallbackPolicy::Nothing && plan.method() == Method::Taylor {
        taylor::solve_many(&task, &|member| batch.terms(member), runs, &|begun| {
            watch(Some(begun))
        });
    } else {
        let look = &mut |done| watch(Some(done));
        // Where a member ends all, those begun are kept.
        let _ended = fill_blocks(runs, 1, look, |member, slot| {
            fill(member, &mut slot[0], &|_| None)
        });
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use nalgebra::{Matrix3, UnitQuaternion, Vector3};

    use super::*;
    use crate::mass::RigidBody;
    use crate::motion::loads::{Analytic, Frame, Term, Wrench};
    use crate::motion::problem::Tolerance;
    use crate::motion::simulate::{NoEvents, simulate};
    use crate::motion::state::{Phase, State};
    use crate::numerics::dispatch::{Level, level};

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
        let mut load = Analytic::new(load, task.body_at_point);
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
        let end = &run([1.0, 2.0, 2.5], Vector3::zeros(), &[0.0, 4.0], &load, 1e-12)[1];
        assert!((end.omega - Vector3::new(0.0, 0.0, 4.8)).norm() < 1e-11);
        assert!(
            end.attitude
                .angle_to(&UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 9.6))
                < 1e-10
        );
    }

    /// Every row another motion of one of two bodies, under terms and what may fail.
    struct Stack {
        calls: CallbackPolicy,
        terms: Vec<Term>,
        /// The row that fails, and whether it ends all.
        fails: Option<(usize, bool)>,
    }

    impl Batch for Stack {
        type Error = Error;

        fn callbacks(&self) -> CallbackPolicy {
            self.calls
        }

        fn start(&self, row: usize) -> (usize, Phase) {
            let number = row as f64;
            let mut phase = Phase::nan();
            phase.attitude = UnitQuaternion::from_euler_angles(0.3, -0.4, number);
            phase.omega = Vector3::new(0.7, -0.9, 1.1) * (0.3 + 0.1 * number);
            (phase.position, phase.velocity) = (Vector3::zeros(), Vector3::x() * number);
            (row % 2, phase)
        }

        fn terms(&self, _: usize) -> &[Term] {
            &self.terms
        }

        fn run(&self, row: Member<'_>) -> Run<Error> {
            if self.fails.is_some_and(|(number, _)| number == row.number) {
                return row.integrate(&mut Failing, &mut NoEvents::new());
            }
            let mut load = Analytic::new(&self.terms, row.body());
            row.integrate(&mut load, &mut NoEvents::new())
        }

        fn ends_all(&self, _: &Error) -> bool {
            self.fails.is_some_and(|(_, ends_all)| ends_all)
        }
    }

    /// A load that fails wherever it is asked.
    struct Failing;

    impl Load for Failing {
        type Error = Error;

        fn exerts_force(&self) -> bool {
            false
        }

        fn depends_on_rates(&self) -> bool {
            true
        }

        fn breaks(&self, _: f64, _: f64) -> Vec<f64> {
            Vec::new()
        }

        fn enter(&mut self, _: f64, _: f64) -> Result<(), Error> {
            Ok(())
        }

        fn wrench(&mut self, _: f64, _: &Phase) -> Result<Wrench, Error> {
            Err(Error::Empty { what: "load" })
        }
    }

    const TIMES: [f64; 3] = [0.0, 1.0, 4.5];

    fn bodies() -> [RigidBody; 2] {
        [[1.0, 2.0, 2.5], [2.0, 2.0, 1.2]].map(|moments| {
            let centre = Vector3::new(0.1, -0.2, 0.3);
            RigidBody::from_principal(1.0, &moments, &Matrix3::identity(), &centre, 0.0)
                .expect("a body")
        })
    }

    fn weight_and_twist() -> Vec<Term> {
        let twist = Term::constant_torque(&Vector3::new(0.2, 0.1, -0.3), Frame::Space);
        let weight = Term::uniform_gravity(&Vector3::new(0.0, 0.0, -9.8));
        vec![weight.expect("finite"), twist.expect("finite")]
    }

    fn plan<'a>(
        bodies: &'a [RigidBody],
        times: &'a [f64],
        method: Method,
        terms: &[Term],
    ) -> Plan<'a> {
        let tolerance = Tolerance::new(1e-9, 0.0).expect("a tolerance");
        let go_on = |_| ControlFlow::Continue(());
        Plan::new(bodies, false, times, method, tolerance, Some(terms), &go_on).expect("a plan")
    }

    /// The runs of `count` rows, and the fractions that were told; stopped once more than `enough` is done, where no
    /// fraction is told all of it.
    fn go(
        plan: &Plan<'_>,
        rows: &Stack,
        count: usize,
        enough: f64,
    ) -> (Vec<Option<Run<Error>>>, Vec<f64>) {
        let (mut runs, told) = (vec![None; count], Mutex::new(Vec::new()));
        simulate_many(plan, rows, &mut runs, &|done| {
            told.lock().expect("no panic").extend(done);
            if done.unwrap_or(1.0) > enough {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        (runs, told.into_inner().expect("no panic"))
    }

    fn never(calls: CallbackPolicy, terms: Vec<Term>) -> Stack {
        let fails = None;
        Stack {
            calls,
            terms,
            fails,
        }
    }

    #[test]
    fn rows_have_the_same_bits_in_lanes_on_all_cores_in_turn_and_alone() {
        let (bodies, all) = (bodies(), 21);
        for (method, terms) in [
            (Method::Taylor, weight_and_twist()),
            (Method::Dop853, weight_and_twist()),
            (Method::Auto, Vec::new()),
        ] {
            let plan = plan(&bodies, &TIMES, method, &terms);
            for calls in [
                CallbackPolicy::Nothing,
                CallbackPolicy::OnAnyThread,
                CallbackPolicy::OnThisThread,
            ] {
                let stack = never(calls, terms.clone());
                for count in [0, 1, 2, all] {
                    let (runs, _) = go(&plan, &stack, count, 1.0);
                    for (row, run) in runs.iter().enumerate() {
                        let run = run.as_ref().expect("begun");
                        let (body, phase) = stack.start(row);
                        let mut task = plan.task(None, body, phase);
                        task.method = method;
                        let mut load = Analytic::new(&terms, task.body_at_point);
                        let watch = &mut |_| ControlFlow::Continue(());
                        let alone = simulate(&task, &mut load, &mut NoEvents::new(), watch);
                        assert_eq!(run.end, End::Complete);
                        if calls == CallbackPolicy::Nothing && level() == Level::Baseline {
                            let error = (run.phase.omega - alone.phase.omega).norm();
                            assert!(error < 1e-12, "{method:?} {row}: {error:e}");
                        } else {
                            assert_eq!(*run, alone, "{method:?} {calls:?} {row}");
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn what_was_done_is_kept_where_all_is_stopped() {
        let (bodies, terms) = (bodies(), weight_and_twist());
        let by_steps = plan(&bodies, &TIMES, Method::Dop853, &terms);
        let in_turn = never(CallbackPolicy::OnThisThread, terms.clone());
        let (runs, told) = go(&by_steps, &in_turn, 8, 0.45);
        assert!(told.is_sorted() && told.last().is_some_and(|done| *done > 0.45));
        for (row, run) in runs.iter().enumerate() {
            let end = run.as_ref().map(|run| &run.end);
            let complete = (row < 3).then_some(&End::Complete);
            let expected = if row == 3 {
                Some(&End::Stopped)
            } else {
                complete
            };
            assert_eq!(end, expected, "{row}");
        }
        // On several cores rows tell no fraction; lanes ask about every 64 steps.
        let apart = never(CallbackPolicy::OnAnyThread, terms.clone());
        let quick = never(CallbackPolicy::Nothing, terms[..1].to_vec());
        let lanes = plan(&bodies, &[0.0, 1e6], Method::Taylor, &quick.terms);
        for (plan, stack) in [(&by_steps, &apart), (&lanes, &quick)] {
            let (runs, _) = go(plan, stack, 300, -1.0);
            let ends: Vec<_> = runs.iter().flatten().map(|run| &run.end).collect();
            assert!(!ends.is_empty() && ends.iter().all(|end| **end == End::Stopped));
            assert!(runs.is_sorted_by_key(Option::is_none));
        }
    }

    #[test]
    fn the_first_that_fails_ends_all_where_it_is_to() {
        let (bodies, terms) = (bodies(), weight_and_twist());
        let plan = plan(&bodies, &TIMES, Method::Dop853, &terms);
        for calls in [CallbackPolicy::OnAnyThread, CallbackPolicy::OnThisThread] {
            for (failing, ends_all) in [(0, true), (3, true), (3, false), (7, true)] {
                let stack = Stack {
                    calls,
                    terms: terms.clone(),
                    fails: Some((failing, ends_all)),
                };
                let (runs, _) = go(&plan, &stack, 8, 1.0);
                for (row, run) in runs.iter().enumerate() {
                    let end = run.as_ref().map(|run| &run.end);
                    if row == failing {
                        let error = Error::Empty { what: "load" };
                        assert_eq!(end, Some(&End::Failed(error)));
                    } else if row < failing || !ends_all {
                        assert_eq!(end, Some(&End::Complete));
                    } else if calls == CallbackPolicy::OnThisThread {
                        assert_eq!(end, None);
                    }
                }
            }
        }
    }
}
