//! The class `Load`: sums of analytic terms, of Python functions and of compiled ones.
//!
//! | file | what it knows |
//! |---|---|
//! | `called` | a Python function |
//! | `address` | a function at an address |
//! | `recipe` | how a term was made, for pickle |
//! | `part` | one term, scaled, scheduled, picked |
//! | `load` | the sum of them |
//! | `operators` | what Python's operators and pickle do with it |
//! | `terms`, `functions` | the functions that make loads |
//! | `acting` | a load at work on a body |
//! | `evaluate` | what a load exerts at a time and a state |

mod acting;
mod address;
mod called;
mod evaluate;
mod functions;
mod load;
mod operators;
mod part;
mod recipe;
mod terms;

pub(crate) use acting::{Acting, Fault};
pub(crate) use functions::{callback, compiled, torque_callback};
pub(crate) use load::PyLoad;
pub(crate) use terms::{
    constant_force, constant_torque, damping, feedback, gravity_gradient, sampled, schedule,
    uniform_gravity,
};
