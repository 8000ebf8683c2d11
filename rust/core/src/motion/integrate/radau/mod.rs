//! Radau IIA: the implicit Runge-Kutta method of order 5 that collocates at three points, the last of them the end of the
//! step. It damps what decays fast whatever the length of the step (L-stable), so that a stiff load does not
//! dictate the steps (Hairer & Wanner, Solving ODEs II, §IV.8).
//!
//! | file | what it knows |
//! |---|---|
//! | `method` | steps: the stages, the error, the next length |
//! | `factors` | the matrices of Newton's iteration |
//! | `triangles` | a factored matrix, and the solutions with it |
//! | `stages` | linear combinations of the stages |
//! | `dense` | the state within a step |
//! | `tableau` | the numbers of the method |

mod dense;
mod factors;
mod method;
mod stages;
mod tableau;
#[cfg(test)]
mod tests;
mod triangles;

pub(crate) use method::Radau;
