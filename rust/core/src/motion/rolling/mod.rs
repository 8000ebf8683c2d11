//! Rolling: a body with a convex surface that touches a plane in one point.
//!
//! Points: C the centre of mass, P the point of contact, `ρ = P − C` in body axes; n the unit normal of the plane, towards the body,
//! and `γ = Rᵀ n` in body axes. A convex surface touches where its outward normal is −γ.
//!
//! | what | file |
//! |---|---|
//! | a surface in the body, its point of contact and curvatures | [`mod@surface`] |
//! | ball, ellipsoid, disk, torus, paraboloid | `sphere`, `ellipsoid`, `disk`, `torus`, `paraboloid` |
//! | the plane, the law of contact, what follows when the body lifts off | [`contact`] |
//! | Newton's and Euler's equations with the constraint of rolling solved | `equations` |
//! | force, friction needed, power | [`force`] |
//! | what stays constant | [`invariants`] |
//! | steady motions, critical rates, rattleback, tippe top | [`mod@steady`] |
//!
//! Source: Routh, Advanced Rigid Dynamics (1884), §§ 244–255; Borisov & Mamaev, Regular and Chaotic Dynamics 7 (2002) 177.

pub mod contact;
mod disk;
mod ellipsoid;
pub(crate) mod equations;
pub mod force;
pub mod invariants;
mod paraboloid;
mod sphere;
pub mod steady;
pub mod surface;
mod torus;

pub use contact::{Contact, LiftOff};
pub use surface::Surface;
