//! The nearest tensor that a body can have, and whether a body within a given box can have one.
//!
//! Whether a tensor is that of a body at all is decided in `validity`.

use nalgebra::{Matrix3, Vector3};

use super::body::RigidBody;
use super::forms::second_moment;
use super::validity::{ASYMMETRY, ROUNDING, check_moments, check_symmetry, mean_of_halves};
use crate::error::{Error, all_finite};
use crate::numerics::power_of_two::length;
use crate::principal::principal_axes;

/// How far inside the triangle inequality a tensor that is not diagonal has to be, beside its trace, for every program to
/// find it possible: moments that are computed in float64 are off by some units of rounding of the largest.
const EDGE: f64 = 4.0 * f64::EPSILON;

/// The tensor of a body that is nearest to this one, and how far it is, both in the Frobenius norm.
///
/// The nearest tensor has the same principal axes; its moments are the nearest point of the cone `I₁ + I₂ ≥ I₃, …` to the
/// moments of the one given. On the edge of the cone the rounding of its elements would decide whether the moments that a
/// program computes from them obey the law. So the same small part of the trace, 8 ε, is added to all three moments there,
/// which leaves the axes as they are. A tensor whose moments obey the law whoever computes them comes back as it is, at
/// distance zero; one with an element that is not finite gives NaN.
///
/// # Examples
///
/// ```
/// use polhode::nalgebra::Matrix3;
/// use polhode::nalgebra::Vector3;
/// use polhode::mass::realizable::nearest_valid;
///
/// // The third moment exceeds the sum of the others by 1: each gives way by a third of it.
/// let (nearest, _) = nearest_valid(&Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 3.0)))?;
/// assert!((nearest[(2, 2)] - nearest[(0, 0)] - nearest[(1, 1)]).abs() < 1e-14);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When the tensor is not symmetric.
pub fn nearest_valid(inertia: &Matrix3<f64>) -> Result<(Matrix3<f64>, f64), Error> {
    check_symmetry("inertia", inertia, ASYMMETRY)?;
    if inertia.iter().any(|x| !x.is_finite()) {
        return Ok((Matrix3::repeat(f64::NAN), f64::NAN));
    }
    let inertia = mean_of_halves(inertia);
    let principal = principal_axes(&inertia);
    let moments = Vector3::from(principal.moments);
    let scale = moments.abs().sum();
    let is_rounding = check_moments(&principal.moments, ROUNDING * scale, ROUNDING, false).is_ok();
    let (on_cone, change) = if is_rounding {
        (inertia, Vector3::zeros())
    } else {
        let nearest = Vector3::from(nearest_moments(&principal.moments));
        let axes = principal.axes;
        let tensor = axes * Matrix3::from_diagonal(&nearest) * axes.transpose();
        (mean_of_halves(&tensor), nearest - moments)
    };
    let nudge = nudge(&on_cone);
    let tensor = on_cone + Matrix3::from_diagonal_element(nudge);
    Ok((tensor, length(&change.add_scalar(nudge))))
}

/// What all three moments of this tensor lack to be inside the cone by twice [`EDGE`]; zero where they are by once that, or
/// where the tensor is diagonal, so that its moments are what they are.
fn nudge(inertia: &Matrix3<f64>) -> f64 {
    let [i1, i2, i3] = principal_axes(inertia).moments;
    let scale = i1.abs() + i2 + i3;
    let is_diagonal = [(0, 1), (0, 2), (1, 2)]
        .iter()
        .all(|&at| inertia[at] == 0.0);
    let inside = i1 - (i3 - i2);
    if (is_diagonal && i1 + i2 >= i3) || inside >= EDGE * scale {
        0.0
    } else {
        2.0 * EDGE * scale - inside
    }
}

/// The nearest point of the cone of possible moments, whose edges are (0, 1, 1), (1, 0, 1) and (1, 1, 0), to ascending
/// moments outside of it.
fn nearest_moments(&[x, y, z]: &[f64; 3]) -> [f64; 3] {
    // Ascending moments are nearest to the face I₁ + I₂ = I₃, or to its edge (0, 1, 1), or to the apex.
    let excess = (z - y - x) / 3.0;
    if excess > 0.0 && x + excess >= 0.0 {
        let (first, second) = (x + excess, y + excess);
        return [first, second, first + second];
    }
    let mean = (0.5 * y + 0.5 * z).max(0.0);
    [0.0, mean, mean]
}

/// What a box says of the second moments of a body inside: which condition leaves least room, and how much.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
/// use polhode::mass::realizable::{BoxVerdict, within_box};
/// use polhode::nalgebra::Vector3;
///
/// // A rod of 2 m along z does not fit into a box that is 1 m high: the spread along z is too wide.
/// let rod = solids::cuboid(&[0.0, 0.0, 2.0], Amount::Mass(1.0))?;
/// let BoxVerdict { margin, axes } = within_box(&rod, &Vector3::repeat(-0.5), &Vector3::repeat(0.5))?;
/// assert_eq!(axes, [2, 2]);
/// assert!((margin - (0.25 - 1.0 / 3.0)).abs() < 1e-12); // l²/12 = 1/3 where (h/2)² = 1/4 has room
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoxVerdict {
    /// The room left by the tightest condition, relative to what the size of the box allows; negative when it is broken.
    pub margin: f64,
    /// The two axes of the tightest condition: the same twice for a spread along one, 0 for x, 1 for y, 2 for z.
    pub axes: [usize; 2],
}

/// Whether matter within the box from `low` to `high` (in the body frame) can have the body's mass, centre and tensor.
///
/// The conditions are those that products of distances from the walls have a mean that is not negative: along one axis
/// `∫ (x − a)(b − x) dm ≥ 0`, which limits the spread, `S_xx ≤ m (C_x − a)(b − C_x)` (Bhatia and Davis); for two axes
/// `∫ (x − a)(y − c) dm ≥ 0` and its three mirror images, which limit the products of inertia near the walls. They decide
/// exactly for every axis and every pair of axes; what all three axes together forbid beyond that is not tested.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
/// use polhode::nalgebra::Vector3;
/// use polhode::mass::realizable::within_box;
///
/// let ball = solids::sphere(1.0, Amount::Mass(1.0))?;
/// let within = |half: f64| within_box(&ball, &Vector3::repeat(-half), &Vector3::repeat(half));
/// assert!(within(1.0)?.margin > 0.0);
/// assert!(within(0.4)?.margin < 0.0); // two points at ±√(1/5) of each axis are the least
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When a corner is not finite or `low` is not below `high`; a flat box is allowed.
pub fn within_box(
    body: &RigidBody,
    low: &Vector3<f64>,
    high: &Vector3<f64>,
) -> Result<BoxVerdict, Error> {
    all_finite("low", low)?;
    all_finite("high", high)?;
    for axis in 0..3 {
        let (a, b) = (low[axis], high[axis]);
        if a > b {
            let (smaller, larger) = ("low", "high");
            return Err(Error::OutOfOrder {
                smaller,
                a,
                larger,
                b,
            });
        }
    }
    let c = body.center_of_mass();
    let s = second_moment(&body.inertia()) / body.mass();
    let (below, above) = (c - low, high - c);
    let size = high - low;
    let mut tightest = BoxVerdict {
        margin: f64::INFINITY,
        axes: [0, 0],
    };
    let mut condition = |room: f64, i: usize, j: usize| {
        let whole = size[i] * size[j];
        // What rounding can have made of an equation, as it holds for matter in the corners or in a flat box.
        let is_rounding = room < 0.0 && room >= -ROUNDING * (s.trace() + whole);
        let room = if is_rounding { 0.0 } else { room };
        let margin = match whole {
            _ if room == 0.0 => 0.0,
            0.0 => f64::INFINITY.copysign(room),
            whole => room / whole,
        };
        if margin < tightest.margin {
            let axes = [i, j];
            tightest = BoxVerdict { margin, axes };
        }
    };
    for i in 0..3 {
        // Outside, both factors' signs could cancel: the centre itself must lie within.
        condition(below[i].min(above[i]) * size[i], i, i);
        condition(below[i] * above[i] - s[(i, i)], i, i);
        for j in i + 1..3 {
            let product = s[(i, j)];
            condition(below[i] * below[j] + product, i, j);
            condition(above[i] * above[j] + product, i, j);
            condition(below[i] * above[j] - product, i, j);
            condition(above[i] * below[j] - product, i, j);
        }
    }
    Ok(tightest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass::{Amount, solids};

    #[test]
    fn nearest_tensor_is_on_the_cone() {
        let nearest = |x: f64, y: f64, z: f64| {
            let tensor = Matrix3::from_diagonal(&Vector3::new(x, y, z));
            let (nearest, distance) = nearest_valid(&tensor).expect("symmetric");
            (nearest.diagonal(), distance)
        };
        let (moments, distance) = nearest(1.0, 1.0, 5.0);
        assert_eq!(moments, Vector3::new(2.0, 2.0, 4.0));
        assert!((distance - 3.0_f64.sqrt()).abs() < 1e-15);
        assert_eq!(nearest(-5.0, 1.0, 3.0).0, Vector3::new(0.0, 2.0, 2.0));
        assert_eq!(nearest(-3.0, -2.0, -1.0).0, Vector3::zeros());
        assert_eq!(nearest(1.0, 2.0, 3.0), (Vector3::new(1.0, 2.0, 3.0), 0.0));
    }

    #[test]
    fn a_turned_tensor_on_the_edge_is_nudged_by_a_part_of_itself() {
        let turn = nalgebra::Rotation3::from_euler_angles(0.3, -1.0, 2.0).into_inner();
        for scale in [1e-300, 1e-47, 1.0, 1e37, 1e300] {
            let with = |thickness: f64| {
                let moments = Vector3::new(1.0 + thickness, 2.0 + thickness, 3.0) * scale;
                mean_of_halves(&(turn * Matrix3::from_diagonal(&moments) * turn.transpose()))
            };
            // 2 EDGE tr(I) = 48 ε where 3 is the largest moment; half of it is enough, to rounding.
            let (nudged, distance) = nearest_valid(&with(0.0)).expect("symmetric");
            let part = distance / (scale * f64::EPSILON * 3.0_f64.sqrt());
            assert!((30.0..66.0).contains(&part), "{part}");
            let [i1, i2, i3] = principal_axes(&nudged).moments;
            assert!(i1 + i2 - i3 > EDGE * (i1 + i2 + i3));
            assert_eq!(nearest_valid(&nudged), Ok((nudged, 0.0)));
            let is_nudged =
                |thickness: f64| nearest_valid(&with(thickness)).expect("symmetric").1 > 0.0;
            assert!(is_nudged(8.0 * f64::EPSILON) && !is_nudged(18.0 * f64::EPSILON));
        }
    }

    #[test]
    fn box_itself_fits_its_box_and_no_smaller_one_than_its_corners_allow() {
        let body = solids::cuboid(&[1.0, 2.0, 3.0], Amount::Mass(2.0)).expect("box");
        let half = Vector3::new(0.5, 1.0, 1.5);
        // Spread 1/12 of the square of the size, where 1/4 is allowed.
        let whole = within_box(&body, &-half, &half).expect("box");
        assert!((whole.margin - (0.25 - 1.0 / 12.0)).abs() < 1e-15);
        // All matter in the corners of a box smaller by √3 has the same spread.
        let corners = half / 3.0_f64.sqrt();
        assert!(
            within_box(&body, &(-corners * 1.000_001), &(corners * 1.000_001))
                .expect("box")
                .margin
                >= 0.0
        );
        assert!(
            within_box(&body, &(-corners * 0.999), &(corners * 0.999))
                .expect("box")
                .margin
                < 0.0
        );
        let aside = Vector3::new(2.0, 0.0, 0.0);
        assert!(
            within_box(&body, &(aside - half), &(aside + half))
                .expect("box")
                .margin
                < 0.0
        );
    }
}
