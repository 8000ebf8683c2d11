//! Runge-Kutta methods on the equations of motion: Euler's equations in principal axes, the attitude, and where a force acts on a free
//! body also the position.

use nalgebra::{Matrix3, Quaternion, SVector, UnitQuaternion, Vector3};

use super::stepper::{Carry, Dense, Scales, Span, Stepper};
use crate::motion::attitude::{from_axes, rate};
use crate::motion::euler_equations::EulerEquations;
use crate::motion::integrate::{Compensated, RungeKutta, System};
use crate::motion::loads::{Bearing, BodyAtPoint, LawSwitch, Load, Stiction, Wrench};
use crate::motion::problem::{Effort, Task, Tolerance};
use crate::motion::state::Phase;

/// A run of the method `M`, whose state has `N` numbers.
pub(super) struct RungeKuttaRun<'a, L, M, const N: usize> {
    equations: Equations<'a, L, N>,
    start: f64,
    method: M,
}

impl<'a, L: Load, M: RungeKutta<N>, const N: usize> RungeKuttaRun<'a, L, M, N> {
    pub(super) fn new(task: &Task<'_>, span: &Span, load: &'a mut L) -> Result<Self, L::Error> {
        let mut equations = Equations::new(
            &task.euler,
            &task.body_at_point,
            span.from,
            &span.phase,
            load,
            task.tolerance,
            span.carry.scales.clone(),
        );
        let y = equations.principal(&span.phase);
        let method = M::new(&mut equations, span.from, span.to, y, span.carry.step)?;
        Ok(Self {
            equations,
            start: span.from,
            method,
        })
    }
}

impl<L: Load, M: RungeKutta<N>, const N: usize> Dense for RungeKuttaRun<'_, L, M, N> {
    type Error = L::Error;

    #[inline]
    fn elapsed(&self) -> f64 {
        self.method.elapsed()
    }

    #[inline]
    fn phase(&self) -> Phase {
        (self.equations).phase(self.start + self.elapsed(), self.method.state())
    }

    #[inline]
    fn within(&mut self, elapsed: f64) -> Result<Phase, L::Error> {
        let y = self.method.within(&mut self.equations, elapsed)?;
        Ok(self.equations.phase(self.start + elapsed, &y))
    }

    #[inline]
    fn over_limit(&self, wheel: Option<usize>, elapsed: f64, phase: &Phase) -> f64 {
        (self.equations).over_limit(wheel, self.start + elapsed, phase)
    }

    #[inline]
    fn bearing_torque(
        &mut self,
        bearing: &Bearing,
        elapsed: f64,
        phase: &Phase,
    ) -> Result<f64, L::Error> {
        self.equations
            .bearing_torque(bearing, self.start + elapsed, phase)
    }
}

impl<L: Load, M: RungeKutta<N>, const N: usize> Stepper for RungeKuttaRun<'_, L, M, N> {
    #[inline]
    fn advance(&mut self) -> Result<(), L::Error> {
        self.method.advance(&mut self.equations)
    }

    #[inline]
    fn effort(&self) -> Effort {
        let progress = self.method.progress();
        Effort {
            steps: progress.steps,
            evaluations: progress.evaluations,
        }
    }

    #[inline]
    fn carry(&self) -> Carry {
        Carry {
            scales: self.equations.scales.clone(),
            step: Some(self.method.step()),
            scheme: None,
        }
    }

    #[inline]
    fn law_switches(&self) -> Vec<LawSwitch> {
        self.equations.law_switches()
    }
}

/// The numbers that turning takes: (x, y, z, w) of `q_NP` and ω in P, P the principal axes.
pub(super) const TURNING: usize = 7;
/// Those and position and velocity of C in N.
pub(super) const MOVING: usize = 13;
/// Those and up to three, eleven or 51 internal states of the load; what is left stays zero.
pub(super) const FEW: usize = 16;
pub(super) const SOME: usize = 24;
pub(super) const MANY: usize = 64;

/// Of a body at rest at the origin, on which a force begins to act, nobody knows yet which distance is large: no less than this part of
/// its radius of gyration.
const OF_SIZE: f64 = 1e-6;

/// The principal axes P as seen from B.
#[derive(Clone, Copy, Debug)]
struct AxesInBody {
    q_bp: UnitQuaternion<f64>,
    columns: Matrix3<f64>,
    /// Whether they are those of B, as of most bodies that are given by their moments.
    are_of_body: bool,
}

/// What makes a phase, which is in body axes, of the numbers of a state.
struct PhaseView {
    axes: AxesInBody,
    /// The wheels at rest in bearings with dry friction, in this span.
    resting: Option<Stiction>,
    /// When the reference point, if no force acts on it, was where; it keeps its velocity.
    origin: (f64, Vector3<f64>, Vector3<f64>),
}

/// `q̇ = ½ q∘ω`, `I ω̇ + ω×Iω = N`; and with N = [`MOVING`] or more `ṙ = v`, `m v̇ = F`, and internal states of the load.
struct Equations<'a, L, const N: usize> {
    euler: EulerEquations,
    mass: f64,
    /// The least distance that errors of the position are relative to.
    least_distance: f64,
    /// Whether the reference point is fixed in N.
    is_held: bool,
    view: PhaseView,
    load: &'a mut L,
    /// The state that the load is asked for. It is written in place, since a copy of it would wait until it is written.
    now: Phase,
    tolerance: Tolerance,
    scales: Scales,
    /// What counts as large of the internal states besides.
    sizes: Vec<[f64; 2]>,
    /// The rates of these states where the equations were asked last.
    rates: Vec<f64>,
}

impl<'a, L: Load, const N: usize> Equations<'a, L, N> {
    /// From the state `phase` at the time `start`.
    fn new(
        euler: &EulerEquations,
        body: &BodyAtPoint,
        start: f64,
        phase: &Phase,
        load: &'a mut L,
        tolerance: Tolerance,
        scales: Scales,
    ) -> Self {
        let states = phase.internal_state.len();
        let scales = Scales {
            internal_state: if scales.internal_state.is_empty() {
                vec![0.0; states]
            } else {
                scales.internal_state
            },
            ..scales
        };
        Self {
            sizes: load.sizes(),
            rates: vec![0.0; states],
            euler: *euler,
            mass: body.mass,
            least_distance: OF_SIZE * (euler.moments()[2] / body.mass).sqrt(),
            is_held: body.pivoted,
            view: PhaseView {
                axes: AxesInBody {
                    q_bp: from_axes(euler.axes()),
                    columns: *euler.axes(),
                    are_of_body: *euler.axes() == Matrix3::identity(),
                },
                resting: Stiction::of(euler, load.bearings()),
                origin: (start, phase.position, phase.velocity),
            },
            load,
            now: phase.clone(),
            tolerance,
            scales,
        }
    }

    /// In principal axes.
    #[inline]
    fn principal(&self, phase: &Phase) -> SVector<f64, N> {
        let q = (phase.attitude * self.view.axes.q_bp).into_inner();
        let w = self.view.axes.columns.tr_mul(&phase.omega);
        let (r, v) = (phase.position, phase.velocity);
        let numbers = [
            q.i, q.j, q.k, q.w, w.x, w.y, w.z, r.x, r.y, r.z, v.x, v.y, v.z,
        ];
        let mut y = SVector::<f64, N>::zeros();
        for (number, given) in y
            .iter_mut()
            .zip(numbers.iter().chain(&phase.internal_state))
        {
            *number = *given;
        }
        y
    }

    /// In body axes, at time `t`.
    #[inline]
    fn phase(&self, t: f64, y: &SVector<f64, N>) -> Phase {
        let mut phase = self.now.clone();
        self.view.show(t, y, &mut phase);
        phase
    }

    /// How many internal states the load has.
    #[inline]
    fn internal_states(&self) -> usize {
        self.scales.internal_state.len()
    }
}

impl<L: Load, const N: usize> Equations<'_, L, N> {
    /// What may change the law of the load within a step.
    fn law_switches(&self) -> Vec<LawSwitch> {
        self.load.law_switches()
    }

    /// As of the load.
    fn over_limit(&self, wheel: Option<usize>, t: f64, phase: &Phase) -> f64 {
        self.load.over_limit(wheel, t, phase)
    }

    /// The torque that a bearing at rest takes.
    fn bearing_torque(
        &mut self,
        bearing: &Bearing,
        t: f64,
        phase: &Phase,
    ) -> Result<f64, L::Error> {
        let mut rates = vec![0.0; self.internal_states()];
        let wrench = self.load.act(t, phase, &mut rates)?;
        let motor = rates[bearing.index()];
        if let Some(resting) = &self.view.resting {
            resting.hold(&phase.omega, &wrench.torque, &mut rates);
        }
        Ok(rates[bearing.index()] - motor)
    }
}

impl PhaseView {
    /// The state `y` at time `t` into `phase`, which has room for the internal states of the load.
    #[inline(always)]
    fn show<const N: usize>(&self, t: f64, y: &SVector<f64, N>, phase: &mut Phase) {
        let (mut q, mut omega) = (quaternion(y), vector(y, 4));
        if !self.axes.are_of_body {
            q *= self.axes.q_bp.conjugate().into_inner();
            omega = self.axes.columns * omega;
        }
        phase.attitude = UnitQuaternion::new_unchecked(q * (1.0 / q.norm_squared().sqrt()));
        phase.omega = omega;
        if N >= MOVING {
            (phase.position, phase.velocity) = (vector(y, 7), vector(y, 10));
        } else {
            let (start, position, velocity) = self.origin;
            (phase.position, phase.velocity) = (position + velocity * (t - start), velocity);
        }
        if N > MOVING {
            let states = phase.internal_state.len();
            (phase.internal_state).copy_from_slice(&y.as_slice()[MOVING..][..states]);
        }
        if let Some(resting) = &self.resting {
            resting.keep(phase);
        }
    }
}

#[inline]
fn quaternion<const N: usize>(y: &SVector<f64, N>) -> Quaternion<f64> {
    Quaternion::new(y[3], y[0], y[1], y[2])
}

#[inline]
fn vector<const N: usize>(y: &SVector<f64, N>, from: usize) -> Vector3<f64> {
    Vector3::new(y[from], y[from + 1], y[from + 2])
}

impl<L: Load, const N: usize> System<N> for Equations<'_, L, N> {
    type Error = L::Error;

    #[inline]
    fn derivative(
        &mut self,
        t: f64,
        y: &SVector<f64, N>,
        slope: &mut SVector<f64, N>,
    ) -> Result<(), L::Error> {
        let (view, phase) = (&self.view, &mut self.now);
        view.show(t, y, phase);
        let rates = &mut slope.as_mut_slice()[N.min(MOVING)..];
        rates.fill(0.0);
        let rates = &mut rates[..phase.internal_state.len()];
        // Number by number, as they were written: a copy of the whole, or of two at once, would wait for them.
        let (force, mut torque) = match self.load.act(t, phase, rates) {
            Ok(Wrench { force, torque }) => (
                Vector3::new(force.x, force.y, force.z),
                Vector3::new(torque.x, torque.y, torque.z),
            ),
            Err(error) => return Err(error),
        };
        if let Some(resting) = &view.resting {
            torque = resting.hold(&phase.omega, &torque, rates);
        }
        if !view.axes.are_of_body {
            torque = view.axes.columns.tr_mul(&torque);
        }
        // Read here and not before the load acts: numbers that were just written are slow to read in other pairs.
        let (q, w) = (quaternion(y), vector(y, 4));
        let turning = match self.euler.massive_acceleration(&w, &torque) {
            Some(turning) => turning,
            None => self.euler.massless_acceleration(&w, &torque)?.into(),
        };
        let q_rate = rate(&q, &w);
        (slope[0], slope[1], slope[2], slope[3]) = (q_rate.i, q_rate.j, q_rate.k, q_rate.w);
        for i in 0..3 {
            slope[4 + i] = turning[i];
        }
        let rates = &slope.as_slice()[N.min(MOVING)..];
        for (kept, rate) in self.rates.iter_mut().zip(rates) {
            *kept = *rate;
        }
        if N >= MOVING {
            // What is held does not move.
            let moving = if self.is_held {
                Vector3::zeros()
            } else {
                force / self.mass
            };
            for i in 0..3 {
                slope[7 + i] = y[10 + i];
                slope[10 + i] = moving[i];
            }
        }
        Ok(())
    }

    /// By the norms of attitude, ω, position and velocity, since single components pass through zero every turn.
    #[inline]
    fn error_norm(
        &self,
        _: &SVector<f64, N>,
        y_new: &SVector<f64, N>,
        error: &SVector<f64, N>,
    ) -> f64 {
        let Tolerance {
            relative, absolute, ..
        } = self.tolerance;
        let part = |from: usize, largest: f64, absolute: f64| {
            let size = vector(error, from).norm();
            if size == 0.0 {
                0.0
            } else {
                size / (absolute + relative * largest.max(vector(y_new, from).norm()))
            }
        };
        let parts = [
            quaternion(error).norm() / relative,
            part(4, self.scales.omega, absolute),
        ];
        let fastest = self.scales.omega.max(vector(y_new, 4).norm());
        let moving = if N >= MOVING {
            let least_speed = self.least_distance * fastest;
            [
                part(7, self.scales.position.max(self.least_distance), 0.0),
                part(10, self.scales.velocity.max(least_speed), 0.0),
            ]
        } else {
            [0.0; 2]
        };
        let largest_or_nan = |most: f64, &part: &f64| {
            if part.is_nan() || part > most {
                part
            } else {
                most
            }
        };
        let of_states = (0..self.internal_states()).map(|i| {
            let size = error[MOVING + i].abs();
            let [per_omega, least] = self.sizes[i];
            let natural = (per_omega * self.scales.omega).max(least);
            // Of a state that has been zero all the time nobody knows yet what is large: what it would come to while the body turns
            // by a radian. Relative to itself the error of one that grows as a power of the time is the same at any step.
            let begun = if self.scales.internal_state[i] == 0.0 && fastest > 0.0 {
                self.rates[i].abs() / fastest
            } else {
                self.scales.internal_state[i]
            };
            let scale = begun.max(y_new[MOVING + i].abs()).max(natural);
            if size == 0.0 || scale == 0.0 {
                0.0
            } else {
                size / (relative * scale)
            }
        });
        let body = parts.iter().chain(&moving).fold(0.0, largest_or_nan);
        of_states.fold(body, |most, part| largest_or_nan(most, &part))
    }

    #[inline]
    fn accept(&mut self, y: &mut Compensated<N>) {
        self.scales.omega = self.scales.omega.max(vector(&y.value, 4).norm());
        if N >= MOVING {
            self.scales.position = self.scales.position.max(vector(&y.value, 7).norm());
            self.scales.velocity = self.scales.velocity.max(vector(&y.value, 10).norm());
            for (largest, now) in self
                .scales
                .internal_state
                .iter_mut()
                .zip(&y.value.as_slice()[MOVING..])
            {
                *largest = largest.max(now.abs());
            }
        }
        // |q|² − 1 with what rounding left out, halved: the first-order correction, exact where it is small.
        let (q, rest) = (quaternion(&y.value), quaternion(y.rest()));
        let excess = 0.5 * ((q.norm() - 1.0) * (q.norm() + 1.0) + 2.0 * q.dot(&rest));
        let mut correction = SVector::zeros();
        for i in 0..4 {
            correction[i] = -excess * y.value[i];
        }
        *y = y.plus(&correction);
    }
}
