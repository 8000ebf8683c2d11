//! Rolling and slipping: a body with a convex surface that touches a plane in one point.
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
//! | those of a body that slips, with the normal force solved; Painlevé's paradox | `sliding` |
//! | force, friction needed, power | [`force`] |
//! | what stays constant | [`invariants`] |
//! | motions in closed form: a ball, a cylinder or a cone | [`mod@rolling_motion`]: `ball`, `lying` |
//! | cylinder and cone, which touch along a line | [`ruled`] |
//! | steady motions, critical rates, rattleback, tippe top | [`mod@steady`] |
//!
//! # Examples
//!
//! ```
//! use polhode::mass::{Amount, solids};
//! use polhode::motion::rolling::{Contact, LiftOff, Surface};
//! use polhode::nalgebra::{UnitQuaternion, Vector3};
//!
//! // A bowl touches with its apex while it stands upright.
//! let bowl = Surface::paraboloid([0.2, 0.2], 0.1, None)?;
//! let up = Vector3::z();
//! let contact = Contact::rolling(bowl, up, Vector3::zeros(), 0.0, LiftOff::Stop)?;
//! assert_eq!(contact.plane_axes().column(2), up);
//! assert_eq!(contact.point_in_body(&UnitQuaternion::identity()), Vector3::new(0.0, 0.0, -0.1));
//! // When it tilts, the contact moves away from the normal by the radius of curvature.
//! assert_eq!(bowl.contact_rate(&up, &Vector3::x()), Vector3::new(-0.2, 0.0, 0.0));
//! assert_eq!(bowl.size(), 0.2);
//! assert_eq!((bowl.disk_radius(), bowl.sphere_radius()), (None, None));
//! # Ok::<(), polhode::Error>(())
//! ```
//!
//! Source: Routh, Advanced Rigid Dynamics (1884), §§ 244–255; Borisov & Mamaev, Regular and Chaotic Dynamics 7 (2002) 177.

mod ball;
pub mod contact;
mod disk;
mod ellipsoid;
pub(crate) mod equations;
pub mod force;
pub mod invariants;
mod lying;
mod paraboloid;
pub mod rolling_motion;
pub mod ruled;
pub(crate) mod sliding;
mod sphere;
pub mod steady;
pub mod surface;
mod torus;

pub use contact::{Contact, ContactPhase, Friction, Law, LiftOff, Resistance, RollingState};
pub use rolling_motion::RollingMotion;
pub use ruled::RuledSurface;
pub use surface::Surface;
