//! Composites: bodies put together, and parts taken out.

use nalgebra::{Matrix3, Vector3};

use super::body::RigidBody;
use super::error_bound::{ErrorBound, UNIT, faint};
use super::integrator::is_thin;
use super::parallel_axis::point_inertia;
use super::provenance::Provenance;
use super::validity::{ROUNDING, check_mass, trace};
use crate::error::{BodyFault, Error, all_finite_of_body};
use crate::numerics::eigen3::eigen3;
use crate::numerics::power_of_two::length;
use crate::numerics::tree_sum::{depth, sum_terms};
use crate::principal::{PrincipalAxes, canonical_to_rounding, principal_axes, with_sign_rule};

/// The bodies as one rigid body.
///
/// Composed from centre to centre, `I = Σ I_i + Σ m_i (d_i² 1 − d_i d_iᵀ)` with `d_i = C_i − C`, so that bodies far from the
/// origin lose nothing. Where the sum is thin its moments come from the parts' own second moments, turned into the axes of
/// the sum: collinear rods and particles keep the smallest moment that they have.
///
/// # Examples
///
/// ```
/// use polhode::mass::assemblies::combined;
/// use polhode::mass::{Amount, solids};
/// use polhode::nalgebra::Vector3;
///
/// // A dumbbell: two balls of 1 kg, 2 m apart.
/// let ball = solids::sphere(0.1, Amount::Mass(1.0))?;
/// let at = |x: f64| ball.translated(&Vector3::new(x, 0.0, 0.0));
/// let dumbbell = combined(&[at(-1.0)?, at(1.0)?])?;
/// assert!((dumbbell.principal().moments[2] - (2.0 + 2.0 * 0.004)).abs() < 1e-15); // 2 m d² + 2 (2/5) m r²
/// // The same, one after the other.
/// assert!(at(-1.0)?.combined(&at(1.0)?)?.is_close(&dumbbell, 1e-15, 1e-15));
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When there are none, or the sum overflows.
pub fn combined(bodies: &[RigidBody]) -> Result<RigidBody, Error> {
    match bodies {
        [] => Err(Error::Empty { what: "bodies" }),
        [one] => Ok(*one),
        many => {
            let sum = Assembly::of(many.len(), |i| (1.0, &many[i]));
            check_mass(sum.mass)?;
            all_finite_of_body("center_of_mass", &sum.center)?;
            all_finite_of_body("inertia", &sum.inertia)?;
            all_finite_of_body("inertia", &[sum.spread])?;
            // The sum of possible bodies is possible.
            let mut principal = canonical_to_rounding(&principal_axes(&sum.inertia));
            if is_thin(&principal) {
                principal = sum.refine_principal(&principal);
                all_finite_of_body("moments", &principal.moments)?;
                principal.moments = principal.moments.map(|moment| moment.max(0.0));
                let provenance = sum.provenance().in_own_axes();
                return Ok(sum.body(principal).with_provenance(provenance));
            }
            let spread = trace(&sum.inertia);
            let body = RigidBody::admit(sum.mass, sum.inertia, &sum.center, principal, spread);
            let provenance = Provenance {
                rounded_to_zero: body.provenance.rounded_to_zero,
                ..sum.provenance()
            };
            Ok(body
                .with_bound(sum.error_bound())
                .with_provenance(provenance))
        }
    }
}

impl RigidBody {
    /// Both bodies as one rigid body: [`combined`] of the two.
    ///
    /// # Errors
    /// When the sum overflows.
    pub fn combined(&self, other: &Self) -> Result<Self, Error> {
        combined(&[*self, *other])
    }

    /// What is left of the body when `part` is taken out of it: a cavity, a hole.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, solids};
    ///
    /// let density = Amount::Density(1.0);
    /// let shell = solids::sphere(2.0, density)?.without(&solids::sphere(1.0, density)?)?;
    /// assert!(shell.is_close(&solids::hollow_sphere(1.0, 2.0, density)?, 1e-14, 1e-14));
    /// # Ok::<(), polhode::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`BodyFault::NoRemainder`] when what is left is no body: its mass or its second moment along some axis is negative.
    pub fn without(&self, part: &Self) -> Result<Self, Error> {
        let mass = self.mass - part.mass;
        if mass <= 0.0 {
            let (what, axis) = ("mass", None);
            let value = mass;
            return Err(BodyFault::NoRemainder { what, axis, value }.into());
        }
        let pair = [(1.0, self), (-1.0, part)];
        let rest = Assembly::of(2, |i| pair[i]);
        all_finite_of_body("center_of_mass", &rest.center)?;
        all_finite_of_body("inertia", &rest.inertia)?;
        all_finite_of_body("inertia", &[rest.spread])?;
        let mut principal = canonical_to_rounding(&principal_axes(&rest.inertia));
        let [i1, i2, i3] = principal.moments;
        // Along the axis of the largest moment the second moment is the smallest.
        let smallest = 0.5 * (i1 + i2 - i3);
        if smallest < -ROUNDING * rest.spread {
            let axis = principal.axes.column(2).into_owned();
            return Err(BodyFault::NoRemainder {
                what: "second moment",
                axis: Some([axis.x, axis.y, axis.z]),
                value: smallest,
            }
            .into());
        }
        let mut provenance = rest.provenance();
        if is_thin(&principal) {
            principal = rest.refine_principal(&principal);
            all_finite_of_body("moments", &principal.moments)?;
            provenance = provenance.in_own_axes();
        }
        principal.moments = principal.moments.map(|moment| moment.max(0.0));
        Ok(rest.body(principal).with_provenance(provenance))
    }
}

/// Bodies with signs: what they are together about their common centre of mass.
struct Assembly<'a, F: Fn(usize) -> (f64, &'a RigidBody)> {
    count: usize,
    part: F,
    mass: f64,
    center: Vector3<f64>,
    /// From the centre as stored to the centre meant: what rounding has left.
    rest: Vector3<f64>,
    inertia: Matrix3<f64>,
    /// The traces of all terms of the tensor, each counted as positive.
    spread: f64,
}

impl<'a, F: Fn(usize) -> (f64, &'a RigidBody)> Assembly<'a, F> {
    fn of(count: usize, part: F) -> Self {
        // The heaviest lies within the whole, so that nothing cancels wherever the bodies stand.
        let heaviest = (0..count)
            .max_by(|&i, &j| part(i).1.mass.total_cmp(&part(j).1.mass))
            .unwrap_or(0);
        let reference = part(heaviest).1.center_of_mass;
        let [mass] = sum_terms(count, |i| {
            let (sign, body) = part(i);
            [sign * body.mass]
        });
        let offset = |from: &Vector3<f64>| {
            let [x, y, z] = sum_terms(count, |i| {
                let (sign, body) = part(i);
                ((body.center_of_mass - from) * (sign * body.mass / mass)).into()
            });
            Vector3::new(x, y, z)
        };
        let center = reference + offset(&reference);
        let rest = offset(&center);
        let [xx, xy, xz, yy, yz, zz, spread] = sum_terms(count, |i| {
            let (sign, body) = part(i);
            let lever = point_inertia(body.mass, &(body.center_of_mass - center));
            let own = body.inertia + lever;
            let [a, b, c] = [own.row(0) * sign, own.row(1) * sign, own.row(2) * sign];
            [a[0], a[1], a[2], b[1], b[2], c[2], trace(&own)]
        });
        let inertia = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        Self {
            count,
            part,
            mass,
            center,
            rest,
            inertia: inertia - point_inertia(mass, &rest),
            spread,
        }
    }

    /// Principal moments and axes from second moments in the axes W that the tensor has, found before they are rounded to
    /// body axes: `S = Σ ± (V s Vᵀ + m d dᵀ)`, with the parts' axes V and their distances d in W.
    fn refine_principal(&self, first: &PrincipalAxes) -> PrincipalAxes {
        let turn = first.axes.transpose();
        let [x, y, z, xx, xy, xz, yy, yz, zz] = sum_terms(self.count, |i| {
            let (sign, body) = (self.part)(i);
            let d = turn * (body.center_of_mass - self.center);
            let md = d * (sign * body.mass);
            let axes = turn * body.principal.axes;
            let s = second_moments(&body.principal.moments).map(|s| sign * s);
            let term = |i: usize, j: usize| {
                let own: f64 = (0..3).map(|k| s[k] * (axes[(i, k)] * axes[(j, k)])).sum();
                own + md[i] * d[j]
            };
            [
                md.x,
                md.y,
                md.z,
                term(0, 0),
                term(0, 1),
                term(0, 2),
                term(1, 1),
                term(1, 2),
                term(2, 2),
            ]
        });
        let first_moment = Vector3::new(x, y, z);
        let second = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
            - first_moment * (first_moment / self.mass).transpose();
        let s = eigen3(&second);
        let [s1, s2, s3] = s.values;
        let column = |k: usize| first.axes * s.vectors.column(k);
        let (u, v) = (column(2), column(1));
        canonical_to_rounding(&PrincipalAxes {
            moments: [s1 + s2, s1 + s3, s2 + s3],
            axes: with_sign_rule(Matrix3::from_columns(&[u, v, u.cross(&v)])),
        })
    }

    fn body(&self, principal: PrincipalAxes) -> RigidBody {
        RigidBody {
            mass: self.mass,
            center_of_mass: self.center,
            inertia: self.inertia,
            principal,
            error_bound: self.error_bound(),
            provenance: self.provenance(),
        }
    }

    /// Of all parts together.
    fn provenance(&self) -> Provenance {
        let of = |i: usize| (self.part)(i).1.provenance;
        (1..self.count).fold(of(0), |whole, i| whole.of_both(&of(i)))
    }

    /// What the parts' own errors and the rounding of these sums can have done.
    ///
    /// With d from the stored centre Q, the centre of the parts as they are stored is at `rest`, and the exact one, which the
    /// exact tensor is about, at most `off` from there. A part's tensor about Q changes by `m (2 |d| δ + δ²)` where its centre
    /// is off by δ, and the tensor about the centre by `M (2 |rest| off + off²)`. Far from the origin, or where masses cancel,
    /// the squares are all there is.
    fn error_bound(&self) -> ErrorBound {
        let [mass, masses, lever, levers, centers, inertia] = sum_terms(self.count, |i| {
            let body = (self.part)(i).1;
            let own = body.error_bound;
            let length = length(&(body.center_of_mass - self.center));
            let shift = (body.mass + own.mass) * own.center_of_mass;
            [
                own.mass,
                body.mass,
                own.mass * length,
                body.mass * length,
                shift,
                own.inertia
                    + length * (own.mass * length + 3.0 * shift)
                    + 2.0 * shift * own.center_of_mass,
            ]
        });
        let relative = 2.0 * UNIT * (depth(self.count) + 8.0);
        let mass = mass + relative * masses;
        let rest = length(&self.rest);
        // What is left of masses that cancel may be none.
        let least = (self.mass - mass).max(0.0);
        let off = |centers: f64| (lever + centers + relative * levers + mass * rest) / least;
        let moved = off(3.0_f64.sqrt() * centers);
        let about_center = mass * rest * rest
            + (self.mass + mass) * moved * (2.0 * rest + moved)
            + 8.0 * UNIT * self.mass * rest * rest;
        let faint = if levers > 0.0 {
            faint(self.spread)
        } else {
            0.0
        };
        ErrorBound {
            mass,
            center_of_mass: off(centers) + self.rest.amax(),
            inertia: inertia + about_center + 2.0 * relative * self.spread + faint,
        }
        .rounded(&Vector3::zeros(), self.spread)
    }
}

/// `∫ x_k² dm` along the principal axes from ascending moments: `s₂ + s₃ = I₁` to the last bit, so that the smallest moment
/// of a needle is not lost in the difference of the large ones.
fn second_moments(&[i1, i2, i3]: &[f64; 3]) -> [f64; 3] {
    let mut difference = i3 - i2;
    if difference > i1 && difference - i1 <= ROUNDING * i3 {
        difference = i1; // rounding of the large moments: a lamina has no thickness
    }
    [
        0.5 * (i2 - i1 + i3),
        0.5 * (i1 + difference),
        0.5 * (i1 - difference),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mass::{Amount, rods, solids};

    #[test]
    fn two_particles_are_a_dumbbell_wherever_they_are() {
        let point = |m, x| {
            RigidBody::new(m, &Matrix3::zeros(), &Vector3::new(x, 0.0, 0.0), 0.0).expect("point")
        };
        let dumbbell = point(1.0, 1e8)
            .combined(&point(3.0, 1e8 + 4.0))
            .expect("sum");
        assert_eq!(dumbbell.principal().moments, [0.0, 12.0, 12.0]);
        assert_eq!(dumbbell.center_of_mass().x, 1e8 + 3.0);
    }

    #[test]
    fn collinear_rods_stay_without_width_however_they_are_turned() {
        let turn = nalgebra::Rotation3::from_euler_angles(0.3, -1.1, 2.0).into_inner();
        let rod = rods::rod(2.0, Amount::Mass(3.0)).expect("rod");
        let part = |x: f64| {
            let moved = rod.translated(&Vector3::new(0.0, 0.0, x)).expect("moved");
            moved.rotated(&turn).expect("turned")
        };
        let whole = combined(&[part(0.0), part(2.0), part(4.0)]).expect("sum");
        let [i1, i2, i3] = whole.principal().moments;
        assert!(i1 < 1e-30 * i3, "{i1:e}");
        assert!((i2 / 27.0 - 1.0).abs() < 4e-15 && (i3 / 27.0 - 1.0).abs() < 4e-15);
    }

    #[test]
    fn cavity_undoes_the_sum_and_too_large_a_cavity_is_told() {
        let ball = solids::sphere(2.0, Amount::Density(1.0)).expect("ball");
        let hole = solids::sphere(1.0, Amount::Density(1.0)).expect("hole");
        let shell = solids::hollow_sphere(1.0, 2.0, Amount::Density(1.0)).expect("shell");
        assert!(
            ball.without(&hole)
                .expect("rest")
                .is_close(&shell, 1e-14, 0.0)
        );
        let heavier = hole.without(&ball).expect_err("negative mass");
        assert!(matches!(
            heavier,
            Error::Body(BodyFault::NoRemainder { what: "mass", .. })
        ));
        let lead = solids::sphere(1.9, Amount::Mass(20.0)).expect("lead");
        let far = lead.translated(&Vector3::new(5.0, 0.0, 0.0)).expect("far");
        let fault = ball.without(&far).expect_err("outside");
        let Error::Body(BodyFault::NoRemainder {
            axis: Some([x, ..]),
            value,
            ..
        }) = fault
        else {
            panic!("{fault}");
        };
        assert!(value < 0.0 && (x.abs() - 1.0).abs() < 1e-12);
    }
}
