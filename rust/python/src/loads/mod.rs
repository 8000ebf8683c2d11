//! The class `Load`: sums of analytic terms, of Python functions and of compiled ones.
//!
//! | file | what it knows |
//! |---|---|
//! | `callbacks` | Python functions, with states of their own or without; states by name |
//! | `clock` | the times at which controllers look at the body |
//! | `firing` | thrusters as a part of a load, and what they are told |
//! | `address` | a function at an address |
//! | `load` | the sum of terms, and its states; one term, scaled, scheduled, picked; what Python's operators and pickle do with it |
//! | `pickle_recipe` | how a term was made, for pickle |
//! | `laws` | the functions that make loads |
//! | `panels` | the function that makes plates in light or air |
//! | `wheel` | the class `Wheel`, a record that is a load, and the function that makes one with a motor |
//! | `registry` | which function makes which law |
//! | `acting` | a load at work on a body, and what the body carries along under it |
//! | `evaluate` | what a load exerts at a time and a state |

mod acting;
mod address;
mod callbacks;
mod clock;
mod evaluate;
mod firing;
mod laws;
mod load;
mod panels;
mod pickle_recipe;
mod registry;
mod wheel;

pub(crate) use acting::{ActingLoad, Fault, carried_along};
pub(crate) use callbacks::{Named, Slot, report_states};
pub(crate) use laws::{callback, compiled, schedule, thrusters, torque_callback, with_states};
pub(crate) use load::{PyLoad, check_start};
pub(crate) use registry::declare_laws;
pub(crate) use wheel::{PyWheel, Turns, wheels};
