//! Uncertainty: what is not known of a body's numbers, where it comes from, and what it makes of all that follows.
//!
//! Every doubt is a *source*: a draw of independent standard normal variables ([`Variable`]). A body carries what one standard
//! deviation of each variable does to its ten numbers, to first order ([`Doubt`]); two bodies that depend on one variable are
//! correlated by it, and stay so through every operation. Beside it go the second-order terms along a few probe directions:
//! they tell where the first order is not enough.
//!
//! | what | file |
//! |---|---|
//! | sources and their variables, the probes | [`variable`] |
//! | standard deviations and covariances as linear forms of variables | [`given`](mod@given) |
//! | what a body carries | [`doubt`] |
//! | how it follows through any function of bodies and numbers | [`follow`](mod@follow) |
//! | through the ways to a body and from body to body | [`changes`] |
//! | through the vertices of a mesh | [`mesh`] |
//! | through particles | [`particles`] |
//! | through the corners of a polygon | [`polygon`] |
//! | through sums, where parts are many | [`composites`] |
//! | which covariances no body can have | [`possible`] |
//! | terms of higher order of moments and axes | `higher` |
//! | moments, axes and radii of gyration after a step | `stepped` |
//! | terms of all that deviations are told of | `terms` |
//! | standard deviations of all that a body has, and where they are not to be trusted | [`deviations`](mod@deviations) |

pub mod changes;
pub mod composites;
pub mod deviations;
pub mod doubt;
pub mod follow;
pub mod given;
mod higher;
pub mod mesh;
pub mod particles;
pub mod polygon;
pub mod possible;
mod stepped;
mod terms;
pub mod variable;

pub use changes::{
    FromPositiveProducts, FromPrincipal, FromTensor, FromTensorAboutOrigin, OfShape, Rotated,
    Scaled, Shape, Translated,
};
pub use composites::together;
pub use deviations::{Deviations, deviations, deviations_about};
pub use doubt::{Doubt, Tangent};
pub use follow::{Change, Follow, follow};
pub use given::{Form, Given};
pub use mesh::of_mesh;
pub use particles::of_particles;
pub use polygon::OfPolygon;
pub use possible::check_possible;
pub use variable::{PROBES, Source, Variable};
