//! The list of the laws. Each stands in a file of its own in `laws`, which answers what a [`Law`] is asked; here its module is
//! declared, its type handed on, and its variant listed.

use nalgebra::Vector4;

pub mod constant_force;
pub mod constant_torque;
pub mod damping;
pub mod feedback;
pub mod gravity_gradient;
pub mod magnetic;
pub mod rotor;
pub mod sampled;
pub mod slug;
pub mod uniform_gravity;
pub mod wheel;

pub use self::constant_force::ConstantForce;
pub use self::constant_torque::ConstantTorque;
pub use self::damping::Damping;
pub use self::feedback::Feedback;
pub use self::gravity_gradient::GravityGradient;
pub use self::magnetic::{Magnetic, MagneticField};
pub use self::rotor::Rotor;
pub use self::sampled::Sampled;
pub use self::slug::Slug;
pub use self::uniform_gravity::UniformGravity;
pub use self::wheel::Wheel;

use super::body_at_point::BodyAtPoint;
use super::carried::Carried;
use super::law::{Law, Traits};
use super::law_switches::Switch;
use super::list::laws;
use super::parameter::Parameter;
use super::principal_frame::{LawNumber, PrincipalFrame};
use super::schedule::Windows;
use super::series_terms::SeriesTerms;
use super::wrench::Wrench;
use crate::error::{Error, finite};
use crate::motion::state::Phase;

laws!(
    ($)
    /// One analytic term of a load.
    #[derive(Clone, Debug, PartialEq)]
    #[non_exhaustive]
    pub enum Term {
        /// A torque N about the reference point of the motion.
        ConstantTorque(ConstantTorque),
        /// A force at a point p of the body: `N = (p − P)×F`.
        ConstantForce(ConstantForce),
        /// The weight m g at C.
        UniformGravity(UniformGravity),
        /// The torque of a distant attractor's field on a body in an orbit: `N = 3μ/r⁵ r×(I_C r)`.
        GravityGradient(GravityGradient),
        /// A torque against ω: `N = −D ω − E |ω| ω`.
        Damping(Damping),
        /// A torque known at some times, with a cubic spline in between.
        Sampled(Sampled),
        /// A torque that turns the body toward an attitude: `N = −K sign(w) vec(q_target⁻¹∘q) − D (ω − ω_target)`.
        Feedback(Feedback),
        /// The torque of a magnetic field: `N = (d − k Ḃ) × B`.
        Magnetic(Magnetic),
        /// A rotor that keeps its momentum in the body: `N = −ω × h`.
        Rotor(Rotor),
        /// A wheel with motor and friction: `ḣ = τ − c Ω − c₀ sign(Ω)`.
        Wheel(Wheel),
        /// A spherical damper: `N = k (σ − ω)`.
        Slug(Slug),
    }
);
