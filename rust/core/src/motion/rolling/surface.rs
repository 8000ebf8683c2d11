//! A convex surface in the body: where it touches a plane, and how it is curved there.

use nalgebra::{Matrix3, Unit, Vector3};

use super::{disk, ellipsoid, paraboloid, sphere, torus};
use crate::error::{Error, all_finite, finite};
use crate::motion::attitude::shortest_turn;
use crate::numerics::power_series::{Arithmetic, transformed};

/// How near the axis of a disk or torus may come to the normal of the plane, as the sine of the angle between them: nearer it lies
/// flat, and touches in more than a point.
const FLAT: f64 = 1e-6;

/// The shape of a surface in its own axes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    Sphere { radius: f64 },
    Ellipsoid { semi_axes: [f64; 3] },
    Disk { radius: f64 },
    Torus { radii: [f64; 2] },
    Paraboloid { radii: [f64; 2], apex: f64 },
}

/// A convex surface, fixed in the body.
///
/// Places are from the origin of the body frame, in body axes.
///
/// # Examples
///
/// ```
/// use polhode::motion::rolling::Surface;
/// use polhode::nalgebra::Vector3;
///
/// let egg = Surface::ellipsoid([1.0, 1.0, 2.0], Vector3::zeros(), None)?;
/// let up = Vector3::z(); // the normal of the plane, in body axes
/// assert_eq!(egg.contact(&up), Vector3::new(0.0, 0.0, -2.0));
/// // At the end of its long axis an ellipsoid of revolution has the curvature c/a².
/// assert_eq!(egg.curvatures(&up), [2.0, 2.0]);
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    shape: Shape,
    center: Vector3<f64>,
    /// Its own axes as columns, in body axes.
    axes: Matrix3<f64>,
}

impl Surface {
    /// Make a sphere.
    ///
    /// # Errors
    /// When the radius is not positive and finite, or the center not finite; so for all surfaces.
    pub fn sphere(radius: f64, center: Vector3<f64>) -> Result<Self, Error> {
        positive("radius", &[radius])?;
        Self::new(Shape::Sphere { radius }, center, Matrix3::identity())
    }

    /// Make an ellipsoid with its semi-axes along the columns of `axes`, or along x, y, z.
    ///
    /// # Errors
    /// As [`Self::sphere`]; when `axes` is no rotation.
    pub fn ellipsoid(
        semi_axes: [f64; 3],
        center: Vector3<f64>,
        axes: Option<Matrix3<f64>>,
    ) -> Result<Self, Error> {
        positive("semi_axes", &semi_axes)?;
        Self::new(Shape::Ellipsoid { semi_axes }, center, rotation(axes)?)
    }

    /// Make a disk, which touches with its sharp edge; a hoop is the same surface. `axis`: normal to the disk.
    ///
    /// # Errors
    /// As [`Self::sphere`]; when `axis` has no direction.
    pub fn disk(radius: f64, axis: Vector3<f64>, center: Vector3<f64>) -> Result<Self, Error> {
        positive("radius", &[radius])?;
        Self::new(Shape::Disk { radius }, center, axes_about(&axis)?)
    }

    /// Make a torus: circles of the minor radius, with their centres on one of the major radius about `axis`.
    ///
    /// # Errors
    /// As [`Self::disk`].
    pub fn torus(
        major_radius: f64,
        minor_radius: f64,
        axis: Vector3<f64>,
        center: Vector3<f64>,
    ) -> Result<Self, Error> {
        positive("major_radius", &[major_radius])?;
        positive("minor_radius", &[minor_radius])?;
        let radii = [major_radius, minor_radius];
        Self::new(Shape::Torus { radii }, center, axes_about(&axis)?)
    }

    /// Make the paraboloid `z = −apex + x²/(2 radii[0]) + y²/(2 radii[1])` below the plane z = 0, in the axes that are the columns of
    /// `axes`, or x, y, z.
    ///
    /// # Errors
    /// As [`Self::ellipsoid`].
    pub fn paraboloid(
        radii: [f64; 2],
        apex: f64,
        axes: Option<Matrix3<f64>>,
    ) -> Result<Self, Error> {
        positive("radii", &radii)?;
        positive("apex", &[apex])?;
        let shape = Shape::Paraboloid { radii, apex };
        Self::new(shape, Vector3::zeros(), rotation(axes)?)
    }

    fn new(shape: Shape, center: Vector3<f64>, axes: Matrix3<f64>) -> Result<Self, Error> {
        all_finite("center", &center)?;
        Ok(Self {
            shape,
            center,
            axes,
        })
    }

    /// Compute the point of contact with a plane. `normal`: the unit normal of the plane towards the body, in body axes.
    #[must_use]
    pub fn contact(&self, normal: &Vector3<f64>) -> Vector3<f64> {
        self.contact_and_rate((*normal).into(), [0.0; 3])[0].into()
    }

    /// Compute the rate of the point of contact in the body. `rate`: that of the normal, in body axes.
    #[must_use]
    pub fn contact_rate(&self, normal: &Vector3<f64>, rate: &Vector3<f64>) -> Vector3<f64> {
        self.contact_and_rate((*normal).into(), (*rate).into())[1].into()
    }

    /// Compute the principal curvatures at the point of contact, the smaller first. That across a sharp edge is infinite.
    #[must_use]
    pub fn curvatures(&self, normal: &Vector3<f64>) -> [f64; 2] {
        // dp = −H dγ; the eigenvalues of H across γ are the radii of curvature.
        let across = axes_of(&Unit::new_unchecked(*normal));
        let (one, other) = (across.column(0).into(), across.column(1).into());
        let (a, b) = (
            self.contact_rate(normal, &one),
            self.contact_rate(normal, &other),
        );
        let [xx, xy, yy] = [-a.dot(&one), -a.dot(&other), -b.dot(&other)];
        let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy).hypot(2.0 * xy));
        let largest = mean + half;
        // The smaller radius from the determinant, which cancels less; of a sharp edge it is rounding of zero.
        let smallest = (xx * yy - xy * xy) / largest;
        let is_edge = matches!(self.shape, Shape::Disk { .. });
        let sharpest = if is_edge {
            f64::INFINITY
        } else {
            1.0 / smallest
        };
        [1.0 / largest, sharpest]
    }

    /// Return the length that errors are relative to: about the radius of the surface.
    #[must_use]
    pub fn size(&self) -> f64 {
        match self.shape {
            Shape::Sphere { radius } | Shape::Disk { radius } => radius,
            Shape::Ellipsoid { semi_axes } => semi_axes.into_iter().fold(0.0, f64::max),
            Shape::Torus { radii } => radii[0] + radii[1],
            Shape::Paraboloid { radii, apex } => radii[0].max(radii[1]).max(apex),
        }
    }

    /// Return whether the surface is one of revolution, and its axis in body axes; of a sphere that from its centre to `from`.
    #[must_use]
    pub fn axis(&self, from: &Vector3<f64>) -> Option<Vector3<f64>> {
        let own = |i: usize| Vector3::from(self.axes.column(i));
        match self.shape {
            Shape::Sphere { .. } => {
                let offset = from - self.center;
                Some(offset.try_normalize(0.0).unwrap_or(own(2)))
            }
            Shape::Ellipsoid {
                semi_axes: [a, b, _],
            } if a == b => Some(own(2)),
            Shape::Ellipsoid {
                semi_axes: [_, b, c],
            } if b == c => Some(own(0)),
            Shape::Ellipsoid {
                semi_axes: [a, _, c],
            } if a == c => Some(own(1)),
            Shape::Disk { .. } | Shape::Torus { .. } => Some(own(2)),
            Shape::Paraboloid { radii: [a, b], .. } if a == b => Some(own(2)),
            Shape::Ellipsoid { .. } | Shape::Paraboloid { .. } => None,
        }
    }

    /// Return the third of its own axes, in body axes.
    pub(crate) fn own_axis(&self) -> Vector3<f64> {
        self.axes.column(2).into()
    }

    /// Return the center of the surface.
    #[must_use]
    pub fn center(&self) -> Vector3<f64> {
        self.center
    }

    /// Return the radius where the surface is a sphere.
    #[must_use]
    pub fn sphere_radius(&self) -> Option<f64> {
        match self.shape {
            Shape::Sphere { radius } => Some(radius),
            _ => None,
        }
    }

    /// Return the radius where the surface is a disk.
    #[must_use]
    pub fn disk_radius(&self) -> Option<f64> {
        match self.shape {
            Shape::Disk { radius } => Some(radius),
            _ => None,
        }
    }

    /// Compute how far the contact is from where it is no point of the surface any more: zero there, positive before. `normal`: as
    /// in [`Self::contact`].
    pub(crate) fn margin(&self, normal: &Vector3<f64>) -> f64 {
        let own = self.axes.transpose() * normal;
        match self.shape {
            Shape::Sphere { .. } | Shape::Ellipsoid { .. } => 1.0,
            Shape::Disk { .. } | Shape::Torus { .. } => own.x.hypot(own.y) - FLAT,
            Shape::Paraboloid { radii, apex } => {
                // Below the rim where x²/(2 r₁) + y²/(2 r₂) < h, with x = −r₁ γ₁/γ₃.
                let steep = radii[0] * own.x * own.x + radii[1] * own.y * own.y;
                own.z - (0.5 * steep / apex).sqrt()
            }
        }
    }

    /// Return by how much the margin changes with the normal, at most; zero where it is constant.
    pub(crate) fn margin_slope(&self) -> f64 {
        match self.shape {
            Shape::Sphere { .. } | Shape::Ellipsoid { .. } => 0.0,
            Shape::Disk { .. } | Shape::Torus { .. } => 1.0,
            Shape::Paraboloid { radii, apex } => 1.0 + (0.5 * radii[0].max(radii[1]) / apex).sqrt(),
        }
    }

    /// Return what is wrong where the margin is not positive.
    pub(crate) fn beyond_margin(&self) -> &'static str {
        match self.shape {
            Shape::Paraboloid { .. } => {
                "the paraboloid touches on its rim, where it ends: give it a larger apex, or another surface"
            }
            _ => {
                "the axis is along the normal of the plane: it lies flat, and the contact is no point; \
                 start it tilted, or end the run before"
            }
        }
    }

    /// Return the surface in other units and from another origin: places are `(p − origin)·factor`.
    pub(crate) fn relative_to(&self, origin: &Vector3<f64>, factor: f64) -> Self {
        let shape = match self.shape {
            Shape::Sphere { radius } => Shape::Sphere {
                radius: radius * factor,
            },
            Shape::Ellipsoid { semi_axes } => Shape::Ellipsoid {
                semi_axes: semi_axes.map(|a| a * factor),
            },
            Shape::Disk { radius } => Shape::Disk {
                radius: radius * factor,
            },
            Shape::Torus { radii } => Shape::Torus {
                radii: radii.map(|a| a * factor),
            },
            Shape::Paraboloid { radii, apex } => Shape::Paraboloid {
                radii: radii.map(|a| a * factor),
                apex: apex * factor,
            },
        };
        Self {
            shape,
            center: (self.center - origin) * factor,
            axes: self.axes,
        }
    }

    /// Compute the point of contact and its rate in the body, for any numbers.
    pub(crate) fn contact_and_rate<N: Arithmetic>(
        &self,
        normal: [N; 3],
        rate: [N; 3],
    ) -> [[N; 3]; 2] {
        let own = self.axes.transpose();
        let (normal, rate) = (transformed(&own, normal), transformed(&own, rate));
        let [point, change] = match &self.shape {
            Shape::Sphere { radius } => sphere::contact(*radius, normal, rate),
            Shape::Ellipsoid { semi_axes } => ellipsoid::contact(semi_axes, normal, rate),
            Shape::Disk { radius } => disk::contact(*radius, normal, rate),
            Shape::Torus { radii } => torus::contact(*radii, normal, rate),
            Shape::Paraboloid { radii, apex } => paraboloid::contact(radii, *apex, normal, rate),
        };
        let point = transformed(&self.axes, point);
        let center = &self.center;
        [
            [
                point[0] + center.x,
                point[1] + center.y,
                point[2] + center.z,
            ],
            transformed(&self.axes, change),
        ]
    }
}

fn positive(what: &'static str, lengths: &[f64]) -> Result<(), Error> {
    for &length in lengths {
        finite(what, length)?;
        if length <= 0.0 {
            return Err(Error::OutOfDomain {
                what,
                law: "a positive length",
                value: length,
            });
        }
    }
    Ok(())
}

/// Return the axes given, which must be orthonormal and right-handed.
fn rotation(axes: Option<Matrix3<f64>>) -> Result<Matrix3<f64>, Error> {
    let Some(axes) = axes else {
        return Ok(Matrix3::identity());
    };
    all_finite("axes", &axes)?;
    let off = (axes.transpose() * axes - Matrix3::identity()).abs().max();
    if off > 1e-12 || axes.determinant() < 0.0 {
        return Err(Error::OutOfDomain {
            what: "axes",
            law: "a rotation matrix whose columns are the axes of the surface, AᵀA = 1 to 1e-12 and det A = 1; \
                  the number is the largest element of AᵀA − 1",
            value: off,
        });
    }
    Ok(axes)
}

/// Return axes whose third is along `axis`.
fn axes_about(axis: &Vector3<f64>) -> Result<Matrix3<f64>, Error> {
    all_finite("axis", axis)?;
    match Unit::try_new(*axis, 0.0) {
        Some(axis) => Ok(axes_of(&axis)),
        None => Err(Error::OutOfDomain {
            what: "axis",
            law: "a vector that has a direction",
            value: axis.norm(),
        }),
    }
}

/// Return the identity turned on the shortest way so that its third axis is `axis`.
pub(super) fn axes_of(axis: &Unit<Vector3<f64>>) -> Matrix3<f64> {
    match shortest_turn(&Vector3::z(), axis) {
        Some(turn) => turn.to_rotation_matrix().into_inner(),
        None => Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, -1.0)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surfaces() -> Vec<Surface> {
        let (center, axis) = (Vector3::new(0.1, -0.2, 0.3), Vector3::new(1.0, 2.0, 2.0));
        let turned = axes_of(&Unit::new_normalize(Vector3::new(0.3, -0.1, 1.0)));
        [
            Surface::sphere(1.5, center),
            Surface::ellipsoid([1.0, 2.0, 3.0], center, Some(turned)),
            Surface::disk(0.7, axis, center),
            Surface::torus(0.7, 0.2, axis, center),
            Surface::paraboloid([0.5, 0.8], 2.0, Some(turned)),
        ]
        .map(|surface| surface.expect("a surface"))
        .to_vec()
    }

    /// The support function `h(γ) = γ·p` has the gradient p, and the rate is across γ: the contact slides along the surface.
    #[test]
    fn contacts_are_gradients_of_the_support_function() {
        let normal = Vector3::new(0.2, -0.3, 0.9).normalize();
        for surface in surfaces() {
            let point = surface.contact(&normal);
            for i in 0..3 {
                let mut step = Vector3::zeros();
                step[i] = 1e-5;
                let support = |normal: Vector3<f64>| {
                    let unit = normal.normalize();
                    surface.contact(&unit).dot(&unit) * normal.norm()
                };
                let slope = (support(normal + step) - support(normal - step)) / 2e-5;
                assert!((slope - point[i]).abs() < 1e-8, "{surface:?}");
            }
            let rate = normal.cross(&Vector3::new(0.5, 0.1, -0.7));
            let ahead = surface.contact(&(normal + rate * 1e-6).normalize());
            let behind = surface.contact(&(normal - rate * 1e-6).normalize());
            let found = surface.contact_rate(&normal, &rate);
            assert!(
                ((ahead - behind) / 2e-6 - found).norm() < 1e-8,
                "{surface:?}"
            );
            assert!(found.dot(&normal).abs() < 1e-15);
        }
    }

    #[test]
    fn curvatures_of_the_textbook() {
        let up = Vector3::z();
        let near = |found: [f64; 2], exact: [f64; 2]| {
            assert!((found[0] - exact[0]).abs() < 1e-14 && (found[1] - exact[1]).abs() < 1e-14);
        };
        let zero = Vector3::zeros();
        let surface = Surface::ellipsoid([1.0, 2.0, 4.0], zero, None).expect("an ellipsoid");
        near(surface.curvatures(&up), [1.0, 4.0]); // c/b², c/a²
        let surface = Surface::paraboloid([0.5, 0.25], 1.0, None).expect("a paraboloid");
        near(surface.curvatures(&up), [2.0, 4.0]);
        // Beside its rim a torus has the curvatures 1/minor and sin θ/(major + minor sin θ), by Meusnier.
        let surface = Surface::torus(0.7, 0.2, up, zero).expect("a torus");
        let (sin, cos) = 0.4_f64.sin_cos();
        let tilted = Vector3::new(sin, 0.0, cos);
        near(surface.curvatures(&tilted), [sin / (0.7 + 0.2 * sin), 5.0]);
        let surface = Surface::disk(0.7, up, zero).expect("a disk");
        let [along, across] = surface.curvatures(&tilted);
        assert!((along - sin / 0.7).abs() < 1e-14 && across == f64::INFINITY);
    }

    #[test]
    fn margins_end_where_the_surface_does() {
        let surface = Surface::paraboloid([0.5, 0.8], 2.0, None).expect("a paraboloid");
        // On the rim: x = √(2 r₁ h), with the slope x/r₁.
        let x = 2.0_f64.sqrt();
        for (factor, sign) in [(0.999, 1.0), (1.001, -1.0)] {
            let normal = Vector3::new(-factor * x / 0.5, 0.0, 1.0).normalize();
            assert_eq!(surface.margin(&normal).signum(), sign);
        }
        assert!(surface.margin(&-Vector3::z()) < 0.0);
        let disk = Surface::disk(1.0, Vector3::z(), Vector3::zeros()).expect("a disk");
        assert!(disk.margin(&Vector3::z()) < 0.0 && disk.margin(&Vector3::x()) > 0.9);
    }

    #[test]
    fn what_is_no_surface_is_refused() {
        let zero = Vector3::zeros();
        assert!(Surface::sphere(-1.0, zero).is_err() && Surface::sphere(f64::NAN, zero).is_err());
        assert!(Surface::disk(1.0, zero, zero).is_err());
        assert!(Surface::ellipsoid([1.0; 3], zero, Some(Matrix3::identity() * 1.1)).is_err());
        assert!(Surface::ellipsoid([1.0; 3], zero, Some(-Matrix3::identity())).is_err());
        assert!(Surface::paraboloid([1.0, 0.0], 1.0, None).is_err());
    }
}
