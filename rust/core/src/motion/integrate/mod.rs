//! Steppers for ordinary differential equations `ẏ = f(t, y)`.
//!
//! | method | file | for |
//! |---|---|---|
//! | Taylor series | [`taylor`] | analytic loads: as accurate as the numbers can be |
//! | Taylor series of rolling | `rolling` | a body on a plane |
//! | DOP853 | `dop853` | loads whose series are not known: callbacks |
//! | Radau IIA | `radau` | stiff loads: strong damping, stiff control |
//! | Taylor series with derivatives | [`variation`] | how a motion under analytic loads depends on what it is computed from |
//! | splitting | `splitting` | loads without damping over long times: the energy does not drift |

pub(crate) mod dop853;
pub(crate) mod radau;
pub(crate) mod rolling;
mod runge_kutta;
pub(crate) mod splitting;
pub mod taylor;
pub mod variation;

pub(crate) use dop853::Dop853;
pub(crate) use radau::Radau;
pub(crate) use runge_kutta::{Compensated, RungeKutta, System};
pub(crate) use splitting::Splitting;
