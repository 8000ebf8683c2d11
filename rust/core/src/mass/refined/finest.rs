//! Principal moments and axes to four times the precision, for the few motions that are so near the separatrix.

use super::vectors::{Vector, along, dot, within};
use crate::numerics::double_double::DoubleDouble;
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
            Self::Axes(given) => finest.axes = nearest(given),
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
    pub(crate) fn components(&self, vector: &Vector4) -> Vector4 {
        self.axes.map(|axis| along(&axis, vector))
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

/// The rotation nearest to axes that are one to rounding: `V (VᵀV)^−½`, with `1 − VᵀV = E` by the powers of E.
fn nearest(axes: &[[f64; 3]; 3]) -> [Vector4; 3] {
    let mut off = [[QuadDouble::default(); 3]; 3];
    for i in 0..3 {
        for j in 0..=i {
            let products = [0, 1, 2].map(|k| DoubleDouble::product(axes[i][k], axes[j][k]));
            let one = QuadDouble::from(if i == j { 1.0 } else { 0.0 });
            let rest = products.into_iter().fold(one, |sum, x| sum - x.into());
            (off[i][j], off[j][i]) = (rest, rest);
        }
    }
    // Each power needs one factor of digits less; the fourth is beyond four times the precision.
    let first = off.map(|row| row.map(QuadDouble::twofold));
    let second = product(&first, &first);
    let third = product(&first, &second);
    std::array::from_fn(|j| {
        std::array::from_fn(|i| {
            let weight = |k: usize| {
                let small = second[k][j] * 0.375.into() + third[k][j] * 0.3125.into();
                off[k][j].scaled(0.5) + small.into()
            };
            let axis = [0, 1, 2].map(|k| axes[k][i]);
            (0..3).fold(QuadDouble::from(axis[j]), |sum, k| {
                sum + QuadDouble::from(axis[k]) * weight(k)
            })
        })
    })
}

fn product(a: &[Vector; 3], b: &[Vector; 3]) -> [Vector; 3] {
    a.map(|row| [0, 1, 2].map(|j| dot(&row, &b.map(|other| other[j]))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass::refined::vectors::orthonormal;

    #[test]
    fn the_nearest_rotation_is_what_newton_finds() {
        let given = [
            [0.36, 0.48, -0.8],
            [-0.8, 0.6, 1e-15],
            [0.48 + 3e-16, 0.64, 0.6],
        ];
        let steps = |n: i32| {
            let start = given.map(|axis| axis.map(QuadDouble::from));
            (0..n).fold(start, |v, _| orthonormal(&v))
        };
        let (found, expected) = (nearest(&given), steps(4));
        for (a, b) in found.as_flattened().iter().zip(expected.as_flattened()) {
            assert!((*a - *b).rounded().abs() < 3e-60);
        }
    }

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
