//! What the motion of a heavy top is like: between which inclinations its axis nods, how often, and on what path.

use std::f64::consts::TAU;

use super::phases::Phases;
use super::reduced::ReducedTop;
use super::top_data::times;
use super::turning_points::TurningPoints;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::power_of_two::times_power_of_two;

/// A difference of two numbers of this size, relative to their sizes, is rounding.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The path that the symmetry axis draws on a sphere about O.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Mode {
    /// The axis rests: it is vertical, or no weight acts and the body spins about it.
    Steady,
    /// Steady precession: the inclination is constant.
    Regular,
    /// The axis comes to rest whenever it is highest.
    Cusp,
    /// The precession turns back while the axis is high.
    Loop,
    /// The precession keeps its sense.
    Wave,
    /// The axis goes through the vertical in every period: the angular momentum about the vertical is that about the axis.
    Crossing,
    /// The axis swings or turns over in a vertical plane.
    Planar,
    /// The axis leaves the upward vertical, or comes to it, in infinite time.
    Asymptotic,
}

impl Mode {
    /// The name in one lower-case word.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Steady => "steady",
            Self::Regular => "regular",
            Self::Cusp => "cusp",
            Self::Loop => "loop",
            Self::Wave => "wave",
            Self::Crossing => "crossing",
            Self::Planar => "planar",
            Self::Asymptotic => "asymptotic",
        }
    }
}

/// How the axis of a heavy top nods and goes round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nutation {
    /// On what path.
    pub mode: Mode,
    /// The least and the largest inclination θ of the axis (from O to C) from the upward vertical.
    pub inclination: [f64; 2],
    /// Time from one least inclination to the next; infinite on an asymptotic path. NaN where the inclination is constant: in
    /// regular precession and of a steady axis.
    pub period: f64,
    /// Mean of φ̇, the rate about the upward vertical; of a steady axis zero. Where the axis goes through the vertical, φ jumps by half a
    /// turn there, which counts as forward.
    pub precession: f64,
    /// Mean of ψ̇, the rate of the body about its axis relative to the line of nodes.
    pub spin: f64,
}

impl Nutation {
    pub(super) fn steady(motion: &ReducedTop) -> Self {
        let inclination = angle(motion.bottom, motion.top);
        Self {
            mode: Mode::Steady,
            inclination: [inclination; 2],
            period: f64::NAN,
            precession: 0.0,
            spin: times_power_of_two(motion.axial.rounded(), motion.exponent),
        }
    }

    pub(super) fn of(
        motion: &ReducedTop,
        points: &TurningPoints,
        phases: &Phases,
        drift: DoubleDouble,
    ) -> Self {
        let [alpha, beta] = phases.mean();
        let rate = |turns: DoubleDouble| TAU * times(turns, motion.exponent).rounded();
        let mode = mode(motion, points, phases);
        Self {
            mode,
            inclination: [
                angle(motion.bottom + points.rise, points.below_top),
                angle(points.above_bottom, points.depth),
            ],
            period: match mode {
                Mode::Regular => f64::NAN,
                _ => times_power_of_two(0.5 / phases.clock.rounded(), -motion.exponent),
            },
            precession: rate(alpha + beta),
            spin: rate(alpha - beta + drift.scaled(2.0)),
        }
    }
}

fn mode(motion: &ReducedTop, points: &TurningPoints, phases: &Phases) -> Mode {
    if phases.clock.high == 0.0 {
        return Mode::Asymptotic;
    }
    let [depth, below_top, height] =
        [points.depth, points.below_top, motion.bottom + points.rise].map(DoubleDouble::rounded);
    if points.range.high <= ROUNDING * depth.min(height) {
        return Mode::Regular;
    }
    let b = motion.spin.rounded();
    let (sum, difference) = (motion.sum().rounded(), motion.difference().rounded());
    let size = motion.lift.high.abs();
    let vanishes = |x: f64, distance: DoubleDouble| {
        x.abs() <= ROUNDING * (size + (motion.spin * distance).high.abs())
    };
    let (at_top, at_bottom) = (
        vanishes(difference, motion.top) && points.beyond_top.high > points.below_top.high,
        vanishes(sum, motion.bottom),
    );
    if at_top || at_bottom {
        return if sum == 0.0 && difference == 0.0 {
            Mode::Planar
        } else {
            Mode::Crossing
        };
    }
    // φ̇ has the sign of a − b u = (a − b) + b (1 − u).
    let terms = [depth, below_top].map(|distance| b * distance);
    let [low, high] = terms.map(|term| difference + term);
    if high.abs() <= ROUNDING * (difference.abs() + terms[1].abs()) {
        Mode::Cusp
    } else if low * high < 0.0 {
        Mode::Loop
    } else {
        Mode::Wave
    }
}

/// θ for `1 + cos θ` and `1 − cos θ`.
fn angle(above: DoubleDouble, below: DoubleDouble) -> f64 {
    2.0 * below.rounded().sqrt().atan2(above.rounded().sqrt())
}
