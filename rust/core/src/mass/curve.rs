//! Thin wires: straight segments from point to point, with a mass per length.

use nalgebra::Vector3;

use super::body::RigidBody;
use super::error_bound::UNIT;
use super::polyhedron::widen;
use super::provenance::{BodySource, Checks, Provenance};
use super::simplex::{Corners, LocalFrame, Wire};
use super::solids::Amount;
use super::surface::{finish, thin};
use crate::error::{Error, all_finite};
use crate::numerics::power_of_two::exponent;
use crate::numerics::threads::Watch;

/// Points joined by straight segments.
struct Polyline<'a>(&'a [[f64; 3]]);

impl Corners<2> for Polyline<'_> {
    fn count(&self) -> usize {
        self.0.len().saturating_sub(1)
    }

    #[inline(always)]
    fn corners(&self, index: usize) -> [[f64; 3]; 2] {
        [self.0[index], self.0[index + 1]]
    }
}

/// A thin wire of uniform mass per length through the points: `∫ r rᵀ dm = λ L (a aᵀ + b bᵀ + s sᵀ)/6` for a segment
/// (a, b) of length L, `s = a + b`.
///
/// `amount` is the total mass or the mass per length λ. A closed wire ends at its first point. `watch` is asked about every
/// 20 ms whether to go on.
///
/// # Examples
///
/// ```
/// use polhode::mass::Amount;
/// use polhode::mass::curve::curve;
/// use std::ops::ControlFlow;
///
/// let points = [[0.0; 3], [6.0, 0.0, 0.0]];
/// let wire = curve(&points, Amount::Density(0.5), &mut |_| ControlFlow::Continue(()))?;
/// assert_eq!(wire.mass(), 3.0);
/// assert!((wire.principal().moments[2] - 9.0).abs() < 1e-14); // m l²/12
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When a coordinate is not finite, the wire has no length, or the amount is not positive; [`Error::Stopped`] where `watch`
/// said so.
pub fn curve(
    points: &[[f64; 3]],
    amount: Amount,
    watch: &mut Watch<'_>,
) -> Result<RigidBody, Error> {
    all_finite("points", points.as_flattened())?;
    let line = Polyline(points);
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for point in points {
        widen(&mut low, &mut high, point);
    }
    if low == high || points.is_empty() {
        return Err(Error::OutOfDomain {
            what: "length of the curve",
            law: "positive: points must be two or more, not all in one place",
            value: 0.0,
        });
    }
    let frame = LocalFrame::of_box(&Vector3::from(low), &Vector3::from(high));
    let (sums, moments) = thin::<_, Wire, 2>(&line, &frame, || frame, watch)?;
    // Each end of a segment is off by a unit of rounding of the extent, its length by four.
    let error =
        sums.roundings() * sums.content + 8.0 * UNIT * sums.extent.norm() * sums.count as f64;
    let checks = Checks::FINITE.and(Checks::VOLUME);
    let length = exponent(sums.frame.unit);
    let body = finish(&sums, length, 2.0 * error, amount)?;
    Ok(body.with_provenance(Provenance {
        moments,
        ..Provenance::of_matter(BodySource::Curve, sums.count, checks)
    }))
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;

    fn curve(points: &[[f64; 3]], amount: Amount) -> Result<RigidBody, Error> {
        super::curve(points, amount, &mut |_| ControlFlow::Continue(()))
    }

    #[test]
    fn straight_wire_is_a_rod() {
        let points: Vec<[f64; 3]> = [0.0, 0.25, 1.0, 3.0]
            .iter()
            .map(|t| [3.0 * t, 4.0 * t, 12.0 * t])
            .collect();
        let rod = curve(&points, Amount::Density(2.0)).expect("rod");
        let length = 39.0;
        assert!((rod.mass() - 2.0 * length).abs() < 1e-12);
        let [i1, i2, i3] = rod.principal().moments;
        assert!(i1 < 1e-28 * i3, "{i1:e}");
        assert!((i2 / (rod.mass() * length * length / 12.0) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn nothing_is_no_wire() {
        assert!(curve(&[], Amount::Mass(1.0)).is_err());
        assert!(curve(&[[1.0; 3]], Amount::Mass(1.0)).is_err());
        assert!(curve(&[[1.0; 3]; 4], Amount::Mass(1.0)).is_err());
        assert!(curve(&[[1.0; 3], [f64::NAN; 3]], Amount::Mass(1.0)).is_err());
    }
}
