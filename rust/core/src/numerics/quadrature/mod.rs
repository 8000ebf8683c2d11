//! Adaptive cubature: tensor products of Gauss-Kronrod rules over boxes that are halved where their errors are.
//!
//! Each rule is two in one: the Gauss rule uses every other node of the Kronrod rule. Along each axis the difference of
//! the two is the error of the *Gauss* rule, of less than two thirds of the degree, and is reported as that of the
//! Kronrod rule: a bound with room to spare wherever the integrand is smooth on the scale of the nodes. The nodes lie
//! inside the box, so that an integrand may be singular on its faces.
//!
//! The nodes beside a face are some thousandths of the box away from it: a jump of the integrand between them and the
//! face is seen by neither rule. So before the integral is called converged, every box is asked closer to its faces
//! (`probes`).
//!
//! | what | file |
//! |---|---|
//! | boxes are halved where their errors are | `adaptive` |
//! | boxes, their integrals, and what is integrated | `cells` |
//! | the rules | `rule` |
//! | a look beside the faces | `probes` |

mod adaptive;
mod cells;
mod probes;
mod rule;

pub(crate) use adaptive::integrate;
pub(crate) use cells::{Cell, Integrand, Leaf};
pub(crate) use rule::Rule;
