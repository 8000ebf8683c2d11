//! The curve of ω in the body (the polhode), the cones of ω, and the ellipsoid of energy that rolls on a plane.
//!
//! Poinsot's picture: the ellipsoid of energy rolls without slipping on a plane that is fixed in space.

use nalgebra::Vector3;

use super::invariants::Invariants;
use super::motion::FreeMotion;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::power_of_two::power_below;

impl FreeMotion {
    /// `count` points of the polhode, components in B: see [`Invariants::polhode`].
    #[must_use]
    pub fn polhode(&self, count: usize) -> Vec<Vector3<f64>> {
        self.polhode_points(count).collect()
    }

    /// The points of [`polhode`](Self::polhode), one by one.
    pub fn polhode_points(&self, count: usize) -> impl Iterator<Item = Vector3<f64>> {
        let points = Invariants::of_motion(self).polhode_points(count);
        points.enumerate().map(move |(j, omega)| {
            // Exactly where the motion starts and the curve closes.
            if j == 0 || j + 1 == count {
                self.initial.omega
            } else {
                self.axes * omega
            }
        })
    }
}

impl Invariants {
    /// `count` points of the polhode, components in principal axes, from ω at time zero in the sense of the motion; the last
    /// is the first again.
    ///
    /// With axis 3 circled, `ω = (a₁ cos φ, a₂ sin φ, ±a₃ √(1 − k² sin² φ))` in equal steps of φ, the amplitude of the
    /// elliptic functions; with axis 1 circled the same with axes 1 and 3 exchanged. On the separatrix this is the limit of
    /// the curves beside it, which goes from one intermediate pole to the other and back. A constant ω is repeated.
    #[must_use]
    pub fn polhode(&self, count: usize) -> Vec<Vector3<f64>> {
        self.polhode_points(count).collect()
    }

    /// The points of [`polhode`](Self::polhode), one by one.
    pub fn polhode_points(&self, count: usize) -> impl Iterator<Item = Vector3<f64>> + use<> {
        let motion = *self;
        let start = self.omega * self.rate_unit;
        let is_steady = self.is_steady();
        let a = self.amplitudes();
        let [x, z] = self.planar_axes();
        // ω̇₂ = α₂ω₃ω₁: φ runs forward where the circled component is positive.
        let sense = 1.0_f64.copysign(self.omega[z]);
        let first = (self.omega.y / a.y).atan2(self.omega[x] / a[x]);
        let steps = count.saturating_sub(1).max(1);
        let fraction = move |j: usize| j as f64 / steps as f64;
        (0..count).map(move |j| {
            if is_steady {
                return start;
            }
            let phi = first + sense * std::f64::consts::TAU * fraction(j);
            motion.on_polhode(phi.sin_cos(), sense) * motion.rate_unit
        })
    }

    /// The axis in whose plane with axis 2 ω circles, and the circled one.
    pub(super) fn planar_axes(&self) -> [usize; 2] {
        if self.circles_third() { [0, 2] } else { [2, 0] }
    }

    /// ω where the amplitude has this sine and cosine, on the side of the circled axis with this sign.
    pub(super) fn on_polhode(&self, (sin, cos): (f64, f64), side: f64) -> Vector3<f64> {
        let (a, m1) = (self.amplitudes(), self.complement());
        let [x, z] = self.planar_axes();
        let mut point = Vector3::zeros();
        point[x] = a[x] * cos;
        point.y = a.y * sin;
        point[z] = side * a[z] * (cos * cos + m1 * sin * sin).sqrt();
        point
    }

    /// The points at which each component of ω has its extremes: where ω crosses the planes through the circled axis. A
    /// single one where ω is constant.
    fn extremes(&self) -> Vec<Vector3<f64>> {
        if self.is_steady() {
            return vec![self.omega];
        }
        let [_, z] = self.planar_axes();
        let side = 1.0_f64.copysign(self.omega[z]);
        [(0.0, 1.0), (1.0, 0.0), (0.0, -1.0), (-1.0, 0.0)]
            .map(|turn| self.on_polhode(turn, side))
            .to_vec()
    }
}

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
        let space = range((points.iter()).map(|omega| {
            self.omega_cross_momentum(omega)
                .norm()
                .atan2(self.twice_energy)
        }));
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

    /// L about the centre of mass at t = 0, components in B.
    #[must_use]
    pub fn angular_momentum_in_body(&self) -> Vector3<f64> {
        (self.initial.attitude).inverse_transform_vector(&self.angular_momentum())
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
            .map(|omega| self.omega_cross_momentum(omega).norm() / self.momentum)
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
    fn omega_cross_momentum(&self, omega: &Vector3<f64>) -> Vector3<f64> {
        let ([x, y, z], [i1, i2, i3]) = ((*omega).into(), self.moments);
        Vector3::new((i3 - i2) * y * z, (i1 - i3) * z * x, (i2 - i1) * x * y)
    }
}
