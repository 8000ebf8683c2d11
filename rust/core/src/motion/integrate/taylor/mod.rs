//! Taylor series: each step sums the power series of the motion in time, to the order at which the work is least.
//!
//! | file | what it knows |
//! |---|---|
//! | `principal_frame` | the principal axes, in doubles or in numbers of twice the precision |
//! | `equations` | one motion: its load in principal axes, from break to break, in a unit of its own |
//! | `linear_terms` | the equations that are linear in the coefficients of one order |
//! | `formulas`, `terms`, `gravity_gradient`, `pulled`, `nonlinear` | the recurrences of terms that are not |
//! | `orbit_series`, `orbit_cache` | the series of an orbit, and where motions look them up |
//! | `series` | the coefficients, and what is asked of the sums of their products |
//! | `single_series`, `batch_series` | these sums, the lanes over the components of one motion or over motions |
//! | `double_double_series` | these sums in numbers of twice the precision |
//! | `variational_series`, `row`, `pace` | these sums in numbers with derivatives, and how far they reach |
//! | `directions` | directions of space as seen from the body |
//! | `translation` | the path of a body that forces act on |
//! | `internal_states` | the states that a load has of its own |
//! | `step` | the length of a step, the state at its end or within |
//! | `drive` | steps, outputs, breaks, until all motions are done; `seen`: each step as it is made |
//! | `batch` | one number of several motions |
//! | `one`, `many` | the motion of one task, of many tasks on all cores |
//! | `varied` | the motion of one task with its derivatives |
//! | `job` | what there is to do of a task |
//! | `kernels` | motions in the lanes that serve them |
//!
//! Sources: Jorba & Zou, Experimental Mathematics 14 (2005) 99; Hairer, Nørsett & Wanner, Solving ODEs I, §I.8.

#![expect(
    clippy::needless_range_loop,
    reason = "rows and components are indices of several arrays at once"
)]

mod batch;
mod batch_series;
mod double_double_series;
mod driver;
mod equations;
mod formulas;
mod gravity_gradient;
mod internal_states;
mod linear_terms;
mod nonlinear;
mod orbit_cache;
mod orbit_series;
mod principal_frame;
mod run;
mod series;
mod single_series;
mod step;
mod stops;
mod translation;
mod variational_series;

pub(super) use run::solve_variational;
pub(crate) use run::solve_with_observer;
pub use run::{solve_many, solve_one};
pub(crate) use step::Step;
