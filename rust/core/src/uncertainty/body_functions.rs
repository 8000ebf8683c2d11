//! The ways to a body and from body to body, for numbers with derivatives.
//!
//! # Examples
//!
//! ```
//! use polhode::Error;
//! use polhode::mass::ten::{Size, Ten};
//! use polhode::mass::{Amount, solids};
//! use polhode::nalgebra::Matrix3;
//! use polhode::uncertainty::changes::TensorAbout;
//! use polhode::uncertainty::{
//!     Change, Follow, FromPositiveProducts, FromTensor, FromTensorAboutOrigin, Given, OfPolygon, OfShape, Rotated, Scaled,
//!     Shape, Source, follow,
//! };
//!
//! // The deviations of all ten numbers, where each of a body's has one.
//! let sigmas = [0.01, 1e-3, 1e-3, 1e-3, 0.02, 0.02, 0.02, 0.001, 0.001, 0.001];
//! let given = Given::independent(&sigmas, Source::fresh())?;
//! let values = [2.0, 0.5, 0.0, 0.0, 1.0, 1.2, 1.4, 0.1, 0.0, 0.0];
//! let numbers: Vec<_> = values.into_iter().zip(given.forms.iter().map(Vec::as_slice)).collect();
//! let deviation = |change: &dyn Fn() -> Result<polhode::uncertainty::Doubt, Error>, k: usize| -> Result<f64, Error> {
//!     let doubt = change()?;
//!     Ok(doubt.covariance_with(&doubt)[(k, k)].sqrt())
//! };
//! let from = Follow { bodies: &[], numbers: &numbers };
//! assert!((deviation(&|| follow(&FromTensor, from), 7)? - 0.001).abs() < 1e-17);
//! assert!((deviation(&|| follow(&FromPositiveProducts, from), 7)? - 0.001).abs() < 1e-17);
//! // I_C = I_O − m d²: the moment about y has the doubts of mass and place too.
//! let expected = (0.02_f64.powi(2) + (0.01 * 0.25_f64).powi(2) + (2.0 * 2.0 * 0.5 * 1e-3_f64).powi(2)).sqrt();
//! assert!((deviation(&|| follow(&FromTensorAboutOrigin, from), 5)? - expected).abs() < 1e-12);
//!
//! // From body to body: a mass scaled by 2 ± 0.1, a turn by a small angle, a tensor about another point.
//! let exact = polhode::uncertainty::Doubt::default();
//! let brick = Ten::of(&solids::cuboid(&[2.0, 1.0, 1.0], Amount::Mass(12.0))?);
//! let bodies = [(brick, &exact)];
//! let doubt = Given::independent(&[0.1], Source::fresh())?;
//! let scale = [(1.0, [].as_slice()), (2.0, &doubt.forms[0])];
//! let from = Follow { bodies: &bodies, numbers: &scale };
//! assert!((deviation(&|| follow(&Scaled, from), 0)? - 1.2).abs() < 1e-15);
//! let turn = [(0.0, [].as_slice()), (0.0, &[]), (0.0, &doubt.forms[0])];
//! let from = Follow { bodies: &bodies, numbers: &turn };
//! assert!((deviation(&|| follow(&Rotated(Matrix3::identity()), from), 7)? - 0.1 * 3.0).abs() < 1e-12); // (I_y − I_x) θ
//! let from = Follow { bodies: &bodies, numbers: &[] };
//! assert_eq!(deviation(&|| follow(&TensorAbout([1.0, 0.0, 0.0]), from), 5)?, 0.0);
//!
//! // From a shape's lengths, then the factor of its mass: a ball with a radius of 1 m ± 1 mm.
//! struct Ball;
//! impl Shape<1> for Ball {
//!     fn of<X: Size>(&self, [radius]: &[X; 1], amount: Amount) -> Result<X::Body, Error> {
//!         solids::sphere(*radius, amount)
//!     }
//! }
//! let radius = Given::independent(&[1e-3], Source::fresh())?;
//! let lengths = [(1.0, radius.forms[0].as_slice()), (1.0, &[])];
//! let from = Follow { bodies: &[], numbers: &lengths };
//! let change = OfShape(&Ball, Amount::Mass(5.0));
//! assert!((deviation(&|| follow(&change, from), 4)? - 2.0 * 2e-3).abs() < 1e-12); // 2/5 m r², so 2 I σ/r
//!
//! // From the corners of a triangle, one of which is known to a millimetre.
//! let corners = [(0.0, [].as_slice()), (0.0, &[]), (1.0, &radius.forms[0]), (0.0, &[]), (0.0, &[]), (1.0, &[]), (1.0, &[])];
//! let from = Follow { bodies: &[], numbers: &corners };
//! let change = OfPolygon(Amount::Density(2.0));
//! assert!((deviation(&|| follow(&change, from), 0)? - 1e-3).abs() < 1e-15); // ρ h σ/2
//! # Ok::<(), polhode::Error>(())
//! ```

use nalgebra::Matrix3;

use super::follow::Change;
use crate::error::Error;
use crate::mass::amount::Amount;
use crate::mass::ten::{ELEMENTS, Size, Ten};

/// A body from its ten numbers: m, C, the [`ELEMENTS`] of the tensor about C.
#[derive(Clone, Copy, Debug)]
pub struct FromTensor;

impl Change for FromTensor {
    fn of<X: Size<Body = Ten<X>>>(&self, _: &[Ten<X>], numbers: &[X]) -> Result<Ten<X>, Error> {
        Ok(Ten::from_array(&std::array::from_fn(|k| numbers[k])))
    }
}

/// A body from m, C, the moments about C and the *positive* products of inertia.
#[derive(Clone, Copy, Debug)]
pub struct FromPositiveProducts;

impl Change for FromPositiveProducts {
    fn of<X: Size<Body = Ten<X>>>(&self, _: &[Ten<X>], numbers: &[X]) -> Result<Ten<X>, Error> {
        Ok(Ten::from_array(&std::array::from_fn(|k| {
            if k < 7 { numbers[k] } else { -numbers[k] }
        })))
    }
}

/// A body from m, C and the [`ELEMENTS`] of the tensor about the origin.
#[derive(Clone, Copy, Debug)]
pub struct FromTensorAboutOrigin;

impl Change for FromTensorAboutOrigin {
    fn of<X: Size<Body = Ten<X>>>(&self, _: &[Ten<X>], numbers: &[X]) -> Result<Ten<X>, Error> {
        let given = Ten::from_array(&std::array::from_fn(|k| numbers[k]));
        let point = Ten {
            inertia: [X::zero(); 6],
            ..given
        };
        let shift = point.about([X::zero(); 3]);
        Ok(Ten {
            inertia: std::array::from_fn(|k| given.inertia[k] - shift[k]),
            ..given
        })
    }
}

/// A body from m, C and three principal moments about it, along the columns of a rotation.
#[derive(Clone, Copy, Debug)]
pub struct FromPrincipal(pub Matrix3<f64>);

impl Change for FromPrincipal {
    fn of<X: Size<Body = Ten<X>>>(&self, _: &[Ten<X>], numbers: &[X]) -> Result<Ten<X>, Error> {
        let [mass, cx, cy, cz, moments @ ..] = numbers else {
            return Err(Error::Empty { what: "moments" });
        };
        let element = |(i, j): (usize, usize)| {
            (moments.iter().enumerate()).fold(X::zero(), |sum, (k, &moment)| {
                sum + moment * (self.0[(i, k)] * self.0[(j, k)])
            })
        };
        Ok(Ten {
            mass: *mass,
            center: [*cx, *cy, *cz],
            inertia: ELEMENTS.map(element),
        })
    }
}

/// A body moved, by three numbers.
#[derive(Clone, Copy, Debug)]
pub struct Translated;

impl Change for Translated {
    fn of<X: Size<Body = Ten<X>>>(
        &self,
        bodies: &[Ten<X>],
        numbers: &[X],
    ) -> Result<Ten<X>, Error> {
        Ok(bodies[0].translated(std::array::from_fn(|k| numbers[k])))
    }
}

/// A body turned by a rotation, and then by three small angles θ about the fixed axes: `(1 + [θ]× + ½ [θ]×²) R`.
#[derive(Clone, Copy, Debug)]
pub struct Rotated(pub Matrix3<f64>);

impl Change for Rotated {
    fn of<X: Size<Body = Ten<X>>>(
        &self,
        bodies: &[Ten<X>],
        numbers: &[X],
    ) -> Result<Ten<X>, Error> {
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
pub struct Scaled;

impl Change for Scaled {
    fn of<X: Size<Body = Ten<X>>>(
        &self,
        bodies: &[Ten<X>],
        numbers: &[X],
    ) -> Result<Ten<X>, Error> {
        Ok(bodies[0].scaled(numbers[0], numbers[1]))
    }
}

/// A body with its tensor taken about a point of the body frame in place of C.
#[derive(Clone, Copy, Debug)]
pub struct TensorAbout(pub [f64; 3]);

impl Change for TensorAbout {
    fn of<X: Size<Body = Ten<X>>>(&self, bodies: &[Ten<X>], _: &[X]) -> Result<Ten<X>, Error> {
        Ok(Ten {
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

impl<S: Shape<N>, const N: usize> Change for OfShape<'_, S, N> {
    fn of<X: Size<Body = Ten<X>>>(&self, _: &[Ten<X>], numbers: &[X]) -> Result<Ten<X>, Error> {
        let lengths = std::array::from_fn(|k| numbers[k]);
        Ok(self.0.of(&lengths, self.1)?.scaled(X::one(), numbers[N]))
    }
}
