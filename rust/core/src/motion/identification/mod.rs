//! From a log of a motion to the body: likelihood along the exact motion.
//!
//! | what | file |
//! |---|---|
//! | the most likely tensor of a tumbling body, and what a log would tell of it | `tumble` |
//! | first estimates: momentum in balance over windows | `momentum_balance` |
//! | ω along a motion, with its derivatives by start and tensor | `series` |
//! | least squares by a triangle, steps of Levenberg and Marquardt | `triangle` |

// Loops run over components and columns, as the formulas do; a comparison that fails for NaN is meant.
#![allow(clippy::needless_range_loop, clippy::neg_cmp_op_on_partial_ord)]

mod momentum_balance;
mod series;
mod triangle;
mod tumble;

pub use tumble::{Bias, ELEMENTS, Fit, Sensor, Tumble, fit_tumble, information};
