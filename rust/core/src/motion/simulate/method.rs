//! The methods, and which of them serves a run.

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
    /// Taylor series of the order at which the work is least: analytic loads, without events.
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
    /// [`Error::MethodCannotServe`], which names one that can.
    pub fn serving(
        self,
        pivoted: bool,
        terms: Option<&[Term]>,
        has_events: bool,
    ) -> Result<Self, Error> {
        let is_free = !pivoted && terms.is_some_and(<[Term]>::is_empty);
        let chosen = if is_free {
            Self::Exact
        } else if terms.is_some() && !has_events {
            Self::Taylor
        } else {
            Self::Dop853
        };
        let needs = match self {
            Self::Exact if !is_free => "a free body: no load, and about=\"center_of_mass\"",
            Self::Taylor if terms.is_none() => {
                "the loads of polhode.loads other than callbacks and compiled functions"
            }
            Self::Taylor if has_events => "a run without events",
            Self::Auto => return Ok(chosen),
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
    use nalgebra::Vector3;

    #[test]
    fn auto_takes_the_first_that_can() {
        let weight = [Term::uniform_gravity(&Vector3::z()).expect("finite")];
        let auto = |pivoted, terms, events| Method::Auto.serving(pivoted, terms, events);
        assert_eq!(auto(false, Some(&[]), true), Ok(Method::Exact));
        assert_eq!(auto(true, Some(&[]), false), Ok(Method::Taylor));
        assert_eq!(auto(true, Some(&weight), false), Ok(Method::Taylor));
        assert_eq!(auto(true, Some(&weight), true), Ok(Method::Dop853));
        assert_eq!(auto(false, None, false), Ok(Method::Dop853));
        for (method, terms, instead) in [
            (Method::Exact, Some(&weight[..]), "taylor"),
            (Method::Taylor, None, "dop853"),
        ] {
            let refused = method.serving(false, terms, false);
            assert!(
                matches!(refused, Err(Error::MethodCannotServe { instead: named, .. }) if named == instead)
            );
        }
        assert!(Method::Taylor.serving(true, Some(&weight), true).is_err());
    }
}
