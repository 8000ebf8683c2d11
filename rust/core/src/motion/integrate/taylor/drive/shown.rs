//! One motion with every step shown as it is made: for events.

use std::ops::ControlFlow;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::lanes::Lanes;
use crate::motion::integrate::taylor::batch::Batch;
use crate::motion::integrate::taylor::course::{AuxiliaryState, PiecewiseEquations};
use crate::motion::integrate::taylor::principal_frame::Precision;
use crate::motion::integrate::taylor::series::{Coefficient, Series};
use crate::motion::integrate::taylor::step::Compensated;
use crate::motion::state::Phase;
use crate::numerics::number::{Number, Real};

/// A step: polynomials in the time since its start, in body axes and real units.
#[derive(Clone, Debug)]
pub(crate) struct Step {
    /// When it begins and ends, since the start of the motion.
    pub(crate) ends: [f64; 2],
    /// What rounding left out of its beginning.
    rest: f64,
    /// The unit of rates: its polynomials are in time times this.
    unit: f64,
    /// ω and (x, y, z, w), from order 1 on; before those the state at the start, and what rounding left out of it.
    state: [f64; 7],
    change: [f64; 7],
    series: Vec<[f64; 7]>,
    /// Position and velocity, where they do not go on evenly.
    path: Vec<[f64; 6]>,
    /// The states of the load, from order 0 on, and what rounding left out at the start.
    own: Vec<Vec<f64>>,
    own_change: Vec<f64>,
    /// Position and velocity at the start of the motion.
    initial: [Vector3<f64>; 2],
}

impl Step {
    /// The state at a time since the start of the motion.
    pub(crate) fn at(&self, elapsed: f64) -> Phase {
        let within = ((elapsed - self.ends[0]) - self.rest) * self.unit;
        let mut sum = [0.0; 7];
        for order in self.series.iter().rev() {
            for (sum, coefficient) in sum.iter_mut().zip(order) {
                *sum = *sum * within + coefficient;
            }
        }
        for ((sum, state), change) in sum.iter_mut().zip(&self.state).zip(&self.change) {
            *sum = state + (*sum * within + change);
        }
        let [x, y, z, i, j, k, w] = sum;
        let [position, velocity] = self.path_at(elapsed, within);
        Phase {
            attitude: UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k)),
            omega: Vector3::new(x, y, z),
            position,
            velocity,
            own: self.own_at(within),
        }
    }

    fn own_at(&self, within: f64) -> Box<[f64]> {
        let states = self.own_change.iter().enumerate().map(|(i, change)| {
            let higher = self.own[1..].iter().rev();
            let sum = higher.fold(0.0, |sum, order| (sum + order[i]) * within);
            self.own[0][i] + (sum + change)
        });
        states.collect()
    }

    fn path_at(&self, elapsed: f64, within: f64) -> [Vector3<f64>; 2] {
        if self.path.is_empty() {
            let [position, velocity] = self.initial;
            return [position + velocity * elapsed, velocity];
        }
        let mut sum = [0.0; 6];
        for order in self.path.iter().rev() {
            for (sum, coefficient) in sum.iter_mut().zip(order) {
                *sum = *sum * within + coefficient;
            }
        }
        let [x, y, z, u, v, w] = sum;
        [Vector3::new(x, y, z), Vector3::new(u, v, w) * self.unit]
    }

    /// How far it turns, about, in radians.
    pub(crate) fn turn(&self) -> f64 {
        let speed = |phase: &Phase| phase.omega.norm();
        let fastest = speed(&self.at(self.ends[0])).max(speed(&self.at(self.ends[1])));
        (self.ends[1] - self.ends[0]).abs() * fastest
    }
}

/// Gets each step of a motion as it is made, and whether the motion has ended with it; may stop the run.
pub(in crate::motion::integrate::taylor) type Observer<'a> =
    &'a mut dyn FnMut(Step, bool) -> ControlFlow<()>;

/// What a step begins with.
pub(super) struct StepStart<'a, L: Number<Real: Precision>, const R: usize> {
    equations: PiecewiseEquations<'a, L::Real>,
    now: (f64, f64),
    state: Compensated<Batch<L, R>>,
    auxiliary: AuxiliaryState<L::Real>,
}

impl<'a, L, S, const B: usize, const R: usize> Lanes<'a, L, S, B, R>
where
    L: Number<Real: Precision>,
    S: Series<Batch<L, R>, B>,
{
    /// What the step that the first motion is to make begins with.
    #[inline(never)]
    pub(super) fn step_start(&self) -> Option<StepStart<'a, L, R>> {
        let motion = self.motions[0].as_ref()?;
        Some(StepStart {
            equations: motion.job.equations.clone(),
            now: self.now[0],
            state: self.state.clone(),
            auxiliary: self.auxiliary_state(0),
        })
    }

    /// The step that began with `before` and was the last one made.
    #[inline(never)]
    pub(super) fn finished_step(&self, before: StepStart<'a, L, R>) -> Step {
        let StepStart {
            equations,
            now,
            state,
            auxiliary,
        } = before;
        let order = self.settings.order;
        let mut series = Vec::with_capacity(order);
        for k in 1..=order {
            let Coefficient { w, q, .. } = self.series.get(k);
            let q = self.nonlinear.to_space(q);
            let [w0, w1, w2, x, y, z, s] = [w[0], w[1], w[2], q[0], q[1], q[2], q[3]];
            let coefficient = [w0, w1, w2, x, y, z, s].map(|number| number.real(0));
            series.push(equations.in_body(&coefficient).map(L::Real::rounded));
        }
        let mut own = Vec::new();
        if let Some(internal_states) = &self.internal_states {
            for k in 0..=order {
                let coefficients =
                    equations.internal_states_in_body(&internal_states.coefficients(0, k));
                own.push(coefficients.into_iter().map(L::Real::rounded).collect());
            }
        }
        // Of what is rounded to a double, which is much of it where the numbers have twice the precision.
        let own_change = equations
            .internal_states_in_body(&auxiliary.internal_states)
            .into_iter()
            .enumerate();
        let own_change: Vec<f64> = own_change
            .map(|(i, exact)| {
                let rounded: &Vec<f64> = &own[0];
                (exact - rounded[i].into()).rounded()
            })
            .collect();
        let unit = equations.unit();
        let end = self.motions[0].as_ref().map_or_else(
            || equations.last_elapsed(),
            |motion| (self.now[0].0 + self.now[0].1) / motion.job.equations.unit(),
        );
        let begin = (now.0 + now.1) / unit;
        let initial = equations.initial();
        let state_in_body =
            equations.in_body(&state.value.components().map(|number| number.real(0)));
        let rest_in_body = equations.in_body(&state.rest.components().map(|number| number.real(0)));
        let rounded = state_in_body.map(L::Real::rounded);
        let change = |i: usize| (state_in_body[i] - rounded[i].into() + rest_in_body[i]).rounded();
        Step {
            ends: [begin, end],
            rest: ((now.0 - begin * unit) + now.1) / unit,
            unit,
            state: rounded,
            change: std::array::from_fn(change),
            series,
            own,
            own_change,
            path: (self.translation.as_ref().zip(auxiliary.position_velocity))
                .map_or_else(Vec::new, |(translation, place)| {
                    translation.path(0, order, &place)
                }),
            initial: [initial.position, initial.velocity],
        }
    }
}
