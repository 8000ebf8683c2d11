//! What small changes at the start, of the body or of the load have become at a time: the derivatives of a motion.
//!
//! Every number of the equations carries its derivatives by the variables with it; Taylor series of numbers with derivatives
//! obey the same recurrences as those of numbers, and what comes out are the series of the motion and of the equations that
//! its derivatives obey, the linearised ones, with all that depends on the varied number. Steps are as long as the series
//! of both allow. Eight variables are varied at a time, each eight in a run of its own.
//!
//! | file | what it knows |
//! |---|---|
//! | `derivatives` | all derivatives at the times of a task |
//! | `parameters` | the variables, in their order |
//! | `numbers` | series and vectors of numbers with derivatives |
//! | `motion` | a motion as series, and units |
//! | `inertia` | the tensor, the mass, the centre of mass |
//! | `acts`, `spline`, `orbit` | the recurrences of the terms of a load |
//! | `pace` | the length of a step |
//! | `columns` | state and derivatives at a time |
//! | `walk` | steps, outputs, breaks |
//!
//! Source: Hairer, Nørsett & Wanner, Solving ODEs I, §I.14; where a law changes its torque with the state, Filippov's rule for
//! derivatives ("saltation"), di Bernardo et al., Piecewise-smooth Dynamical Systems, §2.5.

mod acts;
mod columns;
mod derivatives;
mod inertia;
mod motion;
mod numbers;
mod orbit;
mod pace;
mod parameters;
mod spline;
#[cfg(test)]
mod tests;
mod walk;

pub use derivatives::{Variation, variations};
