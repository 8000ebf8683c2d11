//! A load that is a closure of the caller.

use std::marker::PhantomData;

use nalgebra::Vector3;

use super::load::Load;
use super::wrench::Wrench;
use crate::error::Error;
use crate::motion::state::Phase;

/// A load that only the caller knows: a closure of time and state.
///
/// ```
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::loads::Callback;
/// use polhode::motion::simulate::{Method, NoEvents, Phase, State, Task, Tolerance, simulate};
/// use polhode::nalgebra::{UnitQuaternion, Vector3};
/// use std::ops::ControlFlow;
///
/// let ball = solids::sphere(1.0, Amount::Mass(5.0))?; // I = 2
/// let state = State { attitude: UnitQuaternion::identity(), omega: Vector3::zeros() };
/// let tolerance = Tolerance::new(1e-12, 0.0)?;
/// let task = Task::free(&ball, Phase::in_place(&state), &[0.0, 3.0], Method::Auto, tolerance);
/// let mut push = Callback::torque(|t, _: &Phase| Ok::<_, polhode::Error>(Vector3::z() * t));
/// let run = simulate(&task, &mut push, &mut NoEvents::new(), &mut |_| ControlFlow::Continue(()));
/// let run = run.into_result()?;
/// assert!((run.phase.omega.z - 9.0 / 4.0).abs() < 1e-12); // ω = t²/(2 I)
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # A sum with analytic terms
///
/// A closure may hold an [`Analytic`](super::Analytic) load and add to its wrench. The run then steps by
/// [`Method::Dop853`](crate::motion::simulate::Method) or another method for closures, no longer by series. What terms
/// do beside their wrench is no part of the sum: a [`Rotor`](super::Rotor), a [`Slug`](super::Slug) or a law that
/// switches needs a type of its own that implements [`Load`] and passes these calls on. The breaks of terms that act in
/// windows of time belong into [`with_breaks`](Self::with_breaks).
///
/// ```
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::loads::{Analytic, Callback, Damping, Load, Wrench};
/// use polhode::motion::simulate::{Method, NoEvents, Phase, State, Task, Tolerance, simulate};
/// use polhode::nalgebra::{Matrix3, UnitQuaternion, Vector3};
/// use std::ops::ControlFlow;
///
/// let ball = solids::sphere(1.0, Amount::Mass(5.0))?; // I = 2
/// let state = State { attitude: UnitQuaternion::identity(), omega: Vector3::zeros() };
/// let tolerance = Tolerance::new(1e-12, 0.0)?;
/// let task = Task::free(&ball, Phase::in_place(&state), &[0.0, 3.0], Method::Auto, tolerance);
/// let terms = [Damping::new(&(Matrix3::identity() * 0.5), &Matrix3::zeros())?.into()];
/// let mut air = Analytic::new(&terms, task.body_at_point);
/// let mut sum = Callback::wrench(|t, phase: &Phase| {
///     let motor = Wrench::couple(Vector3::z()); // of time and state, in general
///     Ok::<_, polhode::Error>(air.wrench(t, phase)? + motor)
/// });
/// let run = simulate(&task, &mut sum, &mut NoEvents::new(), &mut |_| ControlFlow::Continue(()));
/// let run = run.into_result()?;
/// assert!((run.phase.omega.z - 2.0 * (1.0 - (-0.75_f64).exp())).abs() < 1e-11); // ω = N/c (1 − exp(−c t/I))
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Callback<F, E> {
    wrench: F,
    exerts_force: bool,
    depends_on_rates: bool,
    breaks: Vec<f64>,
    span: [f64; 2],
    error: PhantomData<fn() -> E>,
}

impl<E: From<Error>, F: FnMut(f64, &Phase) -> Result<Wrench, E>> Callback<F, E> {
    /// A force in N and a torque in B about the reference point, of time and state.
    #[must_use]
    #[inline]
    pub fn wrench(wrench: F) -> Self {
        Self {
            wrench,
            exerts_force: true,
            depends_on_rates: true,
            breaks: Vec::new(),
            span: [f64::NEG_INFINITY, f64::INFINITY],
            error: PhantomData,
        }
    }
}

impl<E: From<Error>> Callback<(), E> {
    /// A torque in B about the reference point, of time and state.
    #[must_use]
    #[inline]
    pub fn torque<G: FnMut(f64, &Phase) -> Result<Vector3<f64>, E>>(
        mut torque: G,
    ) -> Callback<impl FnMut(f64, &Phase) -> Result<Wrench, E>, E> {
        let couple = move |t: f64, phase: &Phase| torque(t, phase).map(Wrench::couple);
        Callback {
            exerts_force: false,
            ..Callback::wrench(couple)
        }
    }
}

impl<F, E> Callback<F, E> {
    /// The same load, which is known not to depend on ω or on the velocity: so that the splitting method can serve it.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::motion::loads::{Callback, Load, Wrench};
    /// use polhode::motion::simulate::Phase;
    /// use polhode::nalgebra::Vector3;
    ///
    /// // A spring in space, switched off at t = 2: not smooth there, and no matter how fast the body is.
    /// let spring = |t: f64, phase: &Phase| {
    ///     let force = if t < 2.0 { phase.position * -3.0 } else { Vector3::zeros() };
    ///     Ok::<_, polhode::Error>(Wrench { force, torque: Vector3::zeros() })
    /// };
    /// let load = Callback::wrench(spring).independent_of_rates().with_breaks(&[2.0]);
    /// assert!(load.exerts_force() && !load.depends_on_rates());
    /// assert_eq!(load.breaks(0.0, 10.0), [2.0]);
    /// ```
    #[must_use]
    pub fn independent_of_rates(self) -> Self {
        Self {
            depends_on_rates: false,
            ..self
        }
    }

    /// The same load, which is not smooth at these times: a step ends there, and the closure is asked for times on either side of
    /// each, never for the time itself.
    #[must_use]
    pub fn with_breaks(self, times: &[f64]) -> Self {
        Self {
            breaks: times.to_vec(),
            ..self
        }
    }
}

impl<E: From<Error>, F: FnMut(f64, &Phase) -> Result<Wrench, E>> Load for Callback<F, E> {
    type Error = E;

    fn exerts_force(&self) -> bool {
        self.exerts_force
    }

    fn depends_on_rates(&self) -> bool {
        self.depends_on_rates
    }

    fn breaks(&self, _: f64, _: f64) -> Vec<f64> {
        self.breaks.clone()
    }

    fn enter(&mut self, from: f64, to: f64) -> Result<(), E> {
        let is_break = |t: f64| self.breaks.contains(&t);
        let (low, high) = (from.min(to), from.max(to));
        self.span = [
            if is_break(low) { low.next_up() } else { low },
            if is_break(high) {
                high.next_down()
            } else {
                high
            },
        ];
        Ok(())
    }

    #[inline]
    fn wrench(&mut self, t: f64, phase: &Phase) -> Result<Wrench, E> {
        let [low, high] = self.span;
        (self.wrench)(t.max(low).min(high), phase)
    }
}
