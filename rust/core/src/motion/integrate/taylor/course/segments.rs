//! A motion from break to break of its load, and what acts in each segment.

use nalgebra::{Matrix3, Matrix3x4, Vector3, Vector4};

use crate::error::{Error, MotionFault};
use crate::mass::validity::ROUNDING;
use crate::motion::integrate::taylor::frame::{Precision, Principal};
use crate::motion::loads::variables::Variables;
use crate::motion::loads::{PrincipalFrame, SeriesTerms, Term};
use crate::motion::problem::Task;
use crate::numerics::number::Real;
use crate::numerics::quaternion::product;

/// The scalar part w of a feedback's error, which is linear in the attitude (x, y, z, w), and the sign of it that the torques
/// are made for.
#[derive(Clone, Debug)]
struct Switch<X> {
    scalar: Vector4<X>,
    side: f64,
    /// What the torque is of the attitude.
    torque: Matrix3x4<X>,
    /// What the rates of states of the load are of it, by their numbers.
    own: Vec<(usize, Vector4<X>)>,
}

impl<X: Real> Switch<X> {
    fn value(&self, attitude: &[X; 4]) -> f64 {
        self.scalar.dot(&Vector4::from(*attitude)).rounded()
    }

    /// The sign of w in `state`; positive where it is zero.
    fn sign(&self, state: &[X; 7]) -> f64 {
        let [_, _, _, x, y, z, w] = *state;
        if self.value(&[x, y, z, w]) < 0.0 {
            -1.0
        } else {
            1.0
        }
    }
}

/// A motion on its way.
#[derive(Clone, Debug)]
pub(in crate::motion::integrate::taylor) struct Course<'a, X: Precision> {
    pub(super) task: Task<'a>,
    pub(super) terms: &'a [Term],
    /// Which numbers are varied, and the first column of each term.
    pub(super) variables: X::Variables,
    pub(super) firsts: Vec<usize>,
    pub(super) axes: Matrix3<X>,
    pub(super) q_bp: [X; 4],
    pub(super) kappa: Vector3<X>,
    pub(super) inverse_moments: Vector3<X>,
    pub(super) products: Vector3<X>,
    /// The ends of the segments, and which is under way.
    pub(super) breaks: Vec<f64>,
    pub(super) segment: usize,
    pub(super) linear: SeriesTerms<'a, X>,
    /// Of each feedback that acts, what changes its law.
    switches: Vec<Switch<X>>,
    /// The unit of rates: a power of two near the fastest of the motion.
    pub(super) unit: f64,
}

impl<'a, X: Precision> Course<'a, X> {
    /// The course of `task` under `terms`.
    ///
    /// # Errors
    /// When a term cannot act, or acts along an axis without a moment of inertia.
    pub(in crate::motion::integrate::taylor) fn new(
        task: &Task<'a>,
        terms: &'a [Term],
        variables: X::Variables,
    ) -> Result<Self, Error> {
        // After those of all terms stand the states of the load.
        let firsts = variables.columns(&mut terms.iter().map(Term::count).chain([0]));
        let principal = X::less(X::principal(task, variables), |principal| {
            turning(task, terms, principal, variables, &firsts)
        });
        let ([i1, i2, i3], [d1, d2, d3]) = (principal.moments, principal.differences);
        let one = X::one();
        let (start, end) = (task.times[0], task.times[task.times.len() - 1]);
        let mut breaks: Vec<f64> = terms.iter().flat_map(Term::breaks).collect();
        breaks.retain(|t| (t - start) * (t - end) < 0.0);
        breaks.push(end);
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        if end < start {
            breaks.reverse();
        }
        let mut course = Self {
            task: task.clone(),
            terms,
            variables,
            firsts,
            axes: principal.axes,
            q_bp: principal.q_bp,
            kappa: Vector3::new(over(d1, i1), over(d2, i2), over(d3, i3)),
            inverse_moments: Vector3::new(over(one, i1), over(one, i2), over(one, i3)),
            products: principal.products.into(),
            breaks,
            segment: 0,
            linear: SeriesTerms::default(),
            switches: Vec::new(),
            unit: 1.0,
        };
        let state = course.start();
        let mut from = start;
        for &to in &course.breaks {
            for (_, term) in course.acting(from, to) {
                term.check(&task.body_at_point, from, to)?;
            }
            from = to;
        }
        course.linearize(&state)?;
        Ok(course)
    }

    /// Past the end of a segment, in the state `state`.
    pub(in crate::motion::integrate::taylor) fn pass_break(
        &mut self,
        state: &[X; 7],
    ) -> Result<(), Error> {
        self.segment += 1;
        self.linearize(state)
    }

    /// What acts in the segment under way.
    fn linearize(&mut self, state: &[X; 7]) -> Result<(), Error> {
        let mut linear = SeriesTerms::default();
        let mut switches: Vec<Switch<X>> = Vec::new();
        for (first, term) in self.acting(self.segment_start(), self.breaks[self.segment]) {
            let (axes, mut side) = (self.principal_axes(first), 1.0);
            if let Some(scalar) = term.switch_function(&axes) {
                let torque = Matrix3x4::zeros();
                let mut switch = Switch {
                    scalar,
                    side,
                    torque,
                    own: Vec::new(),
                };
                switch.side = switch.sign(state);
                side = switch.side;
                let mut own = SeriesTerms::default();
                term.add_to(&mut own, &axes, side);
                switch.torque = own.on_attitude();
                let states = (linear.internal_states.len()..).zip(&own.internal_states);
                switch.own = states.map(|(i, state)| (i, state.on_attitude)).collect();
                switches.push(switch);
            }
            term.add_to(&mut linear, &axes, side);
        }
        self.switches = switches;
        self.check_massless(&linear, state)?;
        self.linear = linear;
        Ok(())
    }

    /// Those of the term whose first number is a variable of the column `first`.
    pub(super) fn principal_axes(&self, first: usize) -> PrincipalFrame<'_, X> {
        PrincipalFrame {
            body: &self.task.body_at_point,
            columns: &self.axes,
            q_bp: &self.q_bp,
            variables: self.variables,
            first,
            middle: self.middle(),
        }
    }

    /// A torque along an axis without moment of inertia has nothing to turn.
    fn check_massless(&self, linear: &SeriesTerms<'_, X>, state: &[X; 7]) -> Result<(), Error> {
        for (n, moment) in self.task.euler.moments().into_iter().enumerate() {
            if moment > 0.0 {
                continue;
            }
            let constant = linear.constant.map(X::rounded);
            let on_omega = linear.on_omega().map(X::rounded);
            let on_attitude = linear.on_attitude().map(X::rounded);
            let mut turned = on_omega;
            // ω along the axis is constant; where it is zero, what it would do does not matter.
            if state[n].rounded() == 0.0 {
                turned.column_mut(n).fill(0.0);
            }
            let mut parts = vec![
                (constant[n].abs(), constant.norm()),
                (turned.row(n).norm(), on_omega.norm()),
                (on_attitude.row(n).norm(), on_attitude.norm()),
            ];
            for formula in &linear.formulas {
                let matrix = formula.matrix.map(X::rounded);
                parts.push((matrix.row(n).norm(), matrix.norm()));
            }
            for (vector, matrix) in &linear.on_space {
                let (size, matrix) = (vector.map(X::rounded).norm(), matrix.map(X::rounded));
                parts.push((matrix.row(n).norm() * size, matrix.norm() * size));
            }
            for own in &linear.internal_states {
                let (torque, momentum) = (own.torque.map(X::rounded), own.momentum.map(X::rounded));
                let mut across = momentum;
                across[n] = 0.0;
                parts.push((torque[n].abs(), torque.norm()));
                parts.push((across.norm(), momentum.norm()));
            }
            let axis = self.axes.column(n).map(X::rounded);
            for (_, torque) in &linear.timed {
                parts.extend(torque.torques_along(&axis, self.middle()));
            }
            if let Some(&(torque, _)) = parts.iter().find(|(part, all)| *part > ROUNDING * all) {
                return Err(Error::Motion(MotionFault::TorqueAlongMasslessAxis {
                    torque,
                }));
            }
        }
        Ok(())
    }

    /// The terms that act between two breaks, each with the column of its first number.
    fn acting(&self, from: f64, to: f64) -> impl Iterator<Item = (usize, &'a Term)> {
        let middle = from + 0.5 * (to - from);
        (self.terms.iter().enumerate()).filter_map(move |(k, term)| {
            let first = self.firsts.get(k).copied().unwrap_or(0);
            Some((first, term.active(middle)?))
        })
    }

    fn segment_start(&self) -> f64 {
        match self.segment {
            0 => self.task.times[0],
            k => self.breaks[k - 1],
        }
    }

    pub(super) fn middle(&self) -> f64 {
        let from = self.segment_start();
        from + 0.5 * (self.breaks[self.segment] - from)
    }

    /// Whether the scalar part of a feedback's error has another sign in `state` than the torques are made for.
    pub(in crate::motion::integrate::taylor) fn has_flipped(&self, state: &[X; 7]) -> bool {
        (self.switches.iter()).any(|switch| switch.sign(state) != switch.side)
    }

    /// How many functions of the attitude change the law by their signs, and of number `index` the value in the attitude (x, y, z, w),
    /// or in a coefficient of its series, and the sign before the step.
    pub(in crate::motion::integrate::taylor) fn switches(&self) -> usize {
        self.switches.len()
    }

    pub(in crate::motion::integrate::taylor) fn switch_value(
        &self,
        index: usize,
        attitude: &[X; 4],
    ) -> f64 {
        self.switches[index].value(attitude)
    }

    pub(in crate::motion::integrate::taylor) fn side(&self, index: usize) -> f64 {
        self.switches[index].side
    }

    /// Takes the torques of the feedbacks for the signs in `state`. Neighbours that come to a change of sign later have been longer
    /// under the law before it: ω and the states of the load, of which they are the derivatives, become what they are for the law
    /// after it.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub(in crate::motion::integrate::taylor) fn flip(
        &mut self,
        state: &mut [X; 7],
        own: &mut [X],
    ) -> Result<(), Error> {
        let [w1, w2, w3, x, y, z, w] = *state;
        let attitude = Vector4::new(x, y, z, w);
        let zero = X::zero();
        let turn = Vector4::from(product([x, y, z, w], [w1, w2, w3, zero]));
        let over_moment = self.inverse_moments / X::from(self.unit) / X::from(self.unit);
        let before = *state;
        for switch in (self.switches.iter()).filter(|it| it.sign(&before) != it.side) {
            let rate = 0.5 * switch.scalar.dot(&turn).rounded();
            // The torque changes its sign.
            let more = switch.torque * attitude * X::from(2.0);
            for (omega, more) in state.iter_mut().zip(&more.component_mul(&over_moment)) {
                *omega += more.saltation(switch.scalar.dot(&attitude), rate);
            }
            for (number, on_attitude) in &switch.own {
                let more = on_attitude.dot(&attitude) * X::from(2.0) / X::from(self.unit);
                if let Some(own) = own.get_mut(*number) {
                    *own += more.saltation(switch.scalar.dot(&attitude), rate);
                }
            }
        }
        self.linearize(&before)
    }

    /// 1 or −1 for backward in time.
    pub(in crate::motion::integrate::taylor) fn direction(&self) -> f64 {
        if self.breaks[self.segment] < self.task.times[0] {
            -1.0
        } else {
            1.0
        }
    }
}

/// Σ J a aᵀ of the wheels that turn freely, in principal axes.
fn turning<X: Precision>(
    task: &Task<'_>,
    terms: &[Term],
    principal: &Principal<X>,
    variables: X::Variables,
    firsts: &[usize],
) -> Matrix3<X> {
    let mut linear = SeriesTerms::default();
    for (k, term) in terms.iter().enumerate() {
        if term.carried().is_some() {
            let axes = PrincipalFrame {
                body: &task.body_at_point,
                columns: &principal.axes,
                q_bp: &principal.q_bp,
                variables,
                first: firsts.get(k).copied().unwrap_or(0),
                middle: task.times[0],
            };
            term.add_to(&mut linear, &axes, 1.0);
        }
    }
    linear.turning
}

fn over<X: Real>(number: X, moment: X) -> X {
    if moment.rounded() > 0.0 {
        number / moment
    } else {
        X::zero()
    }
}
