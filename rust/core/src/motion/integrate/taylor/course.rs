//! One motion as the stepper needs it: in principal axes, in a unit of time of its own, from break to break of its load.

use nalgebra::{Matrix3, Matrix3x4, Quaternion, UnitQuaternion, Vector3, Vector4};

use super::field::{Field, Parts};
use super::moment::Moment;
use crate::error::Error;
use crate::mass::validity::ROUNDING;
use crate::motion::attitude::from_axes;
use crate::motion::loads::{Feedback, Frame, GravityGradient, Sampled, Term};
use crate::motion::simulate::Task;
use crate::motion::state::Phase;
use crate::numerics::double_double::two_sum;

/// What acts between two breaks, linear in what varies: torques about the reference point in principal axes.
#[derive(Clone, Debug, Default)]
struct Linear<'a> {
    constant: Vector3<f64>,
    on_omega: Matrix3<f64>,
    on_attitude: Matrix3x4<f64>,
    /// E of quadratic damping.
    quadratic: Matrix3<f64>,
    /// Torques `M R_PN v` of vectors v fixed in space.
    on_space: Vec<(Vector3<f64>, Matrix3<f64>)>,
    /// Forces in N, and in principal axes.
    force: Vector3<f64>,
    thrust: Vector3<f64>,
    sampled: Vec<&'a Sampled>,
    gradients: Vec<&'a GravityGradient>,
}

/// A motion on its way.
#[derive(Clone, Debug)]
pub(super) struct Course<'a> {
    task: Task<'a>,
    terms: &'a [Term],
    axes: Matrix3<f64>,
    q_bp: UnitQuaternion<f64>,
    kappa: Vector3<f64>,
    inverse_moments: Vector3<f64>,
    /// The ends of the segments, and which is under way.
    breaks: Vec<f64>,
    segment: usize,
    linear: Linear<'a>,
    /// The sign of the scalar part of each feedback's error.
    signs: Vec<f64>,
    /// The unit of rates: a power of two near the fastest of the motion.
    unit: f64,
}

impl<'a> Course<'a> {
    /// The course of `task` under `terms`.
    ///
    /// # Errors
    /// When a term cannot act, or acts along an axis without a moment of inertia.
    pub(super) fn new(task: &Task<'a>, terms: &'a [Term]) -> Result<Self, Error> {
        let ([i1, i2, i3], [d1, d2, d3]) = (task.euler.moments(), task.euler.differences());
        let axes = *task.euler.axes();
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
            axes,
            q_bp: from_axes(&axes),
            kappa: Vector3::new(over(d1, i1), over(d2, i2), over(d3, i3)),
            inverse_moments: Vector3::new(over(1.0, i1), over(1.0, i2), over(1.0, i3)),
            breaks,
            segment: 0,
            linear: Linear::default(),
            signs: Vec::new(),
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
    pub(super) fn pass_break(&mut self, state: &[f64; 7]) -> Result<(), Error> {
        self.segment += 1;
        self.linearize(state)
    }

    /// What acts in the segment under way.
    fn linearize(&mut self, state: &[f64; 7]) -> Result<(), Error> {
        let mut linear = Linear::default();
        let mut signs = Vec::new();
        for term in self.acting(self.segment_start(), self.breaks[self.segment]) {
            if let Term::Feedback(feedback) = term {
                signs.push(sign(&self.error_scalar(feedback), state));
            }
            self.add(&mut linear, term, signs.last().copied().unwrap_or(1.0));
        }
        self.signs = signs;
        self.check_massless(&linear, state)?;
        self.linear = linear;
        Ok(())
    }

    fn add(&self, linear: &mut Linear<'a>, term: &'a Term, sign: f64) {
        let subject = &self.task.subject;
        let in_p = |vector: &Vector3<f64>| self.axes.tr_mul(vector);
        let turned = |matrix: &Matrix3<f64>| self.axes.tr_mul(matrix) * self.axes;
        match term {
            Term::ConstantTorque { vector, frame } => match frame {
                Frame::Body => linear.constant += in_p(vector),
                Frame::Space => linear.on_space.push((*vector, Matrix3::identity())),
            },
            Term::ConstantForce {
                vector,
                frame,
                point,
            } => {
                let arm = point.map_or(subject.center, |point| point - subject.point);
                match frame {
                    Frame::Body => {
                        linear.constant += in_p(&arm.cross(vector));
                        linear.thrust += in_p(vector);
                    }
                    Frame::Space => {
                        if turns(term, subject.pivoted) {
                            let lever = in_p(&arm).cross_matrix();
                            linear.on_space.push((*vector, lever));
                        }
                        linear.force += vector;
                    }
                }
            }
            Term::UniformGravity { gravity } => {
                if subject.pivoted {
                    let lever = in_p(&(subject.center * subject.mass)).cross_matrix();
                    linear.on_space.push((*gravity, lever));
                }
                linear.force += gravity * subject.mass;
            }
            Term::Damping(damping) => {
                linear.on_omega -= turned(&damping.linear);
                linear.quadratic += turned(&damping.quadratic);
            }
            Term::Feedback(feedback) => {
                linear.on_omega -= turned(&feedback.damping);
                linear.on_attitude -=
                    self.axes.tr_mul(&feedback.stiffness) * self.error_vector(feedback) * sign;
            }
            Term::Sampled(sampled) => linear.sampled.push(sampled),
            Term::GravityGradient(gradient) => linear.gradients.push(gradient),
            Term::Scheduled { .. } => {} // never active itself
        }
    }

    /// `q_target⁻¹ ∘ q_NP ∘ q_PB` is linear in (x, y, z, w) of `q_NP`: its column for each of them.
    fn error_columns(&self, feedback: &Feedback) -> [Quaternion<f64>; 4] {
        let (left, right) = (feedback.target.conjugate(), self.q_bp.conjugate());
        let [o, l] = [0.0, 1.0];
        let units = [[o, l, o, o], [o, o, l, o], [o, o, o, l], [l, o, o, o]];
        units.map(|[w, i, j, k]| {
            left.into_inner() * Quaternion::new(w, i, j, k) * right.into_inner()
        })
    }

    fn error_vector(&self, feedback: &Feedback) -> Matrix3x4<f64> {
        Matrix3x4::from_columns(&self.error_columns(feedback).map(|column| column.imag()))
    }

    fn error_scalar(&self, feedback: &Feedback) -> Vector4<f64> {
        Vector4::from(self.error_columns(feedback).map(|column| column.w))
    }

    /// A torque along an axis without moment of inertia has nothing to turn.
    fn check_massless(&self, linear: &Linear<'_>, state: &[f64; 7]) -> Result<(), Error> {
        for (n, moment) in self.task.euler.moments().into_iter().enumerate() {
            if moment > 0.0 {
                continue;
            }
            let mut turned = linear.on_omega;
            // ω along the axis is constant; where it is zero, what it would do does not matter.
            if state[n] == 0.0 {
                turned.column_mut(n).fill(0.0);
            }
            let mut parts = vec![
                (linear.constant[n].abs(), linear.constant.norm()),
                (turned.row(n).norm(), linear.on_omega.norm()),
                (linear.on_attitude.row(n).norm(), linear.on_attitude.norm()),
                (linear.quadratic.row(n).norm(), linear.quadratic.norm()),
            ];
            for (vector, matrix) in &linear.on_space {
                let size = vector.norm();
                parts.push((matrix.row(n).norm() * size, matrix.norm() * size));
            }
            for sampled in &linear.sampled {
                let (_, piece) = sampled.piece(self.middle());
                for torque in piece {
                    let along = match sampled.frame() {
                        Frame::Body => self.axes.column(n).dot(torque).abs(),
                        Frame::Space => torque.norm(),
                    };
                    parts.push((along, torque.norm()));
                }
            }
            if let Some(&(torque, _)) = parts.iter().find(|(part, all)| *part > ROUNDING * all) {
                return Err(Error::TorqueAlongMasslessAxis { torque });
            }
        }
        Ok(())
    }

    /// The terms that act between two breaks.
    fn acting(&self, from: f64, to: f64) -> impl Iterator<Item = &'a Term> + use<'a> {
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
    pub(super) fn has_flipped(&self, state: &[f64; 7]) -> bool {
        let mut feedbacks = self.feedbacks().zip(&self.signs);
        feedbacks.any(|(feedback, &side)| sign(&self.error_scalar(feedback), state) != side)
    }

    /// Takes the torques of the feedbacks for the signs in `state`.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub(super) fn flip(&mut self, state: &[f64; 7]) -> Result<(), Error> {
        self.linearize(state)
    }

    fn feedbacks(&self) -> impl Iterator<Item = &'a Feedback> {
        let acting = self.acting(self.segment_start(), self.breaks[self.segment]);
        acting.filter_map(|term| {
            if let Term::Feedback(feedback) = term {
                Some(feedback)
            } else {
                None
            }
        })
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
    pub(super) fn start(&self) -> [f64; 7] {
        let Phase {
            attitude, omega, ..
        } = self.task.initial;
        let q = (attitude * self.q_bp).into_inner();
        let w = self.axes.tr_mul(&omega) / self.unit;
        [w.x, w.y, w.z, q.i, q.j, q.k, q.w]
    }

    /// The state in body axes and real units; `place` is position and velocity, in units of the unit of rates, of a body
    /// that is pushed.
    pub(super) fn phase(
        &self,
        state: &[f64; 7],
        place: Option<&[f64; 6]>,
        now: (f64, f64),
    ) -> Phase {
        let [x, y, z, i, j, k, w] = *state;
        let initial = self.initial();
        let (position, velocity) = if let Some(&[x, y, z, u, v, w]) = place {
            (Vector3::new(x, y, z), Vector3::new(u, v, w) * self.unit)
        } else {
            let elapsed = (now.0 + now.1) / self.unit;
            (
                initial.position + initial.velocity * elapsed,
                initial.velocity,
            )
        };
        let q_np = Quaternion::new(w, i, j, k);
        Phase {
            attitude: UnitQuaternion::new_normalize(q_np * self.q_bp.conjugate().into_inner()),
            omega: self.axes * Vector3::new(x, y, z) * self.unit,
            position,
            velocity,
        }
    }

    /// ω and (x, y, z, w) in body axes and real units of a state, or of a coefficient of its series.
    pub(super) fn in_body(&self, state: &[f64; 7]) -> [f64; 7] {
        let [x, y, z, i, j, k, w] = *state;
        let omega = self.axes * Vector3::new(x, y, z) * self.unit;
        let q = Quaternion::new(w, i, j, k) * self.q_bp.conjugate().into_inner();
        [omega.x, omega.y, omega.z, q.i, q.j, q.k, q.w]
    }

    /// Takes the power of two at or below the fastest rate of the motion at ω (in principal axes) as the unit of rates.
    pub(super) fn choose_unit(&mut self, omega: &[f64; 3]) -> f64 {
        let (linear, over_moment) = (&self.linear, self.inverse_moments.amax());
        let squares = [
            linear.constant.component_mul(&self.inverse_moments).amax(),
            linear.on_attitude.amax() * over_moment,
        ];
        let on_space = linear.on_space.iter();
        let on_space = on_space.map(|(vector, matrix)| vector.amax() * matrix.amax() * over_moment);
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
            .max(linear.on_omega.amax() * over_moment)
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
    pub(super) fn field<const B: usize>(&self) -> Field<f64, B> {
        let linear = &self.linear;
        let inverse = Matrix3::from_diagonal(&self.inverse_moments);
        let rate = 1.0 / self.unit;
        let on_omega = inverse * linear.on_omega * rate;
        let quadratic = -(inverse * linear.quadratic);
        let on_attitude = inverse * linear.on_attitude * rate * rate;
        let mass = self.task.subject.mass;
        let mut field = Field {
            kappa: self.kappa.into(),
            constant: (inverse * linear.constant * rate * rate).into(),
            on_omega: rows(&on_omega),
            on_attitude: [0, 1, 2].map(|n| [0, 1, 2, 3].map(|i| on_attitude[(n, i)])),
            on_space: [[[0.0; 3]; 3]; B],
            quadratic: rows(&quadratic),
            force: (linear.force / mass * rate * rate).into(),
            thrust: (linear.thrust / mass * rate * rate).into(),
        };
        let directions = self.directions::<B>();
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
    pub(super) fn directions<const B: usize>(&self) -> [[f64; 3]; B] {
        let mut directions = [[0.0, 0.0, 1.0]; B];
        if B > 1 {
            for (i, direction) in directions.iter_mut().enumerate() {
                *direction = [0.0; 3];
                direction[i] = 1.0;
            }
        }
        directions
    }

    /// What depends on the time alone, as it is at `now`.
    pub(super) fn moment(&self, now: (f64, f64)) -> Moment {
        let t = self.time(now);
        let mut moment = Moment::default();
        for sampled in &self.linear.sampled {
            let (from, [c0, c1, c2, c3]) = sampled.piece(self.middle());
            let x = t - from;
            let centered = [
                c0 + (c1 + (c2 + c3 * x) * x) * x,
                c1 + (c2 * 2.0 + c3 * (3.0 * x)) * x,
                c2 + c3 * (3.0 * x),
                *c3,
            ];
            let mut scale = 1.0 / self.unit / self.unit;
            for (k, torque) in centered.iter().enumerate() {
                let torque = torque * scale;
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
            let (r, v) = gradient.orbit_at(&self.task.subject, t);
            let distance = r.norm();
            let cube = distance * distance * distance * self.unit * self.unit;
            moment.orbits.push(super::moment::Orbit {
                position: r / distance,
                velocity: v / (distance * self.unit),
                pull: gradient.mu() / cube,
                strength: gradient.coefficient() / cube,
            });
        }
        moment
    }

    pub(super) fn inverse_moments(&self) -> [f64; 3] {
        self.inverse_moments.into()
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

    pub(super) fn last_time(&self) -> f64 {
        self.task.times[self.task.times.len() - 1]
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

/// The sign that a feedback takes, of its error's scalar part in `state`.
fn sign(scalar: &Vector4<f64>, state: &[f64; 7]) -> f64 {
    let [_, _, _, x, y, z, w] = *state;
    if scalar.dot(&Vector4::new(x, y, z, w)) < 0.0 {
        -1.0
    } else {
        1.0
    }
}

fn over(number: f64, moment: f64) -> f64 {
    if moment > 0.0 { number / moment } else { 0.0 }
}

fn rows(matrix: &Matrix3<f64>) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|n| [0, 1, 2].map(|i| matrix[(n, i)]))
}
