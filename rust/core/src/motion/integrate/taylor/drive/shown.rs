//! One motion with every step shown as it is made: for events.

use std::ops::ControlFlow;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::lanes::Lanes;
use crate::motion::integrate::taylor::course::{Besides, Course};
use crate::motion::integrate::taylor::frame::Precision;
use crate::motion::integrate::taylor::pack::Pack;
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
            internal_state: self.own_at(within),
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
pub(in crate::motion::integrate::taylor) type See<'a> =
    &'a mut dyn FnMut(Step, bool) -> ControlFlow<()>;

/// What a step begins with.
pub(super) struct Before<'a, L: Number<Real: Precision>, const R: usize> {
    course: Course<'a, L::Real>,
    now: (f64, f64),
    state: Compensated<Pack<L, R>>,
    besides: Besides<L::Real>,
}

impl<'a, L, S, const B: usize, const R: usize> Lanes<'a, L, S, B, R>
where
    L: Number<Real: Precision>,
    S: Series<Pack<L, R>, B>,
{
    /// What the step that the first motion is to make begins with.
    #[inline(never)]
    pub(super) fn before(&self) -> Option<Before<'a, L, R>> {
        let lead = self.leads[0].as_ref()?;
        Some(Before {
            course: lead.job.course.clone(),
            now: self.now[0],
            state: self.state.clone(),
            besides: self.besides(0),
        })
    }

    /// The step that began with `before` and was the last one made.
    #[inline(never)]
    pub(super) fn seen(&self, before: Before<'a, L, R>) -> Step {
        let Before {
            course,
            now,
            state,
            besides,
        } = before;
        let order = self.settings.order;
        let mut series = Vec::with_capacity(order);
        for k in 1..=order {
            let Coefficient { w, q, .. } = self.series.get(k);
            let q = self.extras.in_space(q);
            let [w0, w1, w2, x, y, z, s] = [w[0], w[1], w[2], q[0], q[1], q[2], q[3]];
            let coefficient = [w0, w1, w2, x, y, z, s].map(|number| number.real(0));
            series.push(course.in_body(&coefficient).map(L::Real::rounded));
        }
        let mut own = Vec::new();
        if let Some(carried) = &self.carried {
            for k in 0..=order {
                let coefficients = course.own_in_body(&carried.coefficients(0, k));
                own.push(coefficients.into_iter().map(L::Real::rounded).collect());
            }
        }
        // Of what is rounded to a double, which is much of it where the numbers have twice the precision.
        let own_change = course.own_in_body(&besides.own).into_iter().enumerate();
        let own_change: Vec<f64> = own_change
            .map(|(i, exact)| {
                let rounded: &Vec<f64> = &own[0];
                (exact - rounded[i].into()).rounded()
            })
            .collect();
        let unit = course.unit();
        let end = self.leads[0].as_ref().map_or_else(
            || course.last_elapsed(),
            |lead| (self.now[0].0 + self.now[0].1) / lead.job.course.unit(),
        );
        let begin = (now.0 + now.1) / unit;
        let initial = course.initial();
        let state_in_body = course.in_body(&state.value.all().map(|number| number.real(0)));
        let rest_in_body = course.in_body(&state.rest.all().map(|number| number.real(0)));
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
            path: (self.push.as_ref().zip(besides.place))
                .map_or_else(Vec::new, |(push, place)| push.path(0, order, &place)),
            initial: [initial.position, initial.velocity],
        }
    }
}
