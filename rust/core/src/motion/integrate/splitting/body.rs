//! A body as it drifts freely and is kicked by a load.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use super::scheme::Scheme;
use super::short_turn::short_turn;
use crate::error::Error;
use crate::mass::refined::RefinedPrincipal;
use crate::motion::attitude::{from_axes, restored};
use crate::motion::euler_equations::EulerEquations;
use crate::motion::free::FreeMotion;
use crate::motion::loads::Load;
use crate::motion::state::Phase;
use crate::numerics::double_double::two_sum;

/// A vector with what rounding has left out of its sum.
#[derive(Clone, Copy, Debug)]
struct Sum {
    value: Vector3<f64>,
    rest: Vector3<f64>,
}

impl Sum {
    fn of(value: Vector3<f64>) -> Self {
        Self {
            value,
            rest: Vector3::zeros(),
        }
    }

    fn add(&mut self, increment: &Vector3<f64>) {
        for i in 0..3 {
            (self.value[i], self.rest[i]) = two_sum(self.value[i], increment[i] + self.rest[i]);
        }
    }
}

/// A point of phase space by what a free motion keeps: L and the velocity change in kicks only.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// `q_NP`, P the principal axes.
    attitude: UnitQuaternion<f64>,
    /// L about the reference point, in N.
    momentum: Sum,
    position: Sum,
    velocity: Sum,
}

/// A body with two equal moments: it precesses about L at `L/I_t` and spins about its axis at `(1/I_s − 1/I_t) L_s`.
#[derive(Clone, Copy, Debug)]
struct Symmetry {
    axis: usize,
    transverse: f64,
    /// `1/I_s − 1/I_t`; zero for a body without axial moment, whose spin is kept beside.
    slip: f64,
    /// ω along an axis without a moment.
    spin: f64,
}

impl Symmetry {
    fn of(moments: &[f64; 3], massless: &Vector3<f64>) -> Option<Self> {
        let &[i1, i2, i3] = moments;
        let (axis, axial, transverse) = if i1 == i2 {
            (2, i3, i1)
        } else if i2 == i3 {
            (0, i1, i2)
        } else {
            return None;
        };
        let slip = if axial == 0.0 {
            0.0
        } else {
            (transverse - axial) / axial / transverse
        };
        (transverse > 0.0).then_some(Self {
            axis,
            transverse,
            slip,
            spin: massless[axis],
        })
    }

    fn turned(&self, point: &Point, time: f64) -> UnitQuaternion<f64> {
        let momentum = point.momentum.value;
        let along = point.attitude.inverse_transform_vector(&momentum)[self.axis];
        let mut spin = Vector3::zeros();
        spin[self.axis] = (self.slip * along + self.spin) * time;
        UnitQuaternion::from_scaled_axis(momentum * (time / self.transverse))
            * point.attitude
            * UnitQuaternion::from_scaled_axis(spin)
    }
}

/// The body as it drifts and is kicked.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body {
    /// Of a body that moves about.
    mass: Option<f64>,
    euler: EulerEquations,
    pub(super) moments: [f64; 3],
    principal: RefinedPrincipal,
    pub(super) q_bp: UnitQuaternion<f64>,
    /// ω along axes without a moment, in P: it stays as it is.
    massless: Vector3<f64>,
    symmetry: Option<Symmetry>,
    /// `(I₂ − I₃)/I₁` and cyclic, of a body that is not symmetric.
    kappa: [f64; 3],
}

impl Body {
    pub(super) fn of(euler: &EulerEquations, mass: Option<f64>, phase: &Phase) -> Self {
        let moments = euler.moments();
        let along = euler.axes().tr_mul(&phase.omega);
        let massless = Vector3::from_fn(|i, _| if moments[i] == 0.0 { along[i] } else { 0.0 });
        Self {
            mass,
            euler: *euler,
            moments,
            principal: RefinedPrincipal::from_principal(&moments, &Matrix3::identity()),
            q_bp: from_axes(euler.axes()),
            massless,
            symmetry: Symmetry::of(&moments, &massless),
            kappa: [0, 1, 2].map(|i| {
                // A point's ω stays as it is.
                if moments[i] == 0.0 {
                    0.0
                } else {
                    euler.differences()[i] / moments[i]
                }
            }),
        }
    }

    pub(super) fn point(&self, phase: &Phase) -> Point {
        let attitude = phase.attitude * self.q_bp;
        let along = self.q_bp.inverse_transform_vector(&phase.omega);
        let momentum = along.component_mul(&Vector3::from(self.moments));
        Point {
            attitude,
            momentum: Sum::of(attitude * momentum),
            position: Sum::of(phase.position),
            velocity: Sum::of(phase.velocity),
        }
    }

    /// ω in P.
    pub(super) fn omega(&self, point: &Point) -> Vector3<f64> {
        let along = point
            .attitude
            .inverse_transform_vector(&point.momentum.value);
        Vector3::from_fn(|i, _| {
            if self.moments[i] == 0.0 {
                self.massless[i]
            } else {
                along[i] / self.moments[i]
            }
        })
    }

    /// |ω|.
    pub(super) fn speed(&self, point: &Point) -> f64 {
        self.omega(point).norm()
    }

    pub(super) fn phase(&self, point: &Point) -> Phase {
        Phase {
            attitude: point.attitude * self.q_bp.conjugate(),
            omega: self.q_bp * self.omega(point),
            position: point.position.value,
            velocity: point.velocity.value,
            own: Box::default(),
        }
    }

    fn drift(&self, point: &mut Point, time: f64) -> Result<(), Error> {
        let attitude = if let Some(top) = self.symmetry {
            top.turned(point, time)
        } else {
            let omega = self.omega(point);
            let q = point.attitude.into_inner();
            if let Some([x, y, z, w]) = short_turn(&self.kappa, &(omega * time)) {
                UnitQuaternion::new_unchecked(q + q * Quaternion::new(w, x, y, z))
            } else {
                let motion = FreeMotion::refined(&self.principal, &omega, &point.attitude)?;
                motion.at(time).attitude
            }
        };
        point.attitude = restored(&attitude);
        point.position.add(&(point.velocity.value * time));
        Ok(())
    }

    fn kick<L: Load>(
        &self,
        point: &mut Point,
        load: &mut L,
        at: f64,
        time: f64,
    ) -> Result<(), L::Error> {
        let phase = self.phase(point);
        let wrench = load.wrench(at, &phase)?;
        let along = self.q_bp.inverse_transform_vector(&wrench.torque);
        if self.moments[0] == 0.0 {
            // Euler's equations say whether what has no moment can take the torque.
            (self.euler).principal_acceleration(&Vector3::zeros(), &along)?;
        }
        point.momentum.add(&(phase.attitude * wrench.torque * time));
        if let Some(mass) = self.mass {
            point.velocity.add(&(wrench.force * (time / mass)));
        }
        Ok(())
    }

    pub(super) fn step<L: Load>(
        &self,
        scheme: Scheme,
        point: &mut Point,
        load: &mut L,
        start: f64,
        h: f64,
    ) -> Result<(), L::Error> {
        let mut elapsed = 0.0;
        for i in 0..scheme.kicks() {
            let drift = scheme.drift(i) * h;
            self.drift(point, drift)?;
            elapsed += drift;
            self.kick(point, load, start + elapsed, scheme.kick(i) * h)?;
        }
        Ok(self.drift(point, scheme.drift(scheme.kicks()) * h)?)
    }

    /// Half the angle between two attitudes, or how far ω differ in parts of the larger one, whichever is more.
    pub(super) fn difference(&self, a: &Point, b: &Point) -> f64 {
        let (one, other) = (self.omega(a), self.omega(b));
        let most = one.norm().max(other.norm());
        let spin = if most == 0.0 {
            0.0
        } else {
            (one - other).norm() / most
        };
        let apart = a.attitude.conjugate() * b.attitude;
        spin.max(apart.imag().norm())
    }
}
