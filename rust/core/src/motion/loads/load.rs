//! The trait `Load`: what a run asks of whatever acts on the body, analytic or a function of the caller.

use super::body_at_point::BodyAtPoint;
use super::carried_momentum::CarriedMomentum;
use super::laws::Term;
use super::stiction::{Bearing, Stiction};
use super::switch::LawSwitch;
use super::wrench::Wrench;
use crate::error::Error;
use crate::motion::euler_equations::EulerEquations;
use crate::motion::state::Phase;

/// A load as a function of time and state, whoever computes it.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::loads::{Bearing, CarriedMomentum, LawSwitch, Load, Wrench};
/// use polhode::motion::simulate::{Method, NoEvents, Phase, State, Task, Tolerance, simulate};
/// use polhode::nalgebra::{UnitQuaternion, Vector3};
///
/// /// A brake that is on for the first second. A closure would do ([`Callback`](super::Callback)); what a trait adds are
/// /// internal states and laws that switch: [`CarriedMomentum`], [`LawSwitch`], [`Bearing`].
/// struct Brake {
///     is_on: bool,
/// }
///
/// impl Load for Brake {
///     type Error = polhode::Error;
///     fn exerts_force(&self) -> bool {
///         false
///     }
///     fn depends_on_rates(&self) -> bool {
///         true
///     }
///     fn breaks(&self, _: f64, _: f64) -> Vec<f64> {
///         vec![1.0]
///     }
///     fn enter(&mut self, from: f64, to: f64) -> Result<(), Self::Error> {
///         self.is_on = 0.5 * (from + to) < 1.0;
///         Ok(())
///     }
///     fn wrench(&mut self, _: f64, phase: &Phase) -> Result<Wrench, Self::Error> {
///         let torque = if self.is_on { -phase.omega } else { Vector3::zeros() };
///         Ok(Wrench::couple(torque))
///     }
/// }
///
/// let ball = solids::sphere(1.0, Amount::Mass(5.0))?; // I = 2
/// let state = State { attitude: UnitQuaternion::identity(), omega: Vector3::z() };
/// let tolerance = Tolerance::new(1e-12, 0.0)?;
/// let task = Task::free(&ball, Phase::in_place(&state), &[0.0, 3.0], Method::Auto, tolerance);
/// let mut brake = Brake { is_on: true };
/// let (carried, changes, bearings): (Vec<&dyn CarriedMomentum>, Vec<LawSwitch>, &[Bearing]) =
///     (brake.carried(), brake.law_switches(), brake.bearings());
/// assert!(carried.is_empty() && changes.is_empty() && bearings.is_empty());
/// let go_on = &mut |_| ControlFlow::Continue(());
/// let run = simulate(&task, &mut brake, &mut NoEvents::new(), go_on).into_result()?;
/// assert!((run.phase.omega.z - (-0.5_f64).exp()).abs() < 1e-12);
/// # Ok::<(), polhode::Error>(())
/// ```
pub trait Load {
    /// What may go wrong in it, besides what the equations of motion themselves may refuse.
    type Error: From<Error>;

    /// Its terms, when it is a sum of analytic terms and nothing else.
    fn analytic(&self) -> Option<&[Term]> {
        None
    }

    /// Whether it may push, so that a free body's position depends on it.
    fn exerts_force(&self) -> bool;

    /// Whether it may depend on ω or on the velocity: whether it can do else than exchange the energy of motion for that of
    /// position.
    fn depends_on_rates(&self) -> bool;

    /// The times in a run from one time to another at which it is not smooth, where a step must end; in any order, and others may be
    /// among them.
    fn breaks(&self, from: f64, to: f64) -> Vec<f64>;

    /// From now on it is asked for times within from..to alone, both ends included, between which there are no breaks.
    ///
    /// # Errors
    /// When it cannot act there.
    fn enter(&mut self, from: f64, to: f64) -> Result<(), Self::Error>;

    /// From now on its law is the one that it has at time `t` and `phase`, on both sides of where a sign in it changes, until it is told again: so that
    /// it is smooth over a step. Before it is told for the first time in a span, the law changes with the state.
    fn settle(&mut self, t: f64, phase: &Phase) {
        let _ = (t, phase);
    }

    /// What may change the law that it was settled for; nothing of a law without signs.
    fn law_switches(&self) -> Vec<LawSwitch> {
        Vec::new()
    }

    /// Takes the law beyond one of its [changes](Self::law_switches).
    fn switch_law(&mut self, change: &LawSwitch) {
        let _ = change;
    }

    /// The bearings with dry friction that it was settled for.
    fn bearings(&self) -> &[Bearing] {
        &[]
    }

    /// Of the wheel whose momentum is the state of that number, by how much more than its limit the motor is asked for, or of its coils
    /// with a limit the one that is asked for most; see [`CarriedMomentum::over_limit`].
    fn over_limit(&self, wheel: Option<usize>, t: f64, phase: &Phase) -> f64 {
        let _ = (wheel, t, phase);
        -1.0
    }

    /// The times within a span at which its law switches, where that is known no sooner than at the start of the span, after it has
    /// [jumped](Self::jump): the span is cut there. Ascending.
    fn cuts(&self, from: f64, to: f64, phase: &Phase) -> Vec<f64> {
        let _ = (from, to, phase);
        Vec::new()
    }

    /// Of each of its thrusters, by the number of the state that is its impulse, whether it fires just after the time `t`, or just before
    /// it, where `phase` has not [jumped](Self::jump) yet.
    fn firing(&self, t: f64, is_before: bool, phase: &Phase) -> Vec<(usize, bool)> {
        let _ = (t, is_before, phase);
        Vec::new()
    }

    /// From now on it acts on this body, which may change with time.
    fn set_body(&mut self, body: &BodyAtPoint) {
        let _ = body;
    }

    /// Force in N and torque in B about the reference point.
    ///
    /// # Errors
    /// Ends the integration and comes back to the caller as it is.
    fn wrench(&mut self, t: f64, phase: &Phase) -> Result<Wrench, Self::Error>;

    /// What it carries along in the body.
    fn carried(&self) -> Vec<&dyn CarriedMomentum> {
        Vec::new()
    }

    /// What counts as large of each of its internal states besides the largest it has been: a number times the largest |ω|, and a number.
    fn sizes(&self) -> Vec<[f64; 2]> {
        let carried = self.carried().into_iter();
        carried
            .flat_map(|it| vec![[it.size(), 0.0]; it.count()])
            .collect()
    }

    /// As [`Self::wrench`], with the rates of its internal states into `rates`.
    ///
    /// # Errors
    /// As [`Self::wrench`].
    fn act(&mut self, t: f64, phase: &Phase, rates: &mut [f64]) -> Result<Wrench, Self::Error> {
        let _ = rates;
        self.wrench(t, phase)
    }

    /// Its internal states jump to where a span without breaks begins, at time `t`: those of a controller that looks at
    /// the body now and then.
    ///
    /// # Errors
    /// As [`Self::wrench`].
    fn jump(&mut self, t: f64, phase: &mut Phase) -> Result<(), Self::Error> {
        let _ = (t, phase);
        Ok(())
    }
}

/// What a load exerts at a state outside a run, on a body with these equations (without the wheels that turn freely): the bearings at
/// rest hold as far as they can.
///
/// # Errors
/// As [`Load::wrench`].
pub fn wrench_at<L: Load>(
    load: &mut L,
    euler: &EulerEquations,
    t: f64,
    phase: &Phase,
) -> Result<Wrench, L::Error> {
    load.settle(t, phase);
    let mut bearings = load.bearings().to_vec();
    let mut motors = vec![0.0; phase.internal_state.len()];
    let mut wrench = load.act(t, phase, &mut motors)?;
    // One after the other slips, first the one that is furthest beyond its most.
    while let Some(resting) = Stiction::of(euler, &bearings) {
        let mut rates = motors.clone();
        let torque = resting.hold(&phase.omega, &wrench.torque, &mut rates);
        let held = |bearing: &Bearing| rates[bearing.index] - motors[bearing.index];
        let slips =
            |bearing: &Bearing| bearing.turns == 0.0 && bearing.until_slip(held(bearing)) < 0.0;
        let share = |bearing: &Bearing| held(bearing).abs() / bearing.most; // infinite of a limit
        let worst = (bearings.iter_mut())
            .filter(|bearing| slips(bearing))
            .max_by(|a, b| share(a).total_cmp(&share(b)));
        let Some(worst) = worst else {
            return Ok(Wrench { torque, ..wrench });
        };
        *worst = worst.in_slip(held(worst));
        wrench.torque -= worst.axis * worst.friction();
    }
    Ok(wrench)
}
