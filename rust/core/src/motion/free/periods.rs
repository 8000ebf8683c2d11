//! The rhythms of a free motion: the period in the body, and the mean precession of each principal axis about L.

use std::f64::consts::TAU;

use super::invariants::Invariants;
use super::motion::FreeMotion;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::elliptic::{Real, complete_first, complete_third};

/// The periods of a free motion, in the *long-axis convention* of the literature on tumbling asteroids.
///
/// The Euler angles (ZXZ) refer to axis 1 of the body, that of the least moment, with L along z: φ is its precession
/// about L and ψ the rotation about it. In long-axis mode both run all the way round; in short-axis mode ψ swings to
/// and fro. Source: Samarasinha and A'Hearn, Icarus 93 (1991) 194; Kaasalainen, Astron. Astrophys. 376 (2001) 302.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Periods {
    /// `P_ψ = 4K/λ`: after it ω and L are again where they were in the body. Infinite on the separatrix and where nothing
    /// drives ω; the period of small oscillations in the limit of a steady spin about axis 1 or 3.
    pub rotation: f64,
    /// `P_φ = 2π/⟨φ̇₁⟩`: mean period of axis 1 about L.
    pub precession: f64,
    /// `P_ψ/2 = 2K/λ`: from one turning over of the intermediate axis to the next.
    pub flip: f64,
    /// `⟨φ̇_k⟩`: mean rate at which each principal axis goes about L, always in the positive sense.
    pub rates: [f64; 3],
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
    /// assert!((motion.periods().rotation - std::f64::consts::TAU).abs() < 1e-14);
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
        let flip = self.half_period().rounded();
        let rates = self.mean_precession(flip);
        let unit = self.rate_unit;
        Periods {
            rotation: 2.0 * flip / unit,
            precession: TAU / rates[0] / unit,
            flip: flip / unit,
            rates: rates.map(|rate| rate * unit),
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
        complete_first(k_prime) * 2.0.into() / Real::sqrt(square)
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
                assert!((found.rotation * scale / rotation - 1.0).abs() < 1e-15 * 4.0);
                assert_eq!(found.flip * 2.0, found.rotation);
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
        assert!((steady.rotation - TAU / 1.5_f64.sqrt()).abs() < 1e-15 * 8.0);
        assert!((steady.rates[0] - 2.0).abs() < 1e-15 * 4.0);
        let middle = of([1.0, 2.0, 2.5], [0.0, 2.0, 0.0]);
        assert_eq!((middle.rotation, middle.rates), (f64::INFINITY, [2.0; 3]));
        let sphere = of([2.0; 3], [1.0, 2.0, 2.0]);
        assert_eq!((sphere.rotation, sphere.rates), (f64::INFINITY, [3.0; 3]));
        // I₁(I₂ − I₁)ω₁² = I₃(I₃ − I₂)ω₃²: on the separatrix all axes end with L/I₂.
        let separatrix = of([2.0, 4.0, 4.5], [0.75, 0.3, 1.0]);
        assert_eq!(separatrix.rotation, f64::INFINITY);
        let end = (1.5_f64 * 1.5 + 1.2 * 1.2 + 4.5 * 4.5).sqrt() / 4.0;
        assert!(
            separatrix
                .rates
                .iter()
                .all(|rate| (rate - end).abs() < 1e-15 * 4.0)
        );
        let rest = of([1.0, 2.0, 2.5], [0.0; 3]);
        assert_eq!(rest.rotation, f64::INFINITY);
        assert!(rest.rates[0].is_nan());
    }
}
