//! The formulas and exercises of the theory, each under its label, against the closed form on paper.
//!
//! | part | labels |
//! |---|---|
//! | `mass` | mex67, inertia tensor, mln80, mex69, mex73, mex68, mex252, 253, 254, mex255, mex71, mex143 |
//! | `motion` | mln24, mln25, mex173, angular momentum, msl25, msl26, mex174, mln27, mex175 |
//! | `tops` | part II: free precession, steady spins, sleeping, steady precession |

mod mass;
mod motion;
mod tops;

use nalgebra::Vector3;
use polhode::RigidBody;
use proptest::prelude::ProptestConfig;

/// Random parameter sets for each label.
fn sets() -> ProptestConfig {
    ProptestConfig::with_cases(64)
}

/// Equal to 1e-13 of `size`, the largest term of the quantity.
#[track_caller]
fn close(value: f64, expected: f64, size: f64) {
    assert!(
        (value - expected).abs() <= 1e-13 * size,
        "{value} instead of {expected}"
    );
}

#[track_caller]
fn close_vectors(value: &Vector3<f64>, expected: &Vector3<f64>, size: f64) {
    assert!(
        (value - expected).norm() <= 1e-13 * size,
        "{value} instead of {expected}"
    );
}

fn body(shape: Result<RigidBody, polhode::Error>) -> RigidBody {
    shape.expect("a possible body")
}
