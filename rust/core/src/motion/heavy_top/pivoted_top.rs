//! Which bodies are heavy symmetric tops about a fixed point; their steady precession and the sleeping limit (part II).

use nalgebra::{UnitQuaternion, Vector3};

use super::top_data::TopData;
use crate::error::{Error, MotionFault};
use crate::mass::RigidBody;
use crate::mass::provenance::MomentsFrom;
use crate::mass::refined::RefinedPrincipal;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::elliptic::MultiPrecision;
use crate::numerics::power_of_two::{direction_of, exponent, length, times_power_of_two};
use crate::numerics::quad_double::QuadDouble;
use crate::principal::SymmetricTop;

/// A symmetric top whose symmetry axis passes through the pivot O, the origin of the body frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PivotedTop {
    /// Unit vector along the symmetry axis, in B; from O toward C.
    pub axis: Vector3<f64>,
    /// `I_s`, the moment about the symmetry axis.
    pub axial: f64,
    /// `I_t`, the moment about an axis across it through O.
    pub transverse: f64,
    /// `m l`, with l the distance from O to C.
    pub mass_moment: f64,
    /// What the numbers above are rounded from.
    source: TopData,
    /// What that is rounded from, where the body is its tensor: which axis is that of symmetry, and in which sense.
    refined: Option<(RefinedPrincipal, usize, bool)>,
}

impl PivotedTop {
    /// The top that `body` is about the origin of its frame.
    ///
    /// Moments closer than `rtol` times the largest are taken as equal, and O as lying on the axis when it is nearer to it
    /// than `rtol` radii of gyration. The axis of a spherical body is the line from O to C.
    ///
    /// # Errors
    /// [`NotASymmetricTop`](crate::error::BodyFault::NotASymmetricTop), [`MotionFault::PivotOffAxis`]; [`Error::OutOfDomain`] for a point at the pivot,
    /// [`Error::NonFinite`] where C is so far from it that `m l²` is beyond float64.
    pub fn of(body: &RigidBody, rtol: f64) -> Result<Self, Error> {
        let principal = body.principal();
        let (m, c) = (body.mass(), body.center_of_mass());
        body.check_about(&Vector3::zeros())?;
        let top = SymmetricTop::of(&principal, rtol)?;
        let [i1, _, i3] = principal.moments;
        let is_spherical = i3 - i1 <= rtol * i3;
        let axis = match direction_of(&c) {
            Some(to_center) if is_spherical => to_center,
            _ if c.dot(&top.axis) < 0.0 => -top.axis,
            _ => top.axis,
        };
        let arm = c.dot(&axis);
        let transverse = top.transverse + m * arm * arm;
        if transverse == 0.0 {
            return Err(Error::OutOfDomain {
                what: "the moment across the axis through the pivot",
                law: "positive for a top",
                value: transverse,
            });
        }
        let distance = length(&c.cross(&axis));
        let relative = distance / (transverse / m).sqrt();
        if relative > rtol {
            return Err(Error::Motion(MotionFault::PivotOffAxis {
                distance,
                relative,
                allowed: rtol,
            }));
        }
        let (axial, lateral) = if top.axial == i3 {
            (2, [0, 1])
        } else {
            (0, [1, 2])
        };
        let is_tensor = body.provenance().moments == MomentsFrom::Tensor;
        let (moments, direction, refined) = if is_tensor && !is_spherical {
            let refined = RefinedPrincipal::of(body);
            let direction = refined.axis(axial);
            let cosine = (direction.iter().zip(axis.iter())).map(|(a, b)| a.high * b);
            let is_opposite = cosine.sum::<f64>() < 0.0;
            (
                refined.moments,
                toward(direction, is_opposite),
                Some((refined, axial, is_opposite)),
            )
        } else {
            let direction = if is_spherical && arm > 0.0 { c } else { axis };
            let exact = |numbers: [f64; 3]| numbers.map(DoubleDouble::from);
            (exact(principal.moments), exact(direction.into()), None)
        };
        Ok(Self {
            axis,
            axial: top.axial,
            transverse,
            mass_moment: m * arm,
            source: TopData {
                mass: m,
                direction,
                center_of_mass: c,
                axial: moments[axial],
                lateral: lateral.map(|k| moments[k]),
            },
            refined,
        })
    }

    /// Effective potential of the inclination: `V(θ) = (L_z − L_s cos θ)²/(2 I_t sin²θ) + m g l cos θ`.
    ///
    /// `I_t θ̇²/2 + V(θ)` is constant: the energy less that of the spin about the axis. `L_z`, `L_s`: the angular momenta about the upward
    /// vertical and about the axis, both constant. `omega`: in B; `gravity`: in N; θ: of the axis (from O to C) from the upward
    /// vertical. Without gravity the third axis of N stands for the vertical. Source: part II; Landau and Lifshitz, Mechanics, §35.
    #[must_use]
    pub fn effective_potential(
        &self,
        omega: &Vector3<f64>,
        attitude: &UnitQuaternion<f64>,
        gravity: &Vector3<f64>,
        inclination: f64,
    ) -> f64 {
        let up = UnitQuaternion::new_normalize(attitude.into_inner())
            .inverse_transform_vector(&direction_of(&-gravity).unwrap_or_else(Vector3::z));
        let spin = omega.dot(&self.axis);
        let across = omega - self.axis * spin;
        let start = up.dot(&self.axis);
        // L_z − L_s cos θ, where L_z = I_t ω_t·γ + L_s cos θ₀.
        let (half_sin, half_cos) = (0.5 * inclination).sin_cos();
        let (sine, cosine) = (2.0 * half_sin * half_cos, inclination.cos());
        let rest = self.transverse * across.dot(&up) + self.axial * spin * (start - cosine);
        let turning = if rest == 0.0 { 0.0 } else { rest / sine };
        // The square in units in which it is of the order of one.
        let (size, moment) = (exponent(turning), exponent(self.transverse));
        let scaled = times_power_of_two(turning, -size);
        let centrifugal = 0.5 * scaled * scaled / times_power_of_two(self.transverse, -moment);
        times_power_of_two(centrifugal, 2 * size - moment)
            + self.mass_moment * length(gravity) * cosine
    }

    /// The top to twice the precision.
    pub(super) fn source(&self) -> &TopData {
        &self.source
    }

    /// The top to four times the precision.
    pub(super) fn finest(&self) -> TopData<QuadDouble> {
        let TopData {
            mass,
            direction,
            center_of_mass,
            axial,
            lateral,
        } = self.source;
        let (direction, axial, lateral) = match &self.refined {
            None => (
                direction.map(QuadDouble::from),
                axial.into(),
                lateral.map(QuadDouble::from),
            ),
            Some((refined, axial, is_opposite)) => {
                let finest = refined.finest();
                let lateral = [(axial + 1) % 3, (axial + 2) % 3].map(|k| finest.moments[k]);
                let direction = toward(finest.axes[*axial], *is_opposite);
                (direction, finest.moments[*axial], lateral)
            }
        };
        TopData {
            mass,
            direction,
            center_of_mass,
            axial,
            lateral,
        }
    }

    /// Least spin that precesses steadily at the inclination θ: `2 √(I_t m g l cos θ)/I_s`; zero for cos θ ≤ 0.
    ///
    /// For θ = 0 it is the sleeping limit: upright, the top is stable where `I_s² ω_s² ≥ 4 I_t m g l`. `inclination`: θ, of
    /// the axis (from O to C) from the upward vertical. `gravity`: only its size g matters. Infinite for a top without axial moment.
    /// Source: part II; Landau and Lifshitz, Mechanics, §35, problem 2; Goldstein, Classical Mechanics, §5.7.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::RigidBody;
    /// use polhode::motion::heavy_top::PivotedTop;
    /// use polhode::nalgebra::{Matrix3, Vector3};
    ///
    /// let (moments, centre) = ([1.0, 1.0, 2.0], Vector3::z());
    /// let body = RigidBody::from_principal(1.0, &moments, &Matrix3::identity(), &centre, 0.0)?;
    /// let top = PivotedTop::of(&body, 1e-9)?;
    /// let gravity = Vector3::new(0.0, 0.0, -9.0);
    /// let asleep = 2.0 * (2.0_f64 * 9.0).sqrt() / 2.0; // 2 √(I₁ m g l)/I₃, I₁ about the pivot
    /// assert!((top.least_spin(0.0, &gravity) - asleep).abs() < 1e-14);
    /// # Ok::<(), polhode::Error>(())
    /// ```
    #[doc(alias = "sleeping top")]
    #[must_use]
    pub fn least_spin(&self, inclination: f64, gravity: &Vector3<f64>) -> f64 {
        let raised = self.mass_moment * length(gravity) * inclination.cos();
        if raised <= 0.0 {
            return 0.0;
        }
        let (product, size) = product_of_mantissas(self.transverse, raised);
        let half = size.div_euclid(2);
        let mean = times_power_of_two(times_power_of_two(product, size - 2 * half).sqrt(), half);
        2.0 * mean / self.axial
    }

    /// Rates of the two steady precessions, slow and fast: the roots of `I_t φ̇² cos θ − I_s ω_s φ̇ + m g l = 0`.
    ///
    /// `spin`: `ω_s`, the component of ω along the axis (from O to C), which gravity leaves constant. `inclination`: θ, of
    /// the axis from the upward vertical. `gravity`: only its size g matters. The result: φ̇ about the upward vertical, the smaller in
    /// magnitude first: near `m g l/(I_s ω_s)` and `I_s ω_s/(I_t cos θ)` for a fast top. Below the horizontal, where
    /// cos θ < 0, the two have opposite signs; without spin they are those of a conical pendulum.
    /// Source: part II; Goldstein, Classical Mechanics, §5.7.
    ///
    /// # Errors
    /// [`MotionFault::SpinTooSlow`].
    pub fn steady_precession(
        &self,
        spin: f64,
        inclination: f64,
        gravity: &Vector3<f64>,
    ) -> Result<[f64; 2], Error> {
        let (momentum, weight) = (self.axial * spin, self.mass_moment * length(gravity));
        let upright = self.transverse * inclination.cos();
        // In a unit of angular momentum in which the squares are of the order of one.
        let (product, product_size) = product_of_mantissas(upright, weight);
        let unit = exponent(momentum).max((product_size + 1).div_euclid(2));
        let scaled = times_power_of_two(momentum, -unit);
        let discriminant =
            scaled * scaled - 4.0 * times_power_of_two(product, product_size - 2 * unit);
        if discriminant < 0.0 {
            return Err(Error::Motion(MotionFault::SpinTooSlow {
                spin,
                least: self.least_spin(inclination, gravity),
                inclination,
            }));
        }
        // The root that adds, and the other one by their product, so that nothing cancels.
        let sum = 0.5 * (scaled + discriminant.sqrt().copysign(scaled));
        let sum = times_power_of_two(sum, unit);
        if sum == 0.0 {
            return Ok([0.0, 0.0]); // neither spin nor weight
        }
        Ok([weight / sum, sum / upright])
    }
}

/// `a b`, for |a| and |b| without their powers of two, and the exponent of these.
fn product_of_mantissas(a: f64, b: f64) -> (f64, i32) {
    let (of_a, of_b) = (exponent(a), exponent(b));
    let product = times_power_of_two(a, -of_a) * times_power_of_two(b, -of_b);
    (product, of_a + of_b)
}

/// The vector, or the opposite one.
fn toward<T: MultiPrecision>(vector: [T; 3], is_opposite: bool) -> [T; 3] {
    vector.map(|x| if is_opposite { -x } else { x })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass::{Amount, solids};

    fn cone() -> RigidBody {
        // On its apex.
        solids::cone(0.4, 1.0, Amount::Mass(2.0))
            .and_then(|cone| cone.translated(&Vector3::new(0.0, 0.0, -0.75)))
            .expect("cone")
    }

    #[test]
    fn cone_on_its_apex() {
        let top = PivotedTop::of(&cone(), 1e-6).expect("top");
        assert_eq!(top.axis, -Vector3::z());
        assert!((top.axial - 0.3 * 2.0 * 0.16).abs() < 1e-15);
        assert!((top.transverse - 0.6 * 2.0 * (1.0 + 0.04)).abs() < 1e-15);
        assert_eq!(top.mass_moment, 1.5);
    }

    #[test]
    fn steady_precessions_solve_their_equation() {
        let top = PivotedTop::of(&cone(), 1e-6).expect("top");
        let (g, gravity) = (9.81, Vector3::new(0.0, 0.0, -9.81));
        for (spin, inclination) in [(120.0, 0.3), (-120.0, 1.2), (0.0, 2.5), (300.0, 2.0)] {
            let [slow, fast] = top
                .steady_precession(spin, inclination, &gravity)
                .expect("fast");
            assert!(slow.abs() <= fast.abs());
            for rate in [slow, fast] {
                let terms = [
                    top.transverse * rate * rate * inclination.cos(),
                    -top.axial * spin * rate,
                    top.mass_moment * g,
                ];
                let largest = terms
                    .iter()
                    .fold(0.0_f64, |most, term| most.max(term.abs()));
                assert!(terms.iter().sum::<f64>().abs() < 1e-15 * 4.0 * largest);
            }
        }
        let least = top.least_spin(0.3, &gravity);
        assert!(
            top.steady_precession(least * 1.000_001, 0.3, &gravity)
                .is_ok()
        );
        let slower = top.steady_precession(least * 0.999_999, 0.3, &gravity);
        assert!(matches!(
            slower,
            Err(Error::Motion(MotionFault::SpinTooSlow { .. }))
        ));
        assert_eq!(top.least_spin(2.0, &gravity), 0.0);
        assert_eq!(
            top.steady_precession(0.0, 0.3, &Vector3::zeros()),
            Ok([0.0, 0.0])
        );
    }

    #[test]
    fn what_is_no_top_is_refused() {
        let off_axis = cone()
            .translated(&Vector3::new(0.01, 0.0, 0.0))
            .expect("moved");
        assert!(matches!(
            PivotedTop::of(&off_axis, 1e-6),
            Err(Error::Motion(MotionFault::PivotOffAxis { .. }))
        ));
        let brick = solids::cuboid(&[1.0, 2.0, 3.0], Amount::Mass(1.0)).expect("brick");
        assert!(matches!(
            PivotedTop::of(&brick, 1e-6),
            Err(Error::Body(
                crate::error::BodyFault::NotASymmetricTop { .. }
            ))
        ));
        let point = solids::cube(0.0, Amount::Mass(1.0)).expect("point");
        assert!(matches!(
            PivotedTop::of(&point, 1e-6),
            Err(Error::OutOfDomain { .. })
        ));
        let pendulum = point.translated(&Vector3::new(0.0, 3.0, 4.0)).expect("bob");
        let pendulum = PivotedTop::of(&pendulum, 1e-6).expect("spherical pendulum");
        assert_eq!(
            (pendulum.axial, pendulum.transverse, pendulum.mass_moment),
            (0.0, 25.0, 5.0)
        );
        assert!(pendulum.least_spin(0.1, &Vector3::x()).is_infinite());
    }
}
