//! Values as `serde` stores them, and read again by way of the checks of their constructors.
//!
//! | what | file |
//! |---|---|
//! | a value that is stored as its name | `names` |
//! | bodies, and where their numbers come from | `mass` |
//! | states, methods, events | `motion` |
//!
//! Loads that are plain numbers have their forms in their own files.

mod mass;
mod motion;
mod names;
