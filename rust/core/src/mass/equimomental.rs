//! Equimomental systems (mex143): few particles with the mass, the centre of mass and the inertia tensor of a body, which
//! therefore move as it does.

use nalgebra::Vector3;

use super::body::RigidBody;
use super::validity::{ROUNDING, check_mass};
use crate::error::{BodyFault, Error, all_finite, all_finite_of_body, finite, finite_of_body};
use crate::numerics::power_of_two::{exponent, root_of_ratio, times_power_of_two};

/// Particles: masses and where they are.
#[derive(Clone, Debug, PartialEq)]
pub struct Particles {
    /// Their masses.
    pub masses: Vec<f64>,
    /// Their positions, from the origin of B, components in B.
    pub positions: Vec<[f64; 3]>,
}

/// The corners of a regular simplex of r dimensions, `Σ u = 0` and `Σ u_i u_j = (r + 1) δ_ij`: two, three or four points.
const SEGMENT: [[f64; 3]; 2] = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]];
const TRIANGLE: [[f64; 3]; 3] = [
    [0.0, std::f64::consts::SQRT_2, 0.0],
    [SQRT_3_2, -std::f64::consts::FRAC_1_SQRT_2, 0.0],
    [-SQRT_3_2, -std::f64::consts::FRAC_1_SQRT_2, 0.0],
];
const TETRAHEDRON: [[f64; 3]; 4] = [
    [1.0, 1.0, 1.0],
    [1.0, -1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
];
/// √(3/2).
const SQRT_3_2: f64 = 1.224_744_871_391_589;

/// The smallest set of equal positive masses with the mass, the centre of mass and the inertia tensor of `body`.
///
/// Their number is the rank of the second moment `S = ∫ (r − c)(r − c)ᵀ dm` plus one: four for a solid, three for a lamina,
/// two for a rod, one for a point. They stand at `C + V diag(√(s_k/m)) u` with the principal axes V, the principal values
/// `s_k = (I_i + I_j − I_k)/2` of S and the corners u of a regular simplex, centred at the origin and of unit spread.
/// Source: mex143; Routh, Dynamics of a System of Rigid Bodies, elementary part, §34.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
/// use polhode::mass::equimomental::equimomental_particles;
/// use polhode::mass::particles::particles;
///
/// let brick = solids::cuboid(&[1.0, 2.0, 3.0], Amount::Mass(4.0))?;
/// let found = equimomental_particles(&brick)?;
/// assert_eq!(found.masses, [1.0; 4]);
/// assert!(particles(&found.masses, &found.positions)?.is_close(&brick, 1e-14, 1e-14));
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// [`BodyFault::TriangleInequality`] for a body that was admitted (`rtol`) with moments that no masses have; a body larger than
/// any number, `√(I/m)`, or whose mass has no parts that are normal numbers.
pub fn equimomental_particles(body: &RigidBody) -> Result<Particles, Error> {
    let (spread, corners) = spreads(&body.principal().moments)?;
    let (m, c, axes) = (body.mass(), body.center_of_mass(), body.principal().axes);
    let lengths = spread.map(|s| root_of_ratio(s, m));
    let place = |corner: &[f64; 3]| {
        let along = Vector3::from_fn(|k, _| lengths[k] * corner[k]);
        (c + axes * along).into()
    };
    let count = corners.len() as f64;
    let mass = m / count;
    if mass < f64::MIN_POSITIVE && mass * count != m {
        return Err(BodyFault::OutOfRange {
            what: "mass of each particle",
            mantissa: times_power_of_two(m, 60) / count,
            exponent: -60,
        }
        .into());
    }
    let positions: Vec<[f64; 3]> = corners.iter().map(place).collect();
    all_finite("positions", positions.as_flattened())?;
    Ok(Particles {
        masses: vec![mass; corners.len()],
        positions,
    })
}

/// The principal values of the second moment, descending, and the simplex of their rank.
fn spreads(moments: &[f64; 3]) -> Result<([f64; 3], &'static [[f64; 3]]), Error> {
    let [i1, i2, i3] = *moments;
    let (sum, deficit) = (i1 + i2 + i3, i3 - i2 - i1);
    finite("the sum of the principal moments", sum)?;
    let noise = ROUNDING * sum;
    if deficit > noise {
        return Err(BodyFault::TriangleInequality {
            moments: *moments,
            deficit,
            relative: deficit / sum,
            is_given: false,
        }
        .into());
    }
    let first = 0.5 * ((i2 - i1) + i3);
    if i3 == 0.0 {
        return Ok(([0.0; 3], &[[0.0; 3]]));
    }
    // Thinner than the coordinates of its particles can tell: length times ε across.
    if i1 <= ROUNDING * noise {
        return Ok(([first, 0.0, 0.0], &SEGMENT));
    }
    // I₁ is the sum of the other two, however thin the body; I₃ − I₂, their difference, is known to rounding of I₃. Where
    // that is all there is of the difference, as of a needle, the two stay equal.
    let difference = i3 - i2;
    let third = 0.5 * (i1 - difference);
    if third <= noise && third < 0.125 * i1 {
        return Ok(([first, i1, 0.0], &TRIANGLE));
    }
    Ok(([first, 0.5 * (i1 + difference), third], &TETRAHEDRON))
}

/// A stick as three particles in a row: at the distance a from C on one side, b on the other, and at C.
///
/// `m₁ = I₀/(a(a+b))`, `m₂ = I₀/(b(a+b))`, `m₀ = m − I₀/(ab)`. `mass`: m. `inertia`: I₀, about an axis across the stick
/// through C. The moment about every parallel axis agrees too, `I₀ + m x²`. The stick lies along z with C at the origin:
/// positions a, −b and 0, in this order.
/// Source: mex143.
///
/// # Examples
///
/// ```
/// use polhode::mass::equimomental::stick;
///
/// // A rod of 12 kg and 1 m: 2 kg at each end and 8 kg in the middle.
/// let found = stick(12.0, 12.0 / 12.0, 0.5, 0.5)?;
/// assert_eq!(found.masses, [2.0, 2.0, 8.0]);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// [`BodyFault::NegativeCentralMass`] where `m₀ < 0`; distances and mass that are not positive, a negative moment.
pub fn stick(mass: f64, inertia: f64, a: f64, b: f64) -> Result<Particles, Error> {
    check_mass(mass)?;
    for (what, value) in [("inertia", inertia), ("a", a), ("b", b)] {
        if what == "inertia" {
            finite_of_body(what, value)?;
        }
        finite(what, value)?;
        let (law, obeyed) = if what == "inertia" {
            ("zero or more", value >= 0.0)
        } else {
            ("positive", value > 0.0)
        };
        if !obeyed {
            return Err(Error::OutOfDomain { what, law, value });
        }
    }
    // Divided by the larger length first, in a unit of its own: nothing leaves the range of float64 on the way.
    let power = exponent(inertia);
    let over = |long: f64, short: f64| {
        times_power_of_two(times_power_of_two(inertia, -power) / long / short, power)
    };
    let removed = over(a.max(b), a.min(b));
    let mut central = mass - removed;
    if central.abs() <= ROUNDING * mass {
        central = 0.0; // two particles alone, to rounding
    }
    if central < 0.0 {
        return Err(BodyFault::NegativeCentralMass {
            mass: central,
            least: inertia / mass,
        }
        .into());
    }
    let masses = vec![over(a + b, a), over(a + b, b), central];
    all_finite_of_body("masses", &masses)?;
    Ok(Particles {
        masses,
        positions: vec![[0.0, 0.0, a], [0.0, 0.0, -b], [0.0; 3]],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass::{Amount, particles::particles, solids};

    fn count(size: [f64; 3]) -> usize {
        let body = solids::cuboid(&size, Amount::Mass(3.0)).expect("box");
        let found = equimomental_particles(&body).expect("possible");
        let again = particles(&found.masses, &found.positions).expect("particles");
        assert!((again.mass() - 3.0).abs() < 1e-15);
        assert!((again.inertia() - body.inertia()).abs().max() <= 1e-14 * body.inertia().max());
        found.masses.len()
    }

    #[test]
    fn as_many_as_the_rank_and_one() {
        assert_eq!(count([1.0, 2.0, 3.0]), 4);
        assert_eq!(count([1.0, 0.0, 3.0]), 3);
        assert_eq!(count([0.0, 0.0, 3.0]), 2);
        assert_eq!(count([0.0; 3]), 1);
        assert_eq!(count([1e-9, 1e-9, 3.0]), 4);
        assert_eq!(count([1e-3, 0.0, 3.0]), 3);
    }

    #[test]
    fn what_is_left_of_an_eighth_is_more_than_rounding() {
        // The least second moment is 1/2 (x − 6 u), of a needle whose moments are x u, 1 and 1 + 6 u.
        let unit = f64::EPSILON;
        for (x, corners) in [(7.99, 3), (8.0, 4), (8.01, 4)] {
            let (_, simplex) = spreads(&[x * unit, 1.0, 1.0 + 6.0 * unit]).expect("possible");
            assert_eq!(simplex.len(), corners, "{x}");
        }
    }

    #[test]
    fn impossible_moments_have_no_particles() {
        let axes = nalgebra::Matrix3::identity();
        let body =
            RigidBody::from_principal(1.0, &[1.0, 1.0, 2.01], &axes, &Vector3::zeros(), 0.01)
                .expect("admitted");
        let fault = equimomental_particles(&body);
        assert!(matches!(
            fault,
            Err(Error::Body(BodyFault::TriangleInequality { .. }))
        ));
    }

    #[test]
    fn stick_with_two_particles_alone() {
        // a b = I₀/m: the physical pendulum's centre of percussion.
        let found = stick(3.0, 3.0 * 4.0 / 12.0, 0.5, 2.0 / 3.0).expect("stick");
        assert_eq!(found.masses[2], 0.0);
        assert!((found.masses[0] * 0.5 - found.masses[1] * 2.0 / 3.0).abs() < 1e-15);
        let fault = stick(3.0, 1.0, 0.5, 0.5);
        assert!(
            matches!(fault, Err(Error::Body(BodyFault::NegativeCentralMass { mass, least }))
            if (mass + 1.0).abs() < 1e-15 && (least - 1.0 / 3.0).abs() < 1e-15)
        );
        assert!(stick(3.0, 1.0, 0.0, 0.5).is_err() && stick(3.0, -1.0, 1.0, 0.5).is_err());
    }
}
