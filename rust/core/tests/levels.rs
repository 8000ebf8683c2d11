//! What has the same bits at any instruction set and on any number of threads, and the other tests of these files.
//!
//! They change settings of the process, and so stand in a program of their own.

// Failing to make a test's own input fails the test.
#![allow(clippy::expect_used)]

mod eigen3;
mod motions;
mod particles;
mod settings;
mod strategies;
mod taylor;
mod taylor_twofold;
mod watch;
