//! Covariances that no body can have.
//!
//! A second moment `s = ∫ x² dm` is never negative. One that is zero has no variance: what is zero on average and never
//! negative is zero always. So the thickness of a lamina or the width of a rod is exactly known where the tensor says that it
//! is zero; what is uncertain of it has to be said otherwise, as a thin plate with a thickness and a sigma of that.

use super::linear_uncertainty::LinearUncertainty;
use crate::error::{Error, UncertaintyFault};
use crate::mass::body::RigidBody;
use crate::mass::inertial_parameters::InertialParameters;
use crate::mass::validity::ROUNDING;

/// Relative to the sum of all second moments: deviations below it are rounding.
const KNOWN: f64 = 1e-9;

/// Checks that a body can have these uncertainties.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, laminae};
/// use polhode::uncertainty::{Form, Source, check_covariance, propagate::directly};
///
/// // A disk without thickness: its moments are ½ I₃ each, and cannot have deviations of their own.
/// let disk = laminae::disk(1.0, Amount::Mass(1.0))?;
/// let with_sigma_of = |which: &[usize]| {
///     let mut forms: [Form; 10] = Default::default();
///     for &k in which {
///         forms[k] = vec![(Source::named("bench").variable(k as u32), 0.01)];
///     }
///     directly(&forms)
/// };
/// assert!(check_covariance(&disk, &with_sigma_of(&[0])).is_ok());
/// assert!(check_covariance(&disk, &with_sigma_of(&[4, 5, 6])).is_err());
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// [`UncertaintyFault::NoBody`] when a second moment that is zero has a variance.
pub fn check_covariance(body: &RigidBody, uncertainty: &LinearUncertainty) -> Result<(), Error> {
    let principal = body.principal();
    let [i1, i2, i3] = principal.moments;
    let sum = 0.5 * (i1 + i2 + i3);
    for (k, second) in [sum - i1, sum - i2, sum - i3].into_iter().enumerate() {
        if second > ROUNDING * sum {
            continue;
        }
        let axis = principal.axes.column(k).into_owned();
        let along = |change: &InertialParameters<f64>| {
            let tensor = change.tensor();
            0.5 * tensor.trace() - axis.dot(&(tensor * axis))
        };
        let variance: f64 = uncertainty
            .tangents
            .iter()
            .map(|(_, change)| along(change).powi(2))
            .sum();
        let (sigma, spread) = (variance.sqrt(), all(uncertainty));
        // Noise of other elements reaches it by rounding.
        if sigma > KNOWN * spread.max(ROUNDING * sum) {
            return Err(UncertaintyFault::NoBody {
                axis: axis.into(),
                sigma,
            }
            .into());
        }
    }
    Ok(())
}

/// The deviation of the whole tensor.
fn all(uncertainty: &LinearUncertainty) -> f64 {
    let squares = uncertainty
        .tangents
        .iter()
        .flat_map(|(_, change)| change.inertia)
        .map(|x| x * x);
    squares.sum::<f64>().sqrt()
}
