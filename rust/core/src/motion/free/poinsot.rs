//! Poinsot's picture: the ellipsoid of energy rolls without slipping on a plane that is fixed in space.

use nalgebra::Vector3;

use super::invariants::Invariants;
use super::motion::FreeMotion;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::power_of_two::power_below;

/// The ellipsoid `ω·I ω = 2T`, fixed in the body with its centre in C, and the plane on which it rolls.
///
/// They touch at the tip of ω, where the ellipsoid has the normal I ω = L, constant in space: so the plane is invariable.
/// The tip draws the polhode on the ellipsoid and the herpolhode on the plane. Source: Goldstein, Classical Mechanics,
/// §5.6, where the ellipsoid is smaller by √2T.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Poinsot {
    /// `√(2T/I_k)`, half the lengths of the ellipsoid's axes, along the principal axes; infinite for a zero moment.
    pub semi_axes: [f64; 3],
    /// `2T/L = ω·L/L`, of the plane from C. NaN without angular momentum, as the radii.
    pub distance: f64,
    /// `|ω×L|/L`, least and greatest distance of the herpolhode from the foot of the perpendicular from C.
    pub radii: [f64; 2],
}

impl FreeMotion {
    /// L about the centre of mass, components in N: constant.
    #[must_use]
    pub fn angular_momentum(&self) -> Vector3<f64> {
        let (momentum, [inertia_unit, rate_unit]) = self.scaled_momentum();
        momentum * inertia_unit * rate_unit
    }

    /// The normal of the invariable plane: the unit vector along L, components in N. NaN without angular momentum.
    #[must_use]
    pub fn normal(&self) -> Vector3<f64> {
        let (momentum, _) = self.scaled_momentum();
        (momentum / momentum.amax()).normalize()
    }

    /// L in units of two powers of two, of inertia and of rate, so that it is within the range of float64.
    fn scaled_momentum(&self) -> (Vector3<f64>, [f64; 2]) {
        let moments = Vector3::from(self.moments.map(DoubleDouble::rounded));
        let omega = Vector3::from(self.principal_omega.map(DoubleDouble::rounded));
        let units = [moments.z, omega.amax()].map(power_below);
        let [moments, omega] = [moments / units[0], omega / units[1]];
        let momentum = self.initial.attitude * (self.axes * moments.component_mul(&omega));
        (momentum, units)
    }

    /// ω at the time t, components in N: the herpolhode, where the ellipsoid of energy touches the invariable plane.
    #[must_use]
    pub fn herpolhode(&self, t: f64) -> Vector3<f64> {
        let state = self.at(t);
        state.attitude * state.omega
    }
}

impl Invariants {
    /// Ellipsoid, plane, and the ring that holds the herpolhode.
    #[must_use]
    pub fn poinsot(&self) -> Poinsot {
        let radii = (self.extremes().iter())
            .map(|omega| self.askew(omega).norm() / self.momentum)
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], radius| {
                [low.min(radius), high.max(radius)]
            });
        let unit = self.rate_unit;
        let known = |x: f64| {
            if self.momentum > 0.0 {
                x * unit
            } else {
                f64::NAN
            }
        };
        Poinsot {
            semi_axes: self
                .moments
                .map(|moment| (self.twice_energy / moment).sqrt() * unit),
            distance: known(self.twice_energy / self.momentum),
            radii: radii.map(known),
        }
    }

    /// ω×L for an ω of the motion, from the differences of the moments.
    pub(super) fn askew(&self, omega: &Vector3<f64>) -> Vector3<f64> {
        let ([x, y, z], [i1, i2, i3]) = ((*omega).into(), self.moments);
        Vector3::new((i3 - i2) * y * z, (i1 - i3) * z * x, (i2 - i1) * x * y)
    }
}
