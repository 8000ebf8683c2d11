//! The rigid body (m, C, `I_C`).

use nalgebra::{Matrix3, Vector3};

use super::error_bound::ErrorBound;
use super::parallel_axis::{from_center_of_mass, to_center_of_mass};
use super::provenance::{BodySource, Checks, MomentsFrom, Provenance};
use super::second_moment::SecondMoment;
use super::validity::{
    ROUNDING, check_mass, check_moments, check_rotation, mean_of_halves, symmetrize, trace,
};
use crate::error::{
    BodyFault, Error, all_finite, all_finite_of_body, check_rtol, finite, finite_of_body,
};
use crate::numerics::eigen3::{Eigen3, eigen3};
use crate::numerics::power_of_two::{length, root_of_ratio, times_dot};
use crate::principal::{
    PrincipalAxes, TOP_RTOL, canonical, canonical_to_rounding, principal_axes, rounding_rtols,
    with_sign_rule,
};

// The rigid body (m, C, `I_C`), and what makes one possible.

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
        let inertia = symmetrize("inertia", inertia, rtol)?;
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
        let about_origin = symmetrize("inertia_about_origin", inertia_about_origin, rtol)?;
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
        let mut principal = sort_moments(moments, axes);
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
                source: BodySource::PrincipalMoments,
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
            provenance: Provenance::of_matter(BodySource::SecondMoment, 1, Checks::FINITE),
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
        let principal = canonical_to_rounding(&principal_axes(&inertia));
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
        let body = Self::admit(mass, inertia, center_of_mass, principal, scale);
        all_finite_of_body("inertia", &body.inertia)?;
        Ok(body)
    }

    /// The body of a tensor that obeys the laws; moments that it cannot tell from zero are zero.
    pub(in crate::mass) fn admit(
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
                source: BodySource::Tensor,
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
fn sort_moments(moments: &[f64; 3], axes: &Matrix3<f64>) -> PrincipalAxes {
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

// Moments of inertia of a body about points and axes.

impl RigidBody {
    /// Inertia tensor `I_P` about the point P (from the origin of the body frame).
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, solids};
    /// use polhode::nalgebra::Vector3;
    ///
    /// let rod = solids::cuboid(&[0.0, 0.0, 6.0], Amount::Mass(1.0))?;
    /// let end = Vector3::new(0.0, 0.0, 3.0);
    /// assert!((rod.inertia_about(&end)[(0, 0)] - 12.0).abs() < 1e-14); // m l²/3
    /// # Ok::<(), polhode::Error>(())
    /// ```
    #[must_use]
    pub fn inertia_about(&self, point: &Vector3<f64>) -> Matrix3<f64> {
        from_center_of_mass(&self.inertia, self.mass, &(point - self.center_of_mass))
    }

    /// Whether float64 holds the inertia tensor about the point P (from the origin of the body frame): `m d²` may not.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, solids};
    /// use polhode::nalgebra::Vector3;
    ///
    /// let ball = solids::sphere(1.0, Amount::Mass(5.0))?;
    /// assert!(ball.check_about(&Vector3::new(1e100, 0.0, 0.0)).is_ok());
    /// assert!(ball.check_about(&Vector3::new(1e200, 0.0, 0.0)).is_err()); // m d² is beyond float64
    /// # Ok::<(), polhode::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::NonFinite`], with the moment that is not finite.
    pub fn check_about(&self, point: &Vector3<f64>) -> Result<(), Error> {
        if point.iter().any(|x| !x.is_finite()) {
            return Ok(()); // it is for who takes points to say so
        }
        let moments = self.inertia_about(point).diagonal();
        finite("the moment of inertia about this point", moments.max()).map(|_| ())
    }

    /// Principal moments and axes about the point P.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, solids};
    /// use polhode::nalgebra::Vector3;
    ///
    /// let ball = solids::sphere(1.0, Amount::Mass(5.0))?;
    /// let about = ball.principal_about(&Vector3::new(1.0, 0.0, 0.0));
    /// assert!((about.moments[2] - 7.0).abs() < 1e-14); // 2/5 m r² + m r²
    /// # Ok::<(), polhode::Error>(())
    /// ```
    #[must_use]
    pub fn principal_about(&self, point: &Vector3<f64>) -> PrincipalAxes {
        if *point == self.center_of_mass {
            return self.principal;
        }
        let inertia = self.inertia_about(point);
        let mut about = canonical_to_rounding(&principal_axes(&inertia));
        clear_noise(&mut about, trace(&inertia));
        about
    }

    /// How close moments of this body, about any point, must be to be equal as far as its numbers tell, relative to the
    /// largest: for I₁ = 0, I₁ = I₂ and I₂ = I₃. [`TOP_RTOL`], and more where it is of particles whose coordinates were
    /// rounded by as much as its provenance says.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, Provenance, solids};
    /// use polhode::principal::{Top, classify_within};
    ///
    /// // Atoms of a file that prints three decimals: their moments differ by that rounding.
    /// let body = solids::ellipsoid(&[1.0, 1.0001, 3.0], Amount::Mass(1.0))?;
    /// let provenance = Provenance { rounding: 0.5e-3, ..Provenance::of_particles(4) };
    /// let read = body.with_provenance(provenance);
    /// let moments = read.principal().moments;
    /// let classified = |body: polhode::RigidBody| classify_within(&moments, &body.top_rtols(&moments));
    /// assert_eq!(classified(read), Top::Prolate);
    /// assert_eq!(classified(body), Top::Asymmetric);
    /// # Ok::<(), polhode::Error>(())
    /// ```
    #[must_use]
    pub fn top_rtols(&self, moments: &[f64; 3]) -> [f64; 3] {
        rounding_rtols(self.mass, moments, self.provenance.rounding).map(|rtol| rtol.max(TOP_RTOL))
    }

    /// Moment of inertia about the axis through P with direction `axis`: `n·I_P·n`, n the unit vector along `axis`.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, solids};
    /// use polhode::nalgebra::Vector3;
    ///
    /// let ball = solids::sphere(1.0, Amount::Mass(5.0))?;
    /// let (axis, touched) = (Vector3::new(1.0, 1.0, 0.0), Vector3::new(0.0, 0.0, -1.0));
    /// assert!((ball.moment_about(&axis, &touched)? - 7.0).abs() < 1e-14);
    /// # Ok::<(), polhode::Error>(())
    /// ```
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
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, solids};
    ///
    /// let ring = solids::tube(2.0, 2.0, 0.0, Amount::Mass(3.0))?;
    /// assert!((ring.radii_of_gyration()[2] - 2.0).abs() < 1e-14); // √(I/m)
    /// # Ok::<(), polhode::Error>(())
    /// ```
    #[must_use]
    pub fn radii_of_gyration(&self) -> [f64; 3] {
        self.principal
            .moments
            .map(|moment| root_of_ratio(moment, self.mass))
    }
}

// When two bodies are the same, and when nearly.

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
    /// Whether the two agree: mass to `rtol` of itself, the tensor to `rtol` of its largest element, the centre of mass
    /// to `rtol` of its distance from the origin or of the radius of gyration, whichever is larger; each `+ atol`.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, solids};
    ///
    /// let (a, b) = (solids::cube(1.0, Amount::Mass(1.0))?, solids::cube(1.001, Amount::Mass(1.0))?);
    /// assert!(a.is_close(&b, 1e-2, 0.0) && !a.is_close(&b, 1e-6, 0.0));
    /// # Ok::<(), polhode::Error>(())
    /// ```
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

// A body as numbers, and the body of such numbers again: what pickles and files hold.

impl RigidBody {
    /// All that a body is, as numbers: mass, C, the upper triangle of `I_C` by rows, moments, axes by rows, bounds,
    /// provenance.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, solids};
    /// use polhode::RigidBody;
    ///
    /// let ball = solids::sphere(1.0, Amount::Mass(3.0))?;
    /// let mut numbers = ball.to_array();
    /// assert_eq!(RigidBody::from_array(&numbers)?.to_array(), numbers);
    /// numbers[4] *= 2.0; // a tensor that its moments contradict
    /// assert!(RigidBody::from_array(&numbers).is_err());
    /// # Ok::<(), polhode::Error>(())
    /// ```
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
        all_finite_of_body("center_of_mass", &center_of_mass)?;
        all_finite_of_body("moments", &moments)?;
        all_finite_of_body("inertia", &inertia)?;
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
            check_moments(&moments, 2.0 * error_bound.inertia.max(0.0), 1e-12, false)?;
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
    fn moments_beyond_all_numbers_are_told() {
        let at = |z: f64| {
            let center = Vector3::new(0.0, 0.0, z);
            RigidBody::from_principal(1.0, &[1.0, 1.0, 2.0], &Matrix3::identity(), &center, 0.0)
                .and_then(|body| body.check_about(&Vector3::zeros()))
        };
        assert_eq!(at(1e154), Ok(()));
        assert!(
            matches!(at(1.4e154), Err(Error::NonFinite { value, .. }) if value == f64::INFINITY)
        );
    }

    /// A point that is no point is for its reader to refuse, by its name.
    #[test]
    fn the_moment_is_not_blamed_for_the_point() {
        let ball = RigidBody::new(1.0, &Matrix3::identity(), &Vector3::zeros(), 0.0).expect("body");
        for x in [f64::NAN, f64::INFINITY] {
            assert_eq!(ball.check_about(&Vector3::new(0.0, x, 0.0)), Ok(()));
        }
    }

    #[test]
    fn negative_bounds_are_no_bounds() {
        let body = RigidBody::new(1.0, &Matrix3::identity(), &Vector3::zeros(), 0.0);
        let mut numbers = body.expect("body").to_array();
        for (place, value) in [(22, -1.0), (23, f64::NAN), (24, -0.5)] {
            let before = std::mem::replace(&mut numbers[place], value);
            let read = RigidBody::from_array(&numbers);
            assert!(matches!(read, Err(Error::OutOfDomain { .. })), "{read:?}");
            numbers[place] = before;
        }
    }
}
