//! Principal moments and axes to four times the precision, for the few motions that are so near the separatrix.

use nalgebra::Vector3;

use super::vectors::{Vector, dot, orthonormal, within};
use crate::numerics::quad_double::QuadDouble;

type Vector4 = [QuadDouble; 3];

/// What moments and axes are refined from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Source {
    /// Moments, and axes along those of B.
    Exact,
    /// Moments, and axes that are a rotation to rounding: the nearest one.
    Axes([[f64; 3]; 3]),
    /// The rows of a tensor, and the power of two that is their unit.
    Tensor([Vector; 3], f64),
}

/// The principal moments, ascending, with their axes, to four times the precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Finest {
    /// I₁ ≤ I₂ ≤ I₃.
    pub moments: [QuadDouble; 3],
    /// The axes, one after the other, right-handed; components in B.
    pub axes: [[QuadDouble; 3]; 3],
}

impl Source {
    /// From the same to twice the precision.
    pub(super) fn refined(&self, moments: &Vector, axes: &[Vector; 3]) -> Finest {
        let mut finest = Finest {
            moments: moments.map(QuadDouble::from),
            axes: axes.map(|axis| axis.map(QuadDouble::from)),
        };
        match self {
            Self::Exact => {}
            Self::Axes(given) => {
                let given = given.map(|axis| axis.map(QuadDouble::from));
                finest.axes = orthonormal(&orthonormal(&given));
            }
            Self::Tensor(rows, unit) => {
                finest.refine(&rows.map(|row| row.map(QuadDouble::from)));
                finest.moments = finest.moments.map(|moment| moment.scaled(*unit));
            }
        }
        finest
    }
}

/// Corrections at most: each squares the error, and one is enough unless moments are close.
const CORRECTIONS: usize = 3;
/// Axes that are known to twice the precision are not corrected by more than that.
const ARBITRARY: f64 = 1e-8;
/// What a correction of this size leaves is below rounding.
const SMALL: f64 = 1e-30;

impl Finest {
    /// A vector of B by its components along the principal axes.
    #[must_use]
    pub(crate) fn components(&self, vector: &Vector3<f64>) -> Vector4 {
        let vector = [vector.x, vector.y, vector.z].map(QuadDouble::from);
        self.axes.map(|axis| dot(&axis, &vector))
    }

    /// Eigenvalues and eigenvectors of the tensor (its rows) from nearly orthonormal approximate ones.
    ///
    /// With B the tensor in the axes v and G their scalar products, `v_j + Σ x_ij v_i`, `x_ij = (B_ij − λ_j G_ij)/(λ_j − λ_i)`,
    /// is the eigenvector to second order, and `½ (1 − G_jj)` its correction along itself.
    fn refine(&mut self, rows: &[Vector4; 3]) {
        for _ in 0..CORRECTIONS {
            let v = self.axes;
            let b = within(rows, &v);
            let g = v.map(|a| v.map(|b| dot(&a, &b)));
            let values = [0, 1, 2].map(|k| b[k][k] / g[k][k]);
            let mut largest = 0.0_f64;
            for j in 0..3 {
                let along = (QuadDouble::from(1.0) - g[j][j]).scaled(0.5);
                let mut axis = v[j].map(|x| x + along * x);
                for i in [(j + 1) % 3, (j + 2) % 3] {
                    let (rest, gap) = (b[i][j] - values[j] * g[i][j], values[j] - values[i]);
                    if rest.rounded() == 0.0 || gap.rounded() == 0.0 {
                        continue;
                    }
                    // The rest and the gap are small differences; their quotient needs no more than twice the precision.
                    let part = rest.twofold() / gap.twofold();
                    if part.high.abs() > ARBITRARY {
                        continue; // moments so close that the axes stay where they are
                    }
                    largest = largest.max(part.high.abs());
                    for (x, &other) in axis.iter_mut().zip(&v[i]) {
                        *x = *x + QuadDouble::from(part) * other;
                    }
                }
                self.axes[j] = axis;
            }
            self.moments = values;
            if largest <= SMALL {
                break;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_that_are_known_are_corrected_and_others_stay() {
        let diagonal = [1.0, 2.0, 3.0].map(QuadDouble::from);
        let zero = QuadDouble::from(0.0);
        let rows = std::array::from_fn(|i| {
            std::array::from_fn(|j| if i == j { diagonal[i] } else { zero })
        });
        let one = QuadDouble::from(1.0);
        for (angle, is_known) in [(0.9 * ARBITRARY, true), (1.1 * ARBITRARY, false)] {
            let off = QuadDouble::from(angle);
            let turned = [[one, off, zero], [-off, one, zero], [zero, zero, one]];
            let mut finest = Finest {
                moments: diagonal,
                axes: orthonormal(&turned),
            };
            finest.refine(&rows);
            let left = finest.axes[0][1].rounded().abs();
            assert_eq!(left < 1e-30, is_known, "{left}");
            assert_eq!(left > 0.9 * angle, !is_known, "{left}");
        }
    }
}
