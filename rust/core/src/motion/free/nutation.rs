//! How far the body's axes lean from L and from ω: nutation of each principal axis, body cone and space cone.

use nalgebra::Vector3;

use super::invariants::Invariants;

/// The cones of Poinsot's motion, half their opening: least and greatest, equal for a symmetric body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cones {
    /// The principal axis that ω circles in the body, 0 or 2, toward the side of ω.
    pub axis: usize,
    /// Between ω and that axis: ω describes this cone in the body.
    pub body: [f64; 2],
    /// Between ω and L: ω describes this cone in space, between two circular ones.
    pub space: [f64; 2],
}

impl Invariants {
    /// Least and greatest angle between each principal axis and L, in [0, π]: the Euler angle θ of that axis with L along
    /// z. NaN without angular momentum; on the separatrix the bounds that are approached.
    ///
    /// `cos θ_k = I_k ω_k/L`, from the two components so that small angles keep their digits.
    #[must_use]
    pub fn nutation(&self) -> [[f64; 2]; 3] {
        let momenta: Vec<_> = (self.extremes().iter())
            .map(|omega| omega.component_mul(&Vector3::from(self.moments)))
            .collect();
        std::array::from_fn(|k| {
            if self.momentum == 0.0 {
                return [f64::NAN; 2];
            }
            range(momenta.iter().map(|momentum| lean(momentum, k)))
        })
    }

    /// Body cone and space cone. NaN at rest, and the space cone without angular momentum.
    ///
    /// `tan ∠(ω, L) = |ω×L|/2T`; ω is longest and shortest where it crosses the planes of the principal axes.
    #[must_use]
    pub fn cones(&self) -> Cones {
        let axis = self.circled_axis();
        let points = self.extremes();
        let body = range(points.iter().map(|omega| {
            let angle = lean(omega, axis);
            angle.min(std::f64::consts::PI - angle)
        }));
        let space =
            range((points.iter()).map(|omega| self.askew(omega).norm().atan2(self.twice_energy)));
        let known = |angles: [f64; 2], known: bool| if known { angles } else { [f64::NAN; 2] };
        Cones {
            axis,
            body: known(body, self.omega != Vector3::zeros()),
            space: known(space, self.momentum != 0.0),
        }
    }
}

/// Angle between a vector and axis k.
fn lean(v: &Vector3<f64>, k: usize) -> f64 {
    v[(k + 1) % 3].hypot(v[(k + 2) % 3]).atan2(v[k])
}

/// The least and the greatest.
fn range(angles: impl Iterator<Item = f64>) -> [f64; 2] {
    angles.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], angle| {
        [low.min(angle), high.max(angle)]
    })
}
