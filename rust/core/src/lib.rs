//! Rigid-body dynamics: from a mass distribution to its inertia tensor, to its principal axes, to its motion.
//!
//! A *polhode* is the curve that the tip of ω draws in a body that turns freely. To know it, one needs the body's inertia
//! tensor; to know that, its matter. This crate goes the way from one end to the other, and checks each step of it:
//! only bodies that can exist are values of type [`RigidBody`].
//!
//! # A first body
//!
//! A brick of 12 kg, by its edges. Solids stand with their centre of mass at the origin; what they come to is
//! mass, centre and tensor, with the principal axes at hand:
//!
//! ```
//! use polhode::mass::{Amount, solids};
//! use polhode::nalgebra::Vector3;
//!
//! let brick = solids::cuboid(&[8.0, 4.0, 2.0], Amount::Mass(12.0))?;
//! assert_eq!(brick.principal().moments, [20.0, 68.0, 80.0]); // m (b² + c²)/12 and so on, ascending
//!
//! // About a point P, it is I_C + m (d² 1 − d dᵀ).
//! let corner = Vector3::new(4.0, 2.0, 1.0);
//! assert_eq!(brick.inertia_about(&corner)[(0, 0)], 20.0 + 12.0 * (2.0 * 2.0 + 1.0 * 1.0));
//!
//! // What no matter can be is refused: here the third moment exceeds the sum of the others.
//! use polhode::{RigidBody, nalgebra::Matrix3};
//! let tensor = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 3.0));
//! let refused = RigidBody::new(1.0, &tensor, &Vector3::zeros(), 0.0).unwrap_err();
//! assert!(refused.to_string().contains("triangle inequality"));
//! # Ok::<(), polhode::Error>(())
//! ```
//!
//! Bodies also come from particles, closed meshes, voxels, tetrahedra, densities, files, and from other bodies: see [`mass`] and
//! [`io`].
//!
//! # A first motion
//!
//! A free body turns as Euler found, and its state at any time costs the same: theta functions, not steps. About its middle axis
//! the brick flips over:
//!
//! ```
//! use polhode::mass::{Amount, solids};
//! use polhode::motion::free::{FreeMotion, Mode};
//! use polhode::nalgebra::{UnitQuaternion, Vector3};
//!
//! let brick = solids::cuboid(&[8.0, 4.0, 2.0], Amount::Mass(12.0))?;
//! let omega = Vector3::new(1e-3, 1.0, 0.0);
//! let motion = FreeMotion::of(&brick, &omega, &UnitQuaternion::identity())?;
//! assert_eq!(motion.mode, Mode::LongAxis);
//!
//! let flip = motion.periods().flip;
//! assert!((motion.at(flip).omega.y + 1.0).abs() < 1e-6); // the other way round
//! assert!((motion.at(2e6 * flip).omega.y - 1.0).abs() < 1e-5); // and back, a million times later
//! # Ok::<(), polhode::Error>(())
//! ```
//!
//! Where something acts on the body, [`motion::simulate`](fn@motion::simulate::simulate) follows it through the times asked for: the load is a sum of
//! [terms](motion::loads::Term), a [closure](motion::loads::Callback), or a sum of both. In the folder
//! of the crate, `cargo run --example NAME` runs `t_handle`, `tennis_racket`, `stl`, `heavy_top`, `satellite`, `closure`, `events` or
//! `refusals`.
//!
//! # The modules, in the order in which one needs them
//!
//! | the page says | module |
//! |---|---|
//! | `I = ∫ (r² 1 − r rᵀ) dm`, `I_P = I_C + m (d² 1 − d dᵀ)` | [`mass`], with solids in [`mass::solids`] |
//! | triangles from files | [`io`], then [`mass::polyhedron`] |
//! | `I = V diag(I₁, I₂, I₃) Vᵀ`: axes, and what kind of top it is | [`principal`] |
//! | `T = ½ ω·I ω`, `L = I ω`, `I ω̇ + ω × I ω = N` at one instant | [`motion::kinetic_energy`], [`motion::angular_momentum`], [`motion::euler_equations`] |
//! | `ω = φ̇ − (1 − cos φ)/φ² φ×φ̇ + …` along a record, and back | [`motion::rates`] |
//! | motions in closed form | [`motion::free`], [`motion::gyrostat`], [`motion::heavy_top`] |
//! | rolling on a plane | [`motion::rolling`] |
//! | motions under loads | [`motion::loads`], [`motion::simulate`](mod@motion::simulate) |
//! | `Σ = S Sᵀ`: what is not known of a body, and what it makes of all that follows | [`uncertainty`] |
//! | numbers drawn for the members of an ensemble | [`random`] |
//! | threads, lanes, progress | [`parallel`] |
//! | what can be wrong, as plain data | [`error`] |
//!
//! Motion is built on mass, mass on principal axes; nothing points back up. The page of a module maps its formulas to its files.
//!
//! # Units, frames, letters
//!
//! Units are any coherent set; angles are radians. Vectors, matrices and quaternions are those of [`nalgebra`], which this crate hands on.
//!
//! | symbol | meaning |
//! |---|---|
//! | N, B, P | inertial frame, body frame, principal axes (as a frame) or any point of the body (as a point) |
//! | C, O | centre of mass, origin of the body frame |
//! | `I_P` | inertia tensor about the point P, components in B; `I_ij = ∫ (r² δ_ij − r_i r_j) dm` |
//! | V | principal axes as columns, `v_B = V v_P` |
//! | `R_NB`, `q_NB` | attitude, active: `v_N = R_NB v_B`; quaternions are (x, y, z, w) |
//! | ω | angular velocity of B relative to N, components in B |
//!
//! # Errors
//!
//! [`Error`] says what law was broken, by what number, and the way out; its faults are enums with these numbers as fields
//! ([`error::BodyFault`], [`error::MeshFault`], [`error::MotionFault`] and others), and [`Error::kind`] sorts them. All implement
//! [`std::error::Error`]. Numbers that are not finite are refused where they come in. What is a mistake of the program, as slices
//! of different lengths, panics, and a function that may says so under *Panics*.
//!
//! # Features
//!
//! - **`serde`** (off by default): bodies, states, tolerances, meshes and loads that are plain numbers can be stored and read
//!   again, and so can the types of nalgebra. Reading goes by the checks of the constructors: a file cannot bring a body that
//!   cannot be. A body that is typed by hand needs no more than `mass`, `center_of_mass` and `inertia` (three rows). A
//!   free motion is stored as its body and its [`initial`](motion::free::FreeMotion::initial) state. To read the same bits from JSON, turn on
//!   `float_roundtrip` of `serde_json`; states that were not computed (NaN) are written as `null` and not read again.
//!
//! ```
//! # #[cfg(feature = "serde")] {
//! use polhode::mass::{Amount, RigidBody, solids};
//!
//! let brick = solids::cuboid(&[3.0, 2.0, 1.0], Amount::Mass(12.0))?; // moments 5, 10 and 13
//! let text = serde_json::to_string(&brick).expect("a body is written");
//! assert_eq!(serde_json::from_str::<RigidBody>(&text).expect("and read"), brick);
//!
//! let typed = r#"{"mass": 12, "center_of_mass": [0, 0, 0], "inertia": [[5, 0, 0], [0, 10, 0], [0, 0, 16]]}"#;
//! let error = serde_json::from_str::<RigidBody>(typed).expect_err("16 > 5 + 10");
//! assert!(error.to_string().contains("triangle inequality"));
//! # }
//! # Ok::<(), polhode::Error>(())
//! ```
//!
//! # Threads
//!
//! Functions over stacks share work that takes longer than a millisecond among threads, and give the same bits for any number of
//! them: [`parallel::set_thread_limit`]. Those that may run long take a `watch`, which hears of the progress and may end them. There is no pool and
//! no thread left behind. Instruction sets are chosen as the program runs: build for any processor, with the settings you have; the kernels need no
//! flags of the compiler, and whole-program optimization gains little (`benchmarks/crate.py` in the repository measures it).
//!
//! # Versions
//!
//! The least Rust is 1.89; it rises in minor versions alone. Versions follow Semantic Versioning and are those of the Python package: until 1.0 a
//! minor one may break what the changelog says under *Changed*. Bits of results and words of messages may change in any
//! version; what is hidden from this documentation is no part of the interface.

// Symbols must match the page they come from.
#![allow(non_snake_case)]

pub mod error;
#[doc(hidden)]
pub mod inside;
pub mod io;
pub mod mass;
pub mod motion;
mod numerics;
pub mod parallel;
pub mod principal;
pub mod random;
#[cfg(feature = "serde")]
mod stored;
pub mod uncertainty;

/// Vectors, matrices and quaternions of this crate's interface: its `nalgebra` is the one that fits.
pub use nalgebra;

pub use error::Error;
pub use mass::RigidBody;
pub use numerics::double_double::DoubleDouble;
pub use principal::PrincipalAxes;

/// The examples of the readme, which run with the tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
