//! The polhode: the closed curve on which the tip of ω runs in the body.

use nalgebra::Vector3;

use super::FreeMotion;
use super::invariants::Invariants;

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
    pub(super) fn extremes(&self) -> Vec<Vector3<f64>> {
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
