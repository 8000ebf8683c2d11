//! ω from the products of the two theta functions.

use nalgebra::UnitQuaternion;

use super::products::Ratios;
use super::start::Start;
use crate::mass::refined::{RefinedPrincipal, Vector};
use crate::numerics::complex::Complex;
use crate::numerics::double_double::DoubleDouble;

type Number = Complex<DoubleDouble>;

/// What a motion is made from, in the units of the start.
pub(super) struct Given<'a> {
    /// Principal moments.
    pub(super) moments: &'a Vector,
    /// h along the principal axes.
    pub(super) rotor: &'a Vector,
    pub(super) principal: &'a RefinedPrincipal,
    pub(super) attitude: &'a UnitQuaternion<f64>,
}

/// Moments that are further apart than that are those of a slender body.
const SLENDER: f64 = 16.0;

impl Given<'_> {
    /// Whether roundings of the products may count for more than others: as many times as the moments are apart.
    pub(super) fn is_slender(&self) -> bool {
        SLENDER * self.moments[0].high < self.moments[2].high
    }
}

/// `u†σu`, `v†σv`, `u†σv` of both columns, with `u†u` and so on as the fourth of each.
pub(super) struct Squares {
    even: [Number; 4],
    odd: [Number; 4],
    mixed: [Number; 4],
}

pub(super) fn squares([u, v]: &[[Number; 2]; 2]) -> Squares {
    let product = |u: &[Number; 2], v: &[Number; 2]| {
        let [a, b] = u.map(Complex::conjugate);
        let (ab, ba) = (a * v[1], b * v[0]);
        let (aa, bb) = (a * v[0], b * v[1]);
        [ab + ba, (ba - ab).times_i(), aa - bb, aa + bb]
    };
    Squares {
        even: product(u, u),
        odd: product(v, v),
        mixed: product(u, v),
    }
}

/// From the products of the two theta functions to D ω: `ω_i = (|L| n_i − h_i)/I_i` along the principal axes, `D n = χ†σχ`. The
/// products are the four series of `ratios` where they are given.
pub(super) fn omega(
    given: &Given<'_>,
    start: &Start,
    squares: &Squares,
    ratios: Option<&Ratios>,
) -> [[f64; 3]; 4] {
    // 2 Re (Θ̄ₑΘₒ u†σv).
    let parts: [[DoubleDouble; 4]; 4] = std::array::from_fn(|k| {
        let (both, mixed) = ([squares.even[k].re, squares.odd[k].re], squares.mixed[k]);
        match ratios {
            Some(ratios) => ratios.before(both, mixed),
            None => [
                both[0],
                both[1],
                mixed.re.scaled(2.0),
                -mixed.im.scaled(2.0),
            ],
        }
    });
    std::array::from_fn(|row| {
        let [x, y, z, square] = parts.map(|part| part[row]);
        let along: Vector = std::array::from_fn(|i| {
            let [e1, e2, n] = start.frame.map(|axis| axis[i]);
            let sum = start.momentum * (x * e1 + y * e2 + z * n) - given.rotor[i] * square;
            sum / given.moments[i]
        });
        given.principal.in_body(&along).map(DoubleDouble::rounded)
    })
}
