//! The ways to a body and from body to body, for numbers with derivatives.
//!
//! # Examples
//!
//! ```
//! use polhode::Error;
//! use polhode::mass::inertial_parameters::{Size, InertialParameters};
//! use polhode::mass::{Amount, solids};
//! use polhode::nalgebra::Matrix3;
//! use polhode::uncertainty::body_functions::TensorAbout;
//! use polhode::uncertainty::{
//!     BodyFunction, Inputs, FromPositiveProducts, FromTensor, FromTensorAboutOrigin, LinearForms, OfPolygon, OfShape, Rotation, Scaling,
//!     Shape, Source, propagate,
//! };
//!
//! // The deviations of all ten numbers, where each of a body's has one.
//! let sigmas = [0.01, 1e-3, 1e-3, 1e-3, 0.02, 0.02, 0.02, 0.001, 0.001, 0.001];
//! let given = LinearForms::independent(&sigmas, Source::fresh())?;
//! let values = [2.0, 0.5, 0.0, 0.0, 1.0, 1.2, 1.4, 0.1, 0.0, 0.0];
//! let numbers: Vec<_> = values.into_iter().zip(given.forms.iter().map(Vec::as_slice)).collect();
//! let deviation = |change: &dyn Fn() -> Result<polhode::uncertainty::LinearUncertainty, Error>, k: usize| -> Result<f64, Error> {
//!     let uncertainty = change()?;
//!     Ok(uncertainty.covariance_with(&uncertainty)[(k, k)].sqrt())
//! };
//! let from = Inputs { bodies: &[], numbers: &numbers };
//! assert!((deviation(&|| propagate(&FromTensor, from), 7)? - 0.001).abs() < 1e-17);
//! assert!((deviation(&|| propagate(&FromPositiveProducts, from), 7)? - 0.001).abs() < 1e-17);
//! // I_C = I_O − m d²: the moment about y has the uncertainties of mass and place too.
//! let expected = (0.02_f64.powi(2) + (0.01 * 0.25_f64).powi(2) + (2.0 * 2.0 * 0.5 * 1e-3_f64).powi(2)).sqrt();
//! assert!((deviation(&|| propagate(&FromTensorAboutOrigin, from), 5)? - expected).abs() < 1e-12);
//!
//! // From body to body: a mass scaled by 2 ± 0.1, a turn by a small angle, a tensor about another point.
//! let exact = polhode::uncertainty::LinearUncertainty::default();
//! let brick = InertialParameters::of(&solids::cuboid(&[2.0, 1.0, 1.0], Amount::Mass(12.0))?);
//! let bodies = [(brick, &exact)];
//! let uncertainty = LinearForms::independent(&[0.1], Source::fresh())?;
//! let scale = [(1.0, [].as_slice()), (2.0, &uncertainty.forms[0])];
//! let from = Inputs { bodies: &bodies, numbers: &scale };
//! assert!((deviation(&|| propagate(&Scaling, from), 0)? - 1.2).abs() < 1e-15);
//! let turn = [(0.0, [].as_slice()), (0.0, &[]), (0.0, &uncertainty.forms[0])];
//! let from = Inputs { bodies: &bodies, numbers: &turn };
//! assert!((deviation(&|| propagate(&Rotation(Matrix3::identity()), from), 7)? - 0.1 * 3.0).abs() < 1e-12); // (I_y − I_x) θ
//! let from = Inputs { bodies: &bodies, numbers: &[] };
//! assert_eq!(deviation(&|| propagate(&TensorAbout([1.0, 0.0, 0.0]), from), 5)?, 0.0);
//!
//! // From a shape's lengths, then the factor of its mass: a ball with a radius of 1 m ± 1 mm.
//! struct Ball;
//! impl Shape<1> for Ball {
//!     fn of<X: Size>(&self, [radius]: &[X; 1], amount: Amount) -> Result<X::Body, Error> {
//!         solids::sphere(*radius, amount)
//!     }
//! }
//! let radius = LinearForms::independent(&[1e-3], Source::fresh())?;
//! let lengths = [(1.0, radius.forms[0].as_slice()), (1.0, &[])];
//! let from = Inputs { bodies: &[], numbers: &lengths };
//! let change = OfShape(&Ball, Amount::Mass(5.0));
//! assert!((deviation(&|| propagate(&change, from), 4)? - 2.0 * 2e-3).abs() < 1e-12); // 2/5 m r², so 2 I σ/r
//!
//! // From the corners of a triangle, one of which is known to a millimetre.
//! let corners = [(0.0, [].as_slice()), (0.0, &[]), (1.0, &radius.forms[0]), (0.0, &[]), (0.0, &[]), (1.0, &[]), (1.0, &[])];
//! let from = Inputs { bodies: &[], numbers: &corners };
//! let change = OfPolygon(Amount::Density(2.0));
//! assert!((deviation(&|| propagate(&change, from), 0)? - 1e-3).abs() < 1e-15); // ρ h σ/2
//! # Ok::<(), polhode::Error>(())
//! ```

use nalgebra::Matrix3;

use super::propagate::BodyFunction;
use crate::error::Error;
use crate::mass::amount::Amount;
use crate::mass::inertial_parameters::{ELEMENTS, InertialParameters, Size};

/// A body from its ten numbers: m, C, the [`ELEMENTS`] of the tensor about C.
#[derive(Clone, Copy, Debug)]
pub struct FromTensor;

impl BodyFunction for FromTensor {
    fn of<X: Size<Body = InertialParameters<X>>>(
        &self,
        _: &[InertialParameters<X>],
        numbers: &[X],
    ) -> Result<InertialParameters<X>, Error> {
        Ok(InertialParameters::from_array(&std::array::from_fn(|k| {
            numbers[k]
        })))
    }
}

/// A body from m, C, the moments about C and the *positive* products of inertia.
#[derive(Clone, Copy, Debug)]
pub struct FromPositiveProducts;

impl BodyFunction for FromPositiveProducts {
    fn of<X: Size<Body = InertialParameters<X>>>(
        &self,
        _: &[InertialParameters<X>],
        numbers: &[X],
    ) -> Result<InertialParameters<X>, Error> {
        Ok(InertialParameters::from_array(&std::array::from_fn(|k| {
            if k < 7 { numbers[k] } else { -numbers[k] }
        })))
    }
}

/// A body from m, C and the [`ELEMENTS`] of the tensor about the origin.
#[derive(Clone, Copy, Debug)]
pub struct FromTensorAboutOrigin;

impl BodyFunction for FromTensorAboutOrigin {
    fn of<X: Size<Body = InertialParameters<X>>>(
        &self,
        _: &[InertialParameters<X>],
        numbers: &[X],
    ) -> Result<InertialParameters<X>, Error> {
        let given = InertialParameters::from_array(&std::array::from_fn(|k| numbers[k]));
        let point = InertialParameters {
            inertia: [X::zero(); 6],
            ..given
        };
        let shift = point.about([X::zero(); 3]);
        Ok(InertialParameters {
            inertia: std::array::from_fn(|k| given.inertia[k] - shift[k]),
            ..given
        })
    }
}

/// A body from m, C and three principal moments about it, along the columns of a rotation.
#[derive(Clone, Copy, Debug)]
pub struct FromPrincipal(pub Matrix3<f64>);

impl BodyFunction for FromPrincipal {
    fn of<X: Size<Body = InertialParameters<X>>>(
        &self,
        _: &[InertialParameters<X>],
        numbers: &[X],
    ) -> Result<InertialParameters<X>, Error> {
        let [mass, cx, cy, cz, moments @ ..] = numbers else {
            return Err(Error::Empty { what: "moments" });
        };
        let element = |(i, j): (usize, usize)| {
            (moments.iter().enumerate()).fold(X::zero(), |sum, (k, &moment)| {
                sum + moment * (self.0[(i, k)] * self.0[(j, k)])
            })
        };
        Ok(InertialParameters {
            mass: *mass,
            center: [*cx, *cy, *cz],
            inertia: ELEMENTS.map(element),
        })
    }
}

/// A body moved, by three numbers.
#[derive(Clone, Copy, Debug)]
pub struct Translation;

impl BodyFunction for Translation {
    fn of<X: Size<Body = InertialParameters<X>>>(
        &self,
        bodies: &[InertialParameters<X>],
        numbers: &[X],
    ) -> Result<InertialParameters<X>, Error> {
        Ok(bodies[0].translated(std::array::from_fn(|k| numbers[k])))
    }
}

/// A body turned by a rotation, and then by three small angles θ about the fixed axes: `(1 + [θ]× + ½ [θ]×²) R`.
#[derive(Clone, Copy, Debug)]
pub struct Rotation(pub Matrix3<f64>);

impl BodyFunction for Rotation {
    fn of<X: Size<Body = InertialParameters<X>>>(
        &self,
        bodies: &[InertialParameters<X>],
        numbers: &[X],
    ) -> Result<InertialParameters<X>, Error> {
        let (zero, one) = (X::zero(), X::one());
        let [x, y, z] = [numbers[0], numbers[1], numbers[2]];
        let cross = [[zero, -z, y], [z, zero, -x], [-y, x, zero]];
        let product = |a: [[X; 3]; 3], b: [[X; 3]; 3]| -> [[X; 3]; 3] {
            a.map(|row| {
                std::array::from_fn(|j| row[0] * b[0][j] + row[1] * b[1][j] + row[2] * b[2][j])
            })
        };
        let square = product(cross, cross);
        let small: [[X; 3]; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                (if i == j { one } else { zero }) + cross[i][j] + square[i][j] * 0.5
            })
        });
        let given = std::array::from_fn(|i| std::array::from_fn(|j| X::from(self.0[(i, j)])));
        Ok(bodies[0].rotated(&product(small, given)))
    }
}

/// A body scaled, by a factor of its lengths and one of its mass.
#[derive(Clone, Copy, Debug)]
pub struct Scaling;

impl BodyFunction for Scaling {
    fn of<X: Size<Body = InertialParameters<X>>>(
        &self,
        bodies: &[InertialParameters<X>],
        numbers: &[X],
    ) -> Result<InertialParameters<X>, Error> {
        Ok(bodies[0].scaled(numbers[0], numbers[1]))
    }
}

/// A body with its tensor taken about a point of the body frame in place of C.
#[derive(Clone, Copy, Debug)]
pub struct TensorAbout(pub [f64; 3]);

impl BodyFunction for TensorAbout {
    fn of<X: Size<Body = InertialParameters<X>>>(
        &self,
        bodies: &[InertialParameters<X>],
        _: &[X],
    ) -> Result<InertialParameters<X>, Error> {
        Ok(InertialParameters {
            inertia: bodies[0].about(self.0.map(X::from)),
            ..bodies[0]
        })
    }
}

/// A homogeneous shape with N lengths.
pub trait Shape<const N: usize> {
    /// What has these lengths and this amount of matter.
    ///
    /// # Errors
    /// When a length or the amount is outside its domain.
    fn of<X: Size>(&self, lengths: &[X; N], amount: Amount) -> Result<X::Body, Error>;
}

/// A shape from its N lengths and the factor by which its mass or density is another than this.
#[derive(Clone, Copy, Debug)]
pub struct OfShape<'a, S, const N: usize>(pub &'a S, pub Amount);

impl<S: Shape<N>, const N: usize> BodyFunction for OfShape<'_, S, N> {
    fn of<X: Size<Body = InertialParameters<X>>>(
        &self,
        _: &[InertialParameters<X>],
        numbers: &[X],
    ) -> Result<InertialParameters<X>, Error> {
        let lengths = std::array::from_fn(|k| numbers[k]);
        Ok(self.0.of(&lengths, self.1)?.scaled(X::one(), numbers[N]))
    }
}

// A lamina with corners, for coordinates with derivatives.

/// A polygon in the x-y plane from x, y of its corners in order, and the factor by which its mass or density is another than
/// this.
///
/// By Green's theorem, from the triangles that a first corner makes with each edge:
/// `∫ dA = Σ Δ`, `∫ r dA = Σ Δ (a + b)/3`, `∫ r rᵀ dA = Σ Δ (2 a aᵀ + a bᵀ + b aᵀ + 2 b bᵀ)/12`, with `Δ = ½ a × b`.
#[derive(Clone, Copy, Debug)]
pub struct OfPolygon(pub Amount);

impl BodyFunction for OfPolygon {
    fn of<X: Size<Body = InertialParameters<X>>>(
        &self,
        _: &[InertialParameters<X>],
        numbers: &[X],
    ) -> Result<InertialParameters<X>, Error> {
        let [corners @ .., factor] = numbers else {
            return Err(Error::Empty { what: "vertices" });
        };
        let start = [corners[0], corners[1]];
        let (mut area, mut first, mut second) = (X::zero(), [X::zero(); 2], [X::zero(); 3]);
        for edge in corners[2..]
            .chunks_exact(2)
            .zip(corners[4..].chunks_exact(2))
        {
            let [a, b] = [edge.0, edge.1].map(|r| [r[0] - start[0], r[1] - start[1]]);
            let triangle = (a[0] * b[1] - a[1] * b[0]) * 0.5;
            area += triangle;
            for k in 0..2 {
                first[k] += triangle * (a[k] + b[k]) / 3.0;
            }
            for (k, (i, j)) in [(0, 0), (1, 1), (0, 1)].into_iter().enumerate() {
                let products = (a[i] * a[j] + b[i] * b[j]) * 2.0 + a[i] * b[j] + b[i] * a[j];
                second[k] += triangle * products / 12.0;
            }
        }
        let per_area = match self.0 {
            Amount::Mass(mass) => X::from(mass) / area,
            // Corners may go round either way.
            Amount::Density(density) => X::from(density * area.rounded().signum()),
        } * *factor;
        let [x, y] = first.map(|sum| sum / area);
        let [xx, yy, xy] = [
            second[0] - area * x * x,
            second[1] - area * y * y,
            second[2] - area * x * y,
        ]
        .map(|moment| moment * per_area);
        let zero = X::zero();
        Ok(InertialParameters {
            mass: area * per_area,
            center: [start[0] + x, start[1] + y, zero],
            inertia: [yy, xx, xx + yy, -xy, zero, zero],
        })
    }
}
