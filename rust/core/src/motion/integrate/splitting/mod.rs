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
//! | `body` | a body between kicks, and kicked |

mod body;
mod method;
pub(crate) mod scheme;

pub(crate) use self::method::Splitting;
pub(crate) use self::scheme::Scheme;
