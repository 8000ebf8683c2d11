//! Uncertainty: what is not known of a body's numbers, where it comes from, and what it makes of all that follows.
//!
//! Every uncertainty comes from a *source*: a draw of independent standard normal variables ([`Variable`]). A body carries what
//! one standard deviation of each variable does to its ten numbers, to first order ([`LinearUncertainty`]). Two bodies that
//! depend on one variable are correlated by it, and stay so through every operation. Beside it go the second-order terms along a few probe directions:
//! they tell where the first order is not enough.
//!
//! | what | file |
//! |---|---|
//! | sources and their variables, the probes | [`variable`] |
//! | standard deviations and covariances as linear forms of variables | [`linear_forms`](mod@linear_forms) |
//! | what a body carries | [`linear_uncertainty`] |
//! | how it propagates through any function of bodies and numbers | [`propagate`](mod@propagate) |
//! | through the ways to a body and from body to body; through the corners of a polygon | [`body_functions`] |
//! | through the vertices of a mesh | [`mesh`] |
//! | through sums, where parts are many; through particles | [`assemblies`] |
//! | which covariances no body can have | [`check_covariance`](mod@check_covariance) |
//! | standard deviations of all that a body has, and where they are not to be trusted | [`sigma`](mod@sigma) |
//!
//! # Examples
//!
//! ```
//! use polhode::mass::{Amount, solids, inertial_parameters::InertialParameters};
//! use polhode::uncertainty::{
//!     Sigma, LinearUncertainty, Inputs, FromPrincipal, LinearForms, Source, Translation, sigma, sigma_about, propagate, together,
//! };
//! use polhode::nalgebra::{Matrix3, Vector3};
//!
//! // A ball of 2 kg ± 10 g, whose moments were measured to 1 %.
//! let ball = solids::sphere(0.5, Amount::Mass(2.0))?;
//! let values = [2.0, 0.0, 0.0, 0.0, 0.2, 0.2, 0.2];
//! let sigmas = [0.01, 0.0, 0.0, 0.0, 0.002, 0.002, 0.002];
//! let given = LinearForms::independent(&sigmas, Source::named("the bench"))?;
//! let numbers: Vec<_> = values.into_iter().zip(given.forms.iter().map(Vec::as_slice)).collect();
//! let uncertainty = propagate(&FromPrincipal(Matrix3::identity()), Inputs { bodies: &[], numbers: &numbers })?;
//! let own: Sigma = sigma(&ball, &uncertainty);
//! assert!((own.numbers[0] - 0.01).abs() < 1e-17);
//! assert!((own.numbers[4] - 0.002).abs() < 1e-17);
//!
//! // About a point 3 m away, I + m d²: the mass dominates.
//! let far = sigma_about(&ball, &uncertainty, &Vector3::new(3.0, 0.0, 0.0))?;
//! assert!((far.numbers[5] - 0.09_f64.hypot(0.002)).abs() < 1e-12);
//!
//! // Moved by 1 m ± 1 mm, and put together with itself: both parts depend on the same draws.
//! let step = LinearForms::independent(&[0.001], Source::fresh())?;
//! let shift = [(1.0, step.forms[0].as_slice()), (0.0, &[]), (0.0, &[])];
//! let moved = propagate(&Translation, Inputs { bodies: &[(InertialParameters::of(&ball), &uncertainty)], numbers: &shift })?;
//! let there = InertialParameters::of(&ball).translated([1.0, 0.0, 0.0]);
//! let both: LinearUncertainty = together(&[(1.0, InertialParameters::of(&ball), &uncertainty), (1.0, there, &moved)]);
//! assert!((both.covariance_with(&both)[(0, 0)].sqrt() - 0.02).abs() < 1e-15);
//! # Ok::<(), polhode::Error>(())
//! ```

pub mod assemblies;
pub mod body_functions;
pub mod check_covariance;
pub mod linear_forms;
pub mod linear_uncertainty;
pub mod mesh;
pub mod propagate;
pub mod sigma;
pub mod variable;

pub use assemblies::{of_particles, together};
pub use body_functions::{
    FromPositiveProducts, FromPrincipal, FromTensor, FromTensorAboutOrigin, OfPolygon, OfShape,
    Rotation, Scaling, Shape, Translation,
};
pub use check_covariance::check_covariance;
pub use linear_forms::{Form, LinearForms};
pub use linear_uncertainty::{LinearUncertainty, Tangent};
pub use mesh::of_mesh;
pub use propagate::{BodyFunction, Inputs, propagate};
pub use sigma::{Sigma, sigma, sigma_about};
pub use variable::{PROBES, Source, Variable};
