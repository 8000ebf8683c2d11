//! Taylor series: each step sums the power series of the motion in time, to the order at which the work is least.
//!
//! | file | what it knows |
//! |---|---|
//! | `frame` | the principal axes, in doubles or in numbers of twice the precision |
//! | `course` | one motion: its load in principal axes, from break to break, in a unit of its own |
//! | `field` | the equations that are linear in the coefficients of one order |
//! | `formulas`, `terms`, `gradient`, `pulled`, `extras` | the recurrences of terms that are not |
//! | `circuit`, `almanac` | the series of an orbit, and where motions look them up |
//! | `series` | the coefficients, and what is asked of the sums of their products |
//! | `alone`, `abreast` | these sums, the lanes over the components of one motion or over motions |
//! | `twin` | these sums in numbers of twice the precision |
//! | `derived`, `row`, `pace` | these sums in numbers with derivatives, and how far they reach |
//! | `directions` | directions of space as seen from the body |
//! | `push` | the path of a body that forces act on |
//! | `carried` | the states that a load has of its own |
//! | `step` | the length of a step, the state at its end or within |
//! | `drive` | steps, outputs, breaks, until all motions are done; `seen`: each step as it is made |
//! | `pack` | one number of several motions |
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

mod abreast;
mod almanac;
mod alone;
mod carried;
mod circuit;
mod course;
mod derived;
mod directions;
mod drive;
mod extras;
mod field;
mod formulas;
mod frame;
mod gradient;
mod job;
mod kernels;
mod many;
mod one;
mod pace;
mod pack;
mod pulled;
mod push;
mod row;
mod series;
mod step;
mod terms;
mod twin;
mod varied;

pub(crate) use drive::Step;
pub use many::solve_many;
pub use one::solve_one;
pub(crate) use one::solve_seen;
pub(super) use varied::run_varied;
