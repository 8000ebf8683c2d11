//! The rigid body (m, C, `I_C`), and what makes one possible.

use nalgebra::{Matrix3, Vector3};

use crate::error::{BodyFault, Error, all_finite_of_body, check_rtol, finite_of_body};
use crate::mass::error_bound::ErrorBound;
use crate::mass::parallel_axis::to_center_of_mass;
use crate::mass::provenance::{Checks, MomentsFrom, Provenance, Source};
use crate::mass::second_moment::SecondMoment;
use crate::mass::validity::{
    ROUNDING, check_mass, check_moments, check_rotation, mean_of_halves, symmetrized, trace,
};
use crate::numerics::eigen3::{Eigen3, eigen3};
use crate::principal::{PrincipalAxes, canonical, principal_axes, with_sign_rule};

/// A rigid body: mass m > 0, centre of mass C, inertia tensor `I_C` about C, all in the axes of the body frame B.
///
/// Only possible bodies exist: the constructors check that `I_C` is finite, symmetric, positive and obeys the triangle
/// inequality, each relative to the tensor's own size. `I_ij = ∫ (r² δ_ij − r_i r_j) dm`: the off-diagonal elements
/// are *minus* the products of inertia.
///
/// What defined the body is kept exactly, its moments and axes or its tensor; the other form is derived from it.
#[derive(Clone, Copy, Debug)]
#[doc(alias = "mass properties")]
pub struct RigidBody {
    pub(in crate::mass) mass: f64,
    pub(in crate::mass) center_of_mass: Vector3<f64>,
    pub(in crate::mass) inertia: Matrix3<f64>,
    pub(in crate::mass) principal: PrincipalAxes,
    pub(in crate::mass) error_bound: ErrorBound,
    pub(in crate::mass) provenance: Provenance,
}

impl RigidBody {
    /// From mass, tensor about the centre of mass C, and C.
    ///
    /// `rtol` admits tables printed to few digits: asymmetry and violations of the triangle inequality up to that
    /// fraction are accepted; zero admits rounding alone ([`ASYMMETRY`](crate::mass::validity::ASYMMETRY), [`ROUNDING`]).
    /// A principal moment below [`ROUNDING`] times the trace is stored as exactly zero, since a float64 tensor cannot
    /// tell it from zero.
    ///
    /// # Errors
    /// The law that fails, with its numbers.
    pub fn new(
        mass: f64,
        inertia: &Matrix3<f64>,
        center_of_mass: &Vector3<f64>,
        rtol: f64,
    ) -> Result<Self, Error> {
        check_mass(mass)?;
        all_finite_of_body("center_of_mass", center_of_mass)?;
        let inertia = symmetrized("inertia", inertia, rtol)?;
        Self::from_symmetric(mass, inertia, center_of_mass, trace(&inertia), rtol, false)
    }

    /// From mass, tensor about the origin O of the body frame, and the centre of mass C.
    ///
    /// `I_C = I_O − m (c² 1 − c cᵀ)`; what that difference leaves must be the tensor of a body.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::RigidBody;
    /// use polhode::nalgebra::{Matrix3, Vector3};
    ///
    /// let about_origin = Matrix3::from_diagonal(&Vector3::new(3.0, 3.0, 1.0));
    /// let body = RigidBody::from_inertia_about_origin(2.0, &about_origin, &Vector3::new(0.0, 0.0, 1.0), 0.0)?;
    /// assert_eq!(body.principal().moments, [1.0, 1.0, 1.0]); // 2 kg at 1 m less
    /// # Ok::<(), polhode::Error>(())
    /// ```
    ///
    /// # Errors
    /// The law that fails, with its numbers.
    pub fn from_inertia_about_origin(
        mass: f64,
        inertia_about_origin: &Matrix3<f64>,
        center_of_mass: &Vector3<f64>,
        rtol: f64,
    ) -> Result<Self, Error> {
        check_mass(mass)?;
        all_finite_of_body("center_of_mass", center_of_mass)?;
        let about_origin = symmetrized("inertia_about_origin", inertia_about_origin, rtol)?;
        let inertia = to_center_of_mass(&about_origin, mass, center_of_mass);
        let body = Self::from_symmetric(
            mass,
            inertia,
            center_of_mass,
            trace(&about_origin),
            rtol,
            true,
        )
        .map_err(|error| match error {
            Error::Body(BodyFault::NegativeMoment {
                moments,
                is_from_origin,
                ..
            }) => {
                let is_possible_as_given =
                    Self::new(mass, inertia_about_origin, center_of_mass, rtol).is_ok();
                Error::Body(BodyFault::NegativeMoment {
                    moments,
                    is_from_origin,
                    is_possible_as_given,
                })
            }
            other => other,
        })?;
        let rounding = (body.error_bound).rounded(&Vector3::zeros(), trace(&about_origin));
        Ok(body.with_bound(rounding))
    }

    /// From mass, principal moments about C (in any order), the axes they belong to (columns) and C.
    ///
    /// The moments are kept exactly as given.
    ///
    /// # Errors
    /// The law that fails, with its numbers; axes that are not a right-handed orthonormal set.
    pub fn from_principal(
        mass: f64,
        moments: &[f64; 3],
        axes: &Matrix3<f64>,
        center_of_mass: &Vector3<f64>,
        rtol: f64,
    ) -> Result<Self, Error> {
        check_mass(mass)?;
        all_finite_of_body("moments", moments)?;
        all_finite_of_body("center_of_mass", center_of_mass)?;
        check_rotation("axes", axes)?;
        check_rtol(rtol)?;
        let mut principal = sorted(moments, axes);
        check_moments(&principal.moments, 0.0, ROUNDING.max(rtol), false)?;
        // What was admitted as rounding below zero is zero.
        let below = (-principal.moments[0]).max(0.0);
        principal.moments = principal.moments.map(|moment| moment.max(0.0));
        let inertia = tensor(&principal);
        let repair = ErrorBound {
            inertia: below,
            ..ErrorBound::default()
        };
        Ok(Self {
            mass,
            center_of_mass: *center_of_mass,
            inertia,
            principal,
            error_bound: repair.rounded(&Vector3::zeros(), trace(&inertia)),
            provenance: Provenance {
                source: Source::PrincipalMoments,
                elements: 1,
                checks: Checks::FINITE.and(Checks::TENSOR),
                moments: MomentsFrom::Given,
                rounded_to_zero: moments.iter().map(|&moment| u8::from(moment < 0.0)).sum(),
                ..Provenance::default()
            },
        })
    }

    /// From matter: its second moment about its own centre of mass. What matter it is, the source of the second moment
    /// adds by [`Self::with_provenance`].
    ///
    /// # Errors
    /// When the mass is not positive or a number is not finite.
    pub fn from_second_moment(matter: &SecondMoment) -> Result<Self, Error> {
        Self::with_spectrum(matter, &eigen3(&matter.central))
    }

    /// As [`Self::from_second_moment`], with the spectral decomposition of its `central` already at hand.
    pub(in crate::mass) fn with_spectrum(
        matter: &SecondMoment,
        spectrum: &Eigen3,
    ) -> Result<Self, Error> {
        check_mass(matter.mass)?;
        all_finite_of_body("center_of_mass", &matter.center_of_mass)?;
        let inertia = matter.inertia();
        all_finite_of_body("inertia", &inertia)?;
        let spread = matter.central.trace();
        if spread > 0.0 && spread < f64::MIN_POSITIVE {
            return Err(BodyFault::OutOfRange {
                what: "sum of the second moments",
                mantissa: spread,
                exponent: 0,
            }
            .into());
        }
        Ok(Self {
            mass: matter.mass,
            center_of_mass: matter.center_of_mass,
            inertia,
            principal: matter.principal_axes(spectrum),
            error_bound: matter.error_bound,
            provenance: Provenance::of_matter(Source::SecondMoment, 1, Checks::FINITE),
        })
    }

    /// Whether the tensor is one of matter, which has no negative squares: surfaces that cross one another, or bytes that
    /// were damaged, may. What the bounds allow is rounding: half the trace less the tensor is off by 3/2 of the bound on its
    /// diagonal and 1 beside it, an eigenvalue of it by 7/2, and the deficit by twice that.
    pub(in crate::mass) fn check_possible(&self) -> Result<(), Error> {
        let moments = principal_axes(&self.inertia).moments;
        let [i1, i2, i3] = moments;
        let deficit = i3 - i2 - i1;
        let is_rounding = deficit <= 2e-12 * i3 + 7.0 * self.error_bound.inertia;
        if !is_rounding {
            return Err(BodyFault::TriangleInequality {
                moments,
                deficit,
                relative: deficit / (i1 + i2 + i3),
                is_given: false,
            }
            .into());
        }
        Ok(())
    }

    /// The tail of every constructor that starts from a tensor; `scale` is the trace its rounding is relative to.
    fn from_symmetric(
        mass: f64,
        inertia: Matrix3<f64>,
        center_of_mass: &Vector3<f64>,
        scale: f64,
        rtol: f64,
        is_from_origin: bool,
    ) -> Result<Self, Error> {
        all_finite_of_body("inertia", &inertia)?;
        // All that is rounding is relative to it; a trace beyond all numbers would admit anything.
        finite_of_body("the trace of inertia", scale)?;
        let principal = principal_axes(&inertia);
        finite_of_body(
            "the largest principal moment of inertia",
            principal.moments[2],
        )?;
        check_moments(
            &principal.moments,
            ROUNDING * scale,
            ROUNDING.max(rtol),
            is_from_origin,
        )?;
        let body = Self::admitted(mass, inertia, center_of_mass, principal, scale);
        all_finite_of_body("inertia", &body.inertia)?;
        Ok(body)
    }

    /// The body of a tensor that obeys the laws; moments that it cannot tell from zero are zero.
    pub(in crate::mass) fn admitted(
        mass: f64,
        inertia: Matrix3<f64>,
        center_of_mass: &Vector3<f64>,
        mut principal: PrincipalAxes,
        scale: f64,
    ) -> Self {
        // A table may be admitted with a moment below zero by more than rounding: then the tensor too is of the zero.
        // So it is where noise about the origin is all that is left about the centre.
        let own = trace(&inertia);
        let is_repaired = (principal.moments.iter())
            .any(|&moment| moment <= ROUNDING * scale && moment.abs() > ROUNDING * own);
        let rounded_to_zero = clear_noise(&mut principal, scale);
        let stored = if is_repaired {
            tensor(&principal)
        } else {
            inertia
        };
        Self {
            mass,
            center_of_mass: *center_of_mass,
            inertia: stored,
            principal,
            error_bound: ErrorBound {
                inertia: (stored - inertia).amax(),
                ..ErrorBound::default()
            },
            provenance: Provenance {
                source: Source::Tensor,
                elements: 1,
                checks: Checks::FINITE.and(Checks::TENSOR),
                rounded_to_zero,
                ..Provenance::default()
            },
        }
    }

    /// The same body, its numbers known as well as this.
    pub(in crate::mass) fn with_bound(self, error_bound: ErrorBound) -> Self {
        Self {
            error_bound,
            ..self
        }
    }

    /// The same body, its numbers from where this says.
    #[must_use]
    pub fn with_provenance(self, provenance: Provenance) -> Self {
        Self { provenance, ..self }
    }

    /// Mass m.
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// Centre of mass C, from the origin of the body frame.
    #[must_use]
    pub fn center_of_mass(&self) -> Vector3<f64> {
        self.center_of_mass
    }

    /// Inertia tensor `I_C` about the centre of mass.
    #[must_use]
    pub fn inertia(&self) -> Matrix3<f64> {
        self.inertia
    }

    /// Principal moments and axes about the centre of mass.
    #[must_use]
    pub fn principal(&self) -> PrincipalAxes {
        self.principal
    }

    /// What rounding can have done to mass, centre of mass and tensor, against exact arithmetic on what was given.
    #[must_use]
    pub fn error_bound(&self) -> ErrorBound {
        self.error_bound
    }

    /// What the body was made from, what was checked and what was changed on the way.
    #[must_use]
    pub fn provenance(&self) -> Provenance {
        self.provenance
    }
}

/// Moments in ascending order, each with its axis, under the sign rule; where moments are equal, the canonical axes.
fn sorted(moments: &[f64; 3], axes: &Matrix3<f64>) -> PrincipalAxes {
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| moments[i].total_cmp(&moments[j]));
    let [first, second, _] = order;
    let (u, v) = (
        axes.column(first).into_owned(),
        axes.column(second).into_owned(),
    );
    let principal = PrincipalAxes {
        moments: order.map(|k| moments[k] + 0.0), // no negative zero
        axes: with_sign_rule(Matrix3::from_columns(&[u, v, u.cross(&v)])),
    };
    // The moments are exact: any difference is one.
    canonical(&principal, 0.0)
}

/// Moments that a tensor with this trace cannot tell from zero, or that rounding has put below it, are zero; how many
/// were not.
pub(super) fn clear_noise(principal: &mut PrincipalAxes, trace: f64) -> u8 {
    let mut cleared = 0;
    for moment in &mut principal.moments {
        if *moment <= ROUNDING * trace {
            cleared += u8::from(*moment != 0.0);
            *moment = 0.0;
        }
    }
    cleared
}

/// `V diag(I) Vᵀ`, exactly symmetric; exactly diagonal where the axes are the coordinate axes.
pub(super) fn tensor(principal: &PrincipalAxes) -> Matrix3<f64> {
    let scaled = principal.axes * Matrix3::from_diagonal(&Vector3::from(principal.moments));
    mean_of_halves(&(scaled * principal.axes.transpose()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn diagonal(x: f64, y: f64, z: f64) -> Matrix3<f64> {
        Matrix3::from_diagonal(&Vector3::new(x, y, z))
    }

    #[test]
    fn triangle_inequality_is_relative_at_every_scale() {
        for scale in [1e-300, 1e-47, 1.0, 1e37, 1e300] {
            let body =
                |x, y, z| RigidBody::new(1.0, &(diagonal(x, y, z) * scale), &Vector3::zeros(), 0.0);
            assert!(body(1.0, 2.0, 3.0).is_ok());
            assert!(body(1.0, 1.0, 0.0).is_ok());
            let fault = body(1.0, 1.0, 2.0001).expect_err("impossible");
            assert!(
                matches!(fault, Error::Body(BodyFault::TriangleInequality { .. })),
                "{fault}"
            );
            assert!(matches!(
                body(1.0, 1.0, -1.0),
                Err(Error::Body(BodyFault::NegativeMoment { .. }))
            ));
        }
    }

    #[test]
    fn numbers_at_the_ends_of_float64() {
        let most = f64::MAX;
        let wild = Matrix3::new(-4.0, most, most, most, -most, 4.0, most, 4.0, -most);
        for tensor in [wild, diagonal(most, most, most)] {
            let fault = RigidBody::new(1.0, &tensor, &Vector3::zeros(), 0.0).expect_err("no trace");
            assert!(
                matches!(fault, Error::Body(BodyFault::NonFinite { .. })),
                "{fault}"
            );
        }
        let far = Vector3::new(1.0, -3e279, 4e279);
        let body = RigidBody::new(1.0, &diagonal(1.0, 1.0, 1.0), &far, 0.0).expect("far away");
        assert!(body.is_close(&body, 0.0, 0.0));
        let least = Matrix3::new(5.0, 1.0, -1.0, 1.0, 5.0, -1.0, -1.0, -1.0, 6.0) * 5e-323;
        let body = RigidBody::new(1.0, &least, &Vector3::zeros(), 0.0).expect("tiny");
        assert_eq!(RigidBody::from_array(&body.to_array()).as_ref(), Ok(&body));
    }

    #[test]
    fn moment_within_rounding_of_zero_is_stored_as_zero() {
        let body = RigidBody::new(1.0, &diagonal(-1e-16, 1.0, 1.0), &Vector3::zeros(), 0.0)
            .expect("rounding");
        assert_eq!(body.principal().moments[0], 0.0);
    }
}
