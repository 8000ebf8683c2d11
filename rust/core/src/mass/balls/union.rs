//! The body of a union of balls: the sum over the parts of the balls in their cells.

use std::convert::Infallible;

use nalgebra::Vector3;

use super::cut_ball::{Cutter, Moments};
use super::neighbours::{Ball, Neighbours};
use crate::error::{BodyFault, Error, all_finite};
use crate::mass::amount::Amount;
use crate::mass::body::RigidBody;
use crate::mass::integrator::{Matter, integrate_sums};
use crate::mass::provenance::{BodySource, Checks, Provenance};
use crate::mass::simplex::{ELEMENT, LocalFrame, Sums};
use crate::mass::surface::finish;
use crate::numerics::power_of_two::exponent;
use crate::numerics::threads::{Watch, fill_blocks};

/// Balls whose cells a thread computes at a time.
const SHARE: usize = 64;

/// The body that balls of these centers and radii cover, of uniform density: where balls overlap, the matter counts once.
///
/// `amount` is the total mass or the mass per volume. `watch` is asked about every 20 ms whether to go on.
///
/// # Examples
///
/// ```
/// use polhode::mass::Amount;
/// use polhode::mass::balls::balls;
/// use std::ops::ControlFlow;
///
/// let go_on = &mut |_| ControlFlow::Continue(());
/// let centers = [[0.0; 3], [1.0, 0.0, 0.0]];
/// let clump = balls(&centers, &[1.0, 1.0], Amount::Density(1.0), go_on)?;
/// // Two unit balls at the distance d have 8π/3 − π (2 − d)² (d + 4)/12.
/// let volume = std::f64::consts::PI * (8.0 / 3.0 - 5.0 / 12.0);
/// assert!((clump.mass() - volume).abs() < 1e-14);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When there are no balls, a number is not finite, a radius or the amount is not positive; [`Error::Stopped`] where `watch` said so.
///
/// # Panics
/// When there are not as many radii as centers.
pub fn balls(
    centers: &[[f64; 3]],
    radii: &[f64],
    amount: Amount,
    watch: &mut Watch<'_>,
) -> Result<RigidBody, Error> {
    assert_eq!(centers.len(), radii.len(), "one radius for each center");
    amount.check()?;
    if centers.is_empty() {
        return Err(Error::Empty { what: "centers" });
    }
    all_finite("centers", centers.as_flattened())?;
    let is_radius = |radius: f64| radius > 0.0 && radius.is_finite();
    if let Some(index) = radii.iter().position(|&radius| !is_radius(radius)) {
        let radius = radii[index];
        return Err(BodyFault::NotARadius { index, radius }.into());
    }
    let mut low = Vector3::repeat(f64::INFINITY);
    let mut high = Vector3::repeat(f64::NEG_INFINITY);
    for (center, &radius) in centers.iter().zip(radii) {
        let center = Vector3::from(*center);
        low = low.inf(&center.add_scalar(-radius));
        high = high.sup(&center.add_scalar(radius));
    }
    let frame = LocalFrame::of_box(&low, &high);
    let union = Union::of(centers, radii, frame.unit, watch)?;
    let first = union.moments(&frame, watch)?;
    let (sums, moments) = integrate_sums(&union, &first, 3, watch)?;
    let error = sums.scale.x + sums.roundings() * sums.content;
    let body = finish(&sums, 3 * exponent(frame.unit), 2.0 * error, amount)?;
    let checks = Checks::FINITE.and(Checks::VOLUME);
    Ok(body.with_provenance(Provenance {
        moments,
        ..Provenance::of_matter(BodySource::Balls, centers.len(), checks)
    }))
}

/// The parts of the balls in their cells.
struct Union {
    balls: Vec<Ball>,
    /// Each about the center of its ball, lengths in the unit of the body.
    parts: Vec<Moments>,
}

impl Union {
    fn of(
        centers: &[[f64; 3]],
        radii: &[f64],
        unit: f64,
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        let balls = centers.iter().zip(radii);
        let balls = balls.map(|(&center, &radius)| Ball { center, radius });
        let neighbours = Neighbours::of(balls.collect(), unit);
        let mut parts = vec![Moments::default(); centers.len()];
        fill_blocks(&mut parts, SHARE, watch, |first, share| {
            let (mut cutter, mut planes) = (Cutter::default(), Vec::new());
            for (ball, part) in (first..).zip(share) {
                // A ball that another covers has no part.
                if neighbours.planes(ball, &mut planes) {
                    let radius = neighbours.balls[ball].radius / unit;
                    *part = cutter.moments(&planes).of_radius(radius);
                }
            }
            Ok::<(), Infallible>(())
        })?;
        Ok(Self {
            balls: neighbours.balls,
            parts,
        })
    }
}

impl Matter for Union {
    type Moments = Sums;

    fn moments(&self, frame: &LocalFrame, watch: &mut Watch<'_>) -> Result<Sums, Error> {
        let axes = frame.rotation();
        let of_ball = |ball: usize| {
            let part = &self.parts[ball];
            if part.volume == 0.0 {
                return [0.0; ELEMENT];
            }
            let (c, v) = (frame.place(&self.balls[ball].center), part.volume);
            let (own, second) = match &frame.axes {
                None => (part.first, part.second),
                Some(_) => (
                    axes.tr_mul(&part.first),
                    axes.transpose() * part.second * axes,
                ),
            };
            let first = c * v + own;
            let at = |i: usize, j: usize| {
                second[(i, j)] + c[i] * own[j] + own[i] * c[j] + v * c[i] * c[j]
            };
            [
                v,
                first.x,
                first.y,
                first.z,
                at(0, 0),
                at(0, 1),
                at(0, 2),
                at(1, 1),
                at(1, 2),
                at(2, 2),
                part.error,
            ]
        };
        let mut extent = Vector3::zeros();
        for (ball, part) in self.balls.iter().zip(&self.parts) {
            let reach = frame.place(&ball.center).abs().add_scalar(part.radius);
            extent = extent.sup(&reach);
        }
        Sums::of_elements(self.parts.len(), frame, extent, watch, of_ball)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;
    use std::ops::ControlFlow;

    use super::*;

    fn union(balls: &[([f64; 3], f64)]) -> RigidBody {
        let (centers, radii): (Vec<_>, Vec<_>) = balls.iter().copied().unzip();
        let go_on = &mut |_| ControlFlow::Continue(());
        super::balls(&centers, &radii, Amount::Density(1.0), go_on).expect("a body")
    }

    #[test]
    fn two_unit_balls() {
        let body = union(&[([0.0; 3], 1.0), ([0.5, 0.0, 0.0], 1.0)]);
        let volume = PI * (8.0 / 3.0 - 1.5_f64.powi(2) * 4.5 / 12.0);
        assert!(
            (body.mass() - volume).abs() < 1e-14,
            "{}",
            body.mass() - volume
        );
        assert!((body.center_of_mass() - Vector3::new(0.25, 0.0, 0.0)).norm() < 1e-15);
    }

    /// Balls that are covered, that touch or that stand twice change nothing.
    #[test]
    fn covered_balls_count_for_nothing() {
        let ball = ([1.0, 2.0, 3.0], 2.0);
        for other in [
            ([1.0, 2.0, 3.0], 2.0),
            ([1.0, 2.0, 3.0], 1.0),
            ([2.0, 2.0, 3.0], 1.0),
            ([1.5, 2.0, 3.0], 0.1),
        ] {
            for balls in [[ball, other], [other, ball]] {
                let body = union(&balls);
                assert!((body.mass() - 32.0 * PI / 3.0).abs() < 1e-14 * 33.0);
                let moment = 0.4 * body.mass() * 4.0;
                for of_axis in body.principal().moments {
                    assert!((of_axis / moment - 1.0).abs() < 1e-14);
                }
            }
        }
        let touching = union(&[([0.0; 3], 1.0), ([3.0, 0.0, 0.0], 2.0)]);
        assert!((touching.mass() - 12.0 * PI).abs() < 1e-13);
    }

    /// Four balls at the corners of a square have planes that meet in one line, and circles that meet on it.
    #[test]
    fn planes_in_one_line() {
        let square = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
        let radius = 1.75;
        let balls = square.map(|[x, y]| ([x, y, 0.0], radius));
        let body = union(&balls);
        // By slices: four disks of radius r, of which quarters beyond the axes are covered.
        let slice = |z: f64| {
            let square = radius * radius - z * z;
            let r = square.sqrt();
            if r <= 1.0 {
                return 4.0 * PI * square;
            }
            if square <= 2.0 {
                let segment = square * (1.0 / r).acos() - (square - 1.0).sqrt();
                return 4.0 * (PI * square - 2.0 * segment);
            }
            // The quadrant of the plane, and the part of a disk beyond its axes.
            let beyond = square * (1.0 / r).acos() - (square - 1.0).sqrt();
            let lens_corner = {
                let a = (square - 1.0).sqrt() - 1.0;
                let half = (0.5 * a * std::f64::consts::SQRT_2 / r).asin();
                0.5 * a * a + square * half
                    - 0.5 * a * std::f64::consts::SQRT_2 * (square - 0.5 * a * a).sqrt()
            };
            4.0 * (PI * square - 2.0 * beyond + lens_corner)
        };
        let kinks = [
            0.0,
            (radius * radius - 2.0).sqrt(),
            (radius * radius - 1.0).sqrt(),
            radius,
        ];
        let mut volume = 0.0;
        for ends in kinks.windows(2) {
            // Of z = a + (b − a) sin² φ the integrand has no roots at the ends.
            let n = 4000;
            for k in 0..n {
                let phi = (f64::from(k) + 0.5) / f64::from(n) * PI * 0.5;
                let (sine, cosine) = phi.sin_cos();
                let z = ends[0] + (ends[1] - ends[0]) * sine * sine;
                volume += 2.0 * slice(z) * (ends[1] - ends[0]) * 2.0 * sine * cosine * PI * 0.5
                    / f64::from(n);
            }
        }
        assert!(
            (body.mass() / volume - 1.0).abs() < 1e-6,
            "{} {volume}",
            body.mass()
        );
        assert!(body.center_of_mass().norm() < 1e-15);
    }
}
