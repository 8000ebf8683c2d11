//! The class `Load`: sums of analytic terms, of Python functions and of compiled ones.
//!
//! | file | what it knows |
//! |---|---|
//! | `called` | a Python function |
//! | `address` | a function at an address |
//! | `stateful` | Python functions with states of their own |
//! | `named` | states by name, as functions get them |
//! | `own` | the states that a load has of its own, by name |
//! | `inside` | what a body carries along under a load |
//! | `wheels` | the functions that make rotors, wheels and slugs |
//! | `recipe` | how a term was made, for pickle |
//! | `part` | one term, scaled, scheduled, picked |
//! | `load` | the sum of them |
//! | `operators` | what Python's operators and pickle do with it |
//! | `terms`, `control`, `field`, `functions` | the functions that make loads |
//! | `made` | which function makes which law |
//! | `acting` | a load at work on a body |
//! | `evaluate` | what a load exerts at a time and a state |

mod acting;
mod address;
mod called;
mod control;
mod evaluate;
mod field;
mod functions;
mod inside;
mod load;
mod made;
mod named;
mod operators;
mod own;
mod part;
mod recipe;
mod stateful;
mod terms;
mod wheels;

pub(crate) use acting::{Acting, Fault};
pub(crate) use functions::{callback, compiled, torque_callback, with_states};
pub(crate) use load::PyLoad;
pub(crate) use made::declare_laws;
pub(crate) use named::{Named, Slot, reported};
pub(crate) use terms::schedule;
