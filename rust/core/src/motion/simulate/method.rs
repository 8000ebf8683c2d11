//! The methods, and which of them serves a run.

use super::Tolerance;
use crate::error::Error;
use crate::motion::loads::Term;

/// How a motion is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// The first of exact, Taylor and DOP853 that can serve the run.
    #[default]
    Auto,
    /// In closed form: a free body without a load.
    Exact,
    /// Taylor series of the order at which the work is least: analytic loads, without events. At tolerances that doubles
    /// cannot serve in numbers of twice their precision.
    Taylor,
    /// The explicit Runge-Kutta method of order 8 by Dormand and Prince: every load.
    Dop853,
    /// The implicit Runge-Kutta method Radau IIA of order 5: every load, for those that are stiff.
    Radau,
    /// Kicks between exact free motions at equal steps: loads that do not depend on rates, for long times.
    Splitting,
}

impl Method {
    /// Its name.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Exact => "exact",
            Self::Taylor => "taylor",
            Self::Dop853 => "dop853",
            Self::Radau => "radau",
            Self::Splitting => "splitting",
        }
    }

    /// The method that serves a run: itself, or what [`Self::Auto`] chooses.
    ///
    /// `terms`: of the load, where it has analytic ones alone. `pivoted`: whether the origin of the body is fixed.
    ///
    /// # Errors
    /// [`Error::MethodCannotServe`], which names one that can; [`Error::OutOfDomain`] where none serves the tolerance.
    pub fn serving(
        self,
        pivoted: bool,
        terms: Option<&[Term]>,
        has_events: bool,
        tolerance: &Tolerance,
    ) -> Result<Self, Error> {
        let is_free = !pivoted && terms.is_some_and(<[Term]>::is_empty);
        let is_beyond_doubles = tolerance.is_beyond_doubles();
        let chosen = if is_free && !is_beyond_doubles {
            Self::Exact
        } else if terms.is_some() && !has_events {
            Self::Taylor
        } else {
            Self::Dop853
        };
        if is_beyond_doubles && chosen != Self::Taylor {
            return Err(Error::OutOfDomain {
                what: "rtol",
                law: "2.3e-15 or more (ten units of rounding) where method=\"taylor\" cannot serve the run",
                value: tolerance.relative,
            });
        }
        let needs = match self {
            Self::Exact if !is_free => "a free body: no load, and about=\"center_of_mass\"",
            Self::Taylor if terms.is_none() => {
                "the loads of polhode.loads other than callbacks and compiled functions"
            }
            Self::Taylor if has_events => "a run without events",
            Self::Auto => return Ok(chosen),
            method if is_beyond_doubles && method != Self::Taylor => {
                "an rtol of 2.3e-15 or more (ten units of rounding)"
            }
            method => return Ok(method),
        };
        Err(Error::MethodCannotServe {
            method: self.name(),
            needs,
            instead: chosen.name(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::simulate::TIGHTEST;
    use nalgebra::Vector3;

    #[test]
    fn auto_takes_the_first_that_can() {
        let weight = [Term::uniform_gravity(&Vector3::z()).expect("finite")];
        let tolerance = Tolerance::new(1e-10, 0.0).expect("a tolerance");
        let auto =
            |pivoted, terms, events| Method::Auto.serving(pivoted, terms, events, &tolerance);
        assert_eq!(auto(false, Some(&[]), true), Ok(Method::Exact));
        assert_eq!(auto(true, Some(&[]), false), Ok(Method::Taylor));
        assert_eq!(auto(true, Some(&weight), false), Ok(Method::Taylor));
        assert_eq!(auto(true, Some(&weight), true), Ok(Method::Dop853));
        assert_eq!(auto(false, None, false), Ok(Method::Dop853));
        for (method, terms, instead) in [
            (Method::Exact, Some(&weight[..]), "taylor"),
            (Method::Taylor, None, "dop853"),
        ] {
            let refused = method.serving(false, terms, false, &tolerance);
            assert!(
                matches!(refused, Err(Error::MethodCannotServe { instead: named, .. }) if named == instead)
            );
        }
        let refused = Method::Taylor.serving(true, Some(&weight), true, &tolerance);
        assert!(refused.is_err());
    }

    #[test]
    fn below_doubles_there_is_taylor() {
        let tolerance = Tolerance::new(0.9 * TIGHTEST, 0.0).expect("a tolerance");
        let serving = |method: Method, terms| method.serving(false, terms, false, &tolerance);
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
                Err(Error::MethodCannotServe {
                    instead: "taylor",
                    ..
                })
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
