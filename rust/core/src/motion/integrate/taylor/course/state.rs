//! States in principal axes and units of the run, and in body axes and real units.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::segments::Course;
use crate::motion::integrate::taylor::frame::Precision;
use crate::motion::loads::variables::{ATTITUDE, RATES, Variables};
use crate::motion::state::Phase;
use crate::numerics::quaternion::{conjugate, normalized, product};

/// What goes on beside attitude and ω.
#[derive(Clone, Debug, Default)]
pub(in crate::motion::integrate::taylor) struct Besides<X> {
    /// Position and velocity, in units of the unit of rates, of a body that is pushed.
    pub(in crate::motion::integrate::taylor) place: Option<[X; 6]>,
    /// The states of the load, vectors among them in principal axes.
    pub(in crate::motion::integrate::taylor) own: Vec<X>,
}

impl<X: Precision> Course<'_, X> {
    pub(in crate::motion::integrate::taylor) fn initial(&self) -> &Phase {
        &self.task.initial
    }

    /// ω in principal axes and units of the unit of rates, and (x, y, z, w) of the attitude.
    pub(in crate::motion::integrate::taylor) fn start(&self) -> [X; 7] {
        let Phase {
            attitude, omega, ..
        } = self.task.initial;
        let attitude = (self.variables).turned(X::quaternion(&attitude), ATTITUDE);
        let [x, y, z, w] = product(attitude, self.q_bp);
        let omega = self.variables.vector(&omega, RATES);
        let omega = self.axes.tr_mul(&omega) / X::from(self.unit);
        [omega.x, omega.y, omega.z, x, y, z, w]
    }

    /// The state in body axes and real units.
    pub(in crate::motion::integrate::taylor) fn phase(
        &self,
        state: &[X; 7],
        besides: &Besides<X>,
        now: (f64, f64),
    ) -> Phase {
        let [x, y, z, i, j, k, w] = *state;
        let initial = self.initial();
        let (position, velocity) = if let Some(place) = besides.place {
            let [x, y, z, u, v, w] = place.map(X::rounded);
            (Vector3::new(x, y, z), Vector3::new(u, v, w) * self.unit)
        } else {
            let elapsed = (now.0 + now.1) / self.unit;
            (
                initial.position + initial.velocity * elapsed,
                initial.velocity,
            )
        };
        let q_nb = normalized(product([i, j, k, w], conjugate(self.q_bp)));
        let [i, j, k, w] = q_nb.map(X::rounded);
        Phase {
            attitude: UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k)),
            omega: (self.axes * Vector3::new(x, y, z)).map(X::rounded) * self.unit,
            position,
            velocity,
            internal_state: if besides.own.is_empty() {
                Box::default()
            } else {
                let own = self.own_in_body(&besides.own).into_iter();
                own.map(X::rounded).collect()
            },
        }
    }

    /// The load's own states at the start, vectors among them in principal axes.
    pub(in crate::motion::integrate::taylor) fn own_at_start(&self) -> Vec<X> {
        let first = self.firsts.get(self.terms.len()).copied().unwrap_or(0);
        let given = self.task.initial.internal_state.iter().enumerate();
        let given: Vec<X> = given
            .map(|(i, &x)| self.variables.number(x, first + i))
            .collect();
        self.own_turned(&given, |vector| self.axes.tr_mul(&vector))
    }

    /// The load's own states, or coefficients of their series, vectors among them in body axes.
    pub(in crate::motion::integrate::taylor) fn own_in_body(&self, own: &[X]) -> Vec<X> {
        self.own_turned(own, |vector| self.axes * vector)
    }

    /// What is reported of the load's own states, in body axes.
    pub(in crate::motion::integrate::taylor) fn own_reported(
        &self,
        state: &[X; 7],
        own: &[X],
    ) -> Vec<X> {
        let omega = Vector3::from_column_slice(&state[..3]) * X::from(self.unit);
        let states = self
            .own_in_body(own)
            .into_iter()
            .zip(&self.linear.internal_states);
        states
            .map(|(value, state)| value + state.reported_on_omega.dot(&omega))
            .collect()
    }

    fn own_turned(&self, own: &[X], turn: impl Fn(Vector3<X>) -> Vector3<X>) -> Vec<X> {
        let mut turned = own.to_vec();
        for (number, state) in self.linear.internal_states.iter().enumerate() {
            if let Some((first, component)) = state.turned {
                let vector = turn(Vector3::from_column_slice(&own[first..first + 3]));
                turned[number] = vector[component];
            }
        }
        turned
    }

    /// ω and (x, y, z, w) in body axes and real units of a state, or of a coefficient of its series.
    pub(in crate::motion::integrate::taylor) fn in_body(&self, state: &[X; 7]) -> [X; 7] {
        let [x, y, z, i, j, k, w] = *state;
        let omega = self.axes * Vector3::new(x, y, z) * X::from(self.unit);
        let [i, j, k, w] = product([i, j, k, w], conjugate(self.q_bp));
        [omega.x, omega.y, omega.z, i, j, k, w]
    }
}
