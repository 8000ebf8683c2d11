//! Which method serves a run.

use nalgebra::Vector3;

use crate::error::{BodyFault, Error, MotionFault};
use crate::mass::RigidBody;
use crate::mass::validity::ROUNDING;
use crate::motion::heavy_top::PivotedTop;
use crate::motion::loads::Term;
use crate::motion::problem::{Method, Tolerance};

impl Method {
    /// The method that serves a run: itself, or what [`Self::Auto`] chooses.
    ///
    /// `terms`: of the load, where it has analytic ones alone. `pivoted`: whether the origin of the body is fixed. `is_top`
    /// tells, where that matters, whether every body is a [`closed_top`].
    ///
    /// # Errors
    /// [`MotionFault::MethodCannotServe`], which names one that can; [`Error::OutOfDomain`] where none serves the tolerance.
    pub(super) fn serving(
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
                "loads whose series is known: no orbit about an oblate attractor or along samples, no magnetic field along an orbit, no B-dot, no motor with a limit, no dry friction, no feedback on a target that moves"
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

/// The acceleration of free fall, of a load that is uniform gravity alone or nothing at all.
pub(super) fn gravity_alone(terms: &[Term]) -> Option<Vector3<f64>> {
    terms
        .iter()
        .try_fold(Vector3::zeros(), |sum, term| match term {
            Term::UniformGravity(law) => Some(sum + law.gravity),
            _ => None,
        })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::problem::TIGHTEST;
    use nalgebra::Vector3;

    #[test]
    fn auto_takes_the_first_that_can() {
        let weight = [Term::uniform_gravity(&Vector3::z()).expect("finite")];
        let tolerance = Tolerance::new(1e-10, 0.0).expect("a tolerance");
        let auto =
            |pivoted, terms, is_top| Method::Auto.serving(pivoted, terms, &tolerance, || is_top);
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
            let refused = method.serving(false, terms, &tolerance, || true);
            assert!(
                matches!(refused, Err(Error::Motion(MotionFault::MethodCannotServe { instead: named, .. })) if named == instead)
            );
        }
    }

    #[test]
    fn below_doubles_there_is_taylor() {
        let tolerance = Tolerance::new(0.9 * TIGHTEST, 0.0).expect("a tolerance");
        let serving = |method: Method, terms| method.serving(false, terms, &tolerance, || true);
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
