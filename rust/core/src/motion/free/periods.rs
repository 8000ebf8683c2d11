//! The rhythms of a free motion: each mode has its own periods, and the principal axes mean rates about L.

use std::f64::consts::{FRAC_PI_4, TAU};

use super::Mode;
use super::invariants::Invariants;
use super::motion::FreeMotion;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::elliptic::{MultiPrecision, complete_first, complete_third};

/// The periods of a free motion, of a body or of a gyrostat. Each mode has periods of its own; those that it does not have
/// are NaN.
///
/// | motion | its periods |
/// |---|---|
/// | steady: spherical bodies, a spin about a principal axis | `turn`; `wobble`, if the spin is stable |
/// | symmetric body, ω not steady | `spin`, `precession` |
/// | long-axis and short-axis mode | `rotation`, `precession`; `flip`, if the intermediate axis turns over |
/// | separatrix | `precession`; `rotation` and `flip` are infinite |
/// | gyrostat | `turn`, `wobble` of a steady rotation; else `rotation`, infinite on the separatrix |
///
/// In long- and short-axis mode they follow the *long-axis convention* of the literature on tumbling asteroids: the Euler
/// angles (ZXZ) refer to axis 1 of the body, that of the least moment, with L along z. φ is its precession about L and ψ the
/// rotation about it. In long-axis mode both run all the way round; in short-axis mode ψ swings to and fro. Source:
/// Samarasinha and A'Hearn, Icarus 93 (1991) 194; Kaasalainen, Astron. Astrophys. 376 (2001) 302.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Periods {
    /// `2π/|ω|`: one turn of a steady rotation, about an axis at rest in the body and in space. Infinite at rest.
    pub turn: f64,
    /// Period of small oscillations of ω in the body about a steady spin that is stable.
    pub wobble: f64,
    /// `2π/|ψ̇|`: one turn of a symmetric body about its axis, relative to the plane of that axis and L. After it ω is again
    /// where it was in the body.
    pub spin: f64,
    /// `P_ψ = 4K/λ`: after it ω and L are again where they were in the body. Infinite on the separatrix.
    pub rotation: f64,
    /// `P_φ = 2π/⟨φ̇⟩`: mean time in which axis 1, or the axis of a symmetric body, goes once round L.
    pub precession: f64,
    /// `P_ψ/2 = 2K/λ`: time from one turning over of the intermediate axis to the next. That axis turns over if, in between,
    /// it is the principal axis nearest to L, now along L and then against it: if it comes within 45° of L.
    pub flip: f64,
    /// `⟨φ̇_k⟩`: mean rate at which each principal axis goes about L, always in the positive sense. NaN for an axis that rests
    /// along L.
    pub rates: [f64; 3],
}

impl Periods {
    pub(crate) const NONE: Self = Self {
        turn: f64::NAN,
        wobble: f64::NAN,
        spin: f64::NAN,
        rotation: f64::NAN,
        precession: f64::NAN,
        flip: f64::NAN,
        rates: [f64::NAN; 3],
    };
}

impl FreeMotion {
    /// The periods of the motion and its mean rates, as [`Invariants::periods`].
    ///
    /// ```
    /// use polhode::RigidBody;
    /// use polhode::motion::free::FreeMotion;
    /// use polhode::nalgebra::{Matrix3, UnitQuaternion, Vector3};
    ///
    /// let moments = [1.0, 1.0, 1.5];
    /// let top = RigidBody::from_principal(1.0, &moments, &Matrix3::identity(), &Vector3::zeros(), 0.0)?;
    /// let motion = FreeMotion::of(&top, &Vector3::new(0.6, 0.0, 2.0), &UnitQuaternion::identity())?;
    /// // Of a symmetric top ω goes round in the body at (I₃ − I₁) ω₃ / I₁ = 1 rad/s.
    /// assert!((motion.periods().spin - std::f64::consts::TAU).abs() < 1e-14);
    /// assert!(motion.periods().rotation.is_nan());
    /// # Ok::<(), polhode::Error>(())
    /// ```
    #[must_use]
    pub fn periods(&self) -> Periods {
        self.invariants().periods()
    }
}

impl Invariants {
    /// The periods and mean rates. The rates are NaN without angular momentum.
    ///
    /// Axis k precesses with `φ̇_k = L (I_iω_i² + I_jω_j²)/(I_i²ω_i² + I_j²ω_j²)`, a mean of `L/I_i` and `L/I_j`. Its mean over
    /// the motion is a complete integral of the third kind, in which all terms have one sign. Two axes that are not
    /// circled have the same mean rate; the circled one is ahead of them by `2π/P_ψ` where it is axis 3, behind by as
    /// much where it is axis 1.
    #[must_use]
    pub fn periods(&self) -> Periods {
        let half_period = self.half_period().rounded();
        let half = half_period / self.rate_unit;
        let is_steady = match self.mode {
            Mode::Spherical | Mode::Steady => true,
            Mode::Symmetric => self.is_steady(),
            Mode::Separatrix | Mode::LongAxis | Mode::ShortAxis => false,
        };
        if is_steady {
            return self.steady_periods(half);
        }
        let rates = (self.mean_precession(half_period)).map(|rate| rate * self.rate_unit);
        let none = Periods {
            rates,
            ..Periods::NONE
        };
        if self.mode == Mode::Symmetric {
            return Periods {
                spin: 2.0 * half,
                precession: TAU / rates[self.circled_axis()],
                ..none
            };
        }
        let turns_over = self.nutation()[1][0] < FRAC_PI_4;
        Periods {
            rotation: 2.0 * half,
            precession: TAU / rates[0],
            flip: if turns_over { half } else { f64::NAN },
            ..none
        }
    }

    /// `P_ψ` and `P_φ` of axis 1, in every mode: of a steady spin the limits to which those of the mode beside it go.
    pub(super) fn long_axis_periods(&self) -> [f64; 2] {
        let half = self.half_period().rounded();
        [2.0 * half, TAU / self.mean_precession(half)[0]].map(|period| period / self.rate_unit)
    }

    /// Those of a constant ω; of small oscillations half the period is given, infinite where there are none.
    fn steady_periods(&self, half: f64) -> Periods {
        let [x, y, z] = self.omega.into();
        let rate = self.omega.norm() * self.rate_unit;
        let about = |across: f64| if across == 0.0 { f64::NAN } else { rate };
        Periods {
            turn: TAU / rate,
            wobble: if half.is_finite() {
                2.0 * half
            } else {
                f64::NAN
            },
            rates: [y.hypot(z), z.hypot(x), x.hypot(y)].map(about),
            ..Periods::NONE
        }
    }

    /// 2K/λ in the units of the motion, in twice the precision.
    #[inline]
    pub(super) fn half_period(&self) -> DoubleDouble {
        let square = self.rate_square();
        if square.high == 0.0 || self.discriminant.high == 0.0 {
            return f64::INFINITY.into();
        }
        let k_prime = (self.discriminant.abs() / square)
            .sqrt()
            .scaled(self.discriminant_unit);
        complete_first(k_prime) * 2.0.into() / MultiPrecision::sqrt(square)
    }

    fn mean_precession(&self, half_period: f64) -> [f64; 3] {
        let ([_, i2, i3], [_, a2, a3]) = (self.moments, self.contrasts);
        if self.momentum == 0.0 {
            return [f64::NAN; 3];
        }
        if half_period.is_infinite() {
            return [self.twice_energy / self.momentum; 3];
        }
        let k_prime = self.complementary_modulus();
        let ahead = std::f64::consts::PI / half_period;
        if self.circles_third() {
            // cos²φ and sin²φ in φ̇₁: I₃a₃² and, where ω₁ = 0, 2T; squared moments alike.
            let third = self.around_first / a2;
            let momentum = i3 * i3 * third;
            let p = self.momentum * self.momentum / momentum;
            let (first, mean) = complete_third(
                k_prime,
                p,
                i3 * third / momentum,
                self.twice_energy / momentum,
            );
            let slow = self.momentum * mean / first;
            [slow, slow, slow + ahead]
        } else {
            // cos²φ and sin²φ in φ̇₁ = L (I₂ω₂² + I₃ω₃²)/(I₂²ω₂² + I₃²ω₃²), over those of ω₃.
            let (p, b) = ((i2 * i2 * a2) / (i3 * i3 * a3), (i2 * a2) / (i3 * a3));
            let (first, mean) = complete_third(k_prime, p, 1.0, b);
            let slow = (self.momentum / i3) * mean / first;
            [slow, slow + ahead, slow + ahead]
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    /// (moments, ω, `P_ψ`, mean rates) by mpmath 1.3: `ellipk`, and the rates by quadrature of φ̇ over a half period with 30
    /// digits; the last, a thin rod, in closed form.
    type Motion = ([f64; 3], [f64; 3], f64, [f64; 3]);
    const MOTIONS: [Motion; 6] = [
        (
            [1.0, 2.0, 2.5],
            [0.3, 0.2, 1.1],
            9.429_585_403_012_284,
            [
                1.130_726_432_961_382_2,
                1.130_726_432_961_382_2,
                1.797_053_216_021_475_2,
            ],
        ),
        (
            [1.0, 2.0, 2.5],
            [1.3, 0.2, -0.1],
            8.805_996_338_404_208,
            [
                0.625_667_830_208_629,
                1.339_179_971_904_364,
                1.339_179_971_904_364,
            ],
        ),
        (
            [1.0, 1.0, 1.5],
            [0.3, 0.4, 1.0],
            12.566_370_614_359_172,
            [
                1.081_138_830_084_189_8,
                1.081_138_830_084_189_8,
                1.581_138_830_084_189_8,
            ],
        ),
        (
            [0.5, 2.0, 2.0],
            [1.0, 0.4, 0.3],
            8.377_580_409_572_783,
            [
                0.559_016_994_374_947_5,
                1.309_016_994_374_947_5,
                1.309_016_994_374_947_5,
            ],
        ),
        (
            [1.0, 2.0, 2.5],
            [0.001, 1.0, 0.0011],
            75.360_297_259_013_83,
            [
                0.977_679_742_721_845_2,
                0.977_679_742_721_845_2,
                1.061_055_015_056_351,
            ],
        ),
        (
            [0.0, 1.0, 1.0],
            [2.0, 0.3, 0.4],
            std::f64::consts::PI,
            [0.5, 2.5, 2.5],
        ),
    ];

    #[test]
    fn against_quadrature() {
        for (moments, omega, rotation, rates) in MOTIONS {
            for scale in [1.0, 1e-120, 1e120] {
                let moments = moments.map(|moment| moment * scale);
                let omega = Vector3::from(omega) * scale;
                let found = Invariants::of(&moments, &omega).periods();
                let is_symmetric = moments[0] == moments[1] || moments[1] == moments[2];
                let (own, other) = if is_symmetric {
                    (found.spin, found.rotation)
                } else {
                    (found.rotation, found.spin)
                };
                assert!((own * scale / rotation - 1.0).abs() < 1e-15 * 4.0);
                assert!(other.is_nan() && found.turn.is_nan() && found.wobble.is_nan());
                let axis = if moments[0] == moments[1] { 2 } else { 0 };
                assert_eq!(found.precession, TAU / found.rates[axis]);
                for (rate, exact) in found.rates.iter().zip(rates) {
                    assert!(
                        (rate / scale / exact - 1.0).abs() < 1e-15 * 4.0,
                        "{rate} {exact}"
                    );
                }
            }
        }
    }

    #[test]
    fn limits() {
        let of = |moments: [f64; 3], omega: [f64; 3]| {
            Invariants::of(&moments, &Vector3::from(omega)).periods()
        };
        // Steady spins: small oscillations about axes 1 and 3, ω²(I_k − I_i)(I_k − I_j)/(I_iI_j).
        let steady = of([1.0, 2.0, 2.5], [0.0, 0.0, 2.0]);
        assert!((steady.wobble - TAU / 1.5_f64.sqrt()).abs() < 1e-15 * 8.0);
        assert_eq!(steady.turn, TAU / 2.0);
        assert_eq!(steady.rates[..2], [2.0; 2]);
        let none = [
            steady.spin,
            steady.rotation,
            steady.precession,
            steady.flip,
            steady.rates[2],
        ];
        assert!(none.iter().all(|period| period.is_nan()));
        let middle = of([1.0, 2.0, 2.5], [0.0, 2.0, 0.0]);
        assert!(middle.turn == TAU / 2.0 && middle.wobble.is_nan() && middle.flip.is_nan());
        let sphere = of([2.0; 3], [1.0, 2.0, 2.0]);
        assert_eq!((sphere.turn, sphere.rates), (TAU / 3.0, [3.0; 3]));
        assert!(sphere.wobble.is_nan() && sphere.rotation.is_nan());
        // A coin along its axis, where it wobbles with |I₃ − I₁| ω/I₁, and across, where it does not.
        let coin = of([1.0, 1.0, 1.5], [0.0, 0.0, 2.0]);
        assert_eq!((coin.turn, coin.rates[0]), (TAU / 2.0, 2.0));
        assert!((coin.wobble - TAU).abs() < 1e-15 * 8.0 && coin.spin.is_nan());
        let across = of([1.0, 1.0, 1.5], [1.2, 1.6, 0.0]);
        assert_eq!((across.turn, across.rates), (TAU / 2.0, [2.0; 3]));
        assert!(across.wobble.is_nan() && across.precession.is_nan());
        // I₁(I₂ − I₁)ω₁² = I₃(I₃ − I₂)ω₃²: on the separatrix all axes end with L/I₂.
        let separatrix = of([2.0, 4.0, 4.5], [0.75, 0.3, 1.0]);
        assert_eq!(separatrix.rotation, f64::INFINITY);
        assert_eq!(separatrix.flip, f64::INFINITY);
        let end = (1.5_f64 * 1.5 + 1.2 * 1.2 + 4.5 * 4.5).sqrt() / 4.0;
        assert!(
            separatrix
                .rates
                .iter()
                .all(|rate| (rate - end).abs() < 1e-15 * 4.0)
        );
        let rest = of([1.0, 2.0, 2.5], [0.0; 3]);
        assert_eq!(rest.turn, f64::INFINITY);
        assert!(rest.rotation.is_nan() && rest.wobble.is_nan() && rest.rates[0].is_nan());
    }

    /// L leans by 45° from axis 2 where that axis is nearest: `I₂ω₂ = I_kω_k`, k the axis that is circled.
    #[test]
    fn an_axis_that_turns_over_passes_half_a_right_angle() {
        let moments = [1.0, 2.0, 2.5];
        for (circled, omega) in [(0, [2.0, 1.0, 0.0]), (2, [0.0, 1.25, 1.0])] {
            for (share, flips) in [(1.0 - 1e-9, false), (1.0 + 1e-9, true)] {
                let mut omega = Vector3::from(omega);
                omega.y *= share;
                let found = Invariants::of(&moments, &omega);
                assert_eq!(found.circled_axis(), circled);
                let periods = found.periods();
                assert_eq!(periods.flip == 0.5 * periods.rotation, flips);
                assert_eq!(periods.flip.is_nan(), !flips);
            }
        }
    }
}
