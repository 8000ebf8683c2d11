//! Why a motion cannot be told.

use thiserror::Error as ThisError;

use super::kind::Kind;

/// Why a motion, an attitude or a load cannot be told.
#[derive(Clone, Debug, PartialEq, ThisError)]
#[non_exhaustive]
pub enum MotionFault {
    /// A torque about an axis with no moment of inertia.
    #[error(
        "torque has the component {torque:?} along a principal axis whose moment of inertia is zero: \
         the angular acceleration would be infinite; give the body a thickness or remove that component"
    )]
    TorqueAlongMasslessAxis {
        /// The component.
        torque: f64,
    },
    /// Momentum inside a body that has a moment of zero.
    #[error(
        "a gyrostat's principal moments must be positive, got {moment:?}: the momentum inside would turn such a body \
         infinitely fast; give the body a thickness, or nothing inside"
    )]
    MasslessGyrostat {
        /// The least principal moment.
        moment: f64,
    },
    /// More moment in free wheels than the body has.
    #[error(
        "the body without its free wheels must have positive moments, but I − Σ J a aᵀ has the principal moment {moment:?}: \
         the body's inertia includes its locked wheels; add them to it, or give smaller wheels"
    )]
    WheelsTooHeavy {
        /// The least principal moment.
        moment: f64,
    },
    /// An unknown Euler sequence.
    #[error(
        "sequence must be three axes such as \"ZXZ\" (intrinsic) or \"zxz\" (extrinsic), neighbours different, \
         or \"goldstein\", \"landau\", \"aerospace\"; got {got:?}"
    )]
    EulerSequence {
        /// What was given.
        got: String,
    },
    /// First and third Euler angle are not defined.
    #[error(
        "the first and third Euler angles of \"{sequence}\" are not defined where the middle angle is {middle:?} rad: \
         only their sum or difference is; choose another sequence"
    )]
    GimbalLock {
        /// The sequence.
        sequence: String,
        /// The middle angle.
        middle: f64,
    },
    /// The rates of the first and third Euler angle are not defined.
    #[error(
        "the rates of the first and third Euler angle of \"{sequence}\" are not defined where the middle angle is \
         {middle:?} rad: their axes coincide; choose another sequence"
    )]
    SingularEulerRates {
        /// The sequence.
        sequence: String,
        /// The middle angle.
        middle: f64,
    },
    /// A torque or speed that is given at times is needed at another one.
    #[error(
        "the {what} of a wheel is known from t = {first:?} to t = {last:?}, and needed at t = {t:?}: give it times there"
    )]
    OutsideTimes {
        /// Which.
        what: &'static str,
        /// When it is needed.
        t: f64,
        /// Its first time.
        first: f64,
        /// Its last time, or infinity.
        last: f64,
    },
    /// What the body carries along is scaled or scheduled.
    #[error(
        "a load with momentum or states of its own cannot be {what}: what it carries stays in the body; \
         make it with other numbers, or drive it by a torque that is given at times"
    )]
    StatesStay {
        /// What was asked for.
        what: &'static str,
    },
    /// What a motor is to follow does more than a torque.
    #[error(
        "a motor exerts a torque alone, and carries nothing along, and so do coils: what this one is to follow has a force, a wheel or a slug"
    )]
    NoController,
    /// The centre of mass is not on the symmetry axis through the pivot.
    #[error(
        "the pivot, the origin of the body frame, must lie on the symmetry axis: the axis passes it at {distance:?}, \
         {relative:.2e} of the radius of gyration about it where {allowed:.1e} is allowed"
    )]
    PivotOffAxis {
        /// Of the pivot from the axis.
        distance: f64,
        /// That over the radius of gyration about the pivot.
        relative: f64,
        /// What is allowed.
        allowed: f64,
    },
    /// A top that spins too slowly to precess steadily.
    #[error(
        "no steady precession at the inclination {inclination:?} rad: the spin {spin:?} is slower than the least, \
         2 sqrt(I_t m g l cos(inclination))/I_s = {least:?}"
    )]
    SpinTooSlow {
        /// Component of ω along the symmetry axis.
        spin: f64,
        /// The least that precesses steadily.
        least: f64,
        /// Of the symmetry axis from the upward vertical.
        inclination: f64,
    },
    /// A mode that a body with these moments does not have.
    #[error(
        "the body has no {mode} mode: of its principal moments {:?}, {:?}, {:?} the two that ω would need apart are equal, or the \
         least is zero",
        moments[0], moments[1], moments[2]
    )]
    NoSuchMode {
        /// Which.
        mode: &'static str,
        /// The principal moments.
        moments: [f64; 3],
    },
    /// Two periods that no free motion of the body has.
    #[error(
        "no {mode} motion has rotation_period/precession_period = {ratio:?}: for the principal moments {:?}, {:?}, {:?} the ratio \
         reaches from {least:.6} (steady spin) to {most:.6} (the separatrix, as near as float64 tells); check the mode and \
         the moments",
        moments[0], moments[1], moments[2]
    )]
    UnreachablePeriods {
        /// In which mode.
        mode: &'static str,
        /// `P_ψ/P_φ`.
        ratio: f64,
        /// The least that is reached.
        least: f64,
        /// The greatest that is reached.
        most: f64,
        /// The principal moments.
        moments: [f64; 3],
    },
    /// Times do not run in one direction.
    #[error("{what} must be strictly {order}: {what}[{index}] = {next:?} follows {previous:?}")]
    NotMonotone {
        /// Which times.
        what: &'static str,
        /// Ascending, or either way.
        order: &'static str,
        /// The index of the later time.
        index: usize,
        /// The earlier time.
        previous: f64,
        /// The later time.
        next: f64,
    },
    /// A window of time that ends before it starts, or starts before the one before it has ended.
    #[error(
        "windows must be ascending and apart: window {index} is from {on:?} to {off:?}, and the one before it ends at \
         {previous:?}; join windows that touch"
    )]
    WindowOrder {
        /// Which window.
        index: usize,
        /// Its start.
        on: f64,
        /// Its end.
        off: f64,
        /// The end of the window before it.
        previous: f64,
    },
    /// What is known at some times is needed at a time beyond them.
    #[error(
        "the samples of the load are known from t = {first:?} to t = {last:?}, and needed at t = {t:?}: give it samples there, \
         or switch it on within its samples"
    )]
    OutsideSamples {
        /// When it is needed.
        t: f64,
        /// The first time at which it is known.
        first: f64,
        /// The last one.
        last: f64,
    },
    /// A varying body is needed at a time beyond those at which it is known.
    #[error(
        "the bodies are known from t = {first:?} to t = {last:?}, and needed at t = {t:?}: give bodies there too"
    )]
    OutsideBodies {
        /// When it is needed.
        t: f64,
        /// The first time at which it is known.
        first: f64,
        /// The last one.
        last: f64,
    },
    /// Numbers between those of two bodies that no body can have.
    #[error(
        "the spline through the bodies has mass and moments at t = {t:?} that no body can have: give bodies at more times around it, \
         or, where they change suddenly, simulate the parts one after the other"
    )]
    NoBodyBetween {
        /// When.
        t: f64,
    },
    /// A body that loses or gains mass nowhere.
    #[error(
        "outlet: the mass is {first:?} at first and {mass:?} at t = {t:?}: give the point of the body at which it leaves or comes"
    )]
    MassWithoutOutlet {
        /// When.
        t: f64,
        /// The mass then.
        mass: f64,
        /// The first one.
        first: f64,
    },
    /// Wheels whose bearings hold them, in a body that varies.
    #[error(
        "load: dry friction and limits of a wheel's rate are not for a body that varies: leave friction, max_rate and max_momentum out"
    )]
    VaryingWithBearing,
    /// A method of integration that is not made for a run.
    #[error("the method \"{method}\" needs {needs}; \"{instead}\" can serve this run")]
    MethodCannotServe {
        /// The method asked for.
        method: &'static str,
        /// What it needs.
        needs: &'static str,
        /// A method that can.
        instead: &'static str,
    },
    /// A body whose motion about its fixed origin is not known in closed form.
    #[error(
        "the method \"exact\" needs a symmetric top whose axis passes through the origin: {lack}, by {relative:.2e} where \
         {allowed:.1e} is rounding; \"taylor\" can serve this run"
    )]
    NoClosedForm {
        /// What it lacks.
        lack: &'static str,
        /// By how much: of the largest moment, or of the radius of gyration.
        relative: f64,
        /// What is allowed.
        allowed: f64,
    },
    /// Derivatives of a motion under a law whose series is not known.
    #[error(
        "sensitivity: a part of the load has no series from which derivatives come, as a magnetic field along an orbit, B-dot, a \
         motor with a limit and dry friction; take differences of motions from states and loads a little apart, simulated tightly"
    )]
    NoSeries,
    /// A gyrostat of which the closed form loses too many digits.
    #[error(
        "the closed form would give ω at the start with an error of {off:.1e} of it: the moments are too many orders apart, or the \
         momentum inside is too large beside I ω; a simulation can follow this motion"
    )]
    LostInClosedForm {
        /// The error of ω at the start, relative to it.
        off: f64,
    },
    /// A gravity gradient on a body whose origin is fixed.
    #[error(
        "the gravity gradient acts on a body in orbit, whose centre of mass is free: here its \
         origin is fixed"
    )]
    PivotedInOrbit,
    /// A time so far away that the phases of a motion in closed form are not known any more.
    #[error(
        "t = {t:?} is beyond the reach of this motion, |t| <= {reach:.3e}: phases are known to 2^-90 of the turns made, so \
         after 2^88 turns nothing is left of them; ask for times within"
    )]
    BeyondReach {
        /// The time.
        t: f64,
        /// The largest.
        reach: f64,
    },
    /// A time so far from the epoch of an orbit that its state is not known any more.
    #[error(
        "a time {elapsed:?} from the epoch is beyond the reach of this orbit, {reach:.3e}: the phase on an ellipse is known to 2^-90 of \
         the revolutions made, near a parabola to less, and squares of distances must be float64; ask for times within, or give the state of the orbit at a later epoch"
    )]
    OrbitBeyondReach {
        /// The time from the epoch.
        elapsed: f64,
        /// The largest.
        reach: f64,
    },
    /// A body that does not touch the plane on which it is to roll.
    #[error(
        "position: the body {} by {:?}, where 1e-9 of the size {size:?} of its surface is allowed: a body that rolls touches the plane; \
         leave position out to put it there",
        if *gap > 0.0 { "hovers over the plane" } else { "sinks into the plane" },
        gap.abs()
    )]
    NoContact {
        /// The height of the contact over the plane.
        gap: f64,
        /// The size of the surface.
        size: f64,
    },
    /// A surface that touches the plane in no point of its own, or in more than one.
    #[error("{}: {law}", match time {
        Some(time) => format!("the contact is lost at t = {time:?}"),
        None => "attitude: there is no contact at the start".to_owned(),
    })]
    NoPointOfContact {
        /// When; none at the start.
        time: Option<f64>,
        /// Why, and the way out.
        law: &'static str,
    },
    /// A velocity that does not keep a body on its plane.
    #[error(
        "velocity: the contact moves {} the plane with {:?}, where 1e-9 of the speed {speed:?} is allowed: a body on a plane slips along it; \
         leave velocity out for one that rolls, or take its part along the normal away",
        if *away > 0.0 { "off" } else { "into" },
        away.abs()
    )]
    LeavesContact {
        /// The velocity of the contact along the normal.
        away: f64,
        /// The sum of the speeds of the centre of mass and of the contact about it.
        speed: f64,
    },
    /// A body that slips where no normal force, or more than one, keeps it on the plane.
    #[error(
        "no unique force at t = {time:?}: 1 + m (r x n) I^-1 (r x (n + f)) is {bracket:.3e}, and no normal force keeps a body \
         on the plane where it is not positive (Painleve's paradox): take less friction, or end the run before"
    )]
    NoUniqueForce {
        /// When.
        time: f64,
        /// What multiplies the normal force.
        bracket: f64,
    },
    /// Friction that is as large as rolling needs, to rounding, so that it is not known whether the body rolls.
    #[error(
        "the contact is on the edge of the friction cone at t = {time:?}: the coefficient of friction {friction:?} is what rolling needs, \
         {needed:?}, to 1e-12; give a larger coefficient for a body that rolls, or a smaller one for one that slips"
    )]
    OnFrictionCone {
        /// When.
        time: f64,
        /// The coefficient.
        friction: f64,
        /// What rolling needs.
        needed: f64,
    },
    /// Something that a contact cannot do.
    #[error("contact: {needs}")]
    ContactCannotServe {
        /// What it needs.
        needs: &'static str,
    },
    /// A body whose rolling has no closed form here.
    #[error(
        "no closed form: {law}, got {value:?}; the simulation of a contact serves other bodies"
    )]
    RollsInNoClosedForm {
        /// What must be so, and what the number is.
        law: &'static str,
        /// The number.
        value: f64,
    },
    /// A time at which nothing is known of how far a body that rolls has turned.
    #[error(
        "t = {t:?} is beyond the reach of this motion, |t| <= {reach:.3e}: the attitude of a ball on a slope is summed for 1e5 radians, \
         and after 1e15 radians no digit of an angle is left; ask for times within, or go on from a state at a later time"
    )]
    RollingBeyondReach {
        /// The time.
        t: f64,
        /// The largest.
        reach: f64,
    },
    /// The step of an integration fell below what the clock can tell apart.
    #[error(
        "the integration cannot go on at t = {time:?}: its step would have to be {step:.2e}, too small to advance the \
         time; the motion or the load is singular there, or rtol is tighter than the load is smooth"
    )]
    StepTooSmall {
        /// Where.
        time: f64,
        /// The step asked for.
        step: f64,
    },
    /// A run of more steps than a run may take.
    #[error(
        "the integration has come to t = {time:?} in {steps} steps, and would take {ahead:.1e} in all; a run takes {most:e} at \
         most: ask for a looser rtol, or for a shorter time and go on from its end"
    )]
    TooManySteps {
        /// Where it has come to.
        time: f64,
        /// Steps so far.
        steps: u64,
        /// Steps of the whole run at this rate.
        ahead: f64,
        /// The limit.
        most: f64,
    },
    /// A function whose passages through zero are looked for, and that changes too fast for that.
    #[error(
        "{} changes too fast to find all its zeros: {looks} evaluations in parts of the run that were halved are spent (a part \
         halved 24 times counts as 4096), and it is not followed in one of length {length:.1e} near t = {time:?}; if the \
         function is rounding errors about zero there, look for a level above them, else ask for a shorter time and go on from \
         its end",
        match event {
            Some(number) => format!("events: event {number}"),
            None => "a switch of the load".to_owned(),
        }
    )]
    UnresolvedFunction {
        /// Its number among the events, or a switch of the load.
        event: Option<usize>,
        /// Where it has not been followed.
        time: f64,
        /// The length of the part there.
        length: f64,
        /// How often it was evaluated in parts that were halved.
        looks: u64,
    },
    /// The equations of motion gave a number that is not finite.
    #[error(
        "the equations of motion are not finite at t = {time:?}: check the load at that time and state"
    )]
    NotFiniteMotion {
        /// Where.
        time: f64,
    },
    /// Derivatives that leave the range of float64 where the motion itself does not.
    #[error(
        "the derivatives of the motion have left the range of float64 by t = {time:?}: motions that start side by side part \
         that fast; ask for times nearer the start"
    )]
    NotFiniteDerivative {
        /// The first of the times asked for at which they are beyond it.
        time: f64,
    },
}

impl MotionFault {
    /// The kind of mistake.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::TorqueAlongMasslessAxis { .. }
            | Self::MasslessGyrostat { .. }
            | Self::WheelsTooHeavy { .. } => Kind::Inertia,
            Self::NoContact { .. }
            | Self::LeavesContact { .. }
            | Self::NoUniqueForce { .. }
            | Self::OnFrictionCone { .. }
            | Self::NoPointOfContact { .. }
            | Self::RollsInNoClosedForm { .. }
            | Self::ContactCannotServe { .. } => Kind::Contact,
            Self::GimbalLock { .. } | Self::SingularEulerRates { .. } => Kind::SingularAttitude,
            Self::StepTooSmall { .. }
            | Self::TooManySteps { .. }
            | Self::UnresolvedFunction { .. }
            | Self::NotFiniteMotion { .. }
            | Self::NotFiniteDerivative { .. } => Kind::Integration,
            Self::EulerSequence { .. }
            | Self::PivotOffAxis { .. }
            | Self::SpinTooSlow { .. }
            | Self::NoSuchMode { .. }
            | Self::UnreachablePeriods { .. }
            | Self::NotMonotone { .. }
            | Self::WindowOrder { .. }
            | Self::OutsideSamples { .. }
            | Self::OutsideBodies { .. }
            | Self::NoBodyBetween { .. }
            | Self::MassWithoutOutlet { .. }
            | Self::VaryingWithBearing
            | Self::MethodCannotServe { .. }
            | Self::NoClosedForm { .. }
            | Self::LostInClosedForm { .. }
            | Self::NoSeries
            | Self::PivotedInOrbit
            | Self::OutsideTimes { .. }
            | Self::StatesStay { .. }
            | Self::NoController
            | Self::OrbitBeyondReach { .. }
            | Self::RollingBeyondReach { .. }
            | Self::BeyondReach { .. } => Kind::Argument,
        }
    }
}
