//! The turn of a free asymmetric body in a short time, by its power series.
//!
//! The closed form costs mostly the constants of the motion, which are others after every kick.

use nalgebra::Vector3;

/// The turn within which the series converges soon, in radians.
const REACH: f64 = 0.2;
/// So many times as far the closed form is sooner done.
const PARTS: f64 = 2.0;
/// Terms of the series: at the reach the next is below 2⁻⁶⁰ for all bodies, since |κ| ≤ 1.
const TERMS: usize = 26;
/// What is left out, beside one.
const REST: f64 = 4e-19;

/// What the quaternion (x, y, z, w) of the attitude gains in a free turn, as multiples of itself from the left: `q → q + q∘gain`.
///
/// `w`: ω times the time, components in principal axes; `kappa`: `(I₂ − I₃)/I₁` and cyclic. With coefficients that carry the
/// time,
///
/// ```text
/// (k+1) w₁,ₖ₊₁ = κ₁ Σ w₂,ⱼ w₃,ₖ₋ⱼ,   (k+1) qₖ₊₁ = ½ Σ qⱼ∘wₖ₋ⱼ
/// ```
///
/// `None` where the body turns too far.
pub(super) fn short_turn(kappa: &[f64; 3], w: &Vector3<f64>) -> Option<[f64; 4]> {
    let parts = (w.norm() / REACH).ceil().max(1.0);
    if parts.is_nan() || parts > PARTS {
        return None;
    }
    let (gain, later) = part(kappa, &(w / parts));
    if parts == 1.0 {
        return Some(gain);
    }
    // (1 + a)∘(1 + b) = 1 + a + b + a∘b.
    let (next, _) = part(kappa, &later);
    let both = product(&gain, &next);
    Some([0, 1, 2, 3].map(|i| gain[i] + (next[i] + both[i])))
}

/// The gain, and w at the end.
fn part(kappa: &[f64; 3], w: &Vector3<f64>) -> ([f64; 4], Vector3<f64>) {
    let mut ws = [[0.0; 4]; TERMS];
    let mut qs = [[0.0; 4]; TERMS];
    ws[0] = [w.x, w.y, w.z, 0.0];
    qs[0] = [0.0, 0.0, 0.0, 1.0];
    let mut count = 1;
    let mut last = f64::INFINITY;
    while count < TERMS {
        let (mut bent, mut turned) = ([0.0; 3], [0.0; 4]);
        for j in 0..count {
            let (a, b) = (&ws[j], &ws[count - 1 - j]);
            for (i, sum) in bent.iter_mut().enumerate() {
                *sum += a[(i + 1) % 3] * b[(i + 2) % 3];
            }
            let more = product(&qs[j], b);
            for (sum, more) in turned.iter_mut().zip(more) {
                *sum += more;
            }
        }
        let over = 1.0 / count as f64;
        for i in 0..3 {
            ws[count][i] = kappa[i] * bent[i] * over;
        }
        qs[count] = turned.map(|x| 0.5 * x * over);
        let size: f64 = (ws[count].iter().chain(&qs[count])).map(|x| x.abs()).sum();
        count += 1;
        if size + last < REST {
            break;
        }
        last = size;
    }
    // The small ones first.
    let (mut gain, mut later) = ([0.0; 4], [0.0; 4]);
    for k in (0..count).rev() {
        for i in 0..4 {
            later[i] += ws[k][i];
            gain[i] += if k == 0 { 0.0 } else { qs[k][i] };
        }
    }
    (gain, Vector3::new(later[0], later[1], later[2]))
}

/// The product of two quaternions (x, y, z, w).
pub(super) fn product(p: &[f64; 4], q: &[f64; 4]) -> [f64; 4] {
    let [a, b, c, d] = *p;
    let [x, y, z, w] = *q;
    [
        d * x + a * w + b * z - c * y,
        d * y - a * z + b * w + c * x,
        d * z + a * y - b * x + c * w,
        d * w - a * x - b * y - c * z,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass::refined::RefinedPrincipal;
    use crate::motion::free::FreeMotion;
    use nalgebra::{Matrix3, Quaternion, UnitQuaternion};

    #[test]
    fn as_the_closed_form() {
        let direction = |n: u32| {
            let x = f64::from(n);
            Vector3::new(x.sin(), (1.7 * x).cos(), (2.3 * x + 1.0).sin()).normalize()
        };
        for moments in [
            [1.0, 2.0, 2.5],
            [1e-6, 1.0, 1.000_000_9],
            [1.0, 2.0, 3.0],
            [1.0, 1.001, 1.002],
        ] {
            let [i1, i2, i3] = moments;
            let kappa = [(i2 - i3) / i1, (i3 - i1) / i2, (i1 - i2) / i3];
            let principal = RefinedPrincipal::from_principal(&moments, &Matrix3::identity());
            for n in 1..200 {
                let w = direction(n) * (f64::from(n) * 0.002);
                let [x, y, z, u] = short_turn(&kappa, &w).expect("near");
                let motion = FreeMotion::refined(&principal, &w, &UnitQuaternion::identity());
                let exact = motion.expect("finite").at(1.0).attitude;
                let found = Quaternion::new(1.0 + u, x, y, z);
                let error = (found - exact.into_inner()).norm();
                assert!(error < 6e-16, "{moments:?} {n} {error:e}");
            }
            assert_eq!(short_turn(&kappa, &direction(1)), None);
        }
    }
}
