//! Standard deviations of what a body has, and where the first order is not enough for them.
//!
//! With `I = V diag(I_k) Vᵀ` and a change `W = Vᵀ δI V` of the tensor in its principal axes, to first order `δI_k = W_kk`, and
//! the axes turn by the small rotation φ about themselves with `[φ]×_ij = X_ij = W_ij/(I_j − I_i)`. To second order, along a
//! line on which the tensor is `Λ + ε W + ε² B`, with W° the part of W off the diagonal and `[P, Q] = P Q − Q P`,
//!
//! `Z = B + [W, X] − ½ [W°, X]`: the moments bend by `Z_kk`, the rotation by `Z_ij/(I_j − I_i)`.

use nalgebra::{Matrix3, Vector3};

use super::doubt::Doubt;
use super::variable::PROBES;
use crate::mass::body::RigidBody;
use crate::mass::ten::Ten;
use crate::principal::PrincipalAxes;
use crate::principal::derivative::DEGENERATE_RTOL;

/// A first-order deviation counts as right within a percent as long as the second-order terms have less than this fraction of
/// it: their squares add.
const LINEAR: f64 = 0.1;
/// Relative to the size of what is deviated from: smaller terms are rounding.
const ROUNDING: f64 = 1e-13;
/// An angle of more than this deviation, in radians, says nothing of where an axis is.
const ANYWHERE: f64 = 1.0;

/// Standard deviations of a body's numbers, and whether each is linear enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviations {
    /// Of the ten numbers.
    pub numbers: [f64; 10],
    /// Of the principal moments.
    pub moments: [f64; 3],
    /// Of the axes: of the small rotations about each of them, in radians; NaN where the axes are not determined.
    pub axes: [f64; 3],
    /// Whether the first order is enough for each of the ten numbers.
    pub is_linear: [bool; 10],
    /// For each of the moments.
    pub moments_are_linear: [bool; 3],
    /// For each of the angles.
    pub axes_are_linear: [bool; 3],
}

/// Standard deviations of mass, centre, tensor, principal moments and axes about C.
#[must_use]
pub fn deviations(body: &RigidBody, doubt: &Doubt) -> Deviations {
    let numbers = Ten::of(body);
    let principal = body.principal();
    let mut own = [Spread::default(); 10];
    let (mut moments, mut axes) = ([Spread::default(); 3], [Spread::default(); 3]);
    for (_, change) in &doubt.tangents {
        add(&mut own, change.to_array());
        let turned = Turned::of(&principal, &change.tensor());
        add(&mut moments, turned.moments());
        add(&mut axes, turned.angles());
    }
    for along in doubt.probes(&numbers) {
        bend(&mut own, along.map(|number| number.bend).to_array());
        let [slope, curve] = [
            along.map(|number| number.slope),
            along.map(|number| number.bend),
        ];
        let second = Turned::of(&principal, &slope.tensor()).bent(&curve.tensor());
        bend(&mut moments, second.moments());
        bend(&mut axes, second.angles());
    }
    // Of the two moments across each axis.
    let gaps = [(1, 2), (0, 2), (0, 1)].map(|(i, j)| {
        let gap = principal.moments[j] - principal.moments[i];
        if gap > DEGENERATE_RTOL * principal.moments[2] {
            gap
        } else {
            0.0
        }
    });
    let radius =
        (principal.moments[2] / numbers.mass).sqrt() + Vector3::from(numbers.center).norm();
    let size = |k: usize| match k {
        0 => numbers.mass,
        1..4 => radius,
        _ => principal.moments[2],
    };
    Deviations {
        numbers: own.map(|s| s.deviation()),
        moments: moments.map(|s| s.deviation()),
        axes: std::array::from_fn(|k| {
            let sigma = axes[k].deviation();
            let is_determined = gaps[k] > 0.0 && sigma < ANYWHERE;
            if is_determined { sigma } else { f64::NAN }
        }),
        is_linear: std::array::from_fn(|k| own[k].is_linear(size(k))),
        moments_are_linear: moments.map(|s| s.is_linear(principal.moments[2])),
        axes_are_linear: std::array::from_fn(|k| gaps[k] > 0.0 && axes[k].is_linear(1.0)),
    }
}

/// Squares of first- and of second-order terms.
#[derive(Clone, Copy, Debug, Default)]
pub struct Spread {
    first: f64,
    second: f64,
}

impl Spread {
    /// The standard deviation, to first order.
    #[must_use]
    pub fn deviation(self) -> f64 {
        self.first.sqrt()
    }

    /// Whether it is enough, for a number of this size.
    #[must_use]
    pub fn is_linear(self, size: f64) -> bool {
        let second = (self.second / PROBES as f64).sqrt();
        second <= LINEAR * self.deviation() + ROUNDING * size
    }
}

fn add<const N: usize>(sums: &mut [Spread; N], terms: [f64; N]) {
    for (sum, term) in sums.iter_mut().zip(terms) {
        sum.first += term * term;
    }
}

fn bend<const N: usize>(sums: &mut [Spread; N], terms: [f64; N]) {
    for (sum, term) in sums.iter_mut().zip(terms) {
        sum.second += term * term;
    }
}

/// A change of a tensor, in its principal axes.
struct Turned {
    /// W, or Z.
    change: Matrix3<f64>,
    /// `1/(I_j − I_i)`, infinite where they are equal.
    over: Matrix3<f64>,
    axes: Matrix3<f64>,
}

impl Turned {
    fn of(principal: &PrincipalAxes, change: &Matrix3<f64>) -> Self {
        let close = DEGENERATE_RTOL * principal.moments[2];
        let over = Matrix3::from_fn(|i, j| {
            let gap = principal.moments[j] - principal.moments[i];
            if gap.abs() <= close {
                f64::INFINITY
            } else {
                1.0 / gap
            }
        });
        Self {
            change: principal.axes.tr_mul(&(change * principal.axes)),
            over,
            axes: principal.axes,
        }
    }

    /// `X_ij`; infinite where it has to turn between equal moments.
    fn turn(&self, i: usize, j: usize) -> f64 {
        let w = self.change[(i, j)];
        if i == j || w == 0.0 {
            0.0
        } else {
            w * self.over[(i, j)]
        }
    }

    fn moments(&self) -> [f64; 3] {
        std::array::from_fn(|k| self.change[(k, k)])
    }

    /// φ.
    fn angles(&self) -> [f64; 3] {
        [self.turn(2, 1), self.turn(0, 2), self.turn(1, 0)]
    }

    /// Z, for the bend B of the tensor.
    fn bent(&self, bend: &Matrix3<f64>) -> Self {
        let turn = Matrix3::from_fn(|i, j| self.turn(i, j));
        let off = self.change - Matrix3::from_diagonal(&self.change.diagonal());
        let commutator = |p: &Matrix3<f64>| p * turn - turn * p;
        let own = self.axes.tr_mul(&(bend * self.axes));
        Self {
            change: own + commutator(&self.change) - commutator(&off) * 0.5,
            over: self.over,
            axes: self.axes,
        }
    }
}
