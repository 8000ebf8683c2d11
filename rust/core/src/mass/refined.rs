//! Principal moments and axes to twice the precision, and to four times.
//!
//! # Examples
//!
//! ```
//! use polhode::DoubleDouble;
//! use polhode::mass::refined::{RefinedPrincipal, Vector};
//! use polhode::mass::{Amount, solids};
//!
//! let brick = solids::cuboid(&[0.3, 0.2, 0.1], Amount::Mass(1.0))?;
//! let refined = RefinedPrincipal::of(&brick);
//! let moments: Vector = refined.moments;
//! // I₁ = m (b² + c²)/12, off by half a unit of rounding as a float64, and by far less as two.
//! assert!((moments[0].rounded() - 0.05 / 12.0).abs() < 1e-17);
//! let spin: Vector = refined.components(&[1.0, 2.0, 3.0].into());
//! assert_eq!(spin.map(DoubleDouble::rounded), [1.0, 2.0, 3.0]);
//! # Ok::<(), polhode::Error>(())
//! ```

use nalgebra::{Matrix3, Vector3};

use super::RigidBody;
use super::provenance::MomentsFrom;
use super::validity::ROUNDING;
use crate::error::{Error, MotionFault};
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::elliptic::MultiPrecision;
use crate::numerics::power_of_two::power_below;
use crate::numerics::quad_double::QuadDouble;
use crate::principal::{PrincipalAxes, principal_axes};

// Principal moments and axes of a body to twice the precision.
//
// Over 10⁶ rotations the last bit of a moment is 10⁻⁹ rad. What defines the body is taken as exact: its moments and axes,
// or its tensor, whose float64 eigenvalues and eigenvectors are only where the refinement starts.

/// The principal moments, ascending, with their axes, to twice the precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefinedPrincipal {
    /// I₁ ≤ I₂ ≤ I₃.
    pub moments: Vector,
    /// The axes, one after the other, right-handed; components in B.
    axes: [Vector; 3],
    source: RefinementSource,
}

impl RefinedPrincipal {
    /// Of a body about its centre of mass.
    #[must_use]
    pub fn of(body: &RigidBody) -> Self {
        let principal = body.principal();
        let mut refined = Self::from_principal(&principal.moments, &principal.axes);
        if body.provenance().moments == MomentsFrom::Tensor {
            let rows = body.inertia().transpose().data.0;
            refined.refine(&rows.map(|row| row.map(DoubleDouble::from)));
            refined.clear(&principal.moments);
        }
        refined
    }

    /// Of a body about the point P (from the origin of B): `I_P = I_C + m(d² 1 − d dᵀ)` with d = C − P.
    #[must_use]
    pub fn about(body: &RigidBody, point: &Vector3<f64>) -> Self {
        let central = Self::of(body);
        let center = body.center_of_mass();
        let d = [0, 1, 2].map(|i| DoubleDouble::sum(center[i], -point[i]));
        if d.iter().all(|x| x.rounded() == 0.0) {
            return central;
        }
        let mass = DoubleDouble::from(body.mass());
        let square = dot(&d, &d);
        let tensor: [Vector; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let lever = if i == j {
                    square - d[i] * d[j]
                } else {
                    -(d[i] * d[j])
                };
                central.element(body, i, j) + mass * lever
            })
        });
        let about = body.principal_about(point);
        let mut refined = Self::from_principal(&about.moments, &about.axes);
        refined.refine(&tensor);
        refined.clear(&about.moments);
        refined
    }

    /// Of the tensor less another one, whose rows in B these are: of a body without what turns freely in it.
    ///
    /// # Errors
    /// [`MotionFault::WheelsTooHeavy`] where that leaves a moment that is not positive, to rounding.
    pub fn less(&self, other: &[Vector; 3]) -> Result<Self, Error> {
        let tensor: [Vector; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let whole = self.axes.iter().zip(self.moments);
                whole.fold(-other[i][j], |sum, (axis, moment)| {
                    sum + moment * (axis[i] * axis[j])
                })
            })
        });
        let rounded = Matrix3::from_fn(|i, j| tensor[i.min(j)][i.max(j)].rounded());
        let PrincipalAxes { moments, axes } = principal_axes(&rounded);
        let mut refined = Self::from_principal(&moments, &axes);
        refined.refine(&tensor);
        refined.snap();
        let moment = refined.moments[0].rounded();
        if moment > ROUNDING * self.moments[2].rounded() {
            Ok(refined)
        } else {
            Err(MotionFault::WheelsTooHeavy { moment }.into())
        }
    }

    /// Moments that differ by rounding alone are equal: two at a time, or all three.
    fn snap(&mut self) {
        let [a, b, c] = self.moments;
        let alike = |x: DoubleDouble, y: DoubleDouble| (y - x).rounded() <= ALIKE * c.rounded();
        let mean = |x: DoubleDouble, y: DoubleDouble| (x + y).scaled(0.5);
        self.moments = match (alike(a, b), alike(b, c)) {
            (true, true) => [b; 3],
            (true, false) => [mean(a, b), mean(a, b), c],
            (false, true) => [a, mean(b, c), mean(b, c)],
            (false, false) => return,
        };
    }

    /// The components of a vector along the axes. Across the axis of a symmetric body what is rounding alone is zero.
    #[must_use]
    pub fn along(&self, vector: &Vector) -> Vector {
        let mut found = self.axes.map(|axis| along(&axis, vector));
        let size = (found.iter()).fold(0.0, |most: f64, x| most.max(x.rounded().abs()));
        let [a, b, c] = self.moments;
        for (x, y, i, j) in [(a, b, 0, 1), (b, c, 1, 2)] {
            if x == y && found[i].rounded().hypot(found[j].rounded()) <= ALIKE * size {
                (found[i], found[j]) = (DoubleDouble::default(), DoubleDouble::default());
            }
        }
        found
    }

    /// Of the tensor less `Σ J a aᵀ`, with moments J about axes a of any length.
    ///
    /// # Errors
    /// As [`Self::less`].
    pub fn without(&self, turning: &[(Vector3<f64>, f64)]) -> Result<Self, Error> {
        let mut sum = [Vector::default(); 3];
        for (axis, moment) in turning {
            let axis = (axis / power_below(axis.amax())).map(DoubleDouble::from);
            let axis = [axis.x, axis.y, axis.z];
            let part = DoubleDouble::from(*moment) / dot(&axis, &axis);
            for (i, row) in sum.iter_mut().enumerate() {
                for (j, element) in row.iter_mut().enumerate() {
                    *element += part * (axis[i] * axis[j]);
                }
            }
        }
        self.less(&sum)
    }

    /// An element of the tensor in B that the body has about its centre of mass.
    fn element(&self, body: &RigidBody, i: usize, j: usize) -> DoubleDouble {
        if body.provenance().moments == MomentsFrom::Tensor {
            return body.inertia()[(i, j)].into();
        }
        let parts = self.axes.iter().zip(self.moments);
        parts.fold(DoubleDouble::default(), |sum, (axis, moment)| {
            sum + moment * axis[i] * axis[j]
        })
    }

    /// What the body was found to have no moment about has none.
    fn clear(&mut self, known: &[f64; 3]) {
        for (moment, &known) in self.moments.iter_mut().zip(known) {
            if known == 0.0 {
                *moment = DoubleDouble::default();
            }
        }
    }

    /// From ascending moments, taken as exact, and axes (columns) that are a rotation to rounding: the nearest rotation.
    #[must_use]
    pub fn from_principal(moments: &[f64; 3], axes: &Matrix3<f64>) -> Self {
        let columns = axes.data.0.map(|column| column.map(DoubleDouble::from));
        let is_exact = axes.iter().all(|x| x.abs() == 1.0 || *x == 0.0);
        Self {
            moments: moments.map(DoubleDouble::from),
            axes: if is_exact {
                columns
            } else {
                orthonormal(&columns)
            },
            source: if is_exact {
                RefinementSource::Exact
            } else {
                RefinementSource::Axes(axes.data.0)
            },
        }
    }

    /// Whether moments and axes are what they are to the last bit.
    pub(crate) fn is_exact(&self) -> bool {
        self.source == RefinementSource::Exact
    }

    /// The rows of the tensor in B that moments and axes were refined from; `None` where these are given.
    pub(crate) fn tensor(&self) -> Option<[[QuadDouble; 3]; 3]> {
        match &self.source {
            RefinementSource::Exact | RefinementSource::Axes(_) => None,
            RefinementSource::Tensor(rows, unit) => {
                Some(rows.map(|row| row.map(|x| QuadDouble::from(x.scaled(*unit)))))
            }
        }
    }

    /// Moments and axes to four times the precision.
    #[must_use]
    pub(crate) fn finest(&self) -> Finest {
        self.source.refine(&self.moments, &self.axes)
    }

    /// The axes as columns.
    #[must_use]
    pub fn axes(&self) -> Matrix3<DoubleDouble> {
        Matrix3::from(self.axes)
    }

    /// The axis of the k-th moment.
    #[must_use]
    pub fn axis(&self, k: usize) -> Vector {
        self.axes[k]
    }

    /// The axes as columns, rounded.
    #[must_use]
    pub(crate) fn rounded_axes(&self) -> Matrix3<f64> {
        Matrix3::from(self.axes.map(|axis| axis.map(DoubleDouble::rounded)))
    }

    /// A vector of B by its components along the principal axes.
    #[must_use]
    pub fn components(&self, vector: &Vector3<f64>) -> Vector {
        let vector = [vector.x, vector.y, vector.z].map(DoubleDouble::from);
        self.axes.map(|axis| along(&axis, &vector))
    }

    /// The components in B of a vector that is given along the principal axes.
    #[must_use]
    pub(crate) fn in_body(&self, along_axes: &Vector) -> Vector {
        [0, 1, 2].map(|i| along(&self.axes.map(|axis| axis[i]), along_axes))
    }

    /// Eigenvalues and eigenvectors of the tensor (its rows) from approximate ones.
    fn refine(&mut self, rows: &[Vector; 3]) {
        // Products of tensors near the ends of float64 stay within it.
        let largest = rows.as_flattened().iter();
        let unit = power_below(largest.fold(0.0, |most, x| most.max(x.high.abs())));
        let rows = rows.map(|row| row.map(|x| x.scaled(1.0 / unit)));
        self.source = RefinementSource::Tensor(rows, unit);
        let mut b = within(&rows, &self.axes);
        diagonalize(&mut b, &mut self.axes);
        self.moments = [b[0][0], b[1][1], b[2][2]].map(|moment| moment.scaled(unit));
        for (i, j) in [(0, 1), (1, 2), (0, 1)] {
            if (self.moments[j] - self.moments[i]).rounded() < 0.0 {
                self.moments.swap(i, j);
                self.axes.swap(i, j);
                self.axes[i] = self.axes[i].map(|x| -x); // a rotation still
            }
        }
    }
}

/// What differs by less than this part is alike to twice the precision.
const ALIKE: f64 = 1e-29;

// Principal moments and axes to four times the precision, for the few motions that are so near the separatrix.

type Vector4 = [QuadDouble; 3];

/// What moments and axes are refined from.
#[derive(Clone, Copy, Debug, PartialEq)]
enum RefinementSource {
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

impl RefinementSource {
    /// From the same to twice the precision.
    fn refine(&self, moments: &Vector, axes: &[Vector; 3]) -> Finest {
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

// Jacobi's rotations to twice the precision.

/// Below this tangent `tan 2φ = 2 tan φ` and `1 − cos φ = ½ tan² φ`, to what a sweep needs.
const SMALL_ANGLE: f64 = 1e-9;

/// The most sweeps; two or three are enough.
const SWEEPS: usize = 8;

/// Elements off the diagonal below this part of the largest moment are zero to twice the precision.
const NEGLIGIBLE: f64 = 1e-31;

/// Turns the axes until the tensor b in them is diagonal.
///
/// The elements off the diagonal start at rounding; each sweep squares them, so two reach twice the precision.
fn diagonalize(b: &mut [Vector; 3], axes: &mut [Vector; 3]) {
    let size = b[2][2].rounded().abs();
    for _ in 0..SWEEPS {
        let off = [(0, 1), (0, 2), (1, 2)]
            .map(|(i, j)| b[i][j].rounded().abs())
            .into_iter()
            .fold(0.0, f64::max);
        if off <= NEGLIGIBLE * size {
            break;
        }
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            rotate(b, axes, i, j);
        }
    }
}

/// Jacobi's rotation of the axes i and j that makes their product of inertia vanish.
fn rotate(b: &mut [Vector; 3], axes: &mut [Vector; 3], i: usize, j: usize) {
    let product = b[i][j];
    if product.rounded() == 0.0 {
        return;
    }
    let gap = b[j][j] - b[i][i];
    let tangent = if product.high.abs() < SMALL_ANGLE * gap.high.abs() {
        (product.high / gap.high).into()
    } else {
        // cot 2φ, and the smaller root t = tan φ of t² + 2 t cot 2φ − 1 = 0.
        let cotangent = gap / (product + product);
        let one = DoubleDouble::from(1.0);
        let root = one / (cotangent.abs() + (one + cotangent * cotangent).sqrt());
        if cotangent.rounded() < 0.0 {
            -root
        } else {
            root
        }
    };
    // 1 − cos φ; to rounding of its first term where φ is small.
    let square = tangent * tangent;
    let versine = if square.high < SMALL_ANGLE * SMALL_ANGLE {
        square.scaled(0.5)
    } else {
        let root = (DoubleDouble::from(1.0) + square).sqrt();
        square / (root * (root + 1.0.into()))
    };
    let sine = tangent - tangent * versine;
    let turned = |u: DoubleDouble, v: DoubleDouble| {
        (u - (sine * v + versine * u), v + (sine * u - versine * v))
    };
    let (u, v) = (axes[i], axes[j]);
    let pairs: [(DoubleDouble, DoubleDouble); 3] = std::array::from_fn(|c| turned(u[c], v[c]));
    axes[i] = pairs.map(|pair| pair.0);
    axes[j] = pairs.map(|pair| pair.1);
    let k = 3 - i - j;
    let shift = tangent * product;
    b[i][i] -= shift;
    b[j][j] += shift;
    (b[i][k], b[j][k]) = turned(b[i][k], b[j][k]);
    (b[k][i], b[k][j]) = (b[i][k], b[j][k]);
    (b[i][j], b[j][i]) = (DoubleDouble::default(), DoubleDouble::default());
}

// Vectors and matrices of more than double precision.

/// Three components to twice the precision.
pub type Vector = [DoubleDouble; 3];

/// The tensor with these rows, in these axes.
fn within<T: MultiPrecision>(rows: &[[T; 3]; 3], axes: &[[T; 3]; 3]) -> [[T; 3]; 3] {
    axes.map(|axis| {
        let image = [0, 1, 2].map(|i| dot(&rows[i], &axis));
        axes.map(|other| dot(&other, &image))
    })
}

/// `½ V (3 − VᵀV)`: one step of Newton's method toward the nearest rotation, which squares the error.
fn orthonormal<T: MultiPrecision>(v: &[[T; 3]; 3]) -> [[T; 3]; 3] {
    let (half, three) = (T::from(0.5), T::from(3.0));
    let gram = v.map(|a| v.map(|b| dot(&a, &b)));
    std::array::from_fn(|j| {
        std::array::from_fn(|i| {
            let weight = |k: usize| {
                if k == j {
                    three - gram[k][j]
                } else {
                    -gram[k][j]
                }
            };
            half * (v[0][i] * weight(0) + v[1][i] * weight(1) + v[2][i] * weight(2))
        })
    })
}

/// The component along an axis. Where this has zeros, as axes along those of B have, no product is taken.
fn along<T: MultiPrecision>(axis: &[T; 3], vector: &[T; 3]) -> T {
    let mut parts = (axis.iter().zip(vector))
        .filter(|(a, _)| a.rounded() != 0.0)
        .map(|(&a, &x)| a * x);
    let first = parts.next().unwrap_or_else(|| T::from(0.0));
    parts.fold(first, |sum, x| sum + x)
}

fn dot<T: MultiPrecision>(a: &[T; 3], b: &[T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_tensor_has_its_moments_to_twice_the_precision() {
        let tensor = Matrix3::new(4.0, -0.5, 0.25, -0.5, 5.0, 0.75, 0.25, 0.75, 6.0);
        let body = RigidBody::new(1.0, &tensor, &Vector3::zeros(), 0.0).expect("a body");
        let refined = RefinedPrincipal::of(&body);
        let [a, b, c] = refined.moments;
        // Trace, sum of principal minors and determinant are rational.
        assert!((a + b + c - 15.0.into()).rounded().abs() < 1e-30);
        let minors = (20.0 - 0.25) + (24.0 - 0.0625) + (30.0 - 0.5625);
        assert!((a * b + b * c + c * a - minors.into()).rounded().abs() < 1e-29);
        assert!((a * b * c - tensor.determinant().into()).rounded().abs() < 1e-13);
        for (axis, moment) in refined.axes.iter().zip(refined.moments) {
            for i in 0..3 {
                let row = [tensor[(i, 0)], tensor[(i, 1)], tensor[(i, 2)]].map(DoubleDouble::from);
                assert!((dot(&row, axis) - moment * axis[i]).rounded().abs() < 1e-30);
            }
        }
        assert!((refined.rounded_axes().determinant() - 1.0).abs() < 1e-15);
    }

    #[test]
    fn parallel_axes_are_exact() {
        let axes = *nalgebra::Rotation3::from_euler_angles(0.3, -1.0, 2.0).matrix();
        let center = Vector3::new(0.1, -0.2, 0.5);
        let body = RigidBody::from_principal(3.0, &[1.0, 2.0, 2.5], &axes, &center, 0.0);
        let refined = RefinedPrincipal::about(&body.expect("a body"), &Vector3::zeros());
        // Trace: the sum of the moments and 2 m d².
        let d = center.map(DoubleDouble::from);
        let square = d.x * d.x + d.y * d.y + d.z * d.z;
        let [a, b, c] = refined.moments;
        let trace = DoubleDouble::from(5.5) + square * 6.0.into();
        assert!((a + b + c - trace).rounded().abs() < 1e-30);
        // On the axis of symmetry: I_t + m d² twice, I_s.
        let body = RigidBody::from_principal(
            1.0,
            &[0.75, 0.75, 1.25],
            &Matrix3::identity(),
            &Vector3::new(0.0, 0.0, 0.1),
            0.0,
        );
        let refined = RefinedPrincipal::about(&body.expect("a body"), &Vector3::zeros());
        let across = DoubleDouble::from(0.75) + DoubleDouble::product(0.1, 0.1);
        assert_eq!(refined.moments, [across, across, 1.25.into()]);
        let rod = RigidBody::from_principal(
            2.0,
            &[0.0; 3],
            &Matrix3::identity(),
            &Vector3::new(0.1, 0.7, -0.3),
            0.0,
        );
        let refined = RefinedPrincipal::about(&rod.expect("a point"), &Vector3::zeros());
        assert_eq!(refined.moments[0], DoubleDouble::default());
    }

    #[test]
    fn what_differs_by_rounding_alone_is_alike() {
        let with = |a: f64, b: f64, more: f64| {
            let mut refined = RefinedPrincipal::from_principal(&[1.0, a, b], &Matrix3::identity());
            refined.moments[if a == 1.0 { 1 } else { 2 }] += more.into();
            refined.snap();
            refined
        };
        let are_equal = |refined: &RefinedPrincipal| {
            let [a, b, c] = refined.moments;
            (a == b, b == c)
        };
        let (less, more) = (0.9 * ALIKE, 1.1 * ALIKE);
        assert_eq!(are_equal(&with(1.0, 2.0, 2.0 * less)), (true, false));
        assert_eq!(are_equal(&with(1.0, 2.0, 2.0 * more)), (false, false));
        assert_eq!(are_equal(&with(1.5, 1.5, 1.5 * less)), (false, true));
        assert_eq!(are_equal(&with(1.5, 1.5, 1.5 * more)), (false, false));
        assert_eq!(are_equal(&with(1.0, 1.0, -0.5 * less)), (true, true));
        // Across the axis of symmetry.
        let top = with(1.0, 2.0, 0.0);
        let across = |x: f64| top.along(&[x, 0.0, 1.0].map(DoubleDouble::from))[0].rounded();
        assert_eq!((across(less), across(more)), (0.0, more));
        let scalene = with(1.5, 2.0, 0.0);
        let kept = scalene.along(&[less, 0.0, 1.0].map(DoubleDouble::from));
        assert_eq!(kept[0].rounded(), less);
    }

    #[test]
    fn moments_given_are_exact_and_axes_become_a_rotation() {
        let axes = *nalgebra::Rotation3::from_euler_angles(0.3, -1.0, 2.0).matrix();
        let refined = RefinedPrincipal::from_principal(&[1.0, 2.0, 2.5], &axes);
        assert_eq!(refined.moments.map(DoubleDouble::rounded), [1.0, 2.0, 2.5]);
        for (i, a) in refined.axes.iter().enumerate() {
            for (j, b) in refined.axes.iter().enumerate() {
                let exact = if i == j { 1.0 } else { 0.0 };
                assert!((dot(a, b) - exact.into()).rounded().abs() < 1e-30);
            }
        }
    }

    /// Between moments that nearly agree the axes of float64 are off by far more than their last digits.
    #[test]
    fn axes_of_a_nearly_symmetric_body_are_a_rotation_to_twice_the_precision() {
        let turn = *nalgebra::Rotation3::from_euler_angles(0.3, -1.0, 2.0).matrix();
        for gap in [1e-3, 1e-5, 1e-7, 1e-9] {
            let moments = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0 + gap, 1.5));
            let tensor = turn * moments * turn.transpose();
            let tensor = (tensor + tensor.transpose()) * 0.5;
            let body = RigidBody::new(1.0, &tensor, &Vector3::zeros(), 0.0).expect("a body");
            let refined = RefinedPrincipal::of(&body);
            for (i, a) in refined.axes.iter().enumerate() {
                for (j, b) in refined.axes.iter().enumerate() {
                    let exact = if i == j { 1.0 } else { 0.0 };
                    let off = (dot(a, b) - exact.into()).rounded();
                    assert!(off.abs() < 1e-29, "{gap:e} {off:e}");
                }
            }
        }
    }

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
