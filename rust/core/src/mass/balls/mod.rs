//! Unions of overlapping balls (clumps): what several balls cover counts once. In closed form.
//!
//! The union is cut along the power diagram of its spheres. A point belongs to the ball for which `|x − c|² − R²` is least;
//! where that is negative, the point is inside that ball. So the part of the union in the cell of a ball is the ball itself,
//! cut by the planes of the circles in which it meets its neighbours, and parts do not overlap:
//!
//! | step | file |
//! |---|---|
//! | the sum over the parts | `union` |
//! | which balls meet: a tree of boxes | `neighbours` |
//! | a ball cut by planes: volume, first and second moments | `cut_ball` |
//!
//! A ball inside another has an empty cell. Of equal balls the first counts. Where spheres touch, the plane cuts off nothing, and rounding there
//! changes the sums by no more than rounding.

mod cut_ball;
mod neighbours;
mod union;

pub use union::balls;
