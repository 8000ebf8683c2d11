//! The unit of rates of a segment, its equations, and what in them depends on time.

use nalgebra::{Matrix3, Vector3};

use super::segments::Course;
use crate::motion::integrate::taylor::field::Field;
use crate::motion::integrate::taylor::frame::Precision;
use crate::motion::kinematics::Frame;
use crate::motion::loads::variables::{MASS, Variables};
use crate::motion::loads::{
    BodyAtPoint, Forcing, InternalState, LawNumber, PrincipalFrame, SeriesStructure, SeriesTerms,
    Term, TorqueFormula, When,
};
use crate::numerics::number::Real;
use crate::numerics::power_of_two::power_below;

impl<X: Precision> Course<'_, X> {
    pub(in crate::motion::integrate::taylor) fn unit(&self) -> f64 {
        self.unit
    }

    /// Takes the power of two at or below the fastest rate of the motion at ω (in principal axes) as the unit of rates.
    /// `own` are the states of the load.
    pub(in crate::motion::integrate::taylor) fn choose_unit(
        &mut self,
        omega: &[f64; 3],
        own: &[X],
    ) -> f64 {
        let (linear, inverse) = (&self.linear, self.inverse_moments.map(X::rounded));
        let over_moment = inverse.amax();
        let squares = [
            (linear.constant.map(X::rounded))
                .component_mul(&inverse)
                .amax(),
            linear.on_attitude().map(X::rounded).amax() * over_moment,
        ];
        let on_space = linear.on_space.iter();
        let on_space = on_space.map(|(vector, matrix)| {
            vector.map(X::rounded).amax() * matrix.map(X::rounded).amax() * over_moment
        });
        let middle = self.middle();
        let timed = (linear.timed.iter()).map(|(_, torque)| {
            torque.square_of_rate(&self.task.body_at_point, middle, over_moment)
        });
        let gradients = (linear.gradients.iter())
            .map(|(_, gradient)| gradient.square_of_rate(&self.task.body_at_point));
        let timed = timed.chain(gradients);
        let (mut momentum, mut torque, mut decay) = (Vector3::zeros(), Vector3::zeros(), 0.0_f64);
        for (state, &value) in linear.internal_states.iter().zip(own) {
            momentum += state.momentum.map(X::rounded) * value.rounded();
            torque += state.torque.map(X::rounded) * value.rounded();
            decay = decay.max(state.on_itself.rounded().abs());
        }
        let by_own = torque.component_mul(&inverse).amax();
        let squares = squares.into_iter().chain([by_own]);
        let square = (squares.chain(on_space).chain(timed)).fold(0.0, f64::max);
        let rate = Vector3::from(*omega)
            .amax()
            .max(linear.on_omega().map(X::rounded).amax() * over_moment)
            .max(momentum.amax() * over_moment)
            .max(decay)
            .max(square.sqrt());
        self.unit = power_below(rate);
        self.unit
    }

    /// The equations in the segment under way.
    pub(in crate::motion::integrate::taylor) fn field<const B: usize>(&self) -> Field<X, B> {
        let linear = &self.linear;
        let inverse = Matrix3::from_diagonal(&self.inverse_moments);
        let rate = X::from(1.0 / self.unit);
        let on_omega = inverse * linear.on_omega() * rate;
        let on_attitude = inverse * linear.on_attitude() * rate * rate;
        // What the wheels that turn freely add to the tensor, along the axes and across them.
        let (along, across) = (linear.turning.diagonal(), linear.turning);
        let pulled = [(0, 1, 2), (1, 2, 0), (2, 0, 1)]
            .map(|(i, j, k)| self.kappa[i] + (along[j] - along[k]) * self.inverse_moments[i]);
        let aside =
            [(0, 1, 2), (1, 2, 0), (2, 0, 1)].map(|(i, j, k)| self.products[i] + across[(j, k)]);
        let mass = (self.variables).number(self.task.body_at_point.mass, MASS);
        let mut field = Field {
            kappa: self.kappa.into(),
            inverse_moments: self.inverse_moments.into(),
            products: self.products.into(),
            pull: (pulled, aside),
            constant: (inverse * linear.constant * rate * rate).into(),
            on_omega: rows(&on_omega),
            on_attitude: [0, 1, 2].map(|n| [0, 1, 2, 3].map(|i| on_attitude[(n, i)])),
            on_space: [[[X::zero(); 3]; 3]; B],
            force: (linear.force() / mass * rate * rate).into(),
            thrust: (linear.thrust() / mass * rate * rate).into(),
        };
        let directions = Self::directions::<B>();
        for (vector, matrix) in &linear.on_space {
            let scaled = inverse * matrix * rate * rate;
            for (block, direction) in field.on_space.iter_mut().zip(&directions) {
                let part = scaled * vector.dot(&Vector3::from(*direction));
                for (row, more) in block.iter_mut().zip(rows(&part)) {
                    for (x, more) in row.iter_mut().zip(more) {
                        *x += more;
                    }
                }
            }
        }
        field
    }

    /// The formulas of the segment under way, each with its matrix over the moments in units of rates.
    pub(in crate::motion::integrate::taylor) fn formulas(
        &self,
    ) -> impl Iterator<Item = (&TorqueFormula<X>, [[X; 3]; 3])> {
        let inverse = Matrix3::from_diagonal(&self.inverse_moments);
        self.linear.formulas.iter().map(move |formula| {
            // Units are powers of two.
            let scale = X::from(self.unit.powi(formula.degree - 2));
            (formula, rows(&(inverse * formula.matrix * scale)))
        })
    }

    /// The directions in N that the torques of what is fixed in space are made of: the vertical axis, or all.
    pub(in crate::motion::integrate::taylor) fn directions<const B: usize>() -> [[X; 3]; B] {
        let (zero, one) = (X::zero(), X::one());
        let mut directions = [[zero, zero, one]; B];
        if B > 1 {
            for (i, direction) in directions.iter_mut().enumerate() {
                *direction = [zero; 3];
                direction[i] = one;
            }
        }
        directions
    }

    /// Adds what depends on the time alone, as it is at `now`.
    pub(in crate::motion::integrate::taylor) fn force(
        &self,
        forcing: &mut Forcing<X>,
        now: (f64, f64),
    ) {
        let when = When {
            elapsed: X::pair(now.0, now.1) / X::from(self.unit),
            start: self.task.times[0],
            time: self.time(now),
            middle: self.middle(),
            unit: self.unit,
        };
        for (first, torque) in &self.linear.timed {
            let axes = self.principal_axes(*first);
            for (k, torque_k) in torque.cubic(&axes, &when).iter().enumerate() {
                match torque.frame() {
                    Frame::Body => forcing.in_body[k] += axes.principal(torque_k),
                    Frame::Space => forcing.in_space[k] += torque_k,
                }
            }
        }
        if !forcing.has_orbits {
            for (first, gradient) in &self.linear.gradients {
                let on_orbit = gradient.on_orbit(&self.principal_axes(*first), &when);
                forcing.orbits.push(on_orbit);
            }
        }
        for torque in &mut forcing.in_body {
            torque.component_mul_assign(&self.inverse_moments);
        }
    }

    /// What the states of the load do in the segment under way.
    pub(in crate::motion::integrate::taylor) fn own(&self) -> &[InternalState<X>] {
        &self.linear.internal_states
    }

    pub(in crate::motion::integrate::taylor) fn inverse_moments(&self) -> &Vector3<X> {
        &self.inverse_moments
    }
}

/// What the equations of a motion of `subject` under these terms are made of, in numbers of which `variables` are varied: what
/// they add, switched on or not. The principal axes do not matter for it. `has_path` where the path of the body is part of the
/// motion.
pub(in crate::motion::integrate::taylor) fn parts<X: LawNumber>(
    terms: &[Term],
    subject: &BodyAtPoint,
    variables: X::Variables,
    has_path: bool,
) -> SeriesStructure {
    let (zero, one) = (X::zero(), X::one());
    let mut linear = SeriesTerms::default();
    let firsts = variables.columns(&mut terms.iter().map(Term::count));
    for (k, term) in terms.iter().enumerate() {
        let axes = PrincipalFrame {
            body: subject,
            columns: &Matrix3::identity(),
            q_bp: &[zero, zero, zero, one],
            variables,
            first: firsts.get(k).copied().unwrap_or(0),
            middle: subject.start,
        };
        term.add_to(&mut linear, &axes, 1.0);
    }
    linear.structure(has_path)
}

fn rows<X: Real>(matrix: &Matrix3<X>) -> [[X; 3]; 3] {
    [0, 1, 2].map(|n| [0, 1, 2].map(|i| matrix[(n, i)]))
}
