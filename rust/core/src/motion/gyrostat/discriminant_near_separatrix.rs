//! The one number that decides next to a separatrix, in four times the precision.
//!
//! There two zeros of the pencil nearly meet, and all but their difference is known well enough. Between them the pencil is
//! extreme, so that its value there depends little on the place. It is computed from what defines the body: moments, or a
//! tensor whose axes then need not be known.

use nalgebra::Vector3;

use super::pencil::PencilValue;
use super::start::Start;
use crate::mass::refined::{RefinedPrincipal, Vector};
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::quad_double::QuadDouble;

type QuadVector = [QuadDouble; 3];

/// Moments, or the rows of a tensor.
enum Inertia {
    Moments(QuadVector),
    Tensor([QuadVector; 3]),
}

/// The pencil of a body, ω and h (in B) at y, in the units of the start; `unit` is that of the moments.
pub(super) fn value_near_separatrix(
    principal: &RefinedPrincipal,
    unit: f64,
    omega: &Vector3<f64>,
    rotor: &Vector,
    start: &Start,
    y: DoubleDouble,
) -> PencilValue {
    let omega = [omega.x, omega.y, omega.z].map(QuadDouble::from);
    let rotor = rotor.map(QuadDouble::from);
    let (inertia, omega, rotor) = if let Some(rows) = principal.tensor() {
        let rows = rows.map(|row| row.map(|x| x.scaled(unit)));
        (Inertia::Tensor(rows), omega, rotor)
    } else {
        let finest = principal.finest();
        (
            Inertia::Moments(finest.moments.map(|moment| moment.scaled(unit))),
            finest.components(&omega),
            finest.components(&rotor),
        )
    };
    let turned = inertia.times(&omega);
    let momentum: QuadVector = std::array::from_fn(|k| turned[k] + rotor[k]);
    let length = start.momentum;
    // x from that place whose r is across L, which is known to twice the precision alone.
    let mut x = QuadDouble::from(start.along / length);
    let across: QuadVector = std::array::from_fn(|k| x * momentum[k] - omega[k]);
    let beside = dot(&momentum, &across).twofold() / length;
    let step = QuadDouble::from((y.scaled(start.unit) - beside) / length);
    x = x + step;
    let r: QuadVector = std::array::from_fn(|k| across[k] + step * momentum[k]);
    let (value, terms) = inertia.form(x, &r);
    let [i1, i2, i3] = principal.moments.map(|moment| moment.scaled(unit));
    // The pencil of the start has the determinant of 1/I in it, and a unit for each zero.
    let scale = length * length / (i1 * i2 * i3);
    let power = start.unit.powi(-4);
    PencilValue {
        value: (value.twofold() * scale).scaled(power),
        terms: terms * scale.high * power,
    }
}

impl Inertia {
    /// `I v`.
    fn times(&self, v: &QuadVector) -> QuadVector {
        match self {
            Self::Moments(moments) => std::array::from_fn(|k| moments[k] * v[k]),
            Self::Tensor(rows) => rows.map(|row| dot(&row, v)),
        }
    }

    /// `rᵀ I adj(1 − x I) r`, and the sizes of its terms.
    fn form(&self, x: QuadDouble, r: &QuadVector) -> (QuadDouble, f64) {
        let one = QuadDouble::from(1.0);
        let image = self.times(r);
        match self {
            Self::Moments(moments) => {
                let u = moments.map(|moment| one - x * moment);
                let parts: QuadVector =
                    std::array::from_fn(|k| image[k] * r[k] * (u[(k + 1) % 3] * u[(k + 2) % 3]));
                (parts[0] + parts[1] + parts[2], sizes(&parts))
            }
            Self::Tensor(rows) => {
                let element = |i: usize, j: usize| {
                    let part = x * rows[i][j];
                    if i == j { one - part } else { -part }
                };
                let [u11, u22, u33] = [0, 1, 2].map(|k| element(k, k));
                let [u12, u23, u13] = [(0, 1), (1, 2), (0, 2)].map(|(i, j)| element(i, j));
                let [c12, c13, c23] = [
                    u13 * u23 - u12 * u33,
                    u12 * u23 - u13 * u22,
                    u12 * u13 - u11 * u23,
                ];
                let adjugate = [
                    [u22 * u33 - u23 * u23, c12, c13],
                    [c12, u11 * u33 - u13 * u13, c23],
                    [c13, c23, u11 * u22 - u12 * u12],
                ];
                let largest = sizes(&[u11, u22, u33]).max(sizes(&[u12, u23, u13]));
                (
                    dot(&image, &adjugate.map(|row| dot(&row, r))),
                    sizes(&image) * sizes(r) * largest * largest,
                )
            }
        }
    }
}

fn dot(a: &QuadVector, b: &QuadVector) -> QuadDouble {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn sizes(v: &QuadVector) -> f64 {
    v.iter().map(|x| x.rounded().abs()).sum()
}
