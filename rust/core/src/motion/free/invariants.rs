//! What a free motion keeps, and with it the size and shape of its polhode.
//!
//! In principal axes, with the *contrasts*
//!
//! - `α₁ = (I₃ − I₂)/I₁`, `α₂ = (I₃ − I₁)/I₂`, `α₃ = (I₂ − I₁)/I₃`, each in [0, 1] for a real body,
//!
//! Euler's equations are `ω̇₁ = −α₁ω₂ω₃`, `ω̇₂ = α₂ω₃ω₁`, `ω̇₃ = −α₃ω₁ω₂`, and
//!
//! - `A₁ = α₃ω₂² + α₂ω₃² = (L² − 2T I₁)/(I₂I₃)`,
//! - `A₃ = α₂ω₁² + α₁ω₂² = (2T I₃ − L²)/(I₁I₂)`
//!
//! are constant. So are the squared rates `p = α₁A₁` and `q = α₃A₃`, with `p − q = α₂(L² − 2T I₂)/(I₁I₃)`: the larger one
//! tells the mode and the rate λ of Jacobi's functions, their ratio is the parameter m = k². Every one of these is a sum
//! of terms with one sign, but for p − q, which is taken in twice the precision.

use nalgebra::Vector3;

use super::mode::Mode;
use super::motion::FreeMotion;
use super::separation::Separation;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::power_of_two::power_below;

/// Constants of a free motion, in principal axes and in units of its own in which moments and rates are near one.
#[derive(Clone, Copy, Debug)]
pub struct Invariants {
    /// How the body moves.
    pub mode: Mode,
    /// Principal moments, ascending, in units of `inertia_unit`.
    pub(super) moments: [f64; 3],
    /// ω at time zero, in principal axes, in units of `rate_unit`.
    pub(super) omega: Vector3<f64>,
    /// A power of two.
    pub(super) inertia_unit: f64,
    /// A power of two.
    pub(super) rate_unit: f64,
    /// α₁, α₂, α₃.
    pub(super) contrasts: [f64; 3],
    /// A₁.
    pub(super) around_first: f64,
    /// A₃.
    pub(super) around_third: f64,
    /// p.
    pub(super) short_square: DoubleDouble,
    /// q.
    pub(super) long_square: DoubleDouble,
    /// p − q, in units of the square of a power of two.
    pub(super) discriminant: DoubleDouble,
    /// That power.
    pub(super) discriminant_unit: f64,
    /// L.
    pub(super) momentum: f64,
    /// 2T.
    pub(super) twice_energy: f64,
}

impl FreeMotion {
    /// What the motion keeps.
    #[must_use]
    pub fn invariants(&self) -> Invariants {
        Invariants::of_motion(self)
    }
}

impl Invariants {
    /// Of a body with these ascending principal moments and ω, components in principal axes, both finite.
    #[must_use]
    pub fn of(moments: &[f64; 3], omega: &Vector3<f64>) -> Self {
        let [x, y, z] = (*omega).into();
        let moments = moments.map(DoubleDouble::from);
        let omega = [x, y, z].map(DoubleDouble::from);
        let inertia_unit = power_below(moments[2].high);
        let scaled = moments.map(|moment| moment.scaled(1.0 / inertia_unit));
        Self::from_refined(&moments, &omega, &Separation::of(&scaled, &omega))
    }

    /// Of an exact motion.
    #[must_use]
    pub fn of_motion(motion: &FreeMotion) -> Self {
        Self {
            mode: motion.mode,
            ..Self::from_refined(&motion.moments, &motion.principal_omega, &motion.separation)
        }
    }

    /// As [`Invariants::of`], of moments and ω that are known to twice the precision, and how far they are from the separatrix.
    fn from_refined(
        moments: &[DoubleDouble; 3],
        omega: &[DoubleDouble; 3],
        separation: &Separation,
    ) -> Self {
        let inertia_unit = power_below(moments[2].high);
        let fastest = omega
            .iter()
            .fold(0.0, |size: f64, rate| size.max(rate.high.abs()));
        let rate_unit = power_below(fastest);
        let moments = moments.map(|moment| moment.scaled(1.0 / inertia_unit));
        let omega = omega.map(|rate| rate.scaled(1.0 / rate_unit));
        let [i1, _, i3] = moments;
        let contrasts = contrasts(&moments);
        let [a1, a2, a3] = contrasts;
        let [x, y, z] = omega.map(|rate| rate * rate);
        let (around_first, around_third) = (a3 * y + a2 * z, a2 * x + a1 * y);
        let (discriminant, discriminant_unit) = if i1.high == 0.0 {
            (-(a3 * a2 * x), 1.0)
        } else {
            (
                a2 * separation.size / (i1 * i3),
                separation.unit * (separation.rate_unit / rate_unit),
            )
        };
        let (I, w) = (
            moments.map(DoubleDouble::rounded),
            omega.map(DoubleDouble::rounded).into(),
        );
        Self {
            mode: mode(&moments, &w, discriminant.high),
            moments: I,
            omega: w,
            inertia_unit,
            rate_unit,
            contrasts: contrasts.map(DoubleDouble::rounded),
            around_first: around_first.high,
            around_third: around_third.high,
            short_square: a1 * around_first,
            long_square: a3 * around_third,
            discriminant,
            discriminant_unit,
            momentum: Vector3::from(I).component_mul(&w).norm(),
            twice_energy: Vector3::from(I).dot(&w.component_mul(&w)),
        }
    }

    /// |L|.
    #[must_use]
    pub fn angular_momentum(&self) -> f64 {
        self.momentum * self.inertia_unit * self.rate_unit
    }

    /// `L/I_k`: the rates of the steady spins about the principal axes with this angular momentum. Infinite, or NaN, about an
    /// axis without moment.
    #[must_use]
    pub fn steady_rates(&self) -> [f64; 3] {
        self.moments
            .map(|moment| self.momentum / moment * self.rate_unit)
    }

    /// T = ½ ω·I ω.
    #[must_use]
    pub fn kinetic_energy(&self) -> f64 {
        0.5 * self.twice_energy * self.inertia_unit * self.rate_unit * self.rate_unit
    }

    /// `T/T_min` with `T_min = L²/(2I₃)`, the least energy of a body with this angular momentum; one or more, NaN without
    /// any angular momentum.
    ///
    /// `1 + (2T I₃ − L²)/L²`, in which nothing cancels.
    #[must_use]
    pub fn energy_ratio(&self) -> f64 {
        let [i1, i2, i3] = self.moments;
        let squares = self.omega.component_mul(&self.omega);
        let excess = i1 * (i3 - i1) * squares.x + i2 * (i3 - i2) * squares.y;
        1.0 + excess / (self.momentum * self.momentum)
    }

    /// k, the modulus of the elliptic functions in time; one on the separatrix, zero for a symmetric body and in the limit
    /// of a steady spin about axis 1 or 3.
    #[must_use]
    pub fn modulus(&self) -> f64 {
        let (short, long) = (self.short_square.high, self.long_square.high);
        let square = self.rate_square().high;
        if square == 0.0 {
            return square;
        }
        (short.min(long) / square).sqrt()
    }

    /// k′ = √(1 − k²), which keeps its digits near the separatrix.
    #[must_use]
    pub fn complementary_modulus(&self) -> f64 {
        let square = self.rate_square().high;
        if square == 0.0 {
            return 1.0;
        }
        ((self.discriminant.high.abs() / square).sqrt() * self.discriminant_unit).min(1.0)
    }

    /// m₁ = 1 − k² = |p − q|/λ².
    pub(super) fn complement(&self) -> f64 {
        let square = self.rate_square().high;
        if square == 0.0 {
            return 1.0;
        }
        let unit = self.discriminant_unit;
        (self.discriminant.high.abs() / square * unit * unit).min(1.0)
    }

    /// λ², the square of the rate at which the argument of the elliptic functions runs.
    pub(super) fn rate_square(&self) -> DoubleDouble {
        if self.circles_third() {
            self.short_square
        } else {
            self.long_square
        }
    }

    /// Whether p ≥ q.
    pub(super) fn circles_third(&self) -> bool {
        self.discriminant.high >= 0.0
    }

    /// The axis about which ω and L circle in the body: 0 or 2; the symmetry axis of a symmetric body.
    #[must_use]
    pub fn circled_axis(&self) -> usize {
        let [i1, i2, i3] = self.moments;
        let prolate = i1 < i2 && i2 == i3;
        if prolate || !self.circles_third() {
            0
        } else {
            2
        }
    }

    /// Whether ω is constant in the body.
    #[must_use]
    pub fn is_steady(&self) -> bool {
        let [a1, a2, a3] = self.contrasts;
        let [x, y, z] = self.omega.into();
        a1 * y * z == 0.0 && a2 * z * x == 0.0 && a3 * x * y == 0.0
    }

    /// Greatest |ω₁|, |ω₂|, |ω₃| on the polhode, in units of `rate_unit`.
    ///
    /// `a₁² = A₃/α₂`, `a₃² = A₁/α₂`, and `a₂² = A₃/α₁` where axis 3 is circled, `A₁/α₃` where axis 1 is.
    pub(super) fn amplitudes(&self) -> Vector3<f64> {
        if self.is_steady() {
            return self.omega.abs();
        }
        let [a1, a2, a3] = self.contrasts;
        let middle = if self.circles_third() {
            self.around_third / a1
        } else {
            self.around_first / a3
        };
        Vector3::new(self.around_third / a2, middle, self.around_first / a2).map(f64::sqrt)
    }
}

/// `α₁ = (I₃ − I₂)/I₁`, `α₂ = (I₃ − I₁)/I₂`, `α₃ = (I₂ − I₁)/I₃`; a zero moment is that of a thin symmetric rod.
fn contrasts(moments: &[DoubleDouble; 3]) -> [DoubleDouble; 3] {
    let &[i1, i2, i3] = moments;
    if i3.high == 0.0 {
        [0.0.into(); 3]
    } else if i1.high == 0.0 {
        [0.0, 1.0, 1.0].map(DoubleDouble::from)
    } else {
        [(i3 - i2) / i1, (i3 - i1) / i2, (i2 - i1) / i3]
    }
}

fn mode(moments: &[DoubleDouble; 3], omega: &Vector3<f64>, discriminant: f64) -> Mode {
    let &[i1, i2, i3] = moments;
    if i1 == i3 {
        Mode::Spherical
    } else if i1 == i2 || i2 == i3 || i1.high == 0.0 {
        Mode::Symmetric
    } else if omega.iter().filter(|&&rate| rate == 0.0).count() >= 2 {
        Mode::Steady
    } else if discriminant == 0.0 {
        Mode::Separatrix
    } else if discriminant < 0.0 {
        Mode::LongAxis
    } else {
        Mode::ShortAxis
    }
}
