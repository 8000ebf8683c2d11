//! Values as `serde` stores them, and read again by way of the checks of their constructors.
//!
//! | what | file |
//! |---|---|
//! | from a value to its stored form and back | `form` |
//! | bodies, and where their numbers come from | `mass` |
//! | states, methods, events | `motion` |
//!
//! Loads that are plain numbers have their forms in their own files.

mod form;
mod mass;
mod motion;
