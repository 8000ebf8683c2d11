//! What any number must be: finite, and a tolerance a fraction.

use super::any::Error;
use super::body::BodyFault;

/// `Ok` with a finite number, else [`Error::NonFinite`].
#[inline]
pub(crate) fn finite(what: &'static str, value: f64) -> Result<f64, Error> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(Error::NonFinite { what, value })
    }
}

/// `Ok` when every number is finite, else [`Error::NonFinite`] with the first that is not.
#[inline]
pub(crate) fn all_finite<'a>(
    what: &'static str,
    values: impl IntoIterator<Item = &'a f64>,
) -> Result<(), Error> {
    values
        .into_iter()
        .try_for_each(|&value| finite(what, value).map(drop))
}

/// `Ok` with a finite mass property, else [`BodyFault::NonFinite`].
#[inline]
pub(crate) fn finite_of_body(what: &'static str, value: f64) -> Result<f64, Error> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(BodyFault::NonFinite { what, value }.into())
    }
}

/// `Ok` when every mass property is finite, else [`BodyFault::NonFinite`] with the first that is not.
#[inline]
pub(crate) fn all_finite_of_body<'a>(
    what: &'static str,
    values: impl IntoIterator<Item = &'a f64>,
) -> Result<(), Error> {
    values
        .into_iter()
        .try_for_each(|&value| finite_of_body(what, value).map(drop))
}

/// 0 ≤ rtol < 1.
#[inline]
pub(crate) fn check_rtol(rtol: f64) -> Result<(), Error> {
    finite("rtol", rtol)?;
    if (0.0..1.0).contains(&rtol) {
        return Ok(());
    }
    Err(Error::OutOfDomain {
        what: "rtol",
        law: "at least 0 and less than 1",
        value: rtol,
    })
}
