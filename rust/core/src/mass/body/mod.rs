//! The rigid body (m, C, `I_C`).
//!
//! | what | file |
//! |---|---|
//! | the body, and what makes one possible | `possible` |
//! | its moments about points and axes | `about` |
//! | when two are the same | `alike` |
//! | its numbers, stored and read again | `stored` |

mod about;
mod alike;
mod possible;
mod stored;

pub use possible::RigidBody;
