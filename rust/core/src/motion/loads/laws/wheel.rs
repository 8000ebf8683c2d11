//! A wheel in the body, with a motor and friction.

use nalgebra::{Vector3, Vector4};

use super::feedback::Feedback;
use super::slug::{not_negative, positive};
use crate::error::{Error, MotionFault, finite};
use crate::motion::loads::body_at_point::BodyAtPoint;
use crate::motion::loads::carried_momentum::{CarriedMomentum, LawContext};
use crate::motion::loads::law::{ConservedMomentum, Law, Traits};
use crate::motion::loads::piecewise_signal::PiecewiseSignal;
use crate::motion::loads::principal_frame::{LawNumber, PrincipalFrame, exact};
use crate::motion::loads::series_terms::{InternalState, SeriesTerms};
use crate::motion::loads::spline::within;
use crate::motion::loads::switch::Switch;
use crate::motion::loads::variables::{Parameter, ParameterColumns};
use crate::motion::loads::wrench::Wrench;
use crate::motion::state::Phase;

/// A wheel that turns about an axis a fixed in the body with the rate Ω relative to it: J is its moment about that axis, and the
/// tensor I of the body includes it as if it were locked.
///
/// ```text
/// ḣ = τ − c Ω − c₀ sign(Ω),   h = J (Ω + a·ω),   (I − J a aᵀ) ω̇ + ω × ((I − J a aᵀ) ω + h a) = N − a ḣ
/// ```
///
/// with the motor's torque τ, and in its bearing viscous friction c and dry friction c₀: at rest, whatever up to c₀ keeps it there. With
/// its speed given instead of τ
///
/// ```text
/// I ω̇ + ω × (I ω + JΩ a) = N − JΩ̇ a
/// ```
///
/// Source: Hughes, Spacecraft Attitude Dynamics, §3.5; Wittenburg, Dynamics of Multibody Systems, §4.6.
#[derive(Clone, Debug, PartialEq)]
pub struct Wheel {
    /// a, of any length.
    axis: Vector3<f64>,
    /// a of unit length.
    unit: Vector3<f64>,
    /// J.
    inertia: f64,
    /// Ω at the start; of a given speed what it is then.
    rate: f64,
    /// c.
    friction: f64,
    /// c₀.
    dry_friction: f64,
    drive: Drive,
    /// The most that |τ| can be; infinite of a motor without a limit.
    max_torque: f64,
    /// The most that |Ω| can be, infinite without a limit.
    max_rate: f64,
    /// m of a motor that follows a controller: τ = −m·N.
    allocation: Option<Vector3<f64>>,
}

impl Wheel {
    /// A checked wheel.
    ///
    /// # Errors
    /// For an axis without direction, a moment that is not positive, friction that is negative, what is not finite.
    pub fn new(
        axis: &Vector3<f64>,
        inertia: f64,
        rate: f64,
        friction: f64,
        drive: Drive,
    ) -> Result<Self, Error> {
        crate::error::all_finite("axis", axis)?;
        let unit = (axis / axis.amax())
            .try_normalize(0.0)
            .filter(|_| axis.amax() > 0.0)
            .ok_or(Error::NoDirection { what: "axis" })?;
        positive("inertia", inertia)?;
        finite("rate", rate)?;
        not_negative("friction", friction)?;
        Ok(Self {
            axis: *axis,
            unit,
            inertia,
            rate,
            friction,
            dry_friction: 0.0,
            drive,
            max_torque: f64::INFINITY,
            max_rate: f64::INFINITY,
            allocation: None,
        })
    }

    /// The wheel with a motor that can exert so much at most: |τ| is clipped.
    ///
    /// # Errors
    /// For a torque that is not positive or not finite.
    pub fn with_max_torque(self, torque: f64) -> Result<Self, Error> {
        positive("max_torque", torque)?;
        Ok(Self {
            max_torque: torque,
            ..self
        })
    }

    /// The wheel with a rate |Ω| of so much at most. There the motor exerts what keeps this rate, as long as it is asked for more.
    ///
    /// # Errors
    /// For a rate that is not positive or not finite, and less than the one at the start.
    pub fn with_max_rate(self, rate: f64) -> Result<Self, Error> {
        positive("max_rate", rate)?;
        if self.rate.abs() > rate {
            return Err(Error::OutOfDomain {
                what: "rate",
                law: "within the limit of the wheel, max_rate or max_momentum divided by its inertia",
                value: self.rate,
            });
        }
        Ok(Self {
            max_rate: rate.min(self.max_rate),
            ..self
        })
    }

    /// The wheel with a momentum |J Ω| of so much at most: see [`Self::with_max_rate`].
    ///
    /// # Errors
    /// As there.
    pub fn with_max_momentum(self, momentum: f64) -> Result<Self, Error> {
        positive("max_momentum", momentum)?;
        let inertia = self.inertia;
        self.with_max_rate(momentum / inertia)
    }

    /// The wheel whose motor exerts `τ = −m·N` where a controller asks for the torque N on the body: m is a row of the
    /// [allocation](super::super::allocation()) of a set of wheels. Without one it is the axis, of unit length.
    ///
    /// # Errors
    /// For what is not finite.
    pub fn with_allocation(self, row: &Vector3<f64>) -> Result<Self, Error> {
        crate::error::all_finite("allocation", row)?;
        Ok(Self {
            allocation: Some(*row),
            ..self
        })
    }

    /// The wheel with dry friction: the torque c₀ against its rate, and at rest whatever up to it keeps the wheel there.
    ///
    /// # Errors
    /// For a torque that is negative or not finite.
    pub fn with_dry_friction(self, torque: f64) -> Result<Self, Error> {
        not_negative("dry_friction", torque)?;
        Ok(Self {
            dry_friction: torque,
            ..self
        })
    }

    /// The feedback that its motor follows.
    fn feedback(&self) -> Option<&Feedback> {
        self.drive.feedback()
    }

    /// Whether its speed is given.
    fn has_speed(&self) -> bool {
        matches!(self.drive, Drive::Speed(_))
    }

    /// Ω from the state.
    fn speed(&self, state: &[f64], omega: &Vector3<f64>) -> f64 {
        if self.has_speed() {
            state[0] / self.inertia
        } else {
            state[0] / self.inertia - self.unit.dot(omega)
        }
    }

    /// The rate of the state: ḣ, or JΩ̇ where the speed is given.
    fn rate_of_state(&self, now: &LawContext<'_>, state: &[f64]) -> f64 {
        if let Drive::Speed(speed) = &self.drive {
            return self.inertia * speed.line(now.middle)[1];
        }
        let motor = (self.demanded_torque(now)).clamp(-self.max_torque, self.max_torque);
        motor - self.friction * self.speed(state, &now.phase.omega)
    }

    /// What is asked of the motor.
    fn demanded_torque(&self, now: &LawContext<'_>) -> f64 {
        let along = self.allocation.as_ref().unwrap_or(&self.unit);
        match &self.drive {
            Drive::Torque(torque) => torque.value(now.middle),
            Drive::Feedback(law) => -along.dot(&law.torque_on(now)),
            Drive::Controller => -along.dot(&now.command),
            Drive::Speed(_) => 0.0,
        }
    }

    /// a of unit length, in principal axes.
    fn direction<X: LawNumber>(&self, axes: &PrincipalFrame<'_, X>) -> Vector3<X> {
        let scale = self.axis.amax().log2().floor().exp2();
        let mut scaled = exact::<X>(&(self.axis / scale));
        if axes.varies("axis") {
            for i in 0..3 {
                scaled[i] += axes.variation(self.axis[i], "axis", i) / X::from(scale);
            }
        }
        axes.principal(&(scaled / scaled.dot(&scaled).root()))
    }
}

impl Law for Wheel {
    fn traits(&self, _: bool) -> Traits {
        Traits {
            exerts_force: false,
            depends_on_rates: true,
            needs_body: !self.has_speed(),
            needs_epoch: self.feedback().is_some_and(|law| law.target.needs_epoch()),
            keeps: ConservedMomentum::All,
            has_series: !self.has_limit()
                && self.allocation.is_none()
                && !matches!(self.drive, Drive::Controller)
                && self.bearing().is_none()
                && self.rate_limit().is_none()
                && (self.feedback()).is_none_or(|law| law.target.as_fixed().is_some()),
        }
    }

    /// Those of a feedback that its motor follows are the last; limits, dry friction, an allocation and other controllers have no series, and
    /// are left out.
    fn parameters(&self) -> Vec<Parameter> {
        let mut all = vec![Parameter::new("axis", &[3]), Parameter::new("inertia", &[])];
        if let Drive::Speed(speed) = &self.drive {
            all.push(speed.parameter("speed"));
            return all;
        }
        all.push(Parameter::new("rate", &[]));
        all.push(Parameter::new("friction", &[]));
        match &self.drive {
            Drive::Torque(torque) => all.push(torque.parameter("torque")),
            Drive::Feedback(law) => all.extend(law.parameters()),
            Drive::Controller | Drive::Speed(_) => {}
        }
        all
    }

    fn scaled(&self, _: f64) -> Result<Self, Error> {
        Err(MotionFault::StatesStay { what: "scaled" }.into())
    }

    fn with_epoch(mut self, t: f64) -> Self {
        if let Drive::Feedback(law) = &mut self.drive {
            *law = law.clone().with_epoch(t);
        }
        self
    }

    fn breaks(&self, from: f64, to: f64) -> Vec<f64> {
        self.drive.breaks(from, to)
    }

    fn check(&self, body: &BodyAtPoint, from: f64, to: f64) -> Result<(), Error> {
        if to < from && (self.bearing().is_some() || self.rate_limit().is_some()) {
            return Err(Error::OutOfDomain {
                what: "t",
                law: "ascending where a wheel has dry friction or a largest rate: of one that is held nobody knows since when it is",
                value: to,
            });
        }
        self.drive.check(body, from, to)
    }

    /// At a start; of a wheel at rest without what its bearing holds, which follows from all loads on the body.
    fn wrench(&self, body: &BodyAtPoint, t: f64, phase: &Phase) -> Wrench {
        let state = self.begin(t, &phase.omega);
        let now = LawContext {
            body,
            t,
            middle: t,
            phase,
            side: (self.switch(body, t, phase)).map_or(1.0, |switch| switch.side),
            command: Vector3::zeros(),
        };
        let mut torque = self.torque(&now, &state, None);
        if self.bearing().is_some() && self.rate != 0.0 {
            torque += self.unit * (self.dry_friction * self.rate.signum());
        }
        Wrench::couple(torque)
    }

    /// A wheel without motor and friction takes no energy.
    fn potential(&self, _: &BodyAtPoint, _: &Phase) -> Option<f64> {
        let is_free = match &self.drive {
            Drive::Torque(torque) => torque.times().is_empty() && torque.value(0.0) == 0.0,
            Drive::Feedback(_) | Drive::Controller | Drive::Speed(_) => false,
        };
        (is_free && self.friction == 0.0 && self.dry_friction == 0.0).then_some(0.0)
    }

    fn add_to<'a, X: LawNumber>(
        &'a self,
        series: &mut SeriesTerms<'a, X>,
        axes: &PrincipalFrame<'_, X>,
        side: f64,
    ) {
        let a = self.direction(axes);
        let inertia = axes.number(self.inertia, "inertia");
        let friction = if self.has_speed() {
            X::zero()
        } else {
            axes.number(self.friction, "friction")
        };
        let mut state = InternalState {
            momentum: a,
            size: self.inertia,
            ..InternalState::default()
        };
        match &self.drive {
            Drive::Speed(speed) => {
                state.constant = inertia * speed.slope(axes.middle, axes, "speed");
                state.reported_on_omega = a * inertia;
            }
            Drive::Torque(torque) => state.constant = torque.number(axes.middle, axes, "torque"),
            Drive::Controller => {} // has no series
            // With a limit it has no series, nor with dry friction: the law without them.
            Drive::Feedback(law) => {
                let mut asked = SeriesTerms::default();
                law.add_to(&mut asked, axes, side);
                state.on_omega = -asked.on_omega().tr_mul(&a);
                state.on_attitude = -asked.on_attitude().tr_mul(&a);
                series.add_on_attitude(&-(a * state.on_attitude.transpose()));
            }
        }
        if !self.has_speed() {
            series.turning += a * a.transpose() * inertia;
            state.on_itself = -(friction / inertia);
            state.on_omega += a * friction;
        }
        // −a ḣ.
        series.constant -= a * state.constant;
        series.add_on_omega(&-(a * state.on_omega.transpose()));
        state.torque = -(a * state.on_itself);
        series.internal_states.push(state);
    }

    fn may_switch(&self) -> bool {
        self.feedback().is_some()
    }

    fn switch(&self, body: &BodyAtPoint, t: f64, phase: &Phase) -> Option<Switch> {
        self.feedback()?.switch(body, t, phase)
    }

    fn switch_function<X: LawNumber>(&self, axes: &PrincipalFrame<'_, X>) -> Option<Vector4<X>> {
        self.feedback()?.switch_function(axes)
    }

    fn carried(&self) -> Option<&dyn CarriedMomentum> {
        Some(self)
    }
}

impl CarriedMomentum for Wheel {
    fn count(&self) -> usize {
        1
    }

    fn size(&self) -> f64 {
        self.inertia
    }

    fn begin(&self, t: f64, omega: &Vector3<f64>) -> Vec<f64> {
        vec![match &self.drive {
            Drive::Speed(speed) => self.inertia * speed.line(t)[0],
            Drive::Torque(_) | Drive::Feedback(_) | Drive::Controller => {
                self.inertia * (self.rate + self.unit.dot(omega))
            }
        }]
    }

    fn beginning(&self, t: f64, omega: &Vector3<f64>) -> Vec<(Vector3<f64>, Vec<f64>)> {
        let places = ParameterColumns::new(0, self.parameters());
        let mut by_numbers = vec![0.0; places.count()];
        let (a, inertia) = (self.unit, self.inertia);
        if let Drive::Speed(speed) = &self.drive {
            by_numbers[places.of("inertia").start] = speed.line(t)[0];
            for (index, [share, _]) in speed.shares(t) {
                by_numbers[places.of("speed").start + index] = inertia * share;
            }
            return vec![(Vector3::zeros(), by_numbers)];
        }
        // Of a of unit length, by a of any.
        let across = (omega - a * a.dot(omega)) * (inertia / self.axis.norm());
        by_numbers[places.of("axis")].copy_from_slice(across.as_slice());
        by_numbers[places.of("inertia").start] = self.rate + a.dot(omega);
        by_numbers[places.of("rate").start] = inertia;
        vec![(a * inertia, by_numbers)]
    }

    fn is_known(&self) -> bool {
        self.has_speed()
    }

    fn report_states(&self, states: &mut [f64], omega: &Vector3<f64>) {
        if self.has_speed() {
            states[0] += self.inertia * self.unit.dot(omega);
        }
    }

    fn resume_states(&self, states: &mut [f64], t: f64, omega: &Vector3<f64>) {
        if self.has_speed() {
            states.copy_from_slice(&self.begin(t, omega));
        }
    }

    fn turning(&self) -> Option<(Vector3<f64>, f64)> {
        (!self.has_speed()).then_some((self.axis, self.inertia))
    }

    fn bearing(&self) -> Option<(Vector3<f64>, f64, f64)> {
        (self.dry_friction > 0.0 && !self.has_speed()).then_some((
            self.unit,
            self.inertia,
            self.dry_friction,
        ))
    }

    fn rate_limit(&self) -> Option<(Vector3<f64>, f64, f64)> {
        (self.max_rate.is_finite() && !self.has_speed()).then_some((
            self.unit,
            self.inertia,
            self.max_rate,
        ))
    }

    fn has_limit(&self) -> bool {
        self.max_torque.is_finite()
    }

    /// Smooth where nothing is asked for.
    fn over_limit(&self, now: &LawContext<'_>) -> f64 {
        let share = self.demanded_torque(now) / self.max_torque;
        (share - 1.0) * (share + 1.0)
    }

    fn torque(
        &self,
        now: &LawContext<'_>,
        state: &[f64],
        rates: Option<&mut [f64]>,
    ) -> Vector3<f64> {
        let rate = self.rate_of_state(now, state);
        if let Some(rates) = rates {
            rates[0] = rate;
        }
        self.unit.cross(&now.phase.omega) * state[0] - self.unit * rate
    }

    /// JΩ a.
    fn momentum(&self, state: &[f64], omega: &Vector3<f64>) -> Vector3<f64> {
        self.unit * (self.inertia * self.speed(state, omega))
    }

    /// `JΩ a·ω + ½ J Ω²`.
    fn energy(&self, state: &[f64], omega: &Vector3<f64>) -> f64 {
        let speed = self.speed(state, omega);
        self.inertia * speed * (self.unit.dot(omega) + 0.5 * speed)
    }
}

/// What turns a wheel.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::RigidBody;
/// use polhode::motion::loads::{Analytic, Drive, PiecewiseSignal, Wheel, wrench_at};
/// use polhode::motion::simulate::{Method, NoEvents, Phase, State, Task, Tolerance, simulate};
/// use polhode::nalgebra::{Matrix3, UnitQuaternion, Vector3};
///
/// // A satellite at rest, in which a motor of 0.02 N m spins up a wheel of 0.05 kg m² with dry friction of 0.005 N m.
/// let body = RigidBody::from_principal(90.0, &[8.0, 9.0, 10.0], &Matrix3::identity(), &Vector3::zeros(), 0.0)?;
/// let motor = Drive::Torque(PiecewiseSignal::constant("torque", 0.02)?);
/// let wheel = Wheel::new(&Vector3::z(), 0.05, 0.0, 0.0, motor)?.with_dry_friction(0.005)?;
/// let terms = [wheel.into()];
/// let state = State { attitude: UnitQuaternion::identity(), omega: Vector3::zeros() };
/// let tolerance = Tolerance::new(1e-10, 0.0)?;
/// let task = Task::free(&body, Phase::in_place(&state), &[0.0, 10.0], Method::Auto, tolerance);
/// let mut load = Analytic::new(&terms, task.body_at_point);
/// let go_on = &mut |_| ControlFlow::Continue(());
/// let run = simulate(&task, &mut load, &mut NoEvents::new(), go_on).into_result()?;
/// // What the wheel has, h = 0.15 N m s, the body lacks: (I − J) ω = −h.
/// assert!((run.phase.internal_state[0] - 0.15).abs() < 1e-10);
/// assert!((run.phase.omega.z + 0.15 / 9.95).abs() < 1e-10);
/// // The torque on the body at the end, beside the tensor without the wheel.
/// let torque = wrench_at(&mut load, &task.euler, 10.0, &run.phase)?.torque;
/// assert!((torque.z + 0.015).abs() < 1e-12);
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// A motor whose torque τ on the wheel, about its axis, is known; no motor where it is zero.
    Torque(PiecewiseSignal),
    /// A motor that exerts on the body, about the wheel's axis, what a feedback asks for: `τ = −a·N`.
    Feedback(Feedback),
    /// A motor that exerts on the body, about the wheel's axis, what a controller asks for: see
    /// [`Term::controlled`](super::super::Term::controlled).
    Controller,
    /// A motor that gives the wheel a speed Ω relative to the body that is known: straight lines between times.
    Speed(PiecewiseSignal),
}

impl Drive {
    /// The feedback that a motor follows.
    pub(super) fn feedback(&self) -> Option<&Feedback> {
        match self {
            Self::Feedback(law) => Some(law),
            Self::Torque(_) | Self::Controller | Self::Speed(_) => None,
        }
    }

    /// The times at which it is not smooth.
    pub(super) fn breaks(&self, from: f64, to: f64) -> Vec<f64> {
        match self {
            Self::Torque(held) | Self::Speed(held) => within(held.times(), from, to).to_vec(),
            Self::Feedback(law) => law.breaks(from, to),
            Self::Controller => Vec::new(),
        }
    }

    /// Whether it is known from one time to another.
    pub(super) fn check(&self, body: &BodyAtPoint, from: f64, to: f64) -> Result<(), Error> {
        match self {
            Self::Torque(held) => held.covers("torque", from, to, false),
            Self::Speed(held) => held.covers("speed", from, to, true),
            Self::Feedback(law) => law.check(body, from, to),
            Self::Controller => Ok(()),
        }
    }
}
