//! Splitting: kicks by the load between exact free motions, at equal steps.
//!
//! The energy of the free motion and that of position are each followed exactly, one at a time; a composition that reads
//! the same backward keeps the total energy near its start for as long as the motion lasts, where other methods drift
//! (Hairer, Lubich & Wanner, Geometric Numerical Integration, §V.1, §IX; `McLachlan` and Quispel, Acta Numerica 11 (2002) 341).
//!
//! | file | what it knows |
//! |---|---|
//! | `method` | equal steps to the end of a span, and the checks of their length |
//! | [`scheme`] | the compositions of kicks and free motions |
//! | `step_length` | how long the steps may be, and which scheme then takes fewest kicks |
//! | `body` | a body between kicks, and kicked |
//! | `short_turn` | the free motion over a short time |

mod body;
mod method;
pub(crate) mod scheme;
mod short_turn;
mod step_length;
#[cfg(test)]
mod tests;

pub(crate) use self::method::Splitting;
pub(crate) use self::scheme::Scheme;
