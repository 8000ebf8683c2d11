//! The way out of an error of the core in the words of the Python package: which keyword or function mends it.
//!
//! The core says law and numbers, and what mends them where that needs no name of Python's. The command line and the readers of
//! files have remedies of their own for the kinds that `errors` states.

use polhode::Error;
use polhode::error::{BodyFault, FileFault, MeshFault, MotionFault};

/// The way out of an open mesh, with which its message ends.
const CLOSE: &str = "close the mesh (closure=\"caps\" or \"hull\"), or model a thin shell instead";

/// What else can be done with a tensor that no body has.
const NEAREST: &str = " (validity.nearest_valid finds the nearest tensor that a body has)";

/// Moments that differ by more of the largest are not taken as equal by a tolerance.
pub(crate) const NEARLY_EQUAL: f64 = 0.01;

/// The message for a user of Python.
pub(crate) fn in_words(error: &Error) -> String {
    format!("{error}{}", advice(error))
}

/// What follows the core's own words.
pub(crate) fn advice(error: &Error) -> String {
    match error {
        Error::Body(fault) => of_body(fault),
        Error::Mesh(MeshFault::Open { .. }) => format!("; {CLOSE}"),
        Error::Mesh(fault) => of_mesh(fault).to_owned(),
        Error::File(FileFault::IndexZero { .. }) => ": index_base=0".to_owned(),
        Error::Motion(MotionFault::MethodCannotServe { instead, .. }) => {
            format!(": method=\"{instead}\"")
        }
        Error::Motion(fault) => of_motion(fault).to_owned(),
        _ => String::new(),
    }
}

/// Whether a tolerance may admit moments that break the triangle inequality.
pub(crate) fn is_rounded(fault: &BodyFault) -> bool {
    match fault {
        BodyFault::TriangleInequality {
            moments,
            deficit,
            is_given: true,
            ..
        } => may_be_rounded(moments, *deficit),
        _ => false,
    }
}

/// What follows the words of the core on a body that cannot be.
fn of_body(fault: &BodyFault) -> String {
    match fault {
        BodyFault::NotSymmetric { .. } => {
            "; put one number in both places, such as their mean".to_owned()
        }
        BodyFault::TriangleInequality { relative, .. } if is_rounded(fault) => {
            let rtol = rounded_up(*relative);
            format!("; pass rtol={rtol} if the table was printed to few digits")
        }
        BodyFault::TriangleInequality { is_given: true, .. } => {
            format!("; check the numbers and their units{NEAREST}")
        }
        BodyFault::TriangleInequality { .. } => {
            format!("; check matter for surfaces that cross, or take another tensor{NEAREST}")
        }
        BodyFault::NegativeMoment {
            is_possible_as_given: true,
            ..
        } => ": if it is about the centre of mass pass it as inertia=".to_owned(),
        BodyFault::Degenerate { .. } => "; pass mass=".to_owned(),
        BodyFault::NotASpatialInertia { .. } => " (order= says which half comes first)".to_owned(),
        BodyFault::NotASymmetricTop { gap, .. } if *gap <= NEARLY_EQUAL => {
            let rtol = rounded_up(*gap);
            format!("; pass rtol={rtol} to take them as equal, or integrate with simulate()")
        }
        BodyFault::NotASymmetricTop { .. } => "; integrate with simulate()".to_owned(),
        _ => String::new(),
    }
}

/// Whether three moments that break the triangle inequality may be those of a body, rounded to the digits that they show.
///
/// Each is wrong by up to half a unit of the last place of the finest. Moments with all digits of a float64 were computed
/// from a tensor; its elements are taken to have three digits. A single digit is no table of few digits.
fn may_be_rounded(moments: &[f64; 3], deficit: f64) -> bool {
    let largest = moments[2];
    let place = (moments.iter().map(|&moment| last_place(moment)))
        .min()
        .unwrap_or(0);
    let unit = 10.0_f64.powi(place);
    if largest < 1e12 * unit {
        largest >= 10.0 * unit && deficit <= 1.5 * unit * (1.0 + 1e-9)
    } else {
        deficit <= 0.015 * largest
    }
}

/// The power of ten of the last digit that tells a number from all others; high where it has none.
fn last_place(number: f64) -> i32 {
    if number == 0.0 {
        return i32::MAX;
    }
    let text = format!("{number:e}");
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let behind = digits.split_once('.').map_or(0, |(_, behind)| behind.len());
    exponent.parse::<i32>().unwrap_or(0) - i32::try_from(behind).unwrap_or(0)
}

/// Two digits of a positive number, so that they are no less than it.
fn rounded_up(number: f64) -> String {
    let text = format!("{number:.1e}");
    if text.parse().is_ok_and(|rounded: f64| rounded >= number) {
        return text;
    }
    let unit = 10.0_f64.powf(number.log10().floor() - 1.0);
    format!("{:.1e}", number + unit)
}

fn of_mesh(fault: &MeshFault) -> &'static str {
    match fault {
        MeshFault::Inverted { .. } => ", or pass orient=True to turn them all",
        MeshFault::InsideOut { .. } => ", or pass orient=True to turn them",
        _ => "",
    }
}

fn of_motion(fault: &MotionFault) -> &'static str {
    match fault {
        MotionFault::GimbalLock { .. } | MotionFault::SingularEulerRates { .. } => {
            ", or pass singular=\"nan\""
        }
        MotionFault::PivotOffAxis { .. } => {
            "; move the body with translated(), or integrate with simulate()"
        }
        MotionFault::NoSuchMode { .. } => "; use free_motion with an angular velocity",
        MotionFault::OutsideSamples { .. } => " with loads.schedule",
        MotionFault::NoClosedForm { relative, .. } if *relative <= NEARLY_EQUAL => {
            ": method=\"taylor\"; heavy_top(rtol=) takes a body for symmetric"
        }
        MotionFault::NoClosedForm { .. } => ": method=\"taylor\"",
        MotionFault::PivotedInOrbit => "; simulate it with about=\"center_of_mass\"",
        MotionFault::LostInClosedForm { .. } => {
            ": body.simulate(times, omega, load=polhode.loads.rotor(momentum)), or polhode.loads.wheel for wheels that are free"
        }
        MotionFault::TooManySteps { .. } | MotionFault::UnresolvedFunction { .. } => " with resume",
        MotionFault::NoController => {
            "; give torque= the controller alone, such as loads.feedback(...), and add the other loads to the wheel"
        }
        MotionFault::NoSeries => ": sensitivity(method=\"differences\")",
        _ => "",
    }
}
