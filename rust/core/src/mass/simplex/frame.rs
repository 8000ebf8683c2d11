//! Where the coordinates of a sum are taken from, and how exactly.

use nalgebra::{Matrix3, Vector3};

use super::vectors::dot;
use crate::numerics::lane::{Double, Lane};

/// Where coordinates are taken from: `Vᵀ (r − reference)/unit`.
#[derive(Clone, Copy, Debug)]
pub(in crate::mass) struct LocalFrame {
    pub(in crate::mass) reference: Vector3<f64>,
    /// A power of two, so that nothing is rounded: lengths of 1e±150 have fifth powers too.
    pub(in crate::mass) unit: f64,
    /// V, a rotation; `None` is the body axes.
    pub(in crate::mass) axes: Option<Matrix3<f64>>,
}

impl LocalFrame {
    /// In the middle of a box, in units of its size.
    pub(in crate::mass) fn of_box(low: &Vector3<f64>, high: &Vector3<f64>) -> Self {
        let size = (high * 0.5 - low * 0.5).max();
        // Of a denormal size the least normal power, whose reciprocal is a number.
        let power = f64::from_bits(size.to_bits() & 0x7ff0_0000_0000_0000).max(f64::MIN_POSITIVE);
        Self {
            reference: low * 0.5 + high * 0.5,
            unit: if power.is_finite() && size > 0.0 {
                power
            } else {
                1.0
            },
            axes: None,
        }
    }

    /// One point in it.
    pub(in crate::mass) fn place(&self, point: &[f64; 3]) -> Vector3<f64> {
        let r = point.map(Double::<false>::new);
        let placed = match &self.axes {
            None => Shifted::of(self).place(r),
            Some(axes) => Turned::of(self, axes).place(r),
        };
        Vector3::from(placed.map(Lane::get))
    }
}

/// How corners are placed in a frame.
pub(super) trait Place: Copy {
    fn place<L: Lane>(&self, r: [L; 3]) -> [L; 3];
}

/// `(r − reference)/unit`.
#[derive(Clone, Copy)]
pub(super) struct Shifted {
    reference: [f64; 3],
    inverse: f64,
}

impl Shifted {
    pub(super) fn of(frame: &LocalFrame) -> Self {
        Self {
            reference: frame.reference.into(),
            inverse: 1.0 / frame.unit,
        }
    }
}

impl Place for Shifted {
    #[inline(always)]
    fn place<L: Lane>(&self, r: [L; 3]) -> [L; 3] {
        let inverse = L::new(self.inverse);
        let [x, y, z] = self.reference;
        [
            (r[0] - L::new(x)) * inverse,
            (r[1] - L::new(y)) * inverse,
            (r[2] - L::new(z)) * inverse,
        ]
    }
}

/// `Vᵀ (r − reference)/unit` with the rounding errors of difference and products carried along: across the thin direction
/// large terms cancel, and what is left must be that of the stored coordinates.
#[derive(Clone, Copy)]
pub(super) struct Turned {
    reference: [f64; 3],
    inverse: f64,
    axes: [[f64; 3]; 3],
}

impl Turned {
    pub(super) fn of(frame: &LocalFrame, axes: &Matrix3<f64>) -> Self {
        Self {
            reference: frame.reference.into(),
            inverse: 1.0 / frame.unit,
            axes: axes.data.0,
        }
    }
}

impl Place for Turned {
    #[inline(always)]
    fn place<L: Lane>(&self, r: [L; 3]) -> [L; 3] {
        let inverse = L::new(self.inverse);
        let [x, y, z] = self.reference;
        let ((x, x_low), (y, y_low), (z, z_low)) = (
            two_sum(r[0] * inverse, L::new(-x * self.inverse)),
            two_sum(r[1] * inverse, L::new(-y * self.inverse)),
            two_sum(r[2] * inverse, L::new(-z * self.inverse)),
        );
        // No `map`: its closure would be compiled without the instructions of the level.
        let mut placed = r;
        for (coordinate, [a, b, c]) in placed.iter_mut().zip(self.axes) {
            let (a, b, c) = (L::new(a), L::new(b), L::new(c));
            let ((p, e), (q, f), (r, g)) =
                (two_product(x, a), two_product(y, b), two_product(z, c));
            let (partial, h) = two_sum(p, q);
            let (sum, i) = two_sum(partial, r);
            let low = dot([x_low, y_low, z_low], [a, b, c]);
            *coordinate = sum + (low + (e + f + g) + (h + i));
        }
        placed
    }
}

#[inline(always)]
fn two_sum<L: Lane>(a: L, b: L) -> (L, L) {
    let s = a + b;
    let t = s - a;
    (s, (a - (s - t)) + (b - t))
}

#[inline(always)]
fn two_product<L: Lane>(a: L, b: L) -> (L, L) {
    let p = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    // Each of these products is exact, fused or not.
    let rest = a_low * b_high;
    let rest = ((a_high * b_high - p) + a_high * b_low) + rest;
    (p, rest + a_low * b_low)
}

#[inline(always)]
fn split<L: Lane>(a: L) -> (L, L) {
    let scaled = L::new(134_217_729.0) * a; // 2^27 + 1
    let high = scaled - (scaled - a);
    (high, a - high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_coordinate_keeps_what_large_terms_leave() {
        // Across a line through both points the exact coordinate is 2⁻⁶⁰ times a component of the axis.
        let third = 1.0 / 3.0_f64.sqrt();
        let axes = Matrix3::new(
            third,
            0.5_f64.sqrt(),
            0.0,
            third,
            -(0.5_f64.sqrt()),
            0.0,
            third,
            0.0,
            1.0,
        );
        let frame = LocalFrame {
            reference: Vector3::repeat(0.1),
            unit: 1.0,
            axes: Some(axes),
        };
        let tiny = 2.0_f64.powi(-50);
        let r = [1.1 + tiny, 1.1, 7.0].map(Double::<false>::new);
        let placed = Turned::of(&frame, &axes).place(r);
        let step = (1.1 + tiny) - 1.1;
        assert_eq!(placed[1].get(), step * 0.5_f64.sqrt());
    }

    #[test]
    fn the_unit_is_a_power_of_two_of_any_size() {
        for size in [1e-306, 3e-5, 1.0, 7e200, 1.7e308] {
            let frame = LocalFrame::of_box(&Vector3::zeros(), &Vector3::repeat(size));
            assert!((0.5..=1.0).contains(&(size / 2.0 / frame.unit / 2.0)));
        }
        let denormal = LocalFrame::of_box(&Vector3::zeros(), &Vector3::repeat(1e-310));
        assert_eq!(denormal.unit, f64::MIN_POSITIVE);
        let nothing = LocalFrame::of_box(&Vector3::zeros(), &Vector3::zeros());
        assert_eq!(nothing.unit, 1.0);
    }
}
