//! The rigid body (m, C, `I_C`): what makes one possible, how bodies add, how they change frames.

use nalgebra::{Matrix3, Vector3};

use super::error_bound::ErrorBound;
use super::parallel_axis::{from_center_of_mass, to_center_of_mass};
use super::provenance::{Checks, MomentsFrom, Provenance, Source};
use super::second_moment::SecondMoment;
use super::validity::{
    ROUNDING, check_mass, check_moments, check_rotation, check_rtol, mean_of_halves, symmetrized,
    trace,
};
use crate::error::{Error, all_finite, finite};
use crate::numerics::eigen3::{Eigen3, eigen3};
use crate::numerics::power_of_two::{length, times_dot};
use crate::principal::{PrincipalAxes, TOP_RTOL, principal_axes, rounding_rtols, with_sign_rule};

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
    pub(super) mass: f64,
    pub(super) center_of_mass: Vector3<f64>,
    pub(super) inertia: Matrix3<f64>,
    pub(super) principal: PrincipalAxes,
    pub(super) error_bound: ErrorBound,
    pub(super) provenance: Provenance,
}

/// The same mass, centre, tensor, moments and axes; how well they are known and whence does not matter.
impl PartialEq for RigidBody {
    fn eq(&self, other: &Self) -> bool {
        self.mass == other.mass
            && self.center_of_mass == other.center_of_mass
            && self.inertia == other.inertia
            && self.principal == other.principal
    }
}

impl RigidBody {
    /// From mass, tensor about the centre of mass C, and C.
    ///
    /// `rtol` admits tables printed to few digits: asymmetry and violations of the triangle inequality up to that
    /// fraction are accepted; zero admits rounding alone ([`ASYMMETRY`](super::validity::ASYMMETRY), [`ROUNDING`]).
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
        all_finite("center_of_mass", center_of_mass)?;
        let inertia = symmetrized("inertia", inertia, rtol)?;
        let body = Self::from_symmetric(mass, inertia, center_of_mass, trace(&inertia), rtol, "")?;
        Ok(body.with_bound(ErrorBound::default()))
    }

    /// From mass, tensor about the origin O of the body frame, and the centre of mass C.
    ///
    /// `I_C = I_O − m (c² 1 − c cᵀ)`; what that difference leaves must be the tensor of a body.
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
        all_finite("center_of_mass", center_of_mass)?;
        let about_origin = symmetrized("inertia_about_origin", inertia_about_origin, rtol)?;
        let inertia = to_center_of_mass(&about_origin, mass, center_of_mass);
        let hint = "; inertia_about_origin= must be about the origin of the body frame: \
                    if it is about the centre of mass pass it as inertia=";
        let body = Self::from_symmetric(
            mass,
            inertia,
            center_of_mass,
            trace(&about_origin),
            rtol,
            hint,
        )?;
        let rounding = ErrorBound::default().rounded(&Vector3::zeros(), trace(&about_origin));
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
        all_finite("moments", moments)?;
        all_finite("center_of_mass", center_of_mass)?;
        check_rotation("axes", axes)?;
        check_rtol(rtol)?;
        let mut principal = sorted(moments, axes);
        check_moments(&principal.moments, 0.0, ROUNDING.max(rtol), "")?;
        // What was admitted as rounding below zero is zero.
        principal.moments = principal.moments.map(|moment| moment.max(0.0));
        let inertia = tensor(&principal);
        Ok(Self {
            mass,
            center_of_mass: *center_of_mass,
            inertia,
            principal,
            error_bound: ErrorBound::default().rounded(&Vector3::zeros(), trace(&inertia)),
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
    pub(super) fn with_spectrum(matter: &SecondMoment, spectrum: &Eigen3) -> Result<Self, Error> {
        check_mass(matter.mass)?;
        all_finite("center_of_mass", &matter.center_of_mass)?;
        let inertia = matter.inertia();
        all_finite("inertia", &inertia)?;
        let spread = matter.central.trace();
        if spread > 0.0 && spread < f64::MIN_POSITIVE {
            return Err(Error::OutOfRange {
                what: "sum of the second moments",
                mantissa: spread,
                exponent: 0,
            });
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
    pub(super) fn check_possible(&self) -> Result<(), Error> {
        let moments = principal_axes(&self.inertia).moments;
        let [i1, i2, i3] = moments;
        let deficit = i3 - i2 - i1;
        let is_rounding = deficit <= 2e-12 * i3 + 7.0 * self.error_bound.inertia;
        if !is_rounding {
            return Err(Error::TriangleInequality {
                moments,
                deficit,
                relative: deficit / (i1 + i2 + i3),
            });
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
        hint: &'static str,
    ) -> Result<Self, Error> {
        all_finite("inertia", &inertia)?;
        // All that is rounding is relative to it; a trace beyond all numbers would admit anything.
        finite("the trace of inertia", scale)?;
        let principal = principal_axes(&inertia);
        finite(
            "the largest principal moment of inertia",
            principal.moments[2],
        )?;
        check_moments(
            &principal.moments,
            ROUNDING * scale,
            ROUNDING.max(rtol),
            hint,
        )?;
        let body = Self::admitted(mass, inertia, center_of_mass, principal, scale);
        all_finite("inertia", &body.inertia)?;
        Ok(body)
    }

    /// The body of a tensor that obeys the laws; moments that it cannot tell from zero are zero.
    pub(super) fn admitted(
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
        Self {
            mass,
            center_of_mass: *center_of_mass,
            inertia: if is_repaired {
                tensor(&principal)
            } else {
                inertia
            },
            principal,
            error_bound: ErrorBound::default(),
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
    pub(super) fn with_bound(self, error_bound: ErrorBound) -> Self {
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

    /// Inertia tensor `I_P` about the point P (from the origin of the body frame).
    #[must_use]
    pub fn inertia_about(&self, point: &Vector3<f64>) -> Matrix3<f64> {
        from_center_of_mass(&self.inertia, self.mass, &(point - self.center_of_mass))
    }

    /// Principal moments and axes about the point P.
    #[must_use]
    pub fn principal_about(&self, point: &Vector3<f64>) -> PrincipalAxes {
        if *point == self.center_of_mass {
            return self.principal;
        }
        let inertia = self.inertia_about(point);
        let mut about = principal_axes(&inertia);
        clear_noise(&mut about, trace(&inertia));
        about
    }

    /// How close moments of this body, about any point, must be to be equal as far as its numbers tell, relative to the
    /// largest: for I₁ = 0, I₁ = I₂ and I₂ = I₃. [`TOP_RTOL`], and more where it is of particles whose coordinates were
    /// rounded by as much as its provenance says.
    #[must_use]
    pub fn top_rtols(&self, moments: &[f64; 3]) -> [f64; 3] {
        rounding_rtols(self.mass, moments, self.provenance.rounding).map(|rtol| rtol.max(TOP_RTOL))
    }

    /// Moment of inertia about the axis through P with direction `axis`: `n·I_P·n`, n the unit vector along `axis`.
    ///
    /// # Errors
    /// When `axis` is zero or not finite, or the moment is beyond all numbers.
    pub fn moment_about(&self, axis: &Vector3<f64>, point: &Vector3<f64>) -> Result<f64, Error> {
        all_finite("axis", axis)?;
        let longest = axis.amax();
        if longest == 0.0 {
            return Err(Error::NoDirection { what: "axis" });
        }
        // Divided by n·n at the end, rather than normalized first, which would round the direction.
        let n = axis / longest;
        let (w, lever) = (
            self.principal.axes.tr_mul(&n),
            n.cross(&(point - self.center_of_mass)),
        );
        let [i1, i2, i3] = self.principal.moments;
        let central = i1 * w.x * w.x + i2 * w.y * w.y + i3 * w.z * w.z;
        let moment = (central + times_dot(self.mass, &lever, &lever)) / n.dot(&n);
        finite("the moment of inertia about the axis", moment)
    }

    /// Radii of gyration `√(I_k / m)` about the principal axes through C, ascending.
    #[must_use]
    pub fn radii_of_gyration(&self) -> [f64; 3] {
        self.principal
            .moments
            .map(|moment| root_of_ratio(moment, self.mass))
    }

    /// All that a body is, as numbers: mass, C, the upper triangle of `I_C` by rows, moments, axes by rows, bounds,
    /// provenance.
    #[must_use]
    pub fn to_array(&self) -> [f64; 34] {
        let (c, i) = (&self.center_of_mass, &self.inertia);
        let mut numbers = [0.0; 34];
        numbers[0] = self.mass;
        numbers[1..4].copy_from_slice(c.as_slice());
        numbers[4..10].copy_from_slice(&[i.m11, i.m12, i.m13, i.m22, i.m23, i.m33]);
        numbers[10..13].copy_from_slice(&self.principal.moments);
        numbers[13..22].copy_from_slice(self.principal.axes.transpose().as_slice());
        let bound = &self.error_bound;
        numbers[22..25].copy_from_slice(&[bound.mass, bound.center_of_mass, bound.inertia]);
        numbers[25..].copy_from_slice(&self.provenance.to_array());
        numbers
    }

    /// The body that [`Self::to_array`] took apart, the same to the last bit.
    ///
    /// # Errors
    /// When the numbers are not those of a body: moments, axes and tensor must agree.
    pub fn from_array(numbers: &[f64; 34]) -> Result<Self, Error> {
        let [mass, x, y, z, xx, xy, xz, yy, yz, zz, i1, i2, i3, ..] = *numbers;
        let moments = [i1, i2, i3];
        let axes = Matrix3::from_row_slice(&numbers[13..22]);
        let error_bound = ErrorBound {
            mass: numbers[22],
            center_of_mass: numbers[23],
            inertia: numbers[24],
        };
        let provenance = Provenance::from_array(&std::array::from_fn(|k| numbers[25 + k]));
        let inertia = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let center_of_mass = Vector3::new(x, y, z);
        check_mass(mass)?;
        all_finite("center_of_mass", &center_of_mass)?;
        all_finite("moments", &moments)?;
        all_finite("inertia", &inertia)?;
        check_rotation("axes", &axes)?;
        let principal = PrincipalAxes { moments, axes };
        let difference = (inertia - tensor(&principal)).abs().max();
        // The least numbers of float64 have few digits.
        let rounding = 1e-12 * trace(&inertia)
            + f64::MIN_POSITIVE * 64.0 * f64::EPSILON
            + 6.0 * error_bound.inertia.max(0.0);
        let is_ordered = i1 <= i2 && i2 <= i3;
        let may_be_negative = provenance.checks.contains(Checks::UNCHECKED);
        if difference > rounding || !is_ordered || !(i1 >= 0.0 || may_be_negative) {
            let law = "that of the ascending principal moments and the axes stored beside it";
            return Err(Error::OutOfDomain {
                what: "inertia",
                law,
                value: difference,
            });
        }
        // What a second moment gave obeys the law but for rounding, if it was checked; a tensor that was given, alone or as a part,
        // may have been admitted as it is.
        let is_summed = matches!(
            provenance.moments,
            MomentsFrom::SecondMoment | MomentsFrom::OwnAxes
        );
        let may_break = [Checks::UNCHECKED, Checks::TENSOR];
        if is_summed && !(may_break.into_iter()).any(|check| provenance.checks.contains(check)) {
            check_moments(&moments, 2.0 * error_bound.inertia.max(0.0), 1e-12, "")?;
        }
        for (what, value) in [
            ("error_bound.mass", error_bound.mass),
            ("error_bound.center_of_mass", error_bound.center_of_mass),
            ("error_bound.inertia", error_bound.inertia),
        ] {
            if value.is_nan() || value < 0.0 {
                let law = "zero or more";
                return Err(Error::OutOfDomain { what, law, value });
            }
        }
        Ok(Self {
            mass,
            center_of_mass,
            inertia,
            principal,
            error_bound,
            provenance,
        })
    }

    /// Whether the two agree: mass to `rtol` of itself, the tensor to `rtol` of its largest element, the centre of mass
    /// to `rtol` of its distance from the origin or of the radius of gyration, whichever is larger; each `+ atol`.
    #[must_use]
    pub fn is_close(&self, other: &Self, rtol: f64, atol: f64) -> bool {
        // The trace may be beyond all numbers, and so may the distance.
        let gyration = 2.0 * root_of_ratio(trace(&(other.inertia * 0.25)), other.mass);
        let size = gyration.max(length(&other.center_of_mass)).min(f64::MAX);
        (self.mass - other.mass).abs() <= atol + rtol * other.mass
            && length(&(self.center_of_mass - other.center_of_mass)) <= atol + rtol * size
            && (self.inertia - other.inertia).abs().max() <= atol + rtol * other.inertia.abs().max()
    }
}

/// `√(a/b)`, where a/b may be beyond all numbers too.
pub(super) fn root_of_ratio(a: f64, b: f64) -> f64 {
    let ratio = a / b;
    if ratio.is_normal() || a == 0.0 {
        ratio.sqrt()
    } else {
        a.sqrt() / b.sqrt()
    }
}

/// Moments in ascending order, each with its axis, under the sign rule.
fn sorted(moments: &[f64; 3], axes: &Matrix3<f64>) -> PrincipalAxes {
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| moments[i].total_cmp(&moments[j]));
    let [first, second, _] = order;
    let (u, v) = (
        axes.column(first).into_owned(),
        axes.column(second).into_owned(),
    );
    PrincipalAxes {
        moments: order.map(|k| moments[k] + 0.0), // no negative zero
        axes: with_sign_rule(Matrix3::from_columns(&[u, v, u.cross(&v)])),
    }
}

/// Moments that a tensor with this trace cannot tell from zero, or that rounding has put below it, are zero; how many
/// were not.
fn clear_noise(principal: &mut PrincipalAxes, trace: f64) -> u8 {
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
fn tensor(principal: &PrincipalAxes) -> Matrix3<f64> {
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
            assert!(matches!(fault, Error::TriangleInequality { .. }), "{fault}");
            assert!(matches!(
                body(1.0, 1.0, -1.0),
                Err(Error::NegativeMoment { .. })
            ));
        }
    }

    #[test]
    fn radii_of_what_is_very_heavy_and_light() {
        for (mass, moment, radius) in [
            (1e-200, 1e200, 1e200),
            (1e200, 1e-200, 1e-200),
            (2.0, 8.0, 2.0),
        ] {
            let body = RigidBody::new(
                mass,
                &diagonal(moment, moment, moment),
                &Vector3::zeros(),
                0.0,
            );
            let [found, ..] = body.expect("body").radii_of_gyration();
            assert!((found / radius - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn numbers_at_the_ends_of_float64() {
        let most = f64::MAX;
        let wild = Matrix3::new(-4.0, most, most, most, -most, 4.0, most, 4.0, -most);
        for tensor in [wild, diagonal(most, most, most)] {
            let fault = RigidBody::new(1.0, &tensor, &Vector3::zeros(), 0.0).expect_err("no trace");
            assert!(matches!(fault, Error::NonFinite { .. }), "{fault}");
        }
        let far = Vector3::new(1.0, -3e279, 4e279);
        let body = RigidBody::new(1.0, &diagonal(1.0, 1.0, 1.0), &far, 0.0).expect("far away");
        assert!(body.is_close(&body, 0.0, 0.0));
        let least = Matrix3::new(5.0, 1.0, -1.0, 1.0, 5.0, -1.0, -1.0, -1.0, 6.0) * 5e-323;
        let body = RigidBody::new(1.0, &least, &Vector3::zeros(), 0.0).expect("tiny");
        assert_eq!(RigidBody::from_array(&body.to_array()).as_ref(), Ok(&body));
    }

    #[test]
    fn negative_bounds_are_no_bounds() {
        let body = RigidBody::new(1.0, &diagonal(1.0, 1.0, 1.0), &Vector3::zeros(), 0.0);
        let mut numbers = body.expect("body").to_array();
        for (place, value) in [(22, -1.0), (23, f64::NAN), (24, -0.5)] {
            let before = std::mem::replace(&mut numbers[place], value);
            let read = RigidBody::from_array(&numbers);
            assert!(matches!(read, Err(Error::OutOfDomain { .. })), "{read:?}");
            numbers[place] = before;
        }
    }

    #[test]
    fn moment_within_rounding_of_zero_is_stored_as_zero() {
        let body = RigidBody::new(1.0, &diagonal(-1e-16, 1.0, 1.0), &Vector3::zeros(), 0.0)
            .expect("rounding");
        assert_eq!(body.principal().moments[0], 0.0);
    }
}
