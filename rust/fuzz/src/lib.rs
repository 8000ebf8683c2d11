//! What adversaries ask of polhode: input from bytes, as wild as bytes can be, and the laws that every answer must obey.
//!
//! A harness takes bytes, makes of them what a reader or a constructor takes, and asserts of what comes back more than that
//! it comes back: numbers are finite or there is an error, bodies are possible, bounds are not negative, quaternions have
//! unit length, free motions keep energy and angular momentum. `targets` hands it the bytes that libFuzzer breeds
//! (`make fuzz`), `tests/replay.rs` those of `seeds` and some thousands of a generator (`cargo test`).
//!
//! | harness | what it asks |
//! |---|---|
//! | [`readers`] | every reader of bytes or text |
//! | [`bodies`] | every constructor of a body, and what is made of bodies |
//! | [`angles`] | attitudes, Euler angles, kinematics, principal axes |
//! | [`motions`] | free motions, tops, simulations under every load by every method |

// Symbols must match the page they come from.
#![allow(non_snake_case)]

pub mod angles;
pub mod bodies;
pub mod draw;
pub mod laws;
pub mod loads;
pub mod meshes;
pub mod motions;
pub mod readers;
pub mod runs;
pub mod uses;

/// A harness: takes bytes, panics where a law is broken.
pub type Harness = fn(&[u8]);

/// All of them by name.
pub const HARNESSES: [(&str, Harness); 4] = [
    ("readers", readers::run),
    ("bodies", bodies::run),
    ("angles", angles::run),
    ("motions", motions::run),
];
