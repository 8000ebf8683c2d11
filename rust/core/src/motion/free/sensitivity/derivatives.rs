//! The derivatives of the state, from those of ω: the change of the attitude from L and from `δ·L`.

use nalgebra::{Matrix3, SMatrix, UnitQuaternion, Vector3};

use crate::motion::free::FreeMotion;
use crate::motion::free::invariants::Invariants;

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
    pub(in crate::motion::free) fn scaled_sensitivity(
        &self,
        motion: &Invariants,
        t: f64,
    ) -> Sensitivity {
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
