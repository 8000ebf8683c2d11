//! Taylor series: each step sums the power series of the motion in time, to the order at which the work is least.
//!
//! | file | contents |
//! |---|---|
//! | `run` | the motion of one task, of many tasks on all cores, of one task with its derivatives |
//! | `driver`, `stops` | the loop over steps of several motions side by side; outputs, breaks and switches of the load within a step |
//! | `step` | length of a step, state with its rounding errors, a finished step as polynomials in time |
//! | `equations` | equations of one motion: principal axes, unit of rates, segments from break to break of the load |
//! | `principal_frame` | principal axes and moments, in doubles, in double-double, or with derivatives |
//! | `linear_terms` | terms that are linear in the coefficients of one order |
//! | `nonlinear` | all other terms; torques that depend on time alone |
//! | `formulas` | torques that are not linear in ω, such as quadratic damping |
//! | `gravity_gradient`, `orbit_series`, `orbit_cache` | gravity gradient, the series of its orbit, and a cache of such series |
//! | `internal_states` | states of wheels and dampers |
//! | `translation` | path of the centre of mass under forces |
//! | `series` | recursion for ω, attitude and directions: what every series below implements |
//! | `single_series`, `batch_series` | one motion with its components in the lanes; several motions, one in each lane |
//! | `double_double_series`, `variational_series` | one motion in double-double; one motion with derivatives |
//! | `batch` | arithmetic with one number of several motions |
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
