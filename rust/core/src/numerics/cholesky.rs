//! A factor of a covariance, which may be semidefinite.

use crate::error::{Error, UncertaintyFault, finite};

/// What is left of a variance, relative to it, that is rounding.
const ROUNDING: f64 = 1e-13;

/// S with `S Sᵀ = Σ`, both square and by rows; columns beyond the rank of Σ are zero.
///
/// # Examples
///
/// ```
/// use polhode::random::factor;
///
/// assert_eq!(factor(&[4.0, 0.0, 0.0, 9.0])?, [0.0, 2.0, 3.0, 0.0]); // S Sᵀ is what was given
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When the matrix is not symmetric, or some combination of the numbers would have a negative variance.
pub fn factor(covariance: &[f64]) -> Result<Vec<f64>, Error> {
    let count = covariance.len().isqrt();
    let (scale, mut rest) = correlations(covariance, count)?;
    // Cholesky's decomposition of the correlations, so that numbers of any units stand side by side; the number with most of
    // its variance left comes next, so that what is left at the end is rounding or no covariance.
    let mut found = vec![0.0; count * count];
    for step in 0..count {
        let left = |i: usize| rest[i * count + i];
        let pivot = (0..count)
            .max_by(|&i, &j| left(i).total_cmp(&left(j)))
            .unwrap_or(0);
        if left(pivot) <= ROUNDING {
            break;
        }
        let root = left(pivot).sqrt();
        let column: Vec<f64> = (0..count).map(|i| rest[i * count + pivot] / root).collect();
        for i in 0..count {
            for j in 0..count {
                rest[i * count + j] -= column[i] * column[j];
            }
            if column[i] != 0.0 {
                found[i * count + step] = scale[i] * column[i];
            }
        }
        // What the pivot explains of itself is all of it.
        for i in 0..count {
            rest[i * count + pivot] = 0.0;
            rest[pivot * count + i] = 0.0;
        }
    }
    // Where a variance is used up nothing may be left beside it.
    for i in 0..count {
        let worst = (0..count)
            .map(|j| rest[i * count + j])
            .fold(0.0_f64, |a, b| if b.abs() > a.abs() { b } else { a });
        if worst.abs() > ROUNDING * (count as f64) {
            return Err(UncertaintyFault::NotPositive {
                index: i,
                left: -worst.abs(),
            }
            .into());
        }
    }
    Ok(found)
}

/// Standard deviations, and the matrix of correlations by rows.
fn correlations(covariance: &[f64], count: usize) -> Result<(Vec<f64>, Vec<f64>), Error> {
    let at = |i: usize, j: usize| covariance[i * count + j];
    for i in 0..count {
        for j in 0..count {
            finite("covariance", at(i, j))?;
        }
        if at(i, i) < 0.0 {
            return Err(UncertaintyFault::NegativeVariance {
                index: i,
                variance: at(i, i),
            }
            .into());
        }
    }
    let scale: Vec<f64> = (0..count).map(|i| at(i, i).sqrt()).collect();
    let mut matrix = vec![0.0; count * count];
    for i in 0..count {
        for j in 0..count {
            let (a, b) = (at(i, j), at(j, i));
            if (a - b).abs() > 1e-12 * (scale[i] * scale[j]) {
                return Err(UncertaintyFault::NotSymmetric {
                    row: i,
                    column: j,
                    a,
                    b,
                }
                .into());
            }
            if scale[i] > 0.0 && scale[j] > 0.0 {
                matrix[i * count + j] = 0.5 * (a / scale[i] / scale[j] + b / scale[i] / scale[j]);
            } else if a != 0.0 {
                // Of a number that is known, with another.
                return Err(UncertaintyFault::NotPositive {
                    index: i.max(j),
                    left: -a.abs(),
                }
                .into());
            }
        }
    }
    Ok((scale, matrix))
}
