//! Splitting: kicks by the load between exact free motions, at equal steps.
//!
//! The motions by the energy of the free motion and by the potential energy are each computed exactly, one after the other. With a
//! composition that is symmetric in time the error of the total energy does not grow, whereas with other methods the energy drifts
//! (Hairer, Lubich & Wanner, Geometric Numerical Integration, §V.1, §IX; `McLachlan` and Quispel, Acta Numerica 11 (2002) 341).
//!
//! | file | contents |
//! |---|---|
//! | `method` | equal steps to the end of a span, their length and the choice of scheme |
//! | [`scheme`] | the compositions of drifts and kicks |
//! | `body` | the free motion and the kicks of a body |

mod body;
mod method;
pub(crate) mod scheme;

pub(crate) use self::method::Splitting;
pub(crate) use self::scheme::Scheme;
