//! The state of a motion under way, and its derivatives.

use nalgebra::{Quaternion, UnitQuaternion, Vector3, Vector6};

use super::numbers::{Columns, Number, increment};
use super::walk::Walk;
use crate::motion::attitude::from_axes;
use crate::motion::state::Phase;

impl Walk<'_> {
    /// The state now, in body axes and real units.
    pub(super) fn phase(&self) -> Phase {
        let [x, y, z, w] = self.attitude[0].map(|x| x.value);
        let q_pb = from_axes(&self.inertia.axes).conjugate();
        let omega = Vector3::from(self.omega[0].map(|x| x.value)) * self.units.rate;
        Phase {
            attitude: UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)) * q_pb,
            omega: self.inertia.axes * omega,
            ..self.task.initial
        }
    }

    /// The derivatives at the time `h` of the step.
    pub(super) fn columns(&self, h: f64) -> Columns {
        let moved = |x: &Number, row| *x + increment(row, h);
        let q = [0, 1, 2, 3].map(|i| moved(&self.attitude[0][i], &self.motion.attitude[i]));
        let omega = [0, 1, 2].map(|i| moved(&self.omega[0][i], &self.motion.omega[i]));
        let at = Quaternion::new(q[3].value, q[0].value, q[1].value, q[2].value);
        let twice = 2.0 / at.norm_squared();
        std::array::from_fn(|n| {
            let [x, y, z, w] = q.map(|x| x.slopes[n]);
            let tilt = (at.conjugate() * Quaternion::new(w, x, y, z)).imag() * twice;
            let tilt = self.inertia.axes * tilt;
            let own = Vector3::from(omega.map(|x| x.slopes[n])) * self.units.rate;
            let own = self.inertia.axes * own;
            Vector6::new(tilt.x, tilt.y, tilt.z, own.x, own.y, own.z)
        })
    }
}
