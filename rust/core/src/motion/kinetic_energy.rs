//! Kinetic energy of a rigid body in three parts (mln25).

use nalgebra::Vector3;

use crate::mass::RigidBody;
use crate::numerics::power_of_two::times_dot;

/// `T = ½ m v² + m v·(ω×c_P) + ½ ω·I_P·ω`.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::kinetic_energy::{KineticEnergy, kinetic_energy};
/// use polhode::nalgebra::Vector3;
///
/// // A ball of 5 kg swings about a point 1 m beside its centre: ½ (I + m d²) ω² in one part, with the point at rest.
/// let ball = solids::sphere(1.0, Amount::Mass(5.0))?;
/// let (spin, pivot) = (Vector3::new(0.0, 0.0, 2.0), Vector3::new(1.0, 0.0, 0.0));
/// let KineticEnergy { translational, mixed, rotational } = kinetic_energy(&ball, &spin, &Vector3::zeros(), &pivot);
/// assert_eq!((translational, mixed), (0.0, 0.0));
/// assert!((rotational - 0.5 * 7.0 * 4.0).abs() < 1e-14);
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KineticEnergy {
    /// `½ m v²`, of a particle of the body's mass that moves with P.
    pub translational: f64,
    /// `m v·(ω×c_P)`; zero for P = C.
    pub mixed: f64,
    /// `½ ω·I_P·ω`.
    pub rotational: f64,
}

impl KineticEnergy {
    /// The sum of the three parts, which does not depend on P.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.translational + self.mixed + self.rotational
    }
}

/// Kinetic energy of `body` whose point P moves with velocity v while the body turns with ω.
///
/// `omega`, `velocity`: relative to N, components in B. `about`: P, from the origin of B; `c_P = C − P`.
/// Source: mln25, mex67.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, solids};
/// use polhode::nalgebra::Vector3;
/// use polhode::motion::kinetic_energy::kinetic_energy;
///
/// // A ball that rolls: 7/10 m v².
/// let ball = solids::sphere(1.0, Amount::Mass(5.0))?;
/// let (spin, velocity) = (Vector3::new(0.0, 2.0, 0.0), Vector3::new(2.0, 0.0, 0.0));
/// let energy = kinetic_energy(&ball, &spin, &velocity, &Vector3::zeros());
/// assert!((energy.total() - 0.7 * 5.0 * 4.0).abs() < 1e-14);
/// # Ok::<(), polhode::Error>(())
/// ```
#[must_use]
pub fn kinetic_energy(
    body: &RigidBody,
    omega: &Vector3<f64>,
    velocity: &Vector3<f64>,
    about: &Vector3<f64>,
) -> KineticEnergy {
    let c = body.center_of_mass() - about;
    let m = body.mass();
    // ½ω·I_P·ω in principal axes and by the speed ω×c of the centre of mass: a sum of squares, in which nothing cancels.
    let principal = body.principal();
    let w = principal.axes.tr_mul(omega);
    let [i1, i2, i3] = principal.moments;
    let swing = omega.cross(&c);
    KineticEnergy {
        translational: times_dot(0.5 * m, velocity, velocity),
        mixed: times_dot(m, velocity, &swing),
        rotational: 0.5
            * (i1 * w.x * w.x + i2 * w.y * w.y + i3 * w.z * w.z + times_dot(m, &swing, &swing)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass::{Amount, solids::cylinder};

    #[test]
    fn rolling_cylinder_from_three_points() {
        // mex173 in units of m v²: the axis moves with v, the rim's top with 2v, the line of contact not at all.
        let (r, v) = (0.5, 3.0);
        let body = cylinder(r, 1.0, Amount::Mass(1.0)).expect("cylinder");
        let omega = Vector3::new(0.0, 0.0, v / r);
        for (p, speed, expected) in [
            (0.0, v, (0.5, 0.0, 0.25)),
            (-r, 2.0 * v, (2.0, -2.0, 0.75)),
            (r, 0.0, (0.0, 0.0, 0.75)),
        ] {
            let t = kinetic_energy(
                &body,
                &omega,
                &Vector3::new(0.0, speed, 0.0),
                &Vector3::new(-p, 0.0, 0.0),
            );
            let parts = (
                t.translational / (v * v),
                t.mixed / (v * v),
                t.rotational / (v * v),
            );
            let close = |a: f64, b: f64| (a - b).abs() < 1e-14;
            assert!(
                close(parts.0, expected.0)
                    && close(parts.1.abs(), -expected.1)
                    && close(parts.2, expected.2),
                "{parts:?} {expected:?}"
            );
        }
    }
}
