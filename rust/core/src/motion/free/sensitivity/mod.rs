//! What a small change at the start, or of the moments, has become at a time t: exact, at any t.
//!
//! ω(t) is a rational function of ω(0), of the contrasts and of three elliptic [functions of time](super::clock), which are
//! smooth in all of them, so its derivatives follow by the rules. The attitude needs no integral of the third kind. Write
//! its change as a small rotation `δ`, components in B, `R → R exp(δ×)`:
//!
//! - across L: `L_N = R I ω` is constant, so its change is what it was at the start, `δ×L + I δω + δI ω` turned into the
//!   present body axes;
//! - along L: `d(δ·L)/dt = L·δω = δT − ½ ω·δI ω`, hence `δ·L = (δ·L)₀ + t δT − ½ Σ δI_k ∫ω_k² dt`.
//!
//! The integrals of `ω_k²` are of the second kind; they have the addition theorem
//! `∫ω₂² dt = A₁A₃ ∫y² dt + ω₂(0) ω₂(t) y`, and `α₂ω₁² + α₁ω₂² = A₃`, `α₃ω₂² + α₂ω₃² = A₁` give the others.

#[cfg(test)]
mod tests;

use nalgebra::{Matrix3, SMatrix, UnitQuaternion, Vector3};

use super::FreeMotion;
use super::clock::{Clock, HalfPeriod};
use super::invariants::Invariants;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::jet::Jet;

/// Derivatives of the state of a free body at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensitivity {
    /// Of (δ, ω) at the time by (δ, ω) at time zero: δ is a small rotation of the body from its attitude, components in
    /// the body frame as it stands at either time, ω likewise in the body frame.
    pub state: SMatrix<f64, 6, 6>,
    /// Of (δ, ω) at the time by the principal moments, ascending, with axes and initial state held. NaN for a body with a
    /// zero moment, which has no neighbours on one side.
    pub moments: SMatrix<f64, 6, 3>,
}

/// ω at time zero and the moments.
type Slopes = Jet<6>;

/// The clock is set anew after so many units of 1/λ: where y, c and d are near their ends, terms cancel.
const STRETCH: f64 = 2.0;
/// Over so many units of 1/λ, on the separatrix, derivatives grow beyond float64.
const BEYOND: f64 = 700.0;

impl FreeMotion {
    /// The derivatives of the state at the time t.
    #[must_use]
    pub fn sensitivity(&self, t: f64) -> Sensitivity {
        let motion = Invariants::of_motion(self);
        self.scaled_sensitivity(&motion, t)
            .in_units_of(motion.inertia_unit, motion.rate_unit)
    }

    /// In the units of the motion: however large or small those of the arguments are, this is of the order of the turns made.
    pub(super) fn scaled_sensitivity(&self, motion: &Invariants, t: f64) -> Sensitivity {
        let attitudes = [&self.initial.attitude, &self.at(t).attitude];
        motion.sensitivity(t, &self.axes, attitudes, |t| self.at(t).omega)
    }
}

impl Sensitivity {
    /// From the units of a motion to those of its arguments: δ has no unit.
    fn in_units_of(mut self, inertia_unit: f64, rate_unit: f64) -> Self {
        self.moments /= inertia_unit;
        (self.state.fixed_view_mut::<3, 3>(0, 3)).apply(|x| *x /= rate_unit);
        (self.state.fixed_view_mut::<3, 3>(3, 0)).apply(|x| *x *= rate_unit);
        (self.moments.fixed_view_mut::<3, 3>(3, 0)).apply(|x| *x *= rate_unit);
        self
    }
}

impl Invariants {
    /// At the time t; the columns of `axes` are the principal axes, `start` is the attitude at time zero, `now` the one at t.
    /// `omega_at` is ω at any time, in B.
    ///
    /// In units of the rate of the motion the error is a few ε of the largest derivative: not more near the separatrix,
    /// where derivatives grow as exp(λt), nor for symmetric bodies or steady spins. For a needle that turns about its own
    /// axis, it is that times `I₃ω/L`. NaN where derivatives are beyond float64, far out on the separatrix.
    fn sensitivity(
        &self,
        t: f64,
        axes: &Matrix3<f64>,
        [start, now]: [&UnitQuaternion<f64>; 2],
        omega_at: impl Fn(f64) -> Vector3<f64>,
    ) -> Sensitivity {
        let turn = (now.conjugate() * start).to_rotation_matrix().into_inner();
        // Of vectors in principal axes at the start to those at t.
        let turn = axes.tr_mul(&(turn * axes));
        let unit = self.rate_unit;
        let t = t * unit;
        let (by_start, by_moments) = if self.momentum == 0.0 {
            // A body at rest stays there, whatever its moments.
            let at_rest = self.omega == Vector3::zeros();
            let by_moments = SMatrix::repeat(if at_rest { 0.0 } else { f64::NAN });
            (without_momentum(t, &turn), by_moments)
        } else {
            self.in_principal_axes(t, &turn, |t| axes.tr_mul(&omega_at(t / unit)) / unit)
        };
        let mut both = SMatrix::<f64, 6, 6>::zeros();
        both.fixed_view_mut::<3, 3>(0, 0).copy_from(axes);
        both.fixed_view_mut::<3, 3>(3, 3).copy_from(axes);
        Sensitivity {
            state: both * by_start * both.transpose(),
            moments: both * by_moments,
        }
    }

    fn in_principal_axes(
        &self,
        t: f64,
        turn: &Matrix3<f64>,
        omega_at: impl Fn(f64) -> Vector3<f64>,
    ) -> (SMatrix<f64, 6, 6>, SMatrix<f64, 6, 3>) {
        let rates = self.rates(t, omega_at);
        let later = rates.omega;
        let squares = self.square_integrals(t, rates.middle_square);
        let inertia = Vector3::from(self.moments);
        let (before, after) = (
            inertia.component_mul(&self.omega),
            inertia.component_mul(&later),
        );
        // δ at t of a change L_N at the start, in the principal axes there, of d(I ω) at t and of d(δ·L) at t.
        let attitude = |change: Vector3<f64>, own: Vector3<f64>, along: f64| {
            (after.cross(&(turn * change - own)) + after * along) / after.norm_squared()
        };
        let mut state = SMatrix::<f64, 6, 6>::zeros();
        let mut moments = SMatrix::<f64, 6, 3>::zeros();
        for k in 0..3 {
            let axis = Vector3::ith(k, 1.0);
            let tilted = attitude(axis.cross(&before), Vector3::zeros(), before[k]);
            state.fixed_view_mut::<3, 1>(0, k).copy_from(&tilted);

            let own: Vector3<f64> = rates.by_omega.column(k).into();
            let faster = attitude(
                axis * self.moments[k],
                inertia.component_mul(&own),
                t * before[k],
            );
            state.fixed_view_mut::<3, 1>(0, 3 + k).copy_from(&faster);
            state.fixed_view_mut::<3, 1>(3, 3 + k).copy_from(&own);

            let own: Vector3<f64> = rates.by_moments.column(k).into();
            let along = 0.5 * (t * self.omega[k] * self.omega[k] - squares[k]);
            let momentum = inertia.component_mul(&own) + axis * later[k];
            let heavier = attitude(axis * self.omega[k], momentum, along);
            moments.fixed_view_mut::<3, 1>(0, k).copy_from(&heavier);
            moments.fixed_view_mut::<3, 1>(3, k).copy_from(&own);
        }
        (state, moments)
    }

    /// ω at t with its derivatives: in stretches over what whole half periods leave of t, each from the exact ω at its
    /// beginning, then those half periods T, with `ω(t) = ω(t − nT)` but for signs.
    fn rates(&self, t: f64, omega_at: impl Fn(f64) -> Vector3<f64>) -> Rates {
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
        let clock = Clock::at(self, rest / stretches);
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
            rates.skip(self, &periods);
        }
        rates
    }

    /// `∫₀ᵗ ω_k² dt`, from that of ω₂².
    fn square_integrals(&self, t: f64, middle: f64) -> [f64; 3] {
        let [a1, a2, a3] = self.contrasts;
        let [first, second, third] = self.omega.component_mul(&self.omega).into();
        if a2 == 0.0 {
            return [first * t, second * t, third * t];
        }
        let excess = second * t - middle;
        [
            first * t + a1 / a2 * excess,
            middle,
            third * t + a3 / a2 * excess,
        ]
    }

    /// p and q of an ω on the polhode, with their derivatives.
    fn squares(&self, w: &[Slopes; 3]) -> [Slopes; 2] {
        let [a1, a2, a3] = self.contrast_slopes();
        let around_first = a3 * w[1] * w[1] + a2 * w[2] * w[2];
        let around_third = a2 * w[0] * w[0] + a1 * w[1] * w[1];
        [a1 * around_first, a3 * around_third]
    }

    /// The contrasts, with their derivatives by the moments.
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
                Jet { value, slopes }
            }
        })
    }
}

/// Half periods that a time holds: how many, and whether that is an odd number, which beyond 2⁵³ the first does not tell.
struct Periods {
    count: f64,
    are_odd: bool,
}

/// From this many half periods on their number is not known to one at the first attempt.
const MANY: f64 = 4.5e15; // 2⁵²

/// The time but for whole half periods, and these.
fn whole_off(t: f64, half_period: DoubleDouble) -> (Periods, f64) {
    let mut rest = DoubleDouble::from(t);
    let mut periods = Periods {
        count: 0.0,
        are_odd: false,
    };
    loop {
        let count = (rest.high / half_period.high).round();
        if count == 0.0 || !count.is_finite() {
            return (periods, rest.high);
        }
        rest -= half_period * count.into();
        periods.count += count;
        periods.are_odd ^= count % 2.0 != 0.0;
        if count.abs() < MANY {
            return (periods, rest.high);
        }
    }
}

/// ω at a time and its derivatives by ω at time zero and by the moments.
struct Rates {
    omega: Vector3<f64>,
    by_omega: Matrix3<f64>,
    by_moments: Matrix3<f64>,
    /// ∫ω₂² dt.
    middle_square: f64,
}

impl Rates {
    /// By whole half periods `T`, back: `dω = −ω̇ n dT`, and the signs that an odd number gives.
    fn skip(&mut self, motion: &Invariants, periods: &Periods) {
        let whole = HalfPeriod::of(motion);
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
    fn advance(&mut self, motion: &Invariants, clock: &Clock) {
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

/// At rest, or for a rod that turns about itself: every direction keeps its own in space, `δ_N = δ_N(0) + t δω_N(0)`.
fn without_momentum(t: f64, turn: &Matrix3<f64>) -> SMatrix<f64, 6, 6> {
    let mut state = SMatrix::<f64, 6, 6>::zeros();
    state.fixed_view_mut::<3, 3>(0, 0).copy_from(turn);
    state.fixed_view_mut::<3, 3>(0, 3).copy_from(&(turn * t));
    state.fixed_view_mut::<3, 3>(3, 3).copy_from(turn);
    state
}
