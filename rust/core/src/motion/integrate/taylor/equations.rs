//! The equations of one motion: in principal axes, in a unit of rates of its own, in segments between the breaks of its load.
//! The numbers are doubles, double-double, or doubles with derivatives.

use nalgebra::{Matrix3, Matrix3x4, Quaternion, UnitQuaternion, Vector3, Vector4};

use super::batch::Batch;
use super::series::{Coefficient, is_unused};
use crate::error::{Error, MotionFault};
use crate::mass::refined::RefinedPrincipal;
use crate::mass::validity::ROUNDING;
use crate::motion::attitude::{components, from_axes};
use crate::motion::euler_equations::EulerEquations;
use crate::motion::kinematics::Frame;
use crate::motion::loads::variables::{
    ATTITUDE, Block, Fixed, MASS, MOMENTS, PRODUCTS, RATES, Variables, VariationJet, WIDTH,
};
use crate::motion::loads::{
    BodyAtPoint, Forcing, InternalState, LawNumber, ParameterColumns, PrincipalFrame,
    SeriesStructure, SeriesTerms, StepTime, Term, TorqueFormula,
};
use crate::motion::problem::Task;
use crate::motion::problem::limits::check_steps;
use crate::motion::state::Phase;
use crate::numerics::double_double::{DoubleDouble, two_sum};
use crate::numerics::number::{Number, Real};
use crate::numerics::power_of_two::power_below;
use crate::numerics::quaternion::{conjugate, normalized, product};

/// The equations of a motion, and the segment that it is in.
#[derive(Clone, Debug)]
pub(super) struct PiecewiseEquations<'a, X: Precision> {
    task: Task<'a>,
    terms: &'a [Term],
    /// The variables of the derivatives, and the columns of each term; last those of the states of the load.
    variables: X::Variables,
    parameters: Vec<ParameterColumns>,
    axes: Matrix3<X>,
    q_bp: [X; 4],
    kappa: Vector3<X>,
    inverse_moments: Vector3<X>,
    products: Vector3<X>,
    /// The ends of the segments, and the index of the present one.
    breaks: Vec<f64>,
    segment: usize,
    linear: SeriesTerms<'a, X>,
    /// The sign switches of the feedbacks that act.
    switches: Vec<Switch<X>>,
    /// The unit of rates: a power of two near the fastest rate of the motion.
    unit: f64,
}

/// What the orbits at the start of a step follow from: the load, and the time at which the step begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct CacheKey {
    /// The bits of the time since the start of the motion, of its rounding error, and of that start.
    pub(super) when: [u64; 3],
    /// The address of the terms of the load, which outlive the cache, and their number.
    pub(super) terms: (usize, usize),
}

/// The state beside attitude and ω.
#[derive(Clone, Debug, Default)]
pub(super) struct AuxiliaryState<X> {
    /// Position and velocity, in the unit of rates, if forces act on the body.
    pub(super) position_velocity: Option<[X; 6]>,
    /// The internal states of the load; vectors among them in principal axes.
    pub(super) internal_states: Vec<X>,
}

impl<'a, X: Precision> PiecewiseEquations<'a, X> {
    /// Return the equations of `task` under `terms`, in the first segment.
    ///
    /// # Errors
    /// When a term cannot act, or acts along an axis without a moment of inertia.
    pub(super) fn new(
        task: Task<'a>,
        terms: &'a [Term],
        variables: X::Variables,
    ) -> Result<Box<Self>, Error> {
        let each = terms.iter().map(Term::parameters);
        let parameters = variables.columns(&mut each.chain([Vec::new()]));
        let principal = X::subtract_wheels(X::principal(&task, variables), |principal| {
            free_wheel_tensor(&task, terms, principal, variables, &parameters)
        });
        let ([i1, i2, i3], [d1, d2, d3]) = (principal.moments, principal.differences);
        let one = X::one();
        let (start, end) = (task.times[0], task.times[task.times.len() - 1]);
        let each = terms.iter().map(|term| term.breaks(start, end));
        let mut breaks: Vec<f64> = each.flatten().collect();
        breaks.retain(|t| (t - start) * (t - end) < 0.0);
        breaks.push(end);
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        if end < start {
            breaks.reverse();
        }
        let mut equations = Box::new(Self {
            task,
            terms,
            variables,
            parameters,
            axes: principal.axes,
            q_bp: principal.q_bp,
            kappa: Vector3::new(
                quotient_or_zero(d1, i1),
                quotient_or_zero(d2, i2),
                quotient_or_zero(d3, i3),
            ),
            inverse_moments: Vector3::new(
                quotient_or_zero(one, i1),
                quotient_or_zero(one, i2),
                quotient_or_zero(one, i3),
            ),
            products: principal.products.into(),
            breaks,
            segment: 0,
            linear: SeriesTerms::default(),
            switches: Vec::new(),
            unit: 1.0,
        });
        let state = equations.start();
        let mut from = start;
        for &to in &equations.breaks {
            for (_, term) in equations.acting(from, to) {
                term.check(&equations.task.body_at_point, from, to)?;
            }
            from = to;
        }
        equations.linearize(&state)?;
        Ok(equations)
    }

    /// Enter the next segment in the state `state`.
    pub(super) fn pass_break(&mut self, state: &[X; 7]) -> Result<(), Error> {
        self.segment += 1;
        self.linearize(state)
    }

    /// Compute the terms of the present segment.
    fn linearize(&mut self, state: &[X; 7]) -> Result<(), Error> {
        let mut linear = SeriesTerms::default();
        let mut switches: Vec<Switch<X>> = Vec::new();
        for (index, term) in self.acting(self.segment_start(), self.breaks[self.segment]) {
            let (axes, mut side) = (self.principal_axes(index), 1.0);
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

    /// Return the axes for the term of this index.
    fn principal_axes(&self, index: usize) -> PrincipalFrame<'_, X> {
        PrincipalFrame {
            body: &self.task.body_at_point,
            columns: &self.axes,
            q_bp: &self.q_bp,
            variables: self.variables,
            parameters: columns_of(&self.parameters, index),
            term: index,
            middle: self.middle(),
        }
    }

    /// Check that no torque acts along an axis without moment of inertia.
    fn check_massless(&self, linear: &SeriesTerms<'_, X>, state: &[X; 7]) -> Result<(), Error> {
        for (n, moment) in self.task.euler.moments().into_iter().enumerate() {
            if moment > 0.0 {
                continue;
            }
            let constant = linear.constant.map(X::rounded);
            let on_omega = linear.on_omega().map(X::rounded);
            let on_attitude = linear.on_attitude().map(X::rounded);
            let mut turned = on_omega;
            // ω along the axis is constant. If it is zero, torques in proportion to it do not matter.
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

    /// Iterate over the terms that act between two breaks, each with its index.
    fn acting(&self, from: f64, to: f64) -> impl Iterator<Item = (usize, &'a Term)> {
        let middle = from + 0.5 * (to - from);
        (self.terms.iter().enumerate()).filter_map(move |(k, term)| Some((k, term.active(middle)?)))
    }

    fn segment_start(&self) -> f64 {
        match self.segment {
            0 => self.task.times[0],
            k => self.breaks[k - 1],
        }
    }

    fn middle(&self) -> f64 {
        let from = self.segment_start();
        from + 0.5 * (self.breaks[self.segment] - from)
    }

    /// Return whether the scalar part of the error of a feedback has changed its sign in `state`.
    pub(super) fn has_switched(&self, state: &[X; 7]) -> bool {
        (self.switches.iter()).any(|switch| switch.sign(state) != switch.side)
    }

    /// Return the number of functions of the attitude whose sign switches a law.
    pub(super) fn switch_count(&self) -> usize {
        self.switches.len()
    }

    /// Compute the function of this index for the attitude (x, y, z, w), or for a coefficient of its series.
    pub(super) fn switch_value(&self, index: usize, attitude: &[X; 4]) -> f64 {
        self.switches[index].value(attitude)
    }

    /// Return the sign of the function of this index before the step.
    pub(super) fn side(&self, index: usize) -> f64 {
        self.switches[index].side
    }

    /// Switch the laws of the feedbacks to the signs in `state`. A neighbouring motion, which switches later, has been longer under the
    /// law before: so the derivatives of ω and of the states of the load are corrected (saltation).
    ///
    /// # Errors
    /// As [`Self::new`].
    pub(super) fn switch_laws(&mut self, state: &mut [X; 7], own: &mut [X]) -> Result<(), Error> {
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

    /// Return 1, or −1 for backward in time.
    pub(super) fn direction(&self) -> f64 {
        if self.breaks[self.segment] < self.task.times[0] {
            -1.0
        } else {
            1.0
        }
    }

    pub(super) fn unit(&self) -> f64 {
        self.unit
    }

    /// Choose the unit of rates: the power of two at or below the fastest rate of the motion at ω (in principal axes). `own` are the
    /// states of the load.
    pub(super) fn choose_unit(&mut self, omega: &[f64; 3], own: &[X]) -> f64 {
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

    /// Compute the linear terms of the present segment.
    pub(super) fn linear_terms<const B: usize>(&self) -> LinearTerms<X, B> {
        let linear = &self.linear;
        let inverse = Matrix3::from_diagonal(&self.inverse_moments);
        let rate = X::from(1.0 / self.unit);
        let on_omega = inverse * linear.on_omega() * rate;
        let on_attitude = inverse * linear.on_attitude() * rate * rate;
        // The part of the tensor of wheels that turn freely: along the axes and across them.
        let (along, across) = (linear.turning.diagonal(), linear.turning);
        let pull = [(0, 1, 2), (1, 2, 0), (2, 0, 1)]
            .map(|(i, j, k)| self.kappa[i] + (along[j] - along[k]) * self.inverse_moments[i]);
        let off_diagonal =
            [(0, 1, 2), (1, 2, 0), (2, 0, 1)].map(|(i, j, k)| self.products[i] + across[(j, k)]);
        let mass = (self.variables).number(self.task.body_at_point.mass, MASS);
        let mut linear_terms = LinearTerms {
            kappa: self.kappa.into(),
            inverse_moments: self.inverse_moments.into(),
            products: self.products.into(),
            pull: (pull, off_diagonal),
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
            for (block, direction) in linear_terms.on_space.iter_mut().zip(&directions) {
                let part = scaled * vector.dot(&Vector3::from(*direction));
                for (row, more) in block.iter_mut().zip(rows(&part)) {
                    for (x, more) in row.iter_mut().zip(more) {
                        *x += more;
                    }
                }
            }
        }
        linear_terms
    }

    /// Iterate over the formulas of the present segment, each with its matrix over the moments in the unit of rates.
    pub(super) fn formulas(&self) -> impl Iterator<Item = (&TorqueFormula<X>, [[X; 3]; 3])> {
        let inverse = Matrix3::from_diagonal(&self.inverse_moments);
        self.linear.formulas.iter().map(move |formula| {
            // Units are powers of two.
            let scale = X::from(self.unit.powi(formula.degree - 2));
            (formula, rows(&(inverse * formula.matrix * scale)))
        })
    }

    /// Return the directions in N for torques fixed in space: the vertical axis, or all three axes.
    pub(super) fn directions<const B: usize>() -> [[X; 3]; B] {
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

    /// Add the terms that depend on time alone, at `now`.
    pub(super) fn force(&self, forcing: &mut Forcing<X>, now: (f64, f64)) {
        let when = StepTime {
            elapsed: X::pair(now.0, now.1) / X::from(self.unit),
            start: self.task.times[0],
            time: self.time(now),
            middle: self.middle(),
            unit: self.unit,
        };
        for (index, torque) in &self.linear.timed {
            let axes = self.principal_axes(*index);
            for (k, torque_k) in torque.cubic(&axes, &when).iter().enumerate() {
                match torque.frame() {
                    Frame::Body => forcing.in_body[k] += axes.principal(torque_k),
                    Frame::Space => forcing.in_space[k] += torque_k,
                }
            }
        }
        if !forcing.has_orbits {
            for (index, gradient) in &self.linear.gradients {
                let on_orbit = gradient.on_orbit(&self.principal_axes(*index), &when);
                forcing.orbits.push(on_orbit);
            }
        }
        for torque in &mut forcing.in_body {
            torque.component_mul_assign(&self.inverse_moments);
        }
    }

    /// Return the equations of the states of the load in the present segment.
    pub(super) fn internal_states(&self) -> &[InternalState<X>] {
        &self.linear.internal_states
    }

    pub(super) fn inverse_moments(&self) -> &Vector3<X> {
        &self.inverse_moments
    }

    pub(super) fn initial(&self) -> &Phase {
        &self.task.initial
    }

    /// Return the state at the start: ω in principal axes and the unit of rates, and (x, y, z, w) of the attitude.
    pub(super) fn start(&self) -> [X; 7] {
        let Phase {
            attitude, omega, ..
        } = self.task.initial;
        let attitude = (self.variables).vary_attitude(X::quaternion(&attitude), ATTITUDE);
        let [x, y, z, w] = product(attitude, self.q_bp);
        let omega = self.variables.vector(&omega, RATES);
        let omega = self.axes.tr_mul(&omega) / X::from(self.unit);
        [omega.x, omega.y, omega.z, x, y, z, w]
    }

    /// Compute the state in body axes and real units.
    pub(super) fn phase(
        &self,
        state: &[X; 7],
        auxiliary: &AuxiliaryState<X>,
        now: (f64, f64),
    ) -> Phase {
        let [x, y, z, i, j, k, w] = *state;
        let initial = self.initial();
        let (position, velocity) = if let Some(numbers) = auxiliary.position_velocity {
            let [x, y, z, u, v, w] = numbers.map(X::rounded);
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
            internal_state: if auxiliary.internal_states.is_empty() {
                Box::default()
            } else {
                let own = self
                    .internal_states_in_body(&auxiliary.internal_states)
                    .into_iter();
                own.map(X::rounded).collect()
            },
        }
    }

    /// Compute the states of the load at the start; vectors among them in principal axes.
    pub(super) fn internal_states_at_start(&self) -> Vec<X> {
        let first = columns_of(&self.parameters, self.terms.len()).first();
        let given = self.task.initial.internal_state.iter().enumerate();
        let given: Vec<X> = given
            .map(|(i, &x)| self.variables.number(x, first + i))
            .collect();
        self.rotate_internal_states(&given, |vector| self.axes.tr_mul(&vector))
    }

    /// Compute the states of the load, or coefficients of their series, with vectors among them in body axes.
    pub(super) fn internal_states_in_body(&self, own: &[X]) -> Vec<X> {
        self.rotate_internal_states(own, |vector| self.axes * vector)
    }

    /// Compute the values of the states of the load that are reported, in body axes.
    pub(super) fn reported_internal_states(&self, state: &[X; 7], own: &[X]) -> Vec<X> {
        let omega = Vector3::from_column_slice(&state[..3]) * X::from(self.unit);
        let states = self
            .internal_states_in_body(own)
            .into_iter()
            .zip(&self.linear.internal_states);
        states
            .map(|(value, state)| value + state.reported_on_omega.dot(&omega))
            .collect()
    }

    fn rotate_internal_states(&self, own: &[X], turn: impl Fn(Vector3<X>) -> Vector3<X>) -> Vec<X> {
        let mut turned = own.to_vec();
        for (number, state) in self.linear.internal_states.iter().enumerate() {
            if let Some((first, component)) = state.turned {
                let vector = turn(Vector3::from_column_slice(&own[first..first + 3]));
                turned[number] = vector[component];
            }
        }
        turned
    }

    /// Compute ω and (x, y, z, w) in body axes and real units, of a state or of a coefficient of its series.
    pub(super) fn in_body(&self, state: &[X; 7]) -> [X; 7] {
        let [x, y, z, i, j, k, w] = *state;
        let omega = self.axes * Vector3::new(x, y, z) * X::from(self.unit);
        let [i, j, k, w] = product([i, j, k, w], conjugate(self.q_bp));
        [omega.x, omega.y, omega.z, i, j, k, w]
    }

    /// Return the time of output `k` since the start.
    pub(super) fn output(&self, k: usize) -> (f64, f64) {
        self.since_start(self.task.times[k])
    }

    pub(super) fn end_of_segment(&self) -> (f64, f64) {
        self.since_start(self.breaks[self.segment])
    }

    /// Compute a time since the start in the unit of rates, with its rounding error.
    fn since_start(&self, t: f64) -> (f64, f64) {
        let (elapsed, rest) = two_sum(t, -self.task.times[0]);
        (elapsed * self.unit, rest * self.unit)
    }

    pub(super) fn time(&self, now: (f64, f64)) -> f64 {
        self.task.times[0] + (now.0 + now.1) / self.unit
    }

    /// Return the key of the orbit cache for a step that begins at `now`, and the unit of rates.
    #[inline(always)]
    pub(super) fn cache_key(&self, now: (f64, f64)) -> (CacheKey, f64) {
        let (start, unit) = (self.task.times[0], self.unit);
        let key = CacheKey {
            when: [now.0 / unit, now.1 / unit, start].map(f64::to_bits),
            terms: (self.terms.as_ptr().addr(), self.terms.len()),
        };
        (key, unit)
    }

    /// Return the length of the motion.
    pub(super) fn last_elapsed(&self) -> f64 {
        self.last_time() - self.task.times[0]
    }

    /// Return the time of an output.
    pub(super) fn time_of(&self, output: usize) -> f64 {
        self.task.times[output]
    }

    pub(super) fn is_last(&self, output: usize) -> bool {
        output + 1 == self.task.times.len()
    }

    pub(super) fn last_time(&self) -> f64 {
        self.task.times[self.task.times.len() - 1]
    }

    /// Return the largest number of steps that it may take.
    pub(super) fn most_steps(&self) -> u64 {
        self.task.tolerance.most_steps
    }

    /// Check that the motion can reach its end, after so many steps up to `now` in the unit of rates.
    pub(super) fn check_steps(&self, steps: u64, now: f64) -> Result<(), Error> {
        check_steps(
            self.task.tolerance.most_steps,
            steps,
            self.task.times[0],
            now / self.unit,
            self.last_elapsed(),
        )
    }

    /// Return the fraction of the motion that is done.
    pub(super) fn fraction(&self, now: f64) -> f64 {
        let times = self.task.times;
        now / self.unit / (times[times.len() - 1] - times[0])
    }
}

/// The sign switch of a feedback: the scalar part w of its error, which is linear in the attitude (x, y, z, w), and the sign of it for
/// which the torques are computed.
#[derive(Clone, Debug)]
struct Switch<X> {
    scalar: Vector4<X>,
    side: f64,
    /// The matrix from the attitude to the torque.
    torque: Matrix3x4<X>,
    /// The rates of states of the load, linear in the attitude, with the numbers of the states.
    own: Vec<(usize, Vector4<X>)>,
}

impl<X: Real> Switch<X> {
    fn value(&self, attitude: &[X; 4]) -> f64 {
        self.scalar.dot(&Vector4::from(*attitude)).rounded()
    }

    /// Return the sign of w in `state`; positive if w is zero.
    fn sign(&self, state: &[X; 7]) -> f64 {
        let [_, _, _, x, y, z, w] = *state;
        if self.value(&[x, y, z, w]) < 0.0 {
            -1.0
        } else {
            1.0
        }
    }
}

/// Compute Σ J a aᵀ of the wheels that turn freely, in principal axes.
fn free_wheel_tensor<X: Precision>(
    task: &Task<'_>,
    terms: &[Term],
    principal: &PrincipalInertia<X>,
    variables: X::Variables,
    parameters: &[ParameterColumns],
) -> Matrix3<X> {
    let mut linear = SeriesTerms::default();
    for (k, term) in terms.iter().enumerate() {
        if term.carried().is_some() {
            let axes = PrincipalFrame {
                body: &task.body_at_point,
                columns: &principal.axes,
                q_bp: &principal.q_bp,
                variables,
                parameters: columns_of(parameters, k),
                term: k,
                middle: task.times[0],
            };
            term.add_to(&mut linear, &axes, 1.0);
        }
    }
    linear.turning
}

/// Return the columns of the numbers of a term; none where nothing is varied.
fn columns_of(parameters: &[ParameterColumns], index: usize) -> &ParameterColumns {
    parameters.get(index).unwrap_or(ParameterColumns::NONE)
}

fn quotient_or_zero<X: Real>(number: X, moment: X) -> X {
    if moment.rounded() > 0.0 {
        number / moment
    } else {
        X::zero()
    }
}

/// Return the parts of the equations of a motion of `subject` under these terms, whether they are switched on or not. The principal axes
/// do not matter for it. `variables` are those of the derivatives; `has_path` is true if the path of the body is part of the motion.
pub(super) fn parts<X: LawNumber>(
    terms: &[Term],
    subject: &BodyAtPoint,
    variables: X::Variables,
    has_path: bool,
) -> SeriesStructure {
    let (zero, one) = (X::zero(), X::one());
    let mut linear = SeriesTerms::default();
    let parameters = variables.columns(&mut terms.iter().map(Term::parameters));
    for (k, term) in terms.iter().enumerate() {
        let axes = PrincipalFrame {
            body: subject,
            columns: &Matrix3::identity(),
            q_bp: &[zero, zero, zero, one],
            variables,
            parameters: columns_of(&parameters, k),
            term: k,
            middle: subject.start,
        };
        term.add_to(&mut linear, &axes, 1.0);
    }
    linear.structure(has_path)
}

fn rows<X: Real>(matrix: &Matrix3<X>) -> [[X; 3]; 3] {
    [0, 1, 2].map(|n| [0, 1, 2].map(|i| matrix[(n, i)]))
}

/// Moments and axes about the reference point.
#[derive(Clone, Copy, Debug)]
pub(super) struct PrincipalInertia<X> {
    /// I₁ ≤ I₂ ≤ I₃.
    pub(super) moments: [X; 3],
    /// I₂ − I₃, I₃ − I₁, I₁ − I₂.
    pub(super) differences: [X; 3],
    /// The elements 23, 31, 12 of the tensor: zero, but they may carry derivatives.
    pub(super) products: [X; 3],
    /// Columns, in B.
    pub(super) axes: Matrix3<X>,
    /// (x, y, z, w) of the rotation from principal axes to B.
    pub(super) q_bp: [X; 4],
}

/// The numbers of a run: doubles, double-double, or doubles with derivatives.
pub(super) trait Precision: LawNumber {
    /// Whether an orbit is continued from step to step by its own series, because Kepler's equation is solved in doubles only.
    const CARRIES_ORBITS: bool;
    /// Quadratic damping is left out while |ω| is below this part of its largest value. The error of ω, relative to the largest, is
    /// the cube of it; the error of derivatives is its square.
    const REST_SPEED: f64;
    /// Quadratic damping is also left out while |ω| is below this part of ω̇, in units of rates, so that the powers of the reciprocal
    /// in a series do not overflow. Relative to the other torques the damping is then as small as the square of it.
    const REST_SPEED_BESIDE_TORQUES: f64;
    /// Compute the principal frame of the body of a task.
    fn principal(task: &Task<'_>, variables: Self::Variables) -> PrincipalInertia<Self>;

    /// Subtract the derivatives of the tensor of wheels that turn freely, in these axes.
    fn subtract_wheels(
        principal: PrincipalInertia<Self>,
        _turning: impl FnOnce(&PrincipalInertia<Self>) -> Matrix3<Self>,
    ) -> PrincipalInertia<Self> {
        principal
    }

    /// Return the magnitudes of the value and of each derivative.
    fn magnitudes(self) -> [f64; WIDTH + 1] {
        let mut magnitudes = [0.0; WIDTH + 1];
        magnitudes[0] = self.rounded().abs();
        magnitudes
    }
}

impl Precision for f64 {
    const CARRIES_ORBITS: bool = false;
    const REST_SPEED: f64 = 2e-6;
    const REST_SPEED_BESIDE_TORQUES: f64 = 1e-10;

    fn principal(task: &Task<'_>, _: Fixed) -> PrincipalInertia<Self> {
        let axes = *task.euler.axes();
        PrincipalInertia {
            moments: task.euler.moments(),
            differences: task.euler.differences(),
            products: [0.0; 3],
            axes,
            q_bp: components(&from_axes(&axes)),
        }
    }
}

/// The numbers that define body and start are taken as exact: moments and axes, or the tensor; the direction of a quaternion.
impl Precision for DoubleDouble {
    const CARRIES_ORBITS: bool = true;
    const REST_SPEED: f64 = 2e-6;
    const REST_SPEED_BESIDE_TORQUES: f64 = 1e-7;

    fn principal(task: &Task<'_>, _: Fixed) -> PrincipalInertia<Self> {
        let refined = match &task.body_without_wheels {
            Some(body_without_wheels) => **body_without_wheels,
            None => RefinedPrincipal::about(task.body, &task.body_at_point.point),
        };
        let [i1, i2, i3] = refined.moments;
        let axes = refined.axes();
        PrincipalInertia {
            moments: refined.moments,
            differences: [i2 - i3, i3 - i1, i1 - i2],
            products: [Self::default(); 3],
            axes,
            q_bp: quaternion_of_matrix(&axes),
        }
    }
}

/// The tensor of a body with a zero moment has no derivatives: such a body has neighbours on one side only.
impl Precision for VariationJet {
    const CARRIES_ORBITS: bool = false;
    const REST_SPEED: f64 = 1e-8;
    const REST_SPEED_BESIDE_TORQUES: f64 = 1e-10;

    fn principal(task: &Task<'_>, block: Block) -> PrincipalInertia<Self> {
        let plain = <f64 as Precision>::principal(task, Fixed);
        let is_massless = plain.moments.contains(&0.0);
        let variable = |value: f64, column: usize| {
            if is_massless {
                Self::constant(value)
            } else {
                block.number(value, column)
            }
        };
        let mut principal = PrincipalInertia {
            moments: plain.moments.map(Self::constant),
            differences: plain.differences.map(Self::constant),
            products: [Self::constant(0.0); 3],
            axes: plain.axes.map(Self::constant),
            q_bp: plain.q_bp.map(Self::constant),
        };
        // The values are zero, the derivatives are not.
        let along = [0, 1, 2].map(|n| variable(0.0, MOMENTS + n));
        let [yz, zx, xy] = [0, 1, 2].map(|n| variable(0.0, PRODUCTS + n));
        let [x, y, z] = along;
        let mut tensor = Matrix3::new(x, xy, zx, xy, y, yz, zx, yz, z);
        if task.body_without_wheels.is_some() {
            // The variables are of the body with its wheels locked, in its axes.
            let whole = EulerEquations::refined_about(task.body, &task.body_at_point.point);
            let turn = (whole.axes().transpose() * plain.axes).map(Self::constant);
            tensor = turn.transpose() * tensor * turn;
        }
        principal.add(&tensor);
        principal
    }

    fn subtract_wheels(
        mut principal: PrincipalInertia<Self>,
        turning: impl FnOnce(&PrincipalInertia<Self>) -> Matrix3<Self>,
    ) -> PrincipalInertia<Self> {
        let turning = turning(&principal);
        principal.add(&(-turning));
        principal
    }

    fn magnitudes(self) -> [f64; WIDTH + 1] {
        let mut magnitudes = [self.value.abs(); WIDTH + 1];
        for (magnitude, slope) in magnitudes[1..].iter_mut().zip(&self.slopes) {
            *magnitude = slope.abs();
        }
        magnitudes
    }
}

impl PrincipalInertia<VariationJet> {
    /// Add the derivatives of a tensor in these axes.
    fn add(&mut self, tensor: &Matrix3<VariationJet>) {
        let slopes = |x: VariationJet| VariationJet { value: 0.0, ..x };
        for n in 0..3 {
            self.moments[n] += slopes(tensor[(n, n)]);
        }
        for (n, (i, j)) in [(1, 2), (2, 0), (0, 1)].into_iter().enumerate() {
            self.differences[n] += slopes(tensor[(i, i)] - tensor[(j, j)]);
            self.products[n] += slopes(tensor[(i, j)]);
        }
    }
}

/// Compute (x, y, z, w) of a rotation matrix, from the largest of the four.
///
/// Source: Shepperd, Journal of Guidance and Control 1 (1978) 223.
pub(super) fn quaternion_of_matrix<X: Real>(m: &Matrix3<X>) -> [X; 4] {
    let [x, y, z] = [0, 1, 2].map(|i| m[(i, i)]);
    let one = X::one();
    let squares = [
        one + x - y - z,
        one - x + y - z,
        one - x - y + z,
        one + x + y + z,
    ];
    let mut largest = 3;
    for i in 0..3 {
        if squares[i].rounded() > squares[largest].rounded() {
            largest = i;
        }
    }
    let sum = |i, j| m[(i, j)] + m[(j, i)];
    let difference = |i, j| m[(i, j)] - m[(j, i)];
    // Four times the products of component `largest` with all.
    let mut products = match largest {
        0 => [squares[0], sum(0, 1), sum(0, 2), difference(2, 1)],
        1 => [sum(0, 1), squares[1], sum(1, 2), difference(0, 2)],
        2 => [sum(0, 2), sum(1, 2), squares[2], difference(1, 0)],
        _ => [
            difference(2, 1),
            difference(0, 2),
            difference(1, 0),
            squares[3],
        ],
    };
    if products[3].rounded() < 0.0 {
        products = products.map(|x| -x);
    }
    normalized(products)
}

type Square<T> = [[T; 3]; 3];

/// `ω̇ = κ (ω₂ω₃, ω₃ω₁, ω₁ω₂) + c + A ω + Q q + Σ_b G_b γ_b`, components in principal axes.
///
/// κ₁ = (I₂ − I₃)/I₁ and cyclic; c a torque constant in the body, A damping, Q feedback, `G_b` torques of what is fixed in
/// space, each divided by the moments.
#[derive(Clone, Debug)]
pub(super) struct LinearTerms<T, const B: usize> {
    pub(super) kappa: [T; 3],
    /// One over the moments, and the elements 23, 31, 12 of the tensor: zero without derivatives.
    pub(super) inverse_moments: [T; 3],
    pub(super) products: [T; 3],
    /// κ and the elements 23, 31, 12 of the tensor for the gravity gradient: of the body with its wheels locked.
    pub(super) pull: ([T; 3], [T; 3]),
    pub(super) constant: [T; 3],
    pub(super) on_omega: Square<T>,
    pub(super) on_attitude: [[T; 4]; 3],
    pub(super) on_space: [Square<T>; B],
    /// Force over mass: constant in N, and constant in the body.
    pub(super) force: [T; 3],
    pub(super) thrust: [T; 3],
}

impl<T: Copy, const B: usize> LinearTerms<T, B> {
    /// Return terms that are all zero.
    #[inline(always)]
    pub(super) fn none(zero: T) -> Self {
        Self {
            kappa: [zero; 3],
            inverse_moments: [zero; 3],
            products: [zero; 3],
            pull: ([zero; 3], [zero; 3]),
            constant: [zero; 3],
            on_omega: [[zero; 3]; 3],
            on_attitude: [[zero; 4]; 3],
            on_space: [[[zero; 3]; 3]; B],
            force: [zero; 3],
            thrust: [zero; 3],
        }
    }
}

impl<X: Copy + Default + PartialEq, const B: usize> LinearTerms<X, B> {
    /// Return whether each component of ω is constant: that along the axis of a symmetric body without a torque about it.
    pub(super) fn constant_components(&self) -> [bool; 3] {
        let zero = X::default();
        [0, 1, 2].map(|n| {
            let on_space = self.on_space.iter().flat_map(|matrix| &matrix[n]);
            let pulled = self.pull.1.iter().chain([&self.pull.0[n]]);
            [self.kappa[n], self.constant[n]]
                .iter()
                .chain(pulled)
                .chain(&self.on_omega[n])
                .chain(&self.on_attitude[n])
                .chain(on_space)
                .all(|x| *x == zero)
        })
    }
}

impl<L: Number, const R: usize, const B: usize> LinearTerms<Batch<L, R>, B> {
    /// Set the terms of one row.
    #[inline(always)]
    pub(super) fn set(&mut self, row: usize, linear_terms: &LinearTerms<L::Real, B>) {
        for n in 0..3 {
            self.kappa[n].put(row, linear_terms.kappa[n]);
            (self.inverse_moments[n]).put(row, linear_terms.inverse_moments[n]);
            self.pull.0[n].put(row, linear_terms.pull.0[n]);
            self.pull.1[n].put(row, linear_terms.pull.1[n]);
            if L::VARIES {
                self.products[n].put(row, linear_terms.products[n]);
            }
            self.constant[n].put(row, linear_terms.constant[n]);
            self.force[n].put(row, linear_terms.force[n]);
            self.thrust[n].put(row, linear_terms.thrust[n]);
            for i in 0..3 {
                self.on_omega[n][i].put(row, linear_terms.on_omega[n][i]);
            }
            for i in 0..4 {
                self.on_attitude[n][i].put(row, linear_terms.on_attitude[n][i]);
            }
            for b in 0..B {
                for i in 0..3 {
                    self.on_space[b][n][i].put(row, linear_terms.on_space[b][n][i]);
                }
            }
        }
    }

    /// Compute a coefficient of ω̇, `is_first` where it is that of order zero, from the products of the series of ω and the coefficients
    /// of the same order.
    #[inline(always)]
    pub(super) fn acceleration(
        &self,
        parts: SeriesStructure,
        is_first: bool,
        products: [Batch<L, R>; 3],
        at: &Coefficient<Batch<L, R>, B>,
    ) -> [Batch<L, R>; 3] {
        // Written out: a loop would keep the sums in memory.
        let [mut x, mut y, mut z] = [Batch::new(0.0); 3];
        if is_first {
            let [a, b, c] = self.constant;
            [x, y, z] = [x + a, y + b, z + c];
        }
        for ([a, b, c], g) in self.on_space.iter().zip(&at.g) {
            if is_unused(g) {
                continue;
            }
            x = plus_product(a, g, x);
            y = plus_product(b, g, y);
            z = plus_product(c, g, z);
        }
        if parts.on_omega {
            let [a, b, c] = &self.on_omega;
            x = plus_product(a, &at.w, x);
            y = plus_product(b, &at.w, y);
            z = plus_product(c, &at.w, z);
        }
        if parts.on_attitude {
            let [a, b, c] = &self.on_attitude;
            x = plus_product(a, &at.q, x);
            y = plus_product(b, &at.q, y);
            z = plus_product(c, &at.q, z);
        }
        let ([a, b, c], [s, t, u]) = (self.kappa, products);
        [a.mul_add(s, x), b.mul_add(t, y), c.mul_add(u, z)]
    }
}

impl<L: Number, const R: usize, const B: usize> LinearTerms<Batch<L, R>, B> {
    /// Return whether elements off the diagonal of the tensor have derivatives.
    pub(super) fn has_off_diagonal(&self) -> bool {
        !are_zero(&self.products)
    }

    /// Return whether the tensor for the gravity gradient has elements off the diagonal.
    pub(super) fn pull_has_off_diagonal(&self) -> bool {
        !are_zero(&self.pull.1)
    }

    /// Compute the part of `−x×I x`, over the moments, that the elements 23, 31, 12 of a tensor make, from the coefficients of
    /// (x₂x₃, x₃x₁, x₁x₂) and of (x₁², x₂², x₃²); cyclic in i, j, k:
    ///
    /// ```text
    /// −I_ki x_i x_j + I_ij x_k x_i + I_jk (x_k² − x_j²)
    /// ```
    #[inline(always)]
    pub(super) fn off_diagonal_torque(
        &self,
        p: &[Batch<L, R>; 3],
        mixed: &[Batch<L, R>; 3],
        squares: &[Batch<L, R>; 3],
    ) -> [Batch<L, R>; 3] {
        let mut sum = [Batch::new(0.0); 3];
        for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            let torque = p[k] * mixed[j] - p[j] * mixed[k] + p[i] * (squares[k] - squares[j]);
            sum[i] = torque * self.inverse_moments[i];
        }
        sum
    }

    /// Compute `I⁻¹ N` to first order in these elements, from N over the moments.
    pub(super) fn divide_by_off_diagonal(&self, quotient: &[Batch<L, R>; 3]) -> [Batch<L, R>; 3] {
        let (p, a) = (&self.products, quotient);
        [(0, 1, 2), (1, 2, 0), (2, 0, 1)]
            .map(|(i, j, k)| a[i] - (p[k] * a[j] + p[j] * a[k]) * self.inverse_moments[i])
    }
}

fn are_zero<L: Number, const R: usize>(numbers: &[Batch<L, R>; 3]) -> bool {
    let is_zero = |x: &Batch<L, R>| (0..R).all(|row| x.real(row) == L::Real::default());
    numbers.iter().all(is_zero)
}

/// Compute `sum + a·b`.
#[inline(always)]
fn plus_product<L: Number, const R: usize, const N: usize>(
    a: &[Batch<L, R>; N],
    b: &[Batch<L, R>; N],
    mut sum: Batch<L, R>,
) -> Batch<L, R> {
    for i in 0..N {
        sum = a[i].mul_add(b[i], sum);
    }
    sum
}

#[cfg(test)]
mod tests {
    use nalgebra::{UnitQuaternion, Vector3};

    use super::*;
    use crate::numerics::quaternion::{conjugate, product};

    #[test]
    fn quaternions_of_matrices_turn_as_they_do() {
        for (roll, pitch, yaw) in [
            (0.3, -1.0, 2.0),
            (3.1, 0.1, -0.2),
            (0.1, 3.0, 0.2),
            (0.0, 0.1, 3.1),
        ] {
            let q = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
            let q = <DoubleDouble as LawNumber>::quaternion(&q);
            let turned = |i: usize| {
                let mut e = [DoubleDouble::default(); 4];
                e[i] = 1.0.into();
                let [x, y, z, _] = product(product(q, e), conjugate(q));
                Vector3::new(x, y, z)
            };
            let matrix = Matrix3::from_columns(&[turned(0), turned(1), turned(2)]);
            let again = quaternion_of_matrix(&matrix);
            let sign = if q[3].rounded() < 0.0 { -1.0 } else { 1.0 };
            for (a, b) in again.iter().zip(q) {
                assert!((*a - b * sign.into()).rounded().abs() < 1e-31);
            }
            assert!(again[3].rounded() >= 0.0);
        }
    }
}
