//! ω at a time and its derivatives: by whole half periods, then by stretches of a clock over the rest.

use nalgebra::{Matrix3, Vector3};

use super::half_periods::{Periods, whole_off};
use crate::motion::free::clock::{HalfPeriod, JacobiFunctionsOfTime};
use crate::motion::free::invariants::Invariants;
use crate::numerics::jet::Jet;

/// ω at time zero and the moments.
type Slopes = Jet<6>;

/// The clock is set anew after so many units of 1/λ: where y, c and d are near their ends, terms cancel.
const STRETCH: f64 = 2.0;
/// Over so many units of 1/λ, on the separatrix, derivatives grow beyond float64.
const BEYOND: f64 = 700.0;

/// ω at a time and its derivatives by ω at time zero and by the moments.
pub(super) struct Rates {
    pub(super) omega: Vector3<f64>,
    pub(super) by_omega: Matrix3<f64>,
    pub(super) by_moments: Matrix3<f64>,
    /// ∫ω₂² dt.
    pub(super) middle_square: f64,
}

impl Invariants {
    /// ω at t with its derivatives: in stretches over what whole half periods leave of t, each from the exact ω at its
    /// beginning, then those half periods T, with `ω(t) = ω(t − nT)` but for signs.
    #[inline]
    pub(super) fn rates(&self, t: f64, omega_at: impl Fn(f64) -> Vector3<f64>) -> Rates {
        let half_period = self.half_period();
        let mut rates = Rates {
            omega: self.omega,
            by_omega: Matrix3::identity(),
            by_moments: Matrix3::zeros(),
            middle_square: 0.0,
        };
        let (periods, rest) = whole_off(t, half_period);
        let phase = (rest * self.rate_square().high.sqrt()).abs();
        if phase.is_nan() || phase > BEYOND {
            rates.by_omega.fill(f64::NAN);
            rates.by_moments.fill(f64::NAN);
            return rates;
        }
        let stretches = (phase / STRETCH).ceil().max(1.0);
        let clock = JacobiFunctionsOfTime::at(self, rest / stretches);
        let mut done = 0.0;
        while done < stretches {
            if done > 0.0 {
                rates.omega = omega_at(rest * (done / stretches));
            }
            rates.advance(self, &clock);
            done += 1.0;
        }
        rates.omega = omega_at(rest);
        if periods.count != 0.0 {
            rates.skip(self, &periods, half_period.high);
        }
        rates
    }

    /// p and q of an ω on the polhode, with their derivatives.
    #[inline]
    fn squares(&self, w: &[Slopes; 3]) -> [Slopes; 2] {
        let [a1, a2, a3] = self.contrast_slopes();
        let around_first = a3 * w[1] * w[1] + a2 * w[2] * w[2];
        let around_third = a2 * w[0] * w[0] + a1 * w[1] * w[1];
        [a1 * around_first, a3 * around_third]
    }

    /// The contrasts, with their derivatives by the moments.
    #[inline]
    fn contrast_slopes(&self) -> [Slopes; 3] {
        let i: [Slopes; 3] = std::array::from_fn(|k| Jet::variable(self.moments[k], 3 + k));
        let slopes = [
            (i[2] - i[1]) / i[0],
            (i[2] - i[0]) / i[1],
            (i[1] - i[0]) / i[2],
        ];
        std::array::from_fn(|k| {
            let value = self.contrasts[k];
            if self.moments[0] > 0.0 {
                Jet { value, ..slopes[k] }
            } else {
                let mut slopes = [0.0; 6];
                slopes[3..].fill(f64::NAN);
                Jet { slopes, value }
            }
        })
    }
}

impl Rates {
    /// By whole half periods `T`, back: `dω = −ω̇ n dT`, and the signs that an odd number gives.
    #[inline]
    fn skip(&mut self, motion: &Invariants, periods: &Periods, half_period: f64) {
        let whole = HalfPeriod::of(motion, half_period);
        let start = std::array::from_fn(|k| Jet::variable(motion.omega[k], k));
        let [p, q] = motion.squares(&start);
        let [b1, b2, b3] = motion.contrast_slopes();
        let gap = b2 * (b1 * start[2] * start[2] - b3 * start[0] * start[0]);
        let (larger, gap) = if motion.circles_third() {
            (p, gap)
        } else {
            (q, -gap)
        };
        let later = Jet::chain(0.0, [(whole.by_larger, &larger), (whole.by_gap, &gap)]).slopes;
        let [a1, a2, a3] = motion.contrasts;
        let [x, y, z] = self.omega.into();
        let rate = Vector3::new(-a1 * y * z, a2 * z * x, -a3 * x * y) * -periods.count;
        self.by_omega += rate * Vector3::new(later[0], later[1], later[2]).transpose();
        self.by_moments += rate * Vector3::new(later[3], later[4], later[5]).transpose();
        self.middle_square +=
            motion.around_first * motion.around_third * whole.square_integral * periods.count;
        if periods.are_odd {
            let [k, _] = motion.planar_axes();
            for row in [k, 1] {
                self.omega[row] *= -1.0;
                self.by_omega.row_mut(row).neg_mut();
                self.by_moments.row_mut(row).neg_mut();
            }
        }
    }

    /// By the time of a clock that is set to zero now.
    #[inline]
    fn advance(&mut self, motion: &Invariants, clock: &JacobiFunctionsOfTime) {
        let w: [Slopes; 3] = std::array::from_fn(|k| Jet::variable(self.omega[k], k));
        let [a1, a2, a3] = motion.contrast_slopes();
        let [p, q] = motion.squares(&w);
        let [y, c, d] = std::array::from_fn(|k| {
            Jet::chain(
                clock.value[k],
                [(clock.by_short[k], &p), (clock.by_long[k], &q)],
            )
        });
        let starts = [-(a1 * w[1] * w[2]), a2 * w[2] * w[0], -(a3 * w[0] * w[1])];
        let divisor = if motion.circles_third() {
            c * c + a1 * a2 * w[2] * w[2] * y * y
        } else {
            d * d + a2 * a3 * w[0] * w[0] * y * y
        };
        let later = [
            (w[0] * c + starts[0] * y * d) / divisor,
            (w[1] * c * d + starts[1] * y) / divisor,
            (w[2] * d + starts[2] * y * c) / divisor,
        ];
        let slopes = |first: usize| Matrix3::from_fn(|i, j| later[i].slopes[first + j]);
        self.by_moments = slopes(0) * self.by_moments + slopes(3);
        self.by_omega = slopes(0) * self.by_omega;
        self.middle_square += motion.around_first * motion.around_third * clock.square_integral
            + self.omega.y * later[1].value * clock.value[0];
        self.omega = Vector3::from(later.map(|rate| rate.value));
    }
}
