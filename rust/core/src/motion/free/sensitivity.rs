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

use nalgebra::{Matrix3, SMatrix, UnitQuaternion, Vector3};

use super::FreeMotion;
use super::clock::Clock;
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
        let attitudes = [&self.initial.attitude, &self.at(t).attitude];
        let omega_at = |t: f64| self.at(t).omega;
        Invariants::of_motion(self).sensitivity(t, &self.axes, attitudes, omega_at)
    }
}

impl Invariants {
    /// At the time t; the columns of `axes` are the principal axes, `start` is the attitude at time zero, `now` the one at t.
    /// `omega_at` is ω at any time, in B.
    ///
    /// In units of the rate of the motion the error is a few ε of the largest derivative: not more near the separatrix,
    /// where derivatives grow as exp(λt), nor for symmetric bodies or steady spins. For a needle that turns about its own
    /// axis, it is that times `I₃ω/L`. NaN where derivatives are beyond float64, far out on the separatrix.
    #[must_use]
    pub fn sensitivity(
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
        let mut state = both * by_start * both.transpose();
        let mut moments = both * by_moments / self.inertia_unit;
        // δ has no unit, ω that of the motion.
        (state.fixed_view_mut::<3, 3>(0, 3)).apply(|x| *x /= unit);
        (state.fixed_view_mut::<3, 3>(3, 0)).apply(|x| *x *= unit);
        (moments.fixed_view_mut::<3, 3>(3, 0)).apply(|x| *x *= unit);
        Sensitivity { state, moments }
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

    /// ω at t with its derivatives: whole half periods first, then stretches, each from the exact ω at its beginning.
    fn rates(&self, t: f64, omega_at: impl Fn(f64) -> Vector3<f64>) -> Rates {
        let half_period = self.half_period();
        let mut rates = Rates {
            omega: self.omega,
            by_omega: Matrix3::identity(),
            by_moments: Matrix3::zeros(),
            middle_square: 0.0,
        };
        let (mut rest, mut signs) = (t, Vector3::repeat(1.0));
        let count = (t / half_period.high).round();
        if half_period.high.is_finite() && count != 0.0 {
            rest = (DoubleDouble::from(t) - half_period * count.into()).high;
            rates.advance(self, &Clock::after_half_periods(self, count));
            if count % 2.0 != 0.0 {
                let [x, _] = self.planar_axes();
                (signs.y, signs[x]) = (-1.0, -1.0);
            }
        }
        let phase = (rest * self.rate_square().high.sqrt()).abs();
        if phase > BEYOND {
            rates.by_omega.fill(f64::NAN);
            rates.by_moments.fill(f64::NAN);
            return rates;
        }
        let stretches = (phase / STRETCH).ceil().max(1.0);
        let clock = Clock::at(self, rest / stretches);
        let mut done = 0.0;
        while done < stretches {
            if done > 0.0 {
                rates.omega = signs.component_mul(&omega_at(rest * (done / stretches)));
            }
            rates.advance(self, &clock);
            done += 1.0;
        }
        rates.omega = signs.component_mul(&omega_at(rest));
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

/// ω at a time and its derivatives by ω at time zero and by the moments.
struct Rates {
    omega: Vector3<f64>,
    by_omega: Matrix3<f64>,
    by_moments: Matrix3<f64>,
    /// ∫ω₂² dt.
    middle_square: f64,
}

impl Rates {
    /// By the time of a clock that is set to zero now.
    fn advance(&mut self, motion: &Invariants, clock: &Clock) {
        let w: [Slopes; 3] = std::array::from_fn(|k| Jet::variable(self.omega[k], k));
        let [a1, a2, a3] = motion.contrast_slopes();
        let around_first = a3 * w[1] * w[1] + a2 * w[2] * w[2];
        let around_third = a2 * w[0] * w[0] + a1 * w[1] * w[1];
        let (p, q) = (a1 * around_first, a3 * around_third);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::free::RefinedPrincipal;

    /// (moments, ω, t, ∂ω(t)/∂(ω, I) by rows): differences of Taylor series with mpmath 1.3 and 40 digits.
    type Case = ([f64; 3], [f64; 3], f64, [[f64; 6]; 3]);
    const CASES: [Case; 4] = [
        (
            [1.0, 2.0, 2.5],
            [0.3, 0.2, 1.1],
            7.0,
            [
                [
                    -0.22868198229687703,
                    0.8515354050869732,
                    1.3355478939413865,
                    -1.2175496547525855,
                    -1.9746347933914281,
                    2.0667276966141768,
                ],
                [
                    -1.3159422227479085,
                    -0.042996549655228165,
                    0.7592428201663711,
                    -0.7378337895571506,
                    -1.328077924480664,
                    1.3575958554073915,
                ],
                [
                    -0.24784507667334102,
                    0.09117324475412542,
                    1.1667306703786102,
                    -0.13036211061796116,
                    -0.2888388014791201,
                    0.28321588543048054,
                ],
            ],
        ),
        (
            [1.0, 2.0, 2.5],
            [1.3, 0.2, -0.1],
            23.0,
            [
                [
                    1.08897304720779,
                    0.08189716909776745,
                    -0.024456801709917354,
                    -0.10715496300840101,
                    0.015374421590389908,
                    0.030562447931048477,
                ],
                [
                    2.954021160617068,
                    -0.61390876648455,
                    -0.7526785785801735,
                    -3.20393987463727,
                    0.8954585203344761,
                    0.565209133587327,
                ],
                [
                    0.5886886476970363,
                    0.5022857330226516,
                    -0.7355852528316317,
                    -0.6571949889676595,
                    0.26260752616226196,
                    0.052791974657254194,
                ],
            ],
        ),
        (
            [2.0, 2.0, 2.5],
            [0.3, 0.4, 1.0],
            9.0,
            [
                [
                    -0.6281736227227391,
                    -0.7780731968879212,
                    0.040156852551118394,
                    -0.283949403087418,
                    0.18355727170962202,
                    0.08031370510223679,
                ],
                [
                    0.7780731968879212,
                    -0.6281736227227391,
                    -1.1242830725369781,
                    1.2395650668521894,
                    1.5711426144902556,
                    -2.2485661450739562,
                ],
                [
                    0.0,
                    0.0,
                    1.0,
                    -0.12774517367991117,
                    0.12774517367991117,
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
                    106.9926671363426,
                    -0.13200494565136808,
                    -119.61643967846554,
                    0.1319958238520518,
                    0.26337233483494704,
                    -0.2634961974087784,
                ],
                [
                    3.950735698400043,
                    0.9955808238833371,
                    -4.415194470847644,
                    0.004721069529293087,
                    0.009041620161856912,
                    -0.009121723941202765,
                ],
                [
                    -95.69299111908113,
                    0.11801883443792241,
                    106.99288786095074,
                    -0.1180106791061811,
                    -0.20253667089997093,
                    0.2092336083624492,
                ],
            ],
        ),
    ];

    fn motion(moments: [f64; 3], omega: Vector3<f64>) -> FreeMotion {
        let principal = RefinedPrincipal::given(&moments, &Matrix3::identity());
        FreeMotion::refined(&principal, &omega, &UnitQuaternion::identity()).expect("finite")
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
            let principal = RefinedPrincipal::given(&moments, &Matrix3::identity());
            let second = FreeMotion::refined(&principal, &middle.omega, &middle.attitude);
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
