//! Every way an input can be unphysical, each with the number that offends, the law and the way out.

use std::convert::Infallible;

use thiserror::Error as ThisError;

use crate::numerics::threads::Halt;

/// What kind of mistake an [`Error`] reports, for callers that map errors to classes of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kind {
    /// A number or option outside its domain.
    Argument,
    /// Mass properties that no real body has.
    Inertia,
    /// A mesh that does not bound a solid.
    Mesh,
    /// A file that is not what it says.
    File,
    /// An attitude at which the quantity asked for is not defined.
    SingularAttitude,
    /// An integral over a density that did not converge.
    Quadrature,
    /// An integration that could not go on.
    Integration,
    /// More than there is memory for.
    Memory,
}

/// An input that breaks a law of mechanics, of geometry or of the numbers themselves.
#[derive(Clone, Debug, PartialEq, ThisError)]
#[non_exhaustive]
pub enum Error {
    /// A number is NaN or infinite.
    #[error("{what} must be finite, got {value:?}")]
    NonFinite {
        /// The argument.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// A length, scale or density is negative, or zero where it must not be.
    #[error("{what} must be {law}, got {value:?}")]
    OutOfDomain {
        /// The argument.
        what: &'static str,
        /// What it must be.
        law: &'static str,
        /// The number.
        value: f64,
    },
    /// Two lengths are the wrong way round.
    #[error("{smaller} must not exceed {larger}, got {smaller} = {a:?} and {larger} = {b:?}")]
    OutOfOrder {
        /// The length that should be the smaller.
        smaller: &'static str,
        /// What it is.
        a: f64,
        /// The length that should be the larger.
        larger: &'static str,
        /// What it is.
        b: f64,
    },
    /// An interval is empty.
    #[error("{smaller} must be below {larger}, got {smaller} = {a:?} and {larger} = {b:?}")]
    NotBelow {
        /// What should be below.
        smaller: &'static str,
        /// What it is.
        a: f64,
        /// What should be above.
        larger: &'static str,
        /// What it is.
        b: f64,
    },
    /// A density that is no density.
    #[error(
        "density must be zero or more and finite everywhere in the region: at ({:?}, {:?}, {:?}) it is {value:?}",
        point[0], point[1], point[2]
    )]
    ImpossibleDensity {
        /// Where.
        point: [f64; 3],
        /// The number.
        value: f64,
    },
    /// A density that is zero wherever it was looked at.
    #[error(
        "density gives no mass: {mass:?} from {count} points; draw the bounds closely around the matter, so that it is found"
    )]
    NoMassFound {
        /// At how many points.
        count: usize,
        /// The mass found.
        mass: f64,
    },
    /// Not even one look at each cell is allowed.
    #[error("max_evaluations must be at least {needed} for these bounds, got {given}")]
    TooFewEvaluations {
        /// What one look takes.
        needed: usize,
        /// What was allowed.
        given: usize,
    },
    /// A cubature that did not reach its tolerance.
    #[error(
        "the integral of density did not converge: after {evaluations} evaluations its estimated relative error is \
         {error:.2e} where rtol is {rtol:.1e}; let a jump of the density be a boundary (one region on each side of it), \
         raise max_evaluations, or loosen rtol"
    )]
    Quadrature {
        /// The estimated relative error.
        error: f64,
        /// What was asked for.
        rtol: f64,
        /// How many evaluations it took.
        evaluations: usize,
        /// The body as far as it is known.
        estimate: Box<crate::RigidBody>,
    },
    /// A number of the body that float64 does not hold with all its digits.
    #[error(
        "the {what} would be {}, and float64 holds 2.2e-308 to 1.8e+308 with all digits: choose other units of length or mass",
        decimal(*mantissa, *exponent)
    )]
    OutOfRange {
        /// Which number.
        what: &'static str,
        /// The number is this times `2^exponent`.
        mantissa: f64,
        /// The power of two.
        exponent: i32,
    },
    /// The total mass is not positive.
    #[error("mass must be positive, got {mass:?}")]
    NonPositiveMass {
        /// The total mass.
        mass: f64,
    },
    /// One particle has negative mass.
    #[error(
        "masses must not be negative: masses[{index}] is {mass:?}; model a cavity by subtracting a body"
    )]
    NegativeMass {
        /// Which particle.
        index: usize,
        /// Its mass.
        mass: f64,
    },
    /// What a subtraction leaves is no body.
    #[error(
        "the subtraction leaves no possible body: the {what} of what remains would be {value:?}{}; \
         the part taken away must lie within the body it is taken from, and be no denser",
        axis.map(|[x, y, z]| format!(" along the axis ({x:.3}, {y:.3}, {z:.3})")).unwrap_or_default()
    )]
    NoRemainder {
        /// What is negative.
        what: &'static str,
        /// Along which axis of the body frame, if along one.
        axis: Option<[f64; 3]>,
        /// The number.
        value: f64,
    },
    /// The particles have no mass in all.
    #[error("the total mass of the {count} particles must be positive, got {mass:?}")]
    NoMass {
        /// How many particles.
        count: usize,
        /// Their total mass.
        mass: f64,
    },
    /// One cell has negative density.
    #[error(
        "density must not be negative: density[{}, {}, {}] is {density:?}; model a cavity by subtracting a body",
        index[0], index[1], index[2]
    )]
    NegativeDensity {
        /// Which cell.
        index: [usize; 3],
        /// Its density.
        density: f64,
    },
    /// Particles that were added twice.
    #[error(
        "start must place each particle once: numbers {start} to {last} meet the particles {from} to {} that are already          there; leave start out to add one chunk after the other", to - 1,
        last = end - 1
    )]
    Overlap {
        /// The number of the first new particle.
        start: u64,
        /// The number after the last new one.
        end: u64,
        /// The number of the first particle of the piece already there.
        from: u64,
        /// The number after its last.
        to: u64,
    },
    /// Particles that were never added.
    #[error(
        "the particles {start} to {} have not been added: add or merge the chunks that hold them, or leave start out",
        end - 1
    )]
    MissingParticles {
        /// The number of the first.
        start: u64,
        /// The number after the last.
        end: u64,
    },
    /// Bytes that no accumulator wrote.
    #[error("the bytes are not those of a MassAccumulator, or not whole")]
    NotAnAccumulator,
    /// A label that names no body.
    #[error(
        "labels must be the numbers of bodies, counted from 0, or -1 for particles of no body: labels[{index}] is {label}"
    )]
    Label {
        /// Which particle.
        index: usize,
        /// Its label.
        label: i64,
    },
    /// The tensor is not symmetric.
    #[error(
        "{what} must be symmetric: element [{row}][{column}] is {a:?} but [{column}][{row}] is {b:?}, a relative \
         difference of {relative:.2e} where {allowed:.1e} is allowed; pass rtol= for a table printed to few digits"
    )]
    NotSymmetric {
        /// The argument.
        what: &'static str,
        /// Row of the first element.
        row: usize,
        /// Column of the first element.
        column: usize,
        /// The first element.
        a: f64,
        /// Its mirror image.
        b: f64,
        /// Difference over the largest element.
        relative: f64,
        /// What is allowed.
        allowed: f64,
    },
    /// A 6×6 matrix that no mass, first moments and tensor make up.
    #[error(
        "spatial_inertia is not that of a body: element [{row}][{column}] is {got:?} where the others imply {expected:?}; \
         check the order of its halves (order=) and that it is about the origin"
    )]
    NotASpatialInertia {
        /// Row of the element.
        row: usize,
        /// Column of the element.
        column: usize,
        /// What it is.
        got: f64,
        /// What mass, first moments and tensor make it.
        expected: f64,
    },
    /// A body without thickness has no log-Cholesky parameters.
    #[error(
        "the body has no log-Cholesky parameters: its second moment along {along} is {square:?}, and they hold its \
         logarithm; use the pseudo-inertia or the ten parameters"
    )]
    NoLogCholesky {
        /// The axis whose pivot is zero.
        along: &'static str,
        /// The pivot.
        square: f64,
    },
    /// A principal moment about the centre of mass is negative.
    #[error(
        "inertia must have no negative principal moment: they are {:?}, {:?}, {:?} about the centre of mass{hint}",
        moments[0], moments[1], moments[2]
    )]
    NegativeMoment {
        /// The three, ascending.
        moments: [f64; 3],
        /// What may have gone wrong.
        hint: &'static str,
    },
    /// The two smaller principal moments sum to less than the largest.
    #[error(
        "principal moments {:?}, {:?}, {:?} break the triangle inequality I1 + I2 >= I3 by {deficit:?}, {relative:.2e} of \
         their sum: no distribution of mass has them; pass rtol= if the table was printed to few digits",
        moments[0], moments[1], moments[2]
    )]
    TriangleInequality {
        /// The three, ascending.
        moments: [f64; 3],
        /// `I₃ − I₁ − I₂`.
        deficit: f64,
        /// The deficit over the sum of the moments.
        relative: f64,
    },
    /// A matrix is not a rotation.
    #[error(
        "{what} must be a right-handed rotation matrix: its columns deviate from an orthonormal set by {deviation:.2e} \
         and its determinant is {determinant:?}"
    )]
    NotARotation {
        /// The argument.
        what: &'static str,
        /// Largest element of `RᵀR − 1`.
        deviation: f64,
        /// The determinant.
        determinant: f64,
    },
    /// A quaternion does not have unit length.
    #[error(
        "{what} must be a unit quaternion (x, y, z, w): its norm is {norm:?}; divide it by its norm"
    )]
    NotAUnitQuaternion {
        /// The argument.
        what: &'static str,
        /// Its norm.
        norm: f64,
    },
    /// A direction of zero length.
    #[error("{what} must not be the zero vector: it has no direction")]
    NoDirection {
        /// The argument.
        what: &'static str,
    },
    /// A torque about an axis with no moment of inertia.
    #[error(
        "torque has the component {torque:?} along a principal axis whose moment of inertia is zero: \
         the angular acceleration would be infinite; give the body a thickness or remove that component"
    )]
    TorqueAlongMasslessAxis {
        /// The component.
        torque: f64,
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
         only their sum or difference is; pass singular=\"nan\" or choose another sequence"
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
         {middle:?} rad: their axes coincide; pass singular=\"nan\" or choose another sequence"
    )]
    SingularEulerRates {
        /// The sequence.
        sequence: String,
        /// The middle angle.
        middle: f64,
    },
    /// Two particles at these places would need a negative third one.
    #[error(
        "the particle at the centre of mass would have the mass mass - inertia/(a b) = {mass:?}, which must not be \
         negative: choose a b of at least inertia/mass = {least:?}"
    )]
    NegativeCentralMass {
        /// What would be left at the centre.
        mass: f64,
        /// The least product of the distances.
        least: f64,
    },
    /// No two principal moments are equal.
    #[error(
        "the body is no symmetric top: of its principal moments {:?}, {:?}, {:?} the closest two differ by {gap:.2e} of \
         the largest where {allowed:.1e} is allowed; pass rtol= to take them as equal, or integrate with simulate()",
        moments[0], moments[1], moments[2]
    )]
    NotASymmetricTop {
        /// The three, ascending.
        moments: [f64; 3],
        /// The smaller relative gap.
        gap: f64,
        /// What is allowed.
        allowed: f64,
    },
    /// The centre of mass is not on the symmetry axis through the pivot.
    #[error(
        "the pivot, the origin of the body frame, must lie on the symmetry axis: the axis passes it at {distance:?}, \
         {relative:.2e} of the radius of gyration about it where {allowed:.1e} is allowed; move the body with \
         translated(), or integrate with simulate()"
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
         least is zero; use free_motion with an angular velocity",
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
    /// The mesh cannot be used; the message says which part of it and why.
    #[error(transparent)]
    Mesh(#[from] crate::mass::polyhedron::MeshFault),
    /// The corners do not bound a polygon; the message says where and why.
    #[error(transparent)]
    Polygon(#[from] crate::mass::laminae::PolygonFault),
    /// The tetrahedra cannot be used; the message says which and why.
    #[error(transparent)]
    Cells(#[from] crate::mass::tetrahedra::CellFault),
    /// The file cannot be used; the message says where and why.
    #[error(transparent)]
    File(#[from] crate::io::FileFault),
    /// Output times do not run in one direction.
    #[error("t must be strictly monotone: t[{index}] = {next:?} follows {previous:?}")]
    NotMonotone {
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
    /// A sampled torque is asked for at a time at which it is not known.
    #[error(
        "the sampled torque is known from t = {first:?} to t = {last:?}, and needed at t = {t:?}: give it samples there, \
         or switch it on within its samples with loads.schedule"
    )]
    OutsideSamples {
        /// When it is needed.
        t: f64,
        /// The first time at which it is known.
        first: f64,
        /// The last one.
        last: f64,
    },
    /// A method of integration that is not made for a run.
    #[error("method=\"{method}\" needs {needs}; method=\"{instead}\" can serve this run")]
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
        "method=\"exact\" needs a symmetric top whose axis passes through the origin: {lack}, by {relative:.2e} where \
         {allowed:.1e} is rounding; method=\"taylor\" can serve this run, and heavy_top(rtol=) takes a body for symmetric"
    )]
    NoClosedForm {
        /// What it lacks.
        lack: &'static str,
        /// By how much: of the largest moment, or of the radius of gyration.
        relative: f64,
        /// What is allowed.
        allowed: f64,
    },
    /// A gravity gradient on a body whose origin is fixed.
    #[error(
        "the gravity gradient acts on a body in orbit, whose centre of mass is free: simulate it with \
         about=\"center_of_mass\""
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
    /// There is nothing where something is needed.
    #[error("{what} must not be empty")]
    Empty {
        /// The argument.
        what: &'static str,
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
         most: ask for a shorter time (the rest from there with resume), or a looser rtol"
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
    /// More results than there is memory for; nothing has been computed.
    #[error(
        "{count} {what} would take {bytes:.3e} bytes, for which there is no memory: ask for fewer at a time"
    )]
    NoMemory {
        /// Of what.
        what: &'static str,
        /// How many.
        count: usize,
        /// All together.
        bytes: f64,
    },
    /// Whoever watched the work asked it to stop.
    #[error("the computation was stopped before it was finished")]
    Stopped,
}

/// Three digits of `mantissa·2^exponent`, which may lie beyond all doubles.
fn decimal(mantissa: f64, exponent: i32) -> String {
    let logarithm = mantissa.abs().log10() + f64::from(exponent) * std::f64::consts::LOG10_2;
    let digits = 10.0_f64.powf(logarithm - logarithm.floor());
    let sign = if mantissa < 0.0 { "-" } else { "" };
    format!("{sign}{digits:.2}e{}", logarithm.floor())
}

impl From<Halt<Infallible>> for Error {
    fn from(halt: Halt<Infallible>) -> Self {
        match halt {
            Halt::Stopped => Self::Stopped,
            Halt::Failed(never) => match never {},
        }
    }
}

impl Error {
    /// The kind of mistake.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::NonFinite {
                what:
                    "mass"
                    | "masses"
                    | "inertia"
                    | "inertia_about_origin"
                    | "moments"
                    | "products"
                    | "parameters"
                    | "pseudo_inertia"
                    | "spatial_inertia"
                    | "center_of_mass",
                ..
            }
            | Self::NonPositiveMass { .. }
            | Self::OutOfRange { .. }
            | Self::NegativeMass { .. }
            | Self::NegativeDensity { .. }
            | Self::NoMass { .. }
            | Self::NoRemainder { .. }
            | Self::NotSymmetric { .. }
            | Self::NegativeMoment { .. }
            | Self::NotASpatialInertia { .. }
            | Self::NoLogCholesky { .. }
            | Self::TriangleInequality { .. }
            | Self::TorqueAlongMasslessAxis { .. } => Kind::Inertia,
            Self::Mesh(_) | Self::Cells(_) => Kind::Mesh,
            Self::File(_) => Kind::File,
            Self::Quadrature { .. } => Kind::Quadrature,
            Self::GimbalLock { .. } | Self::SingularEulerRates { .. } => Kind::SingularAttitude,
            Self::StepTooSmall { .. }
            | Self::TooManySteps { .. }
            | Self::NotFiniteMotion { .. }
            | Self::NotFiniteDerivative { .. } => Kind::Integration,
            Self::NoMemory { .. } => Kind::Memory,
            _ => Kind::Argument,
        }
    }
}

impl From<Error> for Halt<Error> {
    fn from(error: Error) -> Self {
        match error {
            Error::Stopped => Self::Stopped,
            error => Self::Failed(error),
        }
    }
}

impl From<Halt<Self>> for Error {
    fn from(halt: Halt<Self>) -> Self {
        match halt {
            Halt::Stopped => Self::Stopped,
            Halt::Failed(error) => error,
        }
    }
}

/// `Ok` with a finite number, else [`Error::NonFinite`].
pub(crate) fn finite(what: &'static str, value: f64) -> Result<f64, Error> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(Error::NonFinite { what, value })
    }
}

/// `Ok` when every number is finite, else [`Error::NonFinite`] with the first that is not.
pub(crate) fn all_finite<'a>(
    what: &'static str,
    values: impl IntoIterator<Item = &'a f64>,
) -> Result<(), Error> {
    values
        .into_iter()
        .try_for_each(|&value| finite(what, value).map(drop))
}
