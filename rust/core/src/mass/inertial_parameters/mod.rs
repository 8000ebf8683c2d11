//! The ten numbers of a body, in numbers of any kind: so that what a body depends on can be followed through.
//!
//! | what | file |
//! |---|---|
//! | mass, centre and tensor, moved and put together | `numbers` |
//! | what a shape is made of when its lengths carry derivatives | `size` |
//!
//! # Examples
//!
//! ```
//! use polhode::mass::ten::{ELEMENTS, Size, Ten, place};
//! use polhode::mass::{Amount, solids};
//!
//! /// The volume of a cone, of lengths that may carry derivatives.
//! fn volume<X: Size>(radius: X, height: X) -> X {
//!     radius * radius * height * (std::f64::consts::PI / 3.0)
//! }
//! assert!((volume(1.0, 3.0) - std::f64::consts::PI).abs() < 1e-15);
//!
//! let ball = Ten::of(&solids::sphere(1.0, Amount::Mass(5.0))?);
//! let moved = ball.translated([3.0, 0.0, 0.0]);
//! assert_eq!(moved.center_vector().x, 3.0);
//! // About the origin m d² more, of which the elements are xx, yy, zz, xy, xz, yz.
//! assert_eq!(moved.about([0.0; 3])[place(1, 1)], 2.0 + 45.0);
//! assert_eq!(ELEMENTS[place(0, 2)], (0, 2));
//! // Two of them, 6 m apart, about their common centre.
//! let both = Ten::together([(1.0, &moved), (1.0, &ball.translated([-3.0, 0.0, 0.0]))].into_iter());
//! assert_eq!((both.mass, both.tensor()[(2, 2)]), (10.0, 2.0 * 47.0));
//! # Ok::<(), polhode::Error>(())
//! ```

mod numbers;
mod size;

pub use numbers::{ELEMENTS, Ten, place};
pub use size::Size;
pub(in crate::mass) use size::diagonal;
