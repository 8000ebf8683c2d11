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
//!
//! # Examples
//!
//! ```
//! use polhode::mass::{Amount, solids, ten::Ten};
//! use polhode::uncertainty::{
//!     Deviations, Doubt, Follow, FromPrincipal, Given, Source, Translated, deviations, deviations_about, follow, together,
//! };
//! use polhode::nalgebra::{Matrix3, Vector3};
//!
//! // A ball of 2 kg ± 10 g, whose moments were measured to 1 %.
//! let ball = solids::sphere(0.5, Amount::Mass(2.0))?;
//! let values = [2.0, 0.0, 0.0, 0.0, 0.2, 0.2, 0.2];
//! let sigmas = [0.01, 0.0, 0.0, 0.0, 0.002, 0.002, 0.002];
//! let given = Given::independent(&sigmas, Source::named("the bench"))?;
//! let numbers: Vec<_> = values.into_iter().zip(given.forms.iter().map(Vec::as_slice)).collect();
//! let doubt = follow(&FromPrincipal(Matrix3::identity()), Follow { bodies: &[], numbers: &numbers })?;
//! let own: Deviations = deviations(&ball, &doubt);
//! assert!((own.numbers[0] - 0.01).abs() < 1e-17);
//! assert!((own.numbers[4] - 0.002).abs() < 1e-17);
//!
//! // About a point 3 m away, I + m d²: the mass dominates.
//! let far = deviations_about(&ball, &doubt, &Vector3::new(3.0, 0.0, 0.0))?;
//! assert!((far.numbers[5] - 0.09_f64.hypot(0.002)).abs() < 1e-12);
//!
//! // Moved by 1 m ± 1 mm, and put together with itself: both parts depend on the same draws.
//! let step = Given::independent(&[0.001], Source::fresh())?;
//! let shift = [(1.0, step.forms[0].as_slice()), (0.0, &[]), (0.0, &[])];
//! let moved = follow(&Translated, Follow { bodies: &[(Ten::of(&ball), &doubt)], numbers: &shift })?;
//! let there = Ten::of(&ball).translated([1.0, 0.0, 0.0]);
//! let both: Doubt = together(&[(1.0, Ten::of(&ball), &doubt), (1.0, there, &moved)]);
//! assert!((both.covariance_with(&both)[(0, 0)].sqrt() - 0.02).abs() < 1e-15);
//! # Ok::<(), polhode::Error>(())
//! ```

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
