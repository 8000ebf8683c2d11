//! A motion that goes on run by run, such as that of a control loop: what its runs have in common is computed once.

use std::ops::ControlFlow;
use std::slice;
use std::sync::Arc;

use nalgebra::Vector3;

use super::events::Events;
use super::plan::Plan;
use super::runs::by_method;
use crate::error::Error;
use crate::mass::RigidBody;
use crate::mass::refined::RefinedPrincipal;
use crate::motion::euler_equations::EulerEquations;
use crate::motion::loads::{BodyAtPoint, CarriedMomentum, Load, Term};
use crate::motion::problem::{Method, ReferencePoint, Run, Tolerance};
use crate::motion::state::Phase;

/// Runs of one body, each of which goes on where the one before ended.
///
/// A run has the bits of [`simulate`](super::simulate) through the same times. What does not change from run to run is kept: the reference
/// point, the equations of the body without its wheels, and the method.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::loads::{Analytic, Term};
/// use polhode::motion::kinematics::Frame;
/// use polhode::motion::simulate::{Chain, Method, NoEvents, Phase, State, Tolerance};
/// use polhode::nalgebra::{UnitQuaternion, Vector3};
///
/// let ball = solids::sphere(1.0, Amount::Mass(5.0))?; // I = 2
/// let torque = [Term::constant_torque(&Vector3::z(), Frame::Body)?];
/// let mut chain = Chain::new(ball, false, Tolerance::new(1e-12, 0.0)?);
/// chain.take(Method::Auto, Some(&torque), std::iter::empty())?;
/// let mut phase = Phase::in_place(&State { attitude: UnitQuaternion::identity(), omega: Vector3::zeros() });
/// for k in 0..3 {
///     let times = [f64::from(k), f64::from(k + 1)];
///     let mut load = Analytic::new(&torque, chain.body_at_point(times[0]));
///     let run = chain.run(&times, phase, &mut load, &mut NoEvents::new(), &mut |_| ControlFlow::Continue(()))?;
///     phase = run.into_result()?.phase;
/// }
/// assert!((phase.omega.z - 1.5).abs() < 1e-12); // ω = N t/I
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct Chain {
    body: RigidBody,
    reference_point: ReferencePoint,
    /// The wheels that turn freely (axis and moment), and the body without them.
    without_wheels: Option<Arc<WithoutWheels>>,
    method: Method,
    tolerance: Tolerance,
}

#[derive(Debug)]
struct WithoutWheels {
    turning: Vec<(Vector3<f64>, f64)>,
    euler: EulerEquations,
    principal: Arc<RefinedPrincipal>,
}

impl Chain {
    /// Of `body`, with its origin fixed in space if it is `pivoted`.
    #[must_use]
    pub fn new(body: RigidBody, pivoted: bool, tolerance: Tolerance) -> Self {
        let reference_point = if pivoted {
            ReferencePoint::pivoted(&body, 0.0)
        } else {
            ReferencePoint::free(&body, 0.0)
        };
        Self {
            body,
            reference_point,
            without_wheels: None,
            method: Method::Auto,
            tolerance,
        }
    }

    /// The body.
    #[must_use]
    pub fn body(&self) -> &RigidBody {
        &self.body
    }

    /// What a load acts on in a run that begins at `start`.
    #[must_use]
    pub fn body_at_point(&self, start: f64) -> BodyAtPoint {
        BodyAtPoint {
            start,
            ..self.reference_point.body_at_point
        }
    }

    /// Takes a load with these terms, or one of other kinds too, for the runs from now on, by `method` or what [`Method::Auto`] chooses.
    ///
    /// # Errors
    /// As [`Plan::new`], and [`MotionFault::WheelsTooHeavy`](crate::error::MotionFault::WheelsTooHeavy). The chain is then as it was.
    pub fn take<'c>(
        &mut self,
        method: Method,
        terms: Option<&[Term]>,
        carried: impl Iterator<Item = &'c dyn CarriedMomentum>,
    ) -> Result<(), Error> {
        let (bodies, pivoted) = (
            slice::from_ref(&self.body),
            self.reference_point.body_at_point.pivoted,
        );
        let go_on = &|_| ControlFlow::Continue(());
        let plan = Plan::new(
            bodies,
            pivoted,
            &[0.0],
            method,
            self.tolerance,
            terms,
            go_on,
        )
        .map_err(|refusal| refusal.error)?;
        let method = plan.method();
        let turning: Vec<_> = carried.filter_map(CarriedMomentum::turning).collect();
        let known = self.without_wheels.as_ref();
        if known.map_or(&[][..], |known| &known.turning) != turning {
            self.without_wheels = if turning.is_empty() {
                None
            } else {
                let point = &self.reference_point.body_at_point.point;
                let principal = RefinedPrincipal::about(&self.body, point).without(&turning)?;
                Some(Arc::new(WithoutWheels {
                    turning,
                    euler: EulerEquations::of_refined(&principal),
                    principal: Arc::new(principal),
                }))
            };
        }
        self.method = method;
        Ok(())
    }

    /// Run from `initial`, whose internal states are those of the load, through `times`, under the load that was [taken](Self::take).
    ///
    /// # Errors
    /// For times that do not run one way or are too far apart, and for a start that is not finite.
    pub fn run<L: Load>(
        &self,
        times: &[f64],
        initial: Phase,
        load: &mut L,
        events: &mut dyn Events<Error = L::Error>,
        watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
    ) -> Result<Run<L::Error>, Error> {
        let reference_point = ReferencePoint {
            body_at_point: self.body_at_point(times.first().copied().unwrap_or_default()),
            ..self.reference_point
        };
        let bodies = slice::from_ref(&self.body);
        let pivoted = reference_point.body_at_point.pivoted;
        let plan = Plan::settled(bodies, pivoted, times, self.method, self.tolerance)
            .map_err(|refusal| refusal.error)?;
        let mut task = plan.task(Some(&reference_point), 0, initial);
        if let Some(without) = &self.without_wheels {
            task.euler = without.euler;
            task.body_without_wheels = Some(Arc::clone(&without.principal));
        }
        task.check_start()?;
        Ok(by_method(&task, load, events, watch))
    }
}
