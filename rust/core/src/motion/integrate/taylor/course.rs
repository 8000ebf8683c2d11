//! One motion as the stepper needs it: in principal axes, in a unit of time of its own, from break to break of its load.

use nalgebra::{Matrix3, Matrix3x4, Quaternion, UnitQuaternion, Vector3, Vector4};

use super::field::{Field, Parts};
use super::frame::{Precision, conjugate, cross_matrix, normalized, product};
use super::moment::{Moment, Orbit};
use crate::error::{Error, MotionFault};
use crate::mass::validity::ROUNDING;
use crate::motion::loads::{Feedback, Frame, GravityGradient, Sampled, Term};
use crate::motion::simulate::{Task, check_steps};
use crate::motion::state::Phase;
use crate::numerics::double_double::two_sum;
use crate::numerics::number::Real;

/// What acts between two breaks, linear in what varies: torques about the reference point in principal axes.
#[derive(Clone, Debug)]
struct Linear<'a, X> {
    constant: Vector3<X>,
    on_omega: Matrix3<X>,
    on_attitude: Matrix3x4<X>,
    /// E of quadratic damping.
    quadratic: Matrix3<X>,
    /// Torques `M R_PN v` of vectors v fixed in space.
    on_space: Vec<(Vector3<X>, Matrix3<X>)>,
    /// Forces in N, and in principal axes.
    force: Vector3<X>,
    thrust: Vector3<X>,
    sampled: Vec<&'a Sampled>,
    gradients: Vec<&'a GravityGradient>,
}

impl<X: Real> Default for Linear<'_, X> {
    fn default() -> Self {
        Self {
            constant: Vector3::zeros(),
            on_omega: Matrix3::zeros(),
            on_attitude: Matrix3x4::zeros(),
            quadratic: Matrix3::zeros(),
            on_space: Vec::new(),
            force: Vector3::zeros(),
            thrust: Vector3::zeros(),
            sampled: Vec::new(),
            gradients: Vec::new(),
        }
    }
}

/// The scalar part w of a feedback's error, which is linear in the attitude (x, y, z, w), and the sign of it that the torques
/// are made for.
#[derive(Clone, Copy, Debug)]
struct Switch<X> {
    scalar: Vector4<X>,
    side: f64,
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
pub(super) struct Course<'a, X> {
    task: Task<'a>,
    terms: &'a [Term],
    axes: Matrix3<X>,
    q_bp: [X; 4],
    kappa: Vector3<X>,
    inverse_moments: Vector3<X>,
    /// The ends of the segments, and which is under way.
    breaks: Vec<f64>,
    segment: usize,
    linear: Linear<'a, X>,
    /// Of each feedback that acts, what changes its law.
    switches: Vec<Switch<X>>,
    /// The unit of rates: a power of two near the fastest of the motion.
    unit: f64,
}

impl<'a, X: Precision> Course<'a, X> {
    /// The course of `task` under `terms`.
    ///
    /// # Errors
    /// When a term cannot act, or acts along an axis without a moment of inertia.
    pub(super) fn new(task: &Task<'a>, terms: &'a [Term]) -> Result<Self, Error> {
        let principal = X::principal(task);
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
            task: *task,
            terms,
            axes: principal.axes,
            q_bp: principal.q_bp,
            kappa: Vector3::new(over(d1, i1), over(d2, i2), over(d3, i3)),
            inverse_moments: Vector3::new(over(one, i1), over(one, i2), over(one, i3)),
            breaks,
            segment: 0,
            linear: Linear::default(),
            switches: Vec::new(),
            unit: 1.0,
        };
        let state = course.start();
        let mut from = start;
        for &to in &course.breaks {
            for term in course.acting(from, to) {
                term.check(&task.subject, from, to)?;
            }
            from = to;
        }
        course.linearize(&state)?;
        Ok(course)
    }

    /// Past the end of a segment, in the state `state`.
    pub(super) fn pass_break(&mut self, state: &[X; 7]) -> Result<(), Error> {
        self.segment += 1;
        self.linearize(state)
    }

    /// What acts in the segment under way.
    fn linearize(&mut self, state: &[X; 7]) -> Result<(), Error> {
        let mut linear = Linear::default();
        let mut switches: Vec<Switch<X>> = Vec::new();
        for term in self.acting(self.segment_start(), self.breaks[self.segment]) {
            if let Term::Feedback(feedback) = term {
                let scalar = self.error_scalar(feedback);
                let mut switch = Switch { scalar, side: 1.0 };
                switch.side = switch.sign(state);
                switches.push(switch);
            }
            let side = switches.last().map_or(1.0, |switch| switch.side);
            self.add(&mut linear, term, side);
        }
        self.switches = switches;
        self.check_massless(&linear, state)?;
        self.linear = linear;
        Ok(())
    }

    fn add(&self, linear: &mut Linear<'a, X>, term: &'a Term, sign: f64) {
        let subject = &self.task.subject;
        let exact = |vector: &Vector3<f64>| vector.map(X::from);
        let in_p = |vector: &Vector3<X>| self.axes.tr_mul(vector);
        let turned = |matrix: &Matrix3<f64>| self.axes.tr_mul(&matrix.map(X::from)) * self.axes;
        match term {
            Term::ConstantTorque { vector, frame } => match frame {
                Frame::Body => linear.constant += in_p(&exact(vector)),
                Frame::Space => linear.on_space.push((exact(vector), Matrix3::identity())),
            },
            Term::ConstantForce {
                vector,
                frame,
                point,
            } => {
                let arm = point.map_or(exact(&subject.center), |point| {
                    exact(&point) - exact(&subject.point)
                });
                let vector = exact(vector);
                match frame {
                    Frame::Body => {
                        linear.constant += in_p(&arm.cross(&vector));
                        linear.thrust += in_p(&vector);
                    }
                    Frame::Space => {
                        if turns(term, subject.pivoted) {
                            let lever = cross_matrix(&in_p(&arm));
                            linear.on_space.push((vector, lever));
                        }
                        linear.force += vector;
                    }
                }
            }
            Term::UniformGravity { gravity } => {
                let (gravity, mass) = (exact(gravity), X::from(subject.mass));
                if subject.pivoted {
                    let lever = cross_matrix(&in_p(&(exact(&subject.center) * mass)));
                    linear.on_space.push((gravity, lever));
                }
                linear.force += gravity * mass;
            }
            Term::Damping(damping) => {
                linear.on_omega -= turned(&damping.linear);
                linear.quadratic += turned(&damping.quadratic);
            }
            Term::Feedback(feedback) => {
                linear.on_omega -= turned(&feedback.damping);
                let stiffness = self.axes.tr_mul(&feedback.stiffness.map(X::from));
                linear.on_attitude -= stiffness * self.error_vector(feedback) * X::from(sign);
            }
            Term::Sampled(sampled) => linear.sampled.push(sampled),
            Term::GravityGradient(gradient) => linear.gradients.push(gradient),
            Term::Scheduled { .. } => {} // never active itself
        }
    }

    /// `q_target⁻¹ ∘ q_NP ∘ q_PB` is linear in (x, y, z, w) of `q_NP`: its column for each of them.
    fn error_columns(&self, feedback: &Feedback) -> [[X; 4]; 4] {
        let (left, right) = (X::quaternion(&feedback.target), self.q_bp);
        let [o, l] = [X::zero(), X::one()];
        let units = [[l, o, o, o], [o, l, o, o], [o, o, l, o], [o, o, o, l]];
        units.map(|unit| product(product(conjugate(left), unit), conjugate(right)))
    }

    fn error_vector(&self, feedback: &Feedback) -> Matrix3x4<X> {
        let columns = self.error_columns(feedback);
        Matrix3x4::from_columns(&columns.map(|[x, y, z, _]| Vector3::new(x, y, z)))
    }

    fn error_scalar(&self, feedback: &Feedback) -> Vector4<X> {
        Vector4::from(self.error_columns(feedback).map(|[_, _, _, w]| w))
    }

    /// A torque along an axis without moment of inertia has nothing to turn.
    fn check_massless(&self, linear: &Linear<'_, X>, state: &[X; 7]) -> Result<(), Error> {
        for (n, moment) in self.task.euler.moments().into_iter().enumerate() {
            if moment > 0.0 {
                continue;
            }
            let constant = linear.constant.map(X::rounded);
            let on_omega = linear.on_omega.map(X::rounded);
            let on_attitude = linear.on_attitude.map(X::rounded);
            let quadratic = linear.quadratic.map(X::rounded);
            let mut turned = on_omega;
            // ω along the axis is constant; where it is zero, what it would do does not matter.
            if state[n].rounded() == 0.0 {
                turned.column_mut(n).fill(0.0);
            }
            let mut parts = vec![
                (constant[n].abs(), constant.norm()),
                (turned.row(n).norm(), on_omega.norm()),
                (on_attitude.row(n).norm(), on_attitude.norm()),
                (quadratic.row(n).norm(), quadratic.norm()),
            ];
            for (vector, matrix) in &linear.on_space {
                let (size, matrix) = (vector.map(X::rounded).norm(), matrix.map(X::rounded));
                parts.push((matrix.row(n).norm() * size, matrix.norm() * size));
            }
            for sampled in &linear.sampled {
                let (_, piece) = sampled.piece(self.middle());
                for torque in piece {
                    let along = match sampled.frame() {
                        Frame::Body => self.axes.column(n).map(X::rounded).dot(torque).abs(),
                        Frame::Space => torque.norm(),
                    };
                    parts.push((along, torque.norm()));
                }
            }
            if let Some(&(torque, _)) = parts.iter().find(|(part, all)| *part > ROUNDING * all) {
                return Err(MotionFault::TorqueAlongMasslessAxis { torque }.into());
            }
        }
        Ok(())
    }

    /// The terms that act between two breaks.
    fn acting(&self, from: f64, to: f64) -> impl Iterator<Item = &'a Term> + use<'a, X> {
        let middle = from + 0.5 * (to - from);
        self.terms
            .iter()
            .filter_map(move |term| term.active(middle))
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

    /// Whether the scalar part of a feedback's error has another sign in `state` than the torques are made for.
    pub(super) fn has_flipped(&self, state: &[X; 7]) -> bool {
        (self.switches.iter()).any(|switch| switch.sign(state) != switch.side)
    }

    /// How many functions of the attitude change the law by their signs, and of number `index` the value in the attitude (x, y, z, w),
    /// or in a coefficient of its series, and the sign before the step.
    pub(super) fn switches(&self) -> usize {
        self.switches.len()
    }

    pub(super) fn switch_value(&self, index: usize, attitude: &[X; 4]) -> f64 {
        self.switches[index].value(attitude)
    }

    pub(super) fn side(&self, index: usize) -> f64 {
        self.switches[index].side
    }

    /// Takes the torques of the feedbacks for the signs in `state`.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub(super) fn flip(&mut self, state: &[X; 7]) -> Result<(), Error> {
        self.linearize(state)
    }

    pub(super) fn unit(&self) -> f64 {
        self.unit
    }

    /// 1 or −1 for backward in time.
    pub(super) fn direction(&self) -> f64 {
        if self.breaks[self.segment] < self.task.times[0] {
            -1.0
        } else {
            1.0
        }
    }

    pub(super) fn initial(&self) -> &Phase {
        &self.task.initial
    }

    /// ω in principal axes and units of the unit of rates, and (x, y, z, w) of the attitude.
    pub(super) fn start(&self) -> [X; 7] {
        let Phase {
            attitude, omega, ..
        } = self.task.initial;
        let [x, y, z, w] = product(X::quaternion(&attitude), self.q_bp);
        let omega = self.axes.tr_mul(&omega.map(X::from)) / X::from(self.unit);
        [omega.x, omega.y, omega.z, x, y, z, w]
    }

    /// The state in body axes and real units; `place` is position and velocity, in units of the unit of rates, of a body
    /// that is pushed.
    pub(super) fn phase(&self, state: &[X; 7], place: Option<&[X; 6]>, now: (f64, f64)) -> Phase {
        let [x, y, z, i, j, k, w] = *state;
        let initial = self.initial();
        let (position, velocity) = if let Some(place) = place {
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
        }
    }

    /// ω and (x, y, z, w) in body axes and real units of a state, or of a coefficient of its series.
    pub(super) fn in_body(&self, state: &[X; 7]) -> [X; 7] {
        let [x, y, z, i, j, k, w] = *state;
        let omega = self.axes * Vector3::new(x, y, z) * X::from(self.unit);
        let [i, j, k, w] = product([i, j, k, w], conjugate(self.q_bp));
        [omega.x, omega.y, omega.z, i, j, k, w]
    }

    /// Takes the power of two at or below the fastest rate of the motion at ω (in principal axes) as the unit of rates.
    pub(super) fn choose_unit(&mut self, omega: &[f64; 3]) -> f64 {
        let (linear, inverse) = (&self.linear, self.inverse_moments.map(X::rounded));
        let over_moment = inverse.amax();
        let squares = [
            (linear.constant.map(X::rounded))
                .component_mul(&inverse)
                .amax(),
            linear.on_attitude.map(X::rounded).amax() * over_moment,
        ];
        let on_space = linear.on_space.iter();
        let on_space = on_space.map(|(vector, matrix)| {
            vector.map(X::rounded).amax() * matrix.map(X::rounded).amax() * over_moment
        });
        let gradients = linear.gradients.iter().map(|gradient| {
            let (r, v) = gradient.orbit_at(&self.task.subject, self.task.times[0]);
            let distance = r.norm();
            let pull = gradient.coefficient().abs().max(gradient.mu()) / distance.powi(3);
            pull.max((v.norm() / distance).powi(2))
        });
        let sampled = linear
            .sampled
            .iter()
            .map(|sampled| sampled.at(self.breaks[self.segment]).amax() * over_moment);
        let square = (squares
            .into_iter()
            .chain(on_space)
            .chain(gradients)
            .chain(sampled))
        .fold(0.0, f64::max);
        let rate = Vector3::from(*omega)
            .amax()
            .max(linear.on_omega.map(X::rounded).amax() * over_moment)
            .max(square.sqrt());
        let power = f64::from_bits(rate.to_bits() & 0x7ff0_0000_0000_0000);
        self.unit = if power > 0.0 && power.is_finite() {
            power
        } else {
            1.0
        };
        self.unit
    }

    /// The equations in the segment under way.
    pub(super) fn field<const B: usize>(&self) -> Field<X, B> {
        let linear = &self.linear;
        let inverse = Matrix3::from_diagonal(&self.inverse_moments);
        let rate = X::from(1.0 / self.unit);
        let on_omega = inverse * linear.on_omega * rate;
        let quadratic = -(inverse * linear.quadratic);
        let on_attitude = inverse * linear.on_attitude * rate * rate;
        let mass = X::from(self.task.subject.mass);
        let mut field = Field {
            kappa: self.kappa.into(),
            constant: (inverse * linear.constant * rate * rate).into(),
            on_omega: rows(&on_omega),
            on_attitude: [0, 1, 2].map(|n| [0, 1, 2, 3].map(|i| on_attitude[(n, i)])),
            on_space: [[[X::zero(); 3]; 3]; B],
            quadratic: rows(&quadratic),
            force: (linear.force / mass * rate * rate).into(),
            thrust: (linear.thrust / mass * rate * rate).into(),
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

    /// The directions in N that the torques of what is fixed in space are made of: the vertical axis, or all.
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

    /// What depends on the time alone, as it is at `now`.
    pub(super) fn moment(&self, now: (f64, f64)) -> Moment<X> {
        let elapsed = X::pair(now.0, now.1) / X::from(self.unit);
        let mut moment = Moment::default();
        for sampled in &self.linear.sampled {
            let (from, piece) = sampled.piece(self.middle());
            let [c0, c1, c2, c3] = piece.map(|c| c.map(X::from));
            let x = elapsed + X::pair(self.task.times[0], -from);
            let (two, three) = (X::from(2.0), X::from(3.0));
            let centered = [
                c0 + (c1 + (c2 + c3 * x) * x) * x,
                c1 + (c2 * two + c3 * (three * x)) * x,
                c2 + c3 * (three * x),
                c3,
            ];
            let mut scale = 1.0 / self.unit / self.unit;
            for (k, torque) in centered.iter().enumerate() {
                let torque = torque * X::from(scale);
                match sampled.frame() {
                    Frame::Body => moment.in_body[k] += self.axes.tr_mul(&torque),
                    Frame::Space => moment.in_space[k] += torque,
                }
                scale /= self.unit;
            }
        }
        for torque in &mut moment.in_body {
            torque.component_mul_assign(&self.inverse_moments);
        }
        for gradient in &self.linear.gradients {
            let (r, v) = gradient.orbit_at(&self.task.subject, self.time(now));
            let (r, v) = (r.map(X::from), v.map(X::from));
            let (distance, unit) = (r.dot(&r).root(), X::from(self.unit));
            let cube = distance * distance * distance * unit * unit;
            moment.orbits.push(Orbit {
                position: r / distance,
                velocity: v / (distance * unit),
                pull: X::from(gradient.mu()) / cube,
                strength: X::from(gradient.coefficient()) / cube,
            });
        }
        moment
    }

    pub(super) fn inverse_moments(&self) -> &Vector3<X> {
        &self.inverse_moments
    }

    /// Time since the start of output `k`.
    pub(super) fn output(&self, k: usize) -> (f64, f64) {
        self.since_start(self.task.times[k])
    }

    pub(super) fn end_of_segment(&self) -> (f64, f64) {
        self.since_start(self.breaks[self.segment])
    }

    /// In units of the unit of rates, with what rounding leaves out.
    fn since_start(&self, t: f64) -> (f64, f64) {
        let (elapsed, rest) = two_sum(t, -self.task.times[0]);
        (elapsed * self.unit, rest * self.unit)
    }

    pub(super) fn time(&self, now: (f64, f64)) -> f64 {
        self.task.times[0] + (now.0 + now.1) / self.unit
    }

    /// The whole length of the motion.
    pub(super) fn last_elapsed(&self) -> f64 {
        self.last_time() - self.task.times[0]
    }

    /// The time of an output.
    pub(super) fn time_of(&self, output: usize) -> f64 {
        self.task.times[output]
    }

    pub(super) fn last_time(&self) -> f64 {
        self.task.times[self.task.times.len() - 1]
    }

    /// Whether so many steps up to `now`, in units of the unit of rates, let the motion come to its end.
    pub(super) fn check_steps(&self, steps: u64, now: f64) -> Result<(), Error> {
        check_steps(
            steps,
            self.task.times[0],
            now / self.unit,
            self.last_elapsed(),
        )
    }

    /// How much of the motion is done.
    pub(super) fn fraction(&self, now: f64) -> f64 {
        let times = self.task.times;
        now / self.unit / (times[times.len() - 1] - times[0])
    }
}

/// What kind of equations a sum of terms leads to. Apart from quadratic damping, which may be zero, and directions, which
/// may all be vertical, it does not depend on the numbers in them.
pub(super) fn parts(terms: &[Term], pivoted: bool) -> Parts {
    let mut parts = Parts::default();
    let mut needs_all = false;
    for term in terms {
        let term = match term {
            Term::Scheduled { term, .. } => term,
            term => term,
        };
        if turns(term, pivoted) {
            parts.directions = 1;
            needs_all |= !is_vertical(term);
        }
        parts.is_pushed |= !pivoted && term.exerts_force();
        match term {
            Term::ConstantForce {
                frame: Frame::Body, ..
            } => needs_all |= !pivoted,
            Term::Damping(damping) => {
                parts.on_omega = true;
                parts.quadratic |= damping.quadratic != Matrix3::zeros();
            }
            Term::Feedback(_) => {
                parts.on_omega = true;
                parts.on_attitude = true;
            }
            Term::Sampled(sampled) => {
                parts.is_timed = true;
                needs_all |= sampled.frame() == Frame::Space;
            }
            Term::GravityGradient(_) => {
                parts.is_timed = true;
                parts.gradients += 1;
            }
            _ => {}
        }
    }
    if needs_all {
        parts.directions = 3;
    }
    parts
}

/// Whether the vector of the term is along the axis 3 of its frame.
fn is_vertical(term: &Term) -> bool {
    match term {
        Term::ConstantTorque { vector, .. }
        | Term::ConstantForce { vector, .. }
        | Term::UniformGravity { gravity: vector } => vector.x == 0.0 && vector.y == 0.0,
        _ => false,
    }
}

/// Whether the term exerts a torque through a vector fixed in space.
fn turns(term: &Term, pivoted: bool) -> bool {
    match term {
        Term::ConstantTorque { frame, .. } => *frame == Frame::Space,
        Term::ConstantForce { frame, point, .. } => {
            *frame == Frame::Space && (pivoted || point.is_some())
        }
        Term::UniformGravity { .. } => pivoted,
        _ => false,
    }
}

fn over<X: Real>(number: X, moment: X) -> X {
    if moment.rounded() > 0.0 {
        number / moment
    } else {
        X::zero()
    }
}

fn rows<X: Real>(matrix: &Matrix3<X>) -> [[X; 3]; 3] {
    [0, 1, 2].map(|n| [0, 1, 2].map(|i| matrix[(n, i)]))
}
