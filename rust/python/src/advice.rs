//! The way out of an error of the core in the words of the Python package: which keyword or function mends it.
//!
//! The core says law and numbers, and what mends them where that needs no name of Python's. The command line puts its options
//! in the place of these keywords (`cli/text.py`).

use polhode::Error;
use polhode::error::{BodyFault, FileFault, MeshFault, MotionFault};

/// The way out of an open mesh, with which its message ends: a reader of files names another one before it.
pub(crate) const CLOSE: &str =
    "close the mesh (closure=\"caps\" or \"hull\"), or model a thin shell instead";

/// The message for a user of Python.
pub(crate) fn in_words(error: &Error) -> String {
    format!("{error}{}", advice(error))
}

/// What follows the core's own words.
fn advice(error: &Error) -> String {
    match error {
        Error::Body(fault) => of_body(fault).to_owned(),
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

fn of_body(fault: &BodyFault) -> &'static str {
    match fault {
        BodyFault::NotSymmetric { .. } => "; pass rtol= for a table printed to few digits",
        BodyFault::TriangleInequality { .. } => {
            "; pass rtol= if the table was printed to few digits"
        }
        BodyFault::NegativeMoment {
            is_from_origin: true,
            ..
        } => ": if it is about the centre of mass pass it as inertia=",
        BodyFault::Degenerate { .. } => "; pass mass=",
        BodyFault::NotASpatialInertia { .. } => " (order= says which half comes first)",
        BodyFault::NotASymmetricTop { .. } => {
            "; pass rtol= to take them as equal, or integrate with simulate()"
        }
        _ => "",
    }
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
        MotionFault::NoClosedForm { .. } => {
            ": method=\"taylor\"; heavy_top(rtol=) takes a body for symmetric"
        }
        MotionFault::PivotedInOrbit => "; simulate it with about=\"center_of_mass\"",
        MotionFault::LostInClosedForm { .. } => {
            ": body.simulate(times, omega, load=polhode.loads.rotor(momentum)), or polhode.loads.wheel for wheels that are free"
        }
        MotionFault::TooManySteps { .. } | MotionFault::UnresolvedFunction { .. } => " with resume",
        MotionFault::NoSeries => ": sensitivity(method=\"differences\")",
        _ => "",
    }
}
