//! Taylor series: each step sums the power series of the motion in time, to the order at which the work is least.
//!
//! | file | contents |
//! |---|---|
//! | `run` | the motion of one task, of many tasks on all cores, of one task with its derivatives |
//! | `driver` | the loop over steps of several motions side by side; outputs, breaks and switches of the load within a step |
//! | `step` | length of a step, state with its rounding errors, a finished step as polynomials in time |
//! | `equations` | equations of one motion: principal axes in the numbers of the run, unit of rates, segments from break to break of the load, linear terms |
//! | `nonlinear` | all other terms: torques that depend on time alone or are not linear in ω, such as quadratic damping |
//! | `gravity_gradient`, `orbit_series`, `orbit_cache` | gravity gradient, the series of its orbit, and a cache of such series |
//! | `internal_states` | states of wheels and dampers |
//! | `translation` | path of the centre of mass under forces |
//! | `series` | the recursion for ω, attitude and directions, for any numbers |
//! | `batch`, `batch_series` | arithmetic with one number of several motions; the series of these motions, one in each lane |
//! | `double_double`, `variational` | one motion in double-double; one motion with derivatives |
//! | `single` | one motion in doubles, with its components in the lanes: the one recursion of its own |
//! | `directions` | directions fixed in space, by squares of series |
//!
//! Sources: Jorba & Zou, Experimental Mathematics 14 (2005) 99; Hairer, Nørsett & Wanner, Solving ODEs I, §I.8.

#![expect(
    clippy::needless_range_loop,
    reason = "rows and components are indices of several arrays at once"
)]

mod batch;
mod batch_series;
mod directions;
mod double_double;
mod driver;
mod equations;
mod gravity_gradient;
mod internal_states;
mod nonlinear;
mod orbit_cache;
mod orbit_series;
mod run;
mod series;
mod single;
mod step;
mod translation;
mod variational;

pub(super) use driver::{LAST_TERM, order_of_least_work};
pub(super) use run::solve_variational;
pub(crate) use run::solve_with_observer;
pub use run::{solve_many, solve_one};
pub(crate) use step::Step;
pub(super) use step::{exp2, log2_step};
