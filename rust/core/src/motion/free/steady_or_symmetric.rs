//! Motions whose elliptic functions are sines: the steady spin and the symmetric body.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use super::propagator::Secular;
use super::propagator::{AnySeries, Circular, EllipticArgument, Propagator};
use super::tumbling::hypotenuse;
use crate::mass::refined::Vector;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::theta::circular::{Jacobi, Shifted};

/// Theta functions of modulus zero: α′ = β′ = 1, (sn, cn, dn) = (sin, cos, 1).
fn sines() -> AnySeries {
    AnySeries::Circular(Circular {
        jacobi: Jacobi::new(0.0),
        alpha: Shifted::single(0.0),
        beta: Shifted::single(0.0),
    })
}

fn turns_of(radians: DoubleDouble) -> DoubleDouble {
    radians * DoubleDouble::PER_TURN
}

/// ω constant in the body, and so in space: `q(t) = q(0) ∘ (n sin ½|ω|t, cos ½|ω|t)`, n along ω.
pub(super) fn steady_spin(
    omega: &Vector3<f64>,
    attitude: &UnitQuaternion<f64>,
) -> (Propagator, Secular) {
    let rate = hypotenuse(&[omega.x, omega.y, omega.z].map(DoubleDouble::from));
    let n = if rate.high == 0.0 {
        Vector3::zeros()
    } else {
        omega / rate.high
    };
    let q = attitude.into_inner();
    let turned = q * Quaternion::from_imag(n);
    let zero = [0.0; 4];
    let propagator = Propagator {
        rate: turns_of(rate).scaled(0.5),
        clock: EllipticArgument::Periodic {
            rate: DoubleDouble::default(),
            start: DoubleDouble::default(),
        },
        series: sines(),
        sense: 1.0,
        ratio: 0.0,
        attitude: [
            zero,
            zero,
            [turned.i, turned.j, turned.k, turned.w],
            [q.i, q.j, q.k, q.w],
        ],
        omega: [[0.0; 3], [0.0; 3], [omega.x, omega.y, omega.z]],
        reach: f64::INFINITY,
    };
    let secular = Secular {
        half_period: f64::INFINITY.into(),
        mean_precession: rate,
        modulus: 0.0,
        complementary_modulus: 1.0,
    };
    (propagator, secular)
}

/// The symmetric body, `I_s` along its axis and `I_t` across it: ω circles the axis at the rate
/// `χ̇ = (I_s − I_t) ω_s/I_t`, seen from the body, and the body precesses about L at the rate `L/I_t`.
///
/// A body without moment along its axis is one whose `I_s` is zero and whose two others are their mean, from which they
/// differ by no more than rounding: its `ω_s` stays as it is, as for a thin symmetric rod.
pub(super) fn symmetric_body(
    moments: &Vector,
    w: &Vector,
    axes: &Matrix3<f64>,
    attitude: &UnitQuaternion<f64>,
) -> (Propagator, Secular) {
    let [i1, i2, i3] = *moments;
    let half = DoubleDouble::from(0.5);
    // Right-handed (x, y, z) with z the symmetry axis.
    let (along, across, [x, y, z]) = if i1 == i2 {
        (i3, i1, [0, 1, 2])
    } else {
        (i1, half * (i2 + i3), [1, 2, 0])
    };
    let rate = (along - across) / across * w[z];
    let momentum = hypotenuse(&[across * w[x], across * w[y], along * w[z]]);
    let precession = momentum / across;
    let sense = if (along - across).high < 0.0 {
        -1.0
    } else {
        1.0
    };
    // Directions in which ω_z ≥ 0 and ω_x ≥ 0.
    let sign = |k: usize| if w[k].high < 0.0 { -1.0 } else { 1.0 };
    let signs = [sign(x), sign(x) * sign(z), sign(z)];
    let internal = Matrix3::from_columns(&[
        axes.column(x) * signs[0],
        axes.column(y) * signs[1],
        axes.column(z) * signs[2],
    ]);
    let (wx, wy) = (w[x].abs().high, signs[1] * w[y].high);
    let [size, axial] = [wx.hypot(wy), w[z].abs().high];
    let angle = (sense * wy).atan2(wx);
    let (lateral, axial_part) = if momentum.high == 0.0 {
        (0.0, 1.0)
    } else {
        (
            across.high * size / momentum.high,
            along.high * axial / momentum.high,
        )
    };
    let circling = turns_of(rate.abs());
    let sensed = if sense < 0.0 { -circling } else { circling };
    let propagator = Propagator {
        // Half of μ − χ.
        rate: (turns_of(precession) - sensed).scaled(0.5),
        clock: EllipticArgument::Periodic {
            rate: circling,
            start: (angle / std::f64::consts::TAU).into(),
        },
        series: sines(),
        sense,
        ratio: lateral / (1.0 + axial_part),
        attitude: [[0.0; 4]; 4],
        omega: [
            (internal.column(1) * (sense * size)).into(),
            (internal.column(0) * size).into(),
            (internal.column(2) * axial).into(),
        ],
        reach: f64::INFINITY,
    }
    .starting_at(attitude, &internal);
    let secular = Secular {
        half_period: if rate.high == 0.0 {
            f64::INFINITY.into()
        } else {
            DoubleDouble::PI / rate.abs()
        },
        mean_precession: precession,
        modulus: 0.0,
        complementary_modulus: 1.0,
    };
    (propagator, secular)
}
