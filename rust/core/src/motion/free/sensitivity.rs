//! What a small change at the start, or of the moments, has become at a time t: exact, at any t.
//!
//! ω(t) is a rational function of ω(0), of the contrasts and of three elliptic [functions of time](JacobiFunctionsOfTime), which are
//! smooth in all of them, so its derivatives follow by the rules. The attitude needs no integral of the third kind. Write
//! its change as a small rotation `δ`, components in B, `R → R exp(δ×)`:
//!
//! - across L: `L_N = R I ω` is constant, so its change is what it was at the start, `δ×L + I δω + δI ω` turned into the
//!   present body axes;
//! - along L: `d(δ·L)/dt = L·δω = δT − ½ ω·δI ω`, hence `δ·L = (δ·L)₀ + t δT − ½ Σ δI_k ∫ω_k² dt`.
//!
//! The integrals of `ω_k²` are of the second kind; they have the addition theorem
//! `∫ω₂² dt = A₁A₃ ∫y² dt + ω₂(0) ω₂(t) y`, and `α₂ω₁² + α₁ω₂² = A₃`, `α₃ω₂² + α₂ω₃² = A₁` give the others.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, SMatrix, UnitQuaternion, Vector3};

use super::FreeMotion;
use super::invariants::Invariants;
use crate::motion::closed_form::ClosedForm;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::jacobi::{carlson_rd, jacobi};
use crate::numerics::jet::Jet;
use crate::numerics::turns::{MOST_TURNS, PHASE_ERROR};

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

impl FreeMotion {
    /// The derivatives of the state at the time t.
    #[must_use]
    pub fn sensitivity(&self, t: f64) -> Sensitivity {
        let motion = Invariants::of_motion(self);
        self.scaled_sensitivity(&motion, t)
            .in_units_of(motion.inertia_unit, motion.rate_unit)
    }

    /// In the units of the motion: however large or small those of the arguments are, this is of the order of the turns made.
    fn scaled_sensitivity(&self, motion: &Invariants, t: f64) -> Sensitivity {
        let attitudes = [&self.initial.attitude, &self.at(t).attitude];
        motion.sensitivity(t, &self.axes, attitudes, |t| self.at(t).omega)
    }
}

impl Sensitivity {
    /// From the units of a motion to those of its arguments: δ has no unit.
    #[inline]
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

    /// `∫₀ᵗ ω_k² dt`, from that of ω₂².
    #[inline]
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
}

/// At rest, or for a rod that turns about itself: every direction keeps its own in space, `δ_N = δ_N(0) + t δω_N(0)`.
#[inline]
fn without_momentum(t: f64, turn: &Matrix3<f64>) -> SMatrix<f64, 6, 6> {
    let mut state = SMatrix::<f64, 6, 6>::zeros();
    state.fixed_view_mut::<3, 3>(0, 0).copy_from(turn);
    state.fixed_view_mut::<3, 3>(0, 3).copy_from(&(turn * t));
    state.fixed_view_mut::<3, 3>(3, 3).copy_from(turn);
    state
}

/// Bounds, to first order, on the change of a state at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorBar {
    /// Of the attitude, an angle in radians.
    pub attitude: f64,
    /// Of ω, its length.
    pub omega: f64,
}

impl FreeMotion {
    /// The bounds at the time t: see [`Sensitivity::error_bar`], and what the phases are known to. Infinite where nothing is
    /// known, beyond float64 or beyond [`ClosedForm::reach`]; NaN for a t that is.
    #[must_use]
    pub fn error_bar(&self, t: f64, rtol: f64) -> ErrorBar {
        if t.abs() > self.reach() {
            return ErrorBar {
                attitude: f64::INFINITY,
                omega: f64::INFINITY,
            };
        }
        // In units of the motion, where nothing leaves the range of float64 that is within it.
        let motion = Invariants::of_motion(self);
        let unit = motion.rate_unit;
        let omega = self.initial.omega / unit;
        let bar = self
            .scaled_sensitivity(&motion, t)
            .error_bar(&omega, &motion.moments, rtol);
        let turns = t.abs() / self.reach() * MOST_TURNS;
        let phase = TAU * turns * PHASE_ERROR;
        let known = |bound: f64| {
            if bound.is_nan() && !t.is_nan() {
                f64::INFINITY
            } else {
                bound
            }
        };
        ErrorBar {
            attitude: known(bar.attitude + phase),
            omega: known(bar.omega + phase * omega.norm()) * unit,
        }
    }
}

impl Sensitivity {
    /// What relative errors `rtol` of ω and of each moment, and a turn of the attitude by `rtol` radians, can do together,
    /// in the worst directions: `rtol (‖∂/∂δ‖ + |ω|‖∂/∂ω‖ + Σ I_k‖∂/∂I_k‖)` in the spectral norm.
    ///
    /// A body with a zero moment has no derivatives by its moments; they are then left out.
    #[must_use]
    pub fn error_bar(&self, omega: &Vector3<f64>, moments: &[f64; 3], rtol: f64) -> ErrorBar {
        let of = |row: usize| {
            let block = |column| self.state.fixed_view::<3, 3>(row, column).into_owned();
            let norm = |column| block(column).singular_values().max();
            let by_moments: f64 = if moments[0] > 0.0 {
                let by = |k: usize| self.moments.fixed_view::<3, 1>(row, k).norm();
                (0..3).map(|k| moments[k] * by(k)).sum()
            } else {
                0.0
            };
            rtol * (norm(0) + omega.norm() * norm(3) + by_moments)
        };
        ErrorBar {
            attitude: of(0),
            omega: of(3),
        }
    }
}

/// ω at time zero and the moments.
type Slopes = Jet<6>;

/// The clock is set anew after so many units of 1/λ: where y, c and d are near their ends, terms cancel.
const STRETCH: f64 = 2.0;
/// Over so many units of 1/λ, on the separatrix, derivatives grow beyond float64.
const BEYOND: f64 = 700.0;

/// ω at a time and its derivatives by ω at time zero and by the moments.
struct Rates {
    omega: Vector3<f64>,
    by_omega: Matrix3<f64>,
    by_moments: Matrix3<f64>,
    /// ∫ω₂² dt.
    middle_square: f64,
}

impl Invariants {
    /// ω at t with its derivatives: in stretches over what whole half periods leave of t, each from the exact ω at its
    /// beginning, then those half periods T, with `ω(t) = ω(t − nT)` but for signs.
    #[inline]
    fn rates(&self, t: f64, omega_at: impl Fn(f64) -> Vector3<f64>) -> Rates {
        let half_period = self.half_period();
        let mut rates = Rates {
            omega: self.omega,
            by_omega: Matrix3::identity(),
            by_moments: Matrix3::zeros(),
            middle_square: 0.0,
        };
        let (periods, rest) = take_half_periods_off(t, half_period);
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
    fn skip(&mut self, motion: &Invariants, periods: &HalfPeriods, half_period: f64) {
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

/// Half periods that a time holds: how many, and whether that is an odd number, which beyond 2⁵³ the first does not tell.
struct HalfPeriods {
    count: f64,
    are_odd: bool,
}

/// From this many half periods on their number is not known to one at the first attempt.
const MANY: f64 = 4.5e15; // 2⁵²

/// The time but for whole half periods, and these.
fn take_half_periods_off(t: f64, half_period: DoubleDouble) -> (HalfPeriods, f64) {
    let mut rest = DoubleDouble::from(t);
    let mut periods = HalfPeriods {
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

/// The three elliptic functions of time of which every free motion is a rational function: y, c and d at a time, with their derivatives
/// at that time with respect to p and q.
///
/// They solve `ẏ = c d`, `ċ = −p y d`, `ḋ = −q y c` from (0, 1, 1): with p ≥ q, `y = sn(λt)/λ`, `c = cn(λt)`, `d = dn(λt)`,
/// λ² = p, and with p < q the same with c and d, p and q exchanged. They are smooth in p and q down to zero and across
/// p = q, the separatrix, where Jacobi's functions change roles. With ω(0) and the [contrasts](super::invariants),
///
/// - `ω₁(t) = (ω₁ c + ω̇₁ y d)/D`, `ω₂(t) = (ω₂ c d + ω̇₂ y)/D`, `ω₃(t) = (ω₃ d + ω̇₃ y c)/D`,
/// - `D = 1 − α₁α₃ω₂² y² = c² + α₁α₂ω₃² y² = d² + α₂α₃ω₁² y²`:
///
/// the addition theorems of Jacobi's functions, with the present ω in place of their value at the start.
#[derive(Clone, Copy, Debug)]
struct JacobiFunctionsOfTime {
    /// y, c, d.
    value: [f64; 3],
    /// By p.
    by_short: [f64; 3],
    /// By q.
    by_long: [f64; 3],
    /// ∫₀ᵗ y² dt.
    square_integral: f64,
}

impl JacobiFunctionsOfTime {
    /// At a time within half of a half period, |t| ≤ K/λ, in the units of the motion.
    #[inline]
    fn at(motion: &Invariants, t: f64) -> Self {
        let (p, q, k_prime) = motion.fast_and_slow();
        if p == 0.0 {
            return Self::without_rate(t);
        }
        Self::with_rate(t, p, q, k_prime).with_roles_of(motion)
    }

    /// p = q = 0: a body that does not drive its ω.
    #[inline]
    fn without_rate(t: f64) -> Self {
        Self {
            value: [t, 1.0, 1.0],
            by_short: [-t * t * t / 6.0, -0.5 * t * t, 0.0],
            by_long: [-t * t * t / 6.0, 0.0, -0.5 * t * t],
            square_integral: t * t * t / 3.0,
        }
    }

    /// For p ≥ q, p > 0.
    ///
    /// From `t = ∫₀^y dy/√((1 − py²)(1 − qy²))` follow `∂y/∂q = −½ c d ∫ y²/d² dt`, `∂y/∂p = −½ c d ∫ y²/c² dt`, and with
    /// them the rest. The integrals are Carlson's: `∫₀ᵗ y²/d² dt = ⅓ y³ R_D(c², 1, d²)`. Where c is small the derivative
    /// by p comes from the scaling law `2(p ∂_p + q ∂_q) y = t ẏ − y`.
    fn with_rate(t: f64, p: f64, q: f64, k_prime: f64) -> Self {
        let rate = p.sqrt();
        let (sine, c, d) = jacobi(rate * t, k_prime);
        let y = sine / rate;
        let third = y * y * y / 3.0;
        let (c2, d2) = (c * c, d * d);
        let over_d = third * carlson_rd(c2, 1.0, d2);
        // ∫ dt/d²
        let stretched = t + q * over_d;
        let y_q = -0.5 * c * d * over_d;
        let y_p = if c2 > 0.5 {
            -0.5 * c * d * third * carlson_rd(d2, 1.0, c2)
        } else {
            0.5 * (c * d * stretched - y) / p
        };
        Self {
            value: [y, c, d],
            by_short: [y_p, -0.5 * y * d * stretched, -q * y / d * y_p],
            by_long: [
                y_q,
                0.5 * p * y * d * over_d,
                -0.5 * y * y / d - q * y / d * y_q,
            ],
            square_integral: third * carlson_rd(c2, d2, 1.0),
        }
    }

    /// c and d, p and q exchanged where p < q.
    #[inline]
    fn with_roles_of(self, motion: &Invariants) -> Self {
        if motion.circles_third() {
            return self;
        }
        let exchanged = |[y, c, d]: [f64; 3]| [y, d, c];
        Self {
            value: exchanged(self.value),
            by_short: exchanged(self.by_long),
            by_long: exchanged(self.by_short),
            square_integral: self.square_integral,
        }
    }
}

/// What the half period T = 2K/λ brings, in the units of the motion. Near the separatrix it depends on p − q far more than
/// on either, which is why that stands by itself.
#[derive(Clone, Copy, Debug)]
struct HalfPeriod {
    /// ∂T by the larger of p and q, their difference held.
    by_larger: f64,
    /// ∂T by |p − q|, the larger held.
    by_gap: f64,
    /// ∫₀ᵀ y² dt.
    square_integral: f64,
}

impl HalfPeriod {
    /// Of a motion with finite T, which is given: for p ≥ q, `∂T/∂q = ½ ∫₀ᵀ y²/d² dt` and, by the scaling law,
    /// `2(p ∂_p + q ∂_q)T = −T`.
    #[inline]
    fn of(motion: &Invariants, half_period: f64) -> Self {
        let (p, _, k_prime) = motion.fast_and_slow();
        let m1 = k_prime * k_prime;
        let over_cube = 2.0 / (3.0 * p * p.sqrt());
        let over_d = over_cube * carlson_rd(0.0, 1.0, m1);
        Self {
            by_larger: 0.5 * (m1 * over_d - half_period / p),
            by_gap: -0.5 * over_d,
            square_integral: over_cube * carlson_rd(0.0, m1, 1.0),
        }
    }
}

impl Invariants {
    /// The larger and the smaller of p and q, and k′.
    #[inline]
    fn fast_and_slow(&self) -> (f64, f64, f64) {
        let (p, q) = (self.short_square.high, self.long_square.high);
        let (fast, slow) = if self.circles_third() { (p, q) } else { (q, p) };
        (fast, slow, self.complementary_modulus())
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, UnitQuaternion, Vector3};

    use crate::mass::refined::RefinedPrincipal;
    use crate::motion::free::FreeMotion;

    /// (moments, ω, t, ∂ω(t)/∂(ω, I) by rows): differences of Taylor series with mpmath 1.3 and 40 digits.
    type Case = ([f64; 3], [f64; 3], f64, [[f64; 6]; 3]);
    const CASES: [Case; 4] = [
        (
            [1.0, 2.0, 2.5],
            [0.3, 0.2, 1.1],
            7.0,
            [
                [
                    -0.228_681_982_296_877_03,
                    0.851_535_405_086_973_2,
                    1.335_547_893_941_386_5,
                    -1.217_549_654_752_585_5,
                    -1.974_634_793_391_428_1,
                    2.066_727_696_614_176_8,
                ],
                [
                    -1.315_942_222_747_908_5,
                    -0.042_996_549_655_228_165,
                    0.759_242_820_166_371_1,
                    -0.737_833_789_557_150_6,
                    -1.328_077_924_480_664,
                    1.357_595_855_407_391_5,
                ],
                [
                    -0.247_845_076_673_341_02,
                    0.091_173_244_754_125_42,
                    1.166_730_670_378_610_2,
                    -0.130_362_110_617_961_16,
                    -0.288_838_801_479_120_1,
                    0.283_215_885_430_480_54,
                ],
            ],
        ),
        (
            [1.0, 2.0, 2.5],
            [1.3, 0.2, -0.1],
            23.0,
            [
                [
                    1.088_973_047_207_79,
                    0.081_897_169_097_767_45,
                    -0.024_456_801_709_917_354,
                    -0.107_154_963_008_401_01,
                    0.015_374_421_590_389_908,
                    0.030_562_447_931_048_477,
                ],
                [
                    2.954_021_160_617_068,
                    -0.613_908_766_484_55,
                    -0.752_678_578_580_173_5,
                    -3.203_939_874_637_27,
                    0.895_458_520_334_476_1,
                    0.565_209_133_587_327,
                ],
                [
                    0.588_688_647_697_036_3,
                    0.502_285_733_022_651_6,
                    -0.735_585_252_831_631_7,
                    -0.657_194_988_967_659_5,
                    0.262_607_526_162_261_96,
                    0.052_791_974_657_254_194,
                ],
            ],
        ),
        (
            [2.0, 2.0, 2.5],
            [0.3, 0.4, 1.0],
            9.0,
            [
                [
                    -0.628_173_622_722_739_1,
                    -0.778_073_196_887_921_2,
                    0.040_156_852_551_118_394,
                    -0.283_949_403_087_418,
                    0.183_557_271_709_622_02,
                    0.080_313_705_102_236_79,
                ],
                [
                    0.778_073_196_887_921_2,
                    -0.628_173_622_722_739_1,
                    -1.124_283_072_536_978_1,
                    1.239_565_066_852_189_4,
                    1.571_142_614_490_255_6,
                    -2.248_566_145_073_956_2,
                ],
                [
                    0.0,
                    0.0,
                    1.0,
                    -0.127_745_173_679_911_17,
                    0.127_745_173_679_911_17,
                    0.0,
                ],
            ],
        ),
        (
            [1.0, 2.0, 2.5],
            [1e-3, 1.0, 1.1e-3],
            12.0,
            [
                [
                    106.992_667_136_342_6,
                    -0.132_004_945_651_368_08,
                    -119.616_439_678_465_54,
                    0.131_995_823_852_051_8,
                    0.263_372_334_834_947_04,
                    -0.263_496_197_408_778_4,
                ],
                [
                    3.950_735_698_400_043,
                    0.995_580_823_883_337_1,
                    -4.415_194_470_847_644,
                    0.004_721_069_529_293_087,
                    0.009_041_620_161_856_912,
                    -0.009_121_723_941_202_765,
                ],
                [
                    -95.692_991_119_081_13,
                    0.118_018_834_437_922_41,
                    106.992_887_860_950_74,
                    -0.118_010_679_106_181_1,
                    -0.202_536_670_899_970_93,
                    0.209_233_608_362_449_2,
                ],
            ],
        ),
    ];

    fn motion(moments: [f64; 3], omega: Vector3<f64>) -> FreeMotion {
        let principal = RefinedPrincipal::from_principal(&moments, &Matrix3::identity());
        FreeMotion::from_refined(&principal, &omega, &UnitQuaternion::identity()).expect("finite")
    }

    #[test]
    fn against_differences_in_many_digits() {
        for (moments, omega, t, exact) in CASES {
            let found = motion(moments, omega.into()).sensitivity(t);
            let size = (exact.as_flattened().iter()).fold(0.0, |a: f64, b| a.max(b.abs()));
            for (i, row) in exact.iter().enumerate() {
                for (j, want) in row.iter().enumerate() {
                    let got = if j < 3 {
                        found.state[(3 + i, 3 + j)]
                    } else {
                        found.moments[(3 + i, j - 3)]
                    };
                    let error = (got - want).abs();
                    assert!(error < 4e-15 * size, "{omega:?} {i} {j}: {got} {want}");
                }
            }
        }
    }

    #[test]
    fn scales() {
        let (moments, omega, t, _) = CASES[0];
        let plain = motion(moments, omega.into()).sensitivity(t);
        // Powers of two change no digit.
        let (heavy, fast) = (2.0_f64.powi(400), 2.0_f64.powi(-390));
        let scaled = motion(moments.map(|i| i * heavy), Vector3::from(omega) * fast);
        let scaled = scaled.sensitivity(t / fast);
        assert_eq!(scaled.state[(0, 4)] * fast, plain.state[(0, 4)]);
        assert_eq!(scaled.state[(4, 3)], plain.state[(4, 3)]);
        assert_eq!(scaled.moments[(1, 2)] * heavy, plain.moments[(1, 2)]);
        assert_eq!(scaled.moments[(4, 2)] * heavy / fast, plain.moments[(4, 2)]);
    }

    #[test]
    fn two_spans_make_one() {
        // The derivatives of the later by the earlier, times those of the earlier by the start.
        for (moments, omega, t, _) in CASES {
            let first = motion(moments, omega.into());
            let middle = first.at(t);
            let principal = RefinedPrincipal::from_principal(&moments, &Matrix3::identity());
            let second = FreeMotion::from_refined(&principal, &middle.omega, &middle.attitude);
            let second = second.expect("finite").sensitivity(1e3);
            let (whole, early) = (first.sensitivity(t + 1e3), first.sensitivity(t));
            let size = second.state.norm() * early.state.norm();
            assert!((second.state * early.state - whole.state).norm() < 1e-13 * size);
            let moments = second.state * early.moments + second.moments;
            assert!((moments - whole.moments).norm() < 1e-12 * size);
        }
    }

    #[test]
    fn where_moments_have_no_derivative() {
        let rod = motion([0.0, 1.0, 1.0], Vector3::new(0.5, 0.3, 0.4)).sensitivity(2.0);
        assert!(rod.state.iter().all(|x| x.is_finite()));
        assert!(rod.moments.iter().all(|x| x.is_nan()));
        let rest = motion([1.0, 2.0, 2.5], Vector3::zeros()).sensitivity(3.0);
        assert_eq!(rest.state[(0, 3)], 3.0);
        assert_eq!(rest.moments[(0, 0)], 0.0);
    }
}
