//! The crate from outside: laws, worked numbers and runs. One program, so that what is generic is compiled once.

// Failing to make a test's own input fails the test.
#![allow(clippy::expect_used)]

mod carried;
mod free_motion;
mod identification;
mod laws;
mod runs;
#[cfg(feature = "serde")]
mod stored;
mod strategies;
mod textbook;
mod watch;
