//! What all motions of a stack have in common, and the method that serves them.

use std::fmt;
use std::ops::ControlFlow;

use nalgebra::{UnitQuaternion, Vector3};

use crate::error::{BodyFault, Error, MotionFault};
use crate::mass::RigidBody;
use crate::mass::validity::ROUNDING;
use crate::motion::heavy_top::PivotedTop;
use crate::motion::loads::Term;
use crate::motion::problem::{Method, ReferencePoint, Task, Tolerance, check_scales, check_times};
use crate::motion::state::Phase;

/// Asked now and then whether to go on, with the fraction done where that is known.
pub type Ask<'a> = dyn Fn(Option<f64>) -> ControlFlow<()> + Sync + 'a;

/// Motions of bodies through the same times, by a method that serves them all.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::mass::{Amount, RigidBody, solids};
/// use polhode::motion::loads::{Analytic, Damping, BodyAtPoint, Term};
/// use polhode::motion::simulate::{
///     Ask, CallbackPolicy, Method, NoEvents, Phase, Plan, Refusal, Member, Batch, Run, State, Tolerance, most_demanding, simulate_many,
/// };
/// use polhode::nalgebra::{Matrix3, UnitQuaternion, Vector3};
///
/// /// Balls that start at different rates and are slowed down.
/// struct Balls {
///     terms: Vec<[Term; 1]>,
/// }
///
/// impl Batch for Balls {
///     type Error = polhode::Error;
///
///     fn callbacks(&self) -> CallbackPolicy {
///         CallbackPolicy::Nothing
///     }
///
///     fn start(&self, member: usize) -> (usize, Phase) {
///         let omega = Vector3::new(0.0, 0.0, 1.0 + member as f64);
///         (0, Phase::in_place(&State { attitude: UnitQuaternion::identity(), omega }))
///     }
///
///     fn terms(&self, member: usize) -> &[Term] {
///         &self.terms[member]
///     }
///
///     fn run(&self, member: Member<'_>) -> Run<Self::Error> {
///         let body: BodyAtPoint = member.body();
///         let terms = &self.terms[member.number];
///         member.integrate(&mut Analytic::new(terms, body), &mut NoEvents::new())
///     }
///
///     fn ends_all(&self, _: &Self::Error) -> bool {
///         false
///     }
/// }
///
/// let bodies: [RigidBody; 1] = [solids::sphere(1.0, Amount::Mass(5.0))?]; // I = 2
/// let slowed = |k: i32| Damping::new(&(Matrix3::identity() * 0.2 * f64::from(k)), &Matrix3::zeros());
/// let terms = (1..=20).map(|k| Ok([slowed(k)?.into()])).collect::<Result<Vec<[Term; 1]>, polhode::Error>>()?;
/// let watch: &Ask<'_> = &|_| ControlFlow::Continue(());
/// let (times, tolerance) = ([0.0, 1.0], Tolerance::new(1e-12, 0.0)?);
/// let hardest = Some(most_demanding(&terms, false));
/// let plan = Plan::new(&bodies, false, &times, Method::Auto, tolerance, hardest, watch)
///     .map_err(|Refusal { error, .. }| error)?;
/// assert_eq!((plan.method(), plan.pivoted(), plan.times()), (Method::Taylor, false, &times[..]));
/// let mut runs: Vec<Option<Run<polhode::Error>>> = (0..20).map(|_| None).collect();
/// simulate_many(&plan, &Balls { terms }, &mut runs, watch);
/// let last = runs[19].as_ref().map(|run| run.phase.omega.z);
/// assert!((last.unwrap() - 20.0 * (-2.0_f64).exp()).abs() < 1e-11);
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a> {
    bodies: &'a [RigidBody],
    pivoted: bool,
    times: &'a [f64],
    method: Method,
    tolerance: Tolerance,
}

/// Why motions are not begun.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// The number of the body that is at fault, where it is one of them.
    pub body: Option<usize>,
    /// What is wrong.
    pub error: Error,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.body {
            Some(number) => write!(f, "body {number}: {}", self.error),
            None => self.error.fmt(f),
        }
    }
}

impl std::error::Error for Refusal {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.error)
    }
}

impl<'a> Plan<'a> {
    /// Motions of `bodies`, all of them free or all with their origin fixed, by `method` or what [`Method::Auto`] chooses.
    ///
    /// `terms`: of the load on one of them, where all loads have analytic terms alone, of the same kinds. When `watch` says so while
    /// bodies are looked through, it is as if they had no closed form.
    ///
    /// # Errors
    /// When the times do not run one way, when the method cannot serve, and for the first body whose equations of motion leave the range of float64.
    pub fn new(
        bodies: &'a [RigidBody],
        pivoted: bool,
        times: &'a [f64],
        method: Method,
        tolerance: Tolerance,
        terms: Option<&[Term]>,
        watch: &Ask<'_>,
    ) -> Result<Self, Refusal> {
        check_times(times).map_err(|error| Refusal { body: None, error })?;
        let are_tops =
            || (bodies.iter()).all(|body| watch(None).is_continue() && closed_top(body).is_ok());
        let method = method
            .choose(pivoted, terms, &tolerance, are_tops)
            .map_err(|error| Refusal { body: None, error })?;
        Self::settled(bodies, pivoted, times, method, tolerance)
    }

    /// As [`Self::new`], by a method that is known to serve.
    ///
    /// # Errors
    /// As there, for the times and the bodies.
    pub(super) fn settled(
        bodies: &'a [RigidBody],
        pivoted: bool,
        times: &'a [f64],
        method: Method,
        tolerance: Tolerance,
    ) -> Result<Self, Refusal> {
        check_times(times).map_err(|error| Refusal { body: None, error })?;
        let plan = Self {
            bodies,
            pivoted,
            times,
            method,
            tolerance,
        };
        if method != Method::Exact {
            for (number, body) in bodies.iter().enumerate() {
                check_scales(body, pivoted, times).map_err(|error| Refusal {
                    body: Some(number),
                    error,
                })?;
            }
        }
        Ok(plan)
    }

    /// Whether the origins of the bodies are fixed.
    #[must_use]
    pub fn pivoted(&self) -> bool {
        self.pivoted
    }

    /// When the states are asked for.
    #[must_use]
    pub fn times(&self) -> &'a [f64] {
        self.times
    }

    /// The method that serves them.
    #[must_use]
    pub fn method(&self) -> Method {
        self.method
    }

    /// The reference point of the body, where there is one alone: all members share it.
    pub(super) fn common(&self) -> Option<ReferencePoint> {
        match self.bodies {
            [body] => Some(self.reference_point(body)),
            _ => None,
        }
    }

    fn reference_point(&self, body: &RigidBody) -> ReferencePoint {
        let start = self.times.first().copied().unwrap_or_default();
        if self.pivoted {
            ReferencePoint::pivoted(body, start)
        } else {
            ReferencePoint::free(body, start)
        }
    }

    /// What is to be simulated of body number `body` from `given` on, whose attitude is of unit length to rounding alone.
    pub(super) fn task(
        &self,
        common: Option<&ReferencePoint>,
        body: usize,
        given: Phase,
    ) -> Task<'a> {
        let body = &self.bodies[body];
        // To these the attitude says more than its rounded length does.
        let is_exact =
            self.method == Method::Exact && self.pivoted || self.tolerance.is_beyond_doubles();
        let initial = Phase {
            attitude: if is_exact {
                given.attitude
            } else {
                UnitQuaternion::new_normalize(given.attitude.into_inner())
            },
            ..given
        };
        let reference_point = match common {
            Some(reference_point) => reference_point,
            None => &self.reference_point(body),
        };
        Task::about(
            reference_point,
            body,
            initial,
            self.times,
            self.method,
            self.tolerance,
        )
    }
}

impl Method {
    /// The method that serves a run: itself, or what [`Self::Auto`] chooses.
    ///
    /// `terms`: of the load, where it has analytic ones alone. `pivoted`: whether the origin of the body is fixed. `is_top`
    /// tells, where that matters, whether every body is a [`closed_top`].
    ///
    /// # Errors
    /// [`MotionFault::MethodCannotServe`], which names one that can; [`Error::OutOfDomain`] where none serves the tolerance.
    pub(super) fn choose(
        self,
        pivoted: bool,
        terms: Option<&[Term]>,
        tolerance: &Tolerance,
        is_top: impl FnOnce() -> bool,
    ) -> Result<Self, Error> {
        let is_beyond_doubles = tolerance.is_beyond_doubles();
        let may_be_closed = terms.is_some_and(|terms| {
            if pivoted {
                gravity_alone(terms).is_some()
            } else {
                terms.is_empty()
            }
        });
        let has_series =
            terms.is_some_and(|terms| (terms.iter()).all(|term| term.traits(pivoted).has_series));
        let of_steps = if has_series {
            Self::Taylor
        } else {
            Self::Dop853
        };
        if is_beyond_doubles && of_steps != Self::Taylor {
            return Err(Error::OutOfDomain {
                what: "rtol",
                law: "2.3e-15 or more (ten units of rounding) where the method \"taylor\" cannot serve the run",
                value: tolerance.relative,
            });
        }
        let needs = match self {
            Self::Auto if may_be_closed && !is_beyond_doubles && (!pivoted || is_top()) => {
                return Ok(Self::Exact);
            }
            Self::Auto => return Ok(of_steps),
            Self::Exact if !may_be_closed => {
                "a free body without a load, or with its origin fixed uniform gravity alone on a symmetric top"
            }
            Self::Taylor if terms.is_none() => {
                "analytic loads, no callbacks and no compiled functions"
            }
            Self::Taylor if !has_series => {
                "loads whose series is known: no orbit about an oblate attractor or along samples, no magnetic field along an orbit, no B-dot, no coils with a limit, a table or a controller, no motor with a limit or a controller that is no feedback, no allocation, no dry friction, no feedback on a target that moves"
            }
            method if is_beyond_doubles && method != Self::Taylor => {
                "an rtol of 2.3e-15 or more (ten units of rounding)"
            }
            method => return Ok(method),
        };
        Err(Error::Motion(MotionFault::MethodCannotServe {
            method: self.name(),
            needs,
            instead: of_steps.name(),
        }))
    }
}

/// Of the loads on a stack, whose terms are of the same kinds, one that asks most of a method: a row without a series where there
/// is one, such as a wheel with dry friction among others without.
#[must_use]
pub fn most_demanding<T: AsRef<[Term]>>(rows: &[T], pivoted: bool) -> &[Term] {
    let lacks_series = |terms: &&T| {
        let mut all = terms.as_ref().iter();
        all.any(|term| !term.traits(pivoted).has_series)
    };
    (rows.iter().find(lacks_series).or(rows.first())).map_or(&[], T::as_ref)
}

/// The top that `body` is to rounding about the origin of its frame: its motion under gravity is known in closed form.
///
/// # Errors
/// [`MotionFault::NoClosedForm`] when the moments across its axis differ, or the origin is off that axis;
/// [`Error::OutOfDomain`] for a point at the origin.
pub(super) fn closed_top(body: &RigidBody) -> Result<PivotedTop, Error> {
    PivotedTop::of(body, ROUNDING).map_err(|error| {
        let (lack, relative) = match error {
            Error::Body(BodyFault::NotASymmetricTop { gap, .. }) => {
                ("no two of its principal moments are equal", gap)
            }
            Error::Motion(MotionFault::PivotOffAxis { relative, .. }) => {
                ("the origin is off the symmetry axis", relative)
            }
            other => return other,
        };
        Error::Motion(MotionFault::NoClosedForm {
            lack,
            relative,
            allowed: ROUNDING,
        })
    })
}

/// Return the acceleration of free fall, of a load that is uniform gravity alone or nothing at all.
///
/// # Examples
///
/// ```
/// use polhode::motion::loads::{Term, UniformGravity};
/// use polhode::motion::simulate::gravity_alone;
/// use polhode::nalgebra::Vector3;
///
/// let g = Vector3::new(0.0, 0.0, -9.81);
/// let weight: Term = UniformGravity::new(&g)?.into();
/// assert_eq!(gravity_alone(&[weight]), Some(g));
/// # Ok::<(), polhode::Error>(())
/// ```
#[must_use]
pub fn gravity_alone(terms: &[Term]) -> Option<Vector3<f64>> {
    terms
        .iter()
        .try_fold(Vector3::zeros(), |sum, term| match term {
            Term::UniformGravity(law) => Some(sum + law.gravity),
            _ => None,
        })
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Quaternion, Vector3};

    use super::*;
    use crate::motion::problem::TIGHTEST;

    fn body(scale: f64) -> RigidBody {
        let (moments, centre) = (Vector3::new(2.0, 2.0, 1.2) * scale, Vector3::z());
        RigidBody::from_principal(1.0, &moments.into(), &Matrix3::identity(), &centre, 0.0)
            .expect("a body")
    }

    fn plan(
        bodies: &[RigidBody],
        method: Method,
        pivoted: bool,
        rtol: f64,
    ) -> Result<Plan<'_>, Refusal> {
        let tolerance = Tolerance::new(rtol, 0.0).expect("a tolerance");
        let go_on = |_| ControlFlow::Continue(());
        Plan::new(
            bodies,
            pivoted,
            &[0.0, 1.0],
            method,
            tolerance,
            Some(&[]),
            &go_on,
        )
    }

    #[test]
    fn a_refusal_names_the_body_where_it_is_one() {
        let bodies = [body(1.0), body(1e-260)];
        let at_fault = |method, rtol| {
            plan(&bodies, method, false, rtol)
                .map_err(|refusal| refusal.body)
                .err()
        };
        assert_eq!(at_fault(Method::Dop853, 1e-9), Some(Some(1)));
        assert_eq!(at_fault(Method::Dop853, 1e-20), Some(None));
        assert_eq!(at_fault(Method::Exact, 1e-9), None);
    }

    #[test]
    fn what_is_stopped_while_it_looks_for_tops_goes_in_steps() {
        let (bodies, times) = ([body(1.0)], [0.0, 1.0]);
        let tolerance = Tolerance::new(1e-9, 0.0).expect("a tolerance");
        let method = |flow| {
            let ask = move |_| flow;
            Plan::new(
                &bodies,
                true,
                &times,
                Method::Auto,
                tolerance,
                Some(&[]),
                &ask,
            )
            .map(|plan| plan.method())
        };
        assert_eq!(method(ControlFlow::Continue(())), Ok(Method::Exact));
        assert_eq!(method(ControlFlow::Break(())), Ok(Method::Taylor));
    }

    #[test]
    fn the_exact_top_alone_takes_the_attitude_as_given() {
        let bodies = [body(1.0)];
        let given = UnitQuaternion::new_unchecked(Quaternion::new(0.6, 0.0, 0.8 + 1e-13, 0.0));
        for (method, pivoted, keeps) in [
            (Method::Exact, true, true),
            (Method::Exact, false, false),
            (Method::Taylor, true, false),
        ] {
            let plan = plan(&bodies, method, pivoted, 1e-9).expect("a plan");
            let phase = Phase {
                attitude: given,
                ..Phase::nan()
            };
            let taken = plan.task(None, 0, phase).initial.attitude;
            assert_eq!(taken.coords == given.coords, keeps, "{method:?}");
        }
    }

    #[test]
    fn auto_takes_the_first_that_can() {
        let weight = [Term::uniform_gravity(&Vector3::z()).expect("finite")];
        let tolerance = Tolerance::new(1e-10, 0.0).expect("a tolerance");
        let auto =
            |pivoted, terms, is_top| Method::Auto.choose(pivoted, terms, &tolerance, || is_top);
        assert_eq!(auto(false, Some(&[]), false), Ok(Method::Exact));
        assert_eq!(auto(true, Some(&[]), false), Ok(Method::Taylor));
        assert_eq!(auto(true, Some(&weight), true), Ok(Method::Exact));
        assert_eq!(auto(true, Some(&weight), false), Ok(Method::Taylor));
        assert_eq!(auto(false, Some(&weight), true), Ok(Method::Taylor));
        assert_eq!(auto(false, None, true), Ok(Method::Dop853));
        for (method, terms, instead) in [
            (Method::Exact, Some(&weight[..]), "taylor"),
            (Method::Taylor, None, "dop853"),
        ] {
            let refused = method.choose(false, terms, &tolerance, || true);
            assert!(
                matches!(refused, Err(Error::Motion(MotionFault::MethodCannotServe { instead: named, .. })) if named == instead)
            );
        }
    }

    #[test]
    fn below_doubles_there_is_taylor() {
        let tolerance = Tolerance::new(0.9 * TIGHTEST, 0.0).expect("a tolerance");
        let serving = |method: Method, terms| method.choose(false, terms, &tolerance, || true);
        assert_eq!(serving(Method::Auto, Some(&[])), Ok(Method::Taylor));
        assert_eq!(serving(Method::Taylor, Some(&[])), Ok(Method::Taylor));
        for method in [
            Method::Exact,
            Method::Dop853,
            Method::Radau,
            Method::Splitting,
        ] {
            let refused = serving(method, Some(&[]));
            assert!(matches!(
                refused,
                Err(Error::Motion(MotionFault::MethodCannotServe {
                    instead: "taylor",
                    ..
                }))
            ));
        }
        for method in [Method::Auto, Method::Dop853] {
            assert!(matches!(
                serving(method, None),
                Err(Error::OutOfDomain { what: "rtol", .. })
            ));
        }
    }
}
