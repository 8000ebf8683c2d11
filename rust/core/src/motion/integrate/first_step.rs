//! The first step of a method, from the sizes of state, slope and change of slope.

use nalgebra::SVector;

use super::system::System;

/// A step that a method whose error is of the order 1/`exponent` may try first, at most `span`, with its sign; takes one
/// evaluation of the equations.
///
/// `y`, `slope`: the state and `f(start, y)`. Source: Hairer, Nørsett & Wanner, Solving ODEs I, §II.4.
///
/// # Errors
/// What the equations refuse.
pub(super) fn first_step<S: System<N>, const N: usize>(
    system: &mut S,
    start: f64,
    span: f64,
    y: &SVector<f64, N>,
    slope: &SVector<f64, N>,
    exponent: f64,
) -> Result<f64, S::Error> {
    let (size, speed) = (system.error_norm(y, y, y), system.error_norm(y, y, slope));
    let trial = if speed > 0.0 && speed.is_finite() {
        0.01 * size / speed
    } else {
        1e-3 * span.abs()
    };
    let trial = trial.min(span.abs()).copysign(span);
    let there = y + slope * trial;
    let mut later = SVector::zeros();
    system.derivative(start + trial, &there, &mut later)?;
    let bend = system.error_norm(y, &there, &(later - slope)) / trial.abs();
    let fastest = speed.max(bend);
    let step = if fastest > 0.0 && fastest.is_finite() {
        (0.01 / fastest).powf(exponent).min(100.0 * trial.abs())
    } else {
        trial.abs()
    };
    Ok(step.min(span.abs()).copysign(span))
}
