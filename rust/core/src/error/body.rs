//! Why numbers, particles or densities make no body.

use thiserror::Error as ThisError;

use super::kind::Kind;

/// Why numbers, particles or densities make no body, or none that can do what is asked of it.
#[derive(Clone, Debug, PartialEq, ThisError)]
#[non_exhaustive]
pub enum BodyFault {
    /// A number of the body is NaN or infinite.
    #[error("{what} must be finite, got {value:?}")]
    NonFinite {
        /// Which.
        what: &'static str,
        /// The number.
        value: f64,
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
    /// The particles have no mass in all.
    #[error("the total mass of the {count} particles must be positive, got {mass:?}")]
    NoMass {
        /// How many particles.
        count: usize,
        /// Their total mass.
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
    /// The tensor is not symmetric.
    #[error(
        "{what} must be symmetric: element [{row}][{column}] is {a:?} but [{column}][{row}] is {b:?}, a relative \
         difference of {relative:.2e} where {allowed:.1e} is allowed"
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
    /// A principal moment about the centre of mass is negative.
    #[error(
        "inertia must have no negative principal moment: they are {:?}, {:?}, {:?} about the centre of mass{}",
        moments[0], moments[1], moments[2],
        if *is_from_origin { ", where the tensor given must be about the origin of the body frame" } else { "" }
    )]
    NegativeMoment {
        /// The three, ascending.
        moments: [f64; 3],
        /// Whether the tensor was given about the origin of the body frame and moved to the centre of mass.
        is_from_origin: bool,
        /// Whether a body has the tensor as it was given, taken about the centre of mass.
        is_possible_as_given: bool,
    },
    /// The two smaller principal moments sum to less than the largest.
    #[error(
        "principal moments {:?}, {:?}, {:?} break the triangle inequality I1 + I2 >= I3 by {deficit:?}, {relative:.2e} of \
         their sum: no distribution of mass has them",
        moments[0], moments[1], moments[2]
    )]
    TriangleInequality {
        /// The three, ascending.
        moments: [f64; 3],
        /// `I₃ − I₁ − I₂`.
        deficit: f64,
        /// The deficit over the sum of the moments.
        relative: f64,
        /// Whether the tensor was given as numbers; else it is that of matter, or of a body that was admitted with a tolerance.
        is_given: bool,
    },
    /// A 6×6 matrix that no mass, first moments and tensor make up.
    #[error(
        "spatial_inertia is not that of a body: element [{row}][{column}] is {got:?} where the others imply {expected:?}; \
         check the order of its halves and that it is about the origin"
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
    /// No two principal moments are equal.
    #[error(
        "the body is no symmetric top: of its principal moments {:?}, {:?}, {:?} the closest two differ by {gap:.2e} of \
         the largest where {allowed:.1e} is allowed",
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
    /// A shape without extent that is given a density.
    #[error(
        "{what} must be positive where a density is given (a degenerate shape takes a mass), got {value:?}"
    )]
    Degenerate {
        /// Its length, area or volume.
        what: &'static str,
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
    /// A cubature that did not reach its tolerance; the body as far as it is known stands beside this error.
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
    },
    /// Particles that were added twice.
    #[error(
        "start must place each particle once: numbers {start} to {last} meet the particles {from} to {} that are already there; \
         leave start out to add one chunk after the other",
        to - 1,
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
    /// A ball has no radius.
    #[error(
        "radii must be positive and finite: radii[{index}] is {radius:?}; leave out balls of no size"
    )]
    NotARadius {
        /// Which ball.
        index: usize,
        /// The number.
        radius: f64,
    },
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
}

impl BodyFault {
    /// The kind of mistake.
    #[must_use]
    pub fn kind(&self) -> Kind {
        match self {
            Self::NonFinite { .. }
            | Self::OutOfRange { .. }
            | Self::NonPositiveMass { .. }
            | Self::NegativeMass { .. }
            | Self::NegativeDensity { .. }
            | Self::NoMass { .. }
            | Self::NoRemainder { .. }
            | Self::NotSymmetric { .. }
            | Self::NegativeMoment { .. }
            | Self::TriangleInequality { .. }
            | Self::NotASpatialInertia { .. }
            | Self::NoLogCholesky { .. } => Kind::Inertia,
            Self::Quadrature { .. } => Kind::Quadrature,
            Self::NotASymmetricTop { .. }
            | Self::NegativeCentralMass { .. }
            | Self::ImpossibleDensity { .. }
            | Self::Degenerate { .. }
            | Self::NoMassFound { .. }
            | Self::TooFewEvaluations { .. }
            | Self::Overlap { .. }
            | Self::MissingParticles { .. }
            | Self::NotAnAccumulator
            | Self::NotARadius { .. }
            | Self::Label { .. } => Kind::Argument,
        }
    }
}

/// Three digits of `mantissa·2^exponent`, which may lie beyond all doubles.
fn decimal(mantissa: f64, exponent: i32) -> String {
    let logarithm = mantissa.abs().log10() + f64::from(exponent) * std::f64::consts::LOG10_2;
    let digits = 10.0_f64.powf(logarithm - logarithm.floor());
    let sign = if mantissa < 0.0 { "-" } else { "" };
    format!("{sign}{digits:.2}e{}", logarithm.floor())
}
