//! Bodies made of particles: `I = Σ m (r² 1 − r rᵀ)` (mln25).

use nalgebra::{Matrix3, Vector3};

use super::body::RigidBody;
use super::error_bound::ErrorBound;
use super::second_moment::SecondMoment;
use crate::error::{Error, finite};
use crate::numerics::double_double::{two_product, two_sum};
use crate::numerics::reduce::sum_terms;

/// Below this ratio of smallest to largest second moment a body is thin: its smallest moment would lose digits in one
/// pass, so the sums are taken again in its own axes.
const THIN: f64 = 0.05;

/// The body of the particles with these masses at these positions.
///
/// Three passes: the centre of mass, the second moment about it, and for a thin body the second moment again in the axes
/// that the first one found, which leaves the smallest principal moment as accurate as the coordinates are.
///
/// # Errors
/// When a mass is negative, the total is not positive, or a number is not finite.
///
/// # Panics
/// When the slices differ in length.
pub fn particles(masses: &[f64], positions: &[[f64; 3]]) -> Result<RigidBody, Error> {
    assert_eq!(masses.len(), positions.len(), "one position for each mass");
    check(masses, positions)?;
    // A massive particle lies within the body, so that nothing cancels wherever the body stands.
    let heaviest = (0..masses.len())
        .max_by(|&i, &j| masses[i].total_cmp(&masses[j]))
        .unwrap_or(0);
    let reference = Vector3::from(positions[heaviest]);
    let [mass, x, y, z] = sum_terms(masses.len(), |i| {
        let (m, d) = (masses[i], Vector3::from(positions[i]) - reference);
        [m, m * d.x, m * d.y, m * d.z]
    });
    let center = reference + Vector3::new(x, y, z) / mass;
    let first = central(masses, positions, &center, None);
    let body = RigidBody::from_second_moment(&first)?;
    let [i1, i2, i3] = body.principal().moments;
    // Second moments from the moments of inertia, ascending: s₁ = (I₁ + I₂ − I₃)/2 and s₃ = (I₂ + I₃ − I₁)/2.
    if i1 + i2 - i3 >= THIN * (i2 + i3 - i1) {
        return Ok(body);
    }
    RigidBody::from_second_moment(&central(
        masses,
        positions,
        &center,
        Some(body.principal().axes),
    ))
}

/// Second moment about the centre of mass in the given axes; `center` is C but for rounding.
fn central(
    masses: &[f64],
    positions: &[[f64; 3]],
    center: &Vector3<f64>,
    axes: Option<Matrix3<f64>>,
) -> SecondMoment {
    let [mass, x, y, z, xx, xy, xz, yy, yz, zz] = sum_terms(masses.len(), |i| {
        let y = match &axes {
            None => Vector3::from(positions[i]) - center,
            Some(axes) => turned(&positions[i], center, axes),
        };
        let m = masses[i];
        let my = m * y;
        [
            m,
            my.x,
            my.y,
            my.z,
            my.x * y.x,
            my.x * y.y,
            my.x * y.z,
            my.y * y.y,
            my.y * y.z,
            my.z * y.z,
        ]
    });
    let first = Vector3::new(x, y, z);
    let second = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let bound = ErrorBound::of_sums(masses.len(), mass, center, second.trace());
    let about = SecondMoment::about_reference(&Vector3::zeros(), mass, &first, &second, bound);
    match axes {
        None => SecondMoment {
            center_of_mass: center + about.center_of_mass,
            ..about
        },
        Some(axes) => SecondMoment {
            center_of_mass: center + axes * about.center_of_mass,
            axes,
            ..about
        },
    }
}

/// `axesᵀ (r − center)` with the rounding errors of difference and products carried along: across the thin direction
/// large terms cancel, and what is left must be that of the stored coordinates.
fn turned(r: &[f64; 3], center: &Vector3<f64>, axes: &Matrix3<f64>) -> Vector3<f64> {
    let d: [(f64, f64); 3] = std::array::from_fn(|j| two_sum(r[j], -center[j]));
    Vector3::from_fn(|k, _| {
        let [(p0, e0), (p1, e1), (p2, e2)]: [(f64, f64); 3] =
            std::array::from_fn(|j| two_product(d[j].0, axes[(j, k)]));
        let (partial, f0) = two_sum(p0, p1);
        let (sum, f1) = two_sum(partial, p2);
        let low = d[0].1 * axes[(0, k)] + d[1].1 * axes[(1, k)] + d[2].1 * axes[(2, k)];
        sum + (low + (e0 + e1 + e2) + (f0 + f1))
    })
}

fn check(masses: &[f64], positions: &[[f64; 3]]) -> Result<(), Error> {
    for (index, (&mass, position)) in masses.iter().zip(positions).enumerate() {
        finite("masses", mass)?;
        if mass < 0.0 {
            return Err(Error::NegativeMass { index, mass });
        }
        for &x in position {
            finite("positions", x)?;
        }
    }
    let [mass] = sum_terms(masses.len(), |i| [masses[i]]);
    if mass > 0.0 {
        Ok(())
    } else {
        Err(Error::NoMass {
            count: masses.len(),
            mass,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_atomic_molecule() {
        // mex255: three m₁ on a triangle of side a, m₂ at height h above it.
        let (m1, m2, a, h) = (1.0, 3.0, 2.0, 1.5);
        let r = a / 3.0_f64.sqrt();
        let at = |k: f64| {
            let angle = k * 2.0 * std::f64::consts::PI / 3.0;
            [r * angle.cos(), r * angle.sin(), 0.0]
        };
        let body = particles(
            &[m1, m1, m1, m2],
            &[at(0.0), at(1.0), at(2.0), [0.0, 0.0, h]],
        )
        .expect("molecule");
        let inertia = body.inertia();
        assert!((inertia[(2, 2)] - m1 * a * a).abs() < 1e-14);
        let transverse = 0.5 * m1 * a * a + 3.0 * m1 * m2 / (3.0 * m1 + m2) * h * h;
        assert!((inertia[(0, 0)] - transverse).abs() < 1e-14);
    }

    #[test]
    fn oblique_rod_of_particles_is_thin_without_noise() {
        let direction = [3.0, 4.0, 12.0];
        let positions: Vec<[f64; 3]> = (-5..=5)
            .map(|k| direction.map(|x| x * f64::from(k)))
            .collect();
        let body = particles(&[1.0; 11], &positions).expect("rod");
        let [i1, i2, i3] = body.principal().moments;
        assert!(i1 / i3 < 1e-30, "{i1:e}");
        assert!((i2 / (169.0 * 110.0) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn weightless_particles_do_not_count() {
        let body = particles(&[2.0, 0.0], &[[1.0, 0.0, 0.0], [1e300, 0.0, 0.0]]).expect("point");
        assert_eq!(body.principal().moments, [0.0; 3]);
        assert_eq!(body.center_of_mass(), Vector3::x());
    }
}
