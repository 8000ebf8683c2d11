//! Which tensors belong to bodies: the nearest one that does, and whether a body of a given size can have it.

use nalgebra::{Matrix3, Vector3};

use super::body::RigidBody;
use super::forms::second_moment;
use super::validity::{ASYMMETRY, ROUNDING, check_moments, check_symmetry, mean_of_halves};
use crate::error::{Error, all_finite};
use crate::numerics::power_of_two::length;
use crate::principal::principal_axes;

/// The tensor of a body that is nearest to this one, and how far it is, both in the Frobenius norm.
///
/// The nearest tensor has the same principal axes; its moments are the nearest point of the cone `I₁ + I₂ ≥ I₃, …` to the
/// moments of the one given. A tensor that [`RigidBody::new`] accepts comes back as it is, at distance zero; one with an
/// element that is not finite gives NaN.
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
    let scale = principal.moments.iter().map(|x| x.abs()).sum::<f64>();
    if check_moments(&principal.moments, ROUNDING * scale, ROUNDING, false).is_ok() {
        return Ok((inertia, 0.0));
    }
    let nearest = nearest_moments(&principal.moments);
    let axes = principal.axes;
    let tensor = axes * Matrix3::from_diagonal(&Vector3::from(nearest)) * axes.transpose();
    let distance = Vector3::from(nearest) - Vector3::from(principal.moments);
    Ok((mean_of_halves(&tensor), length(&distance)))
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
