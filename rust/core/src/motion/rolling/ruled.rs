//! A cylinder or a cone: a surface of straight lines, which touches a plane along one of them.

use nalgebra::{Unit, Vector3};

use crate::error::{Error, all_finite, finite};

/// Which of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Cylinder,
    Cone,
}

/// A cylinder or a cone, fixed in the body.
///
/// # Examples
///
/// ```
/// use polhode::motion::rolling::RuledSurface;
/// use polhode::nalgebra::Vector3;
///
/// let (axis, center) = (Vector3::z(), Vector3::zeros());
/// let roller = RuledSurface::cylinder(0.5, 2.0, axis, center)?;
/// // On a plane with the normal x of the body it lies on the line below.
/// let [first, last] = roller.line_of_contact(&Vector3::x());
/// assert_eq!(first, Vector3::new(-0.5, 0.0, 1.0));
/// assert_eq!(last, Vector3::new(-0.5, 0.0, -1.0));
/// // A cone lies on a line from its apex to the rim.
/// let cone = RuledSurface::cone(3.0, 4.0, axis, center)?;
/// let [apex, rim] = cone.line_of_contact(&Vector3::x());
/// assert_eq!((apex, rim), (Vector3::new(0.0, 0.0, 3.0), Vector3::new(-3.0, 0.0, -1.0)));
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RuledSurface {
    pub(super) kind: Kind,
    pub(super) radius: f64,
    pub(super) height: f64,
    pub(super) axis: Unit<Vector3<f64>>,
    pub(super) center: Vector3<f64>,
}

impl RuledSurface {
    /// Make a cylinder. `center`: its middle.
    ///
    /// # Errors
    /// When the radius or the height is not positive and finite, the axis has no direction, or the center is not finite.
    pub fn cylinder(
        radius: f64,
        height: f64,
        axis: Vector3<f64>,
        center: Vector3<f64>,
    ) -> Result<Self, Error> {
        Self::new(Kind::Cylinder, radius, height, &axis, center)
    }

    /// Make a cone. `axis`: from its base to its apex. `center`: its centroid, a quarter of the height above the base.
    ///
    /// # Errors
    /// As [`Self::cylinder`].
    pub fn cone(
        radius: f64,
        height: f64,
        axis: Vector3<f64>,
        center: Vector3<f64>,
    ) -> Result<Self, Error> {
        Self::new(Kind::Cone, radius, height, &axis, center)
    }

    fn new(
        kind: Kind,
        radius: f64,
        height: f64,
        axis: &Vector3<f64>,
        center: Vector3<f64>,
    ) -> Result<Self, Error> {
        for (what, value) in [("radius", radius), ("height", height)] {
            finite(what, value)?;
            if value <= 0.0 {
                return Err(Error::OutOfDomain {
                    what,
                    law: "a positive length",
                    value,
                });
            }
        }
        all_finite("axis", axis)?;
        all_finite("center", &center)?;
        let Some(axis) = Unit::try_new(*axis, 0.0) else {
            return Err(Error::OutOfDomain {
                what: "axis",
                law: "a vector that has a direction",
                value: axis.norm(),
            });
        };
        Ok(Self {
            kind,
            radius,
            height,
            axis,
            center,
        })
    }

    /// Compute the ends of the line on which the surface lies, in body axes from their origin: of a cone the apex first, of a cylinder
    /// the end toward which its axis points.
    ///
    /// `normal`: that of the plane toward the body, in body axes; its part along the axis does not matter. NaN where it has no other.
    #[must_use]
    pub fn line_of_contact(&self, normal: &Vector3<f64>) -> [Vector3<f64>; 2] {
        let across = normal - *self.axis * normal.dot(&self.axis);
        let below = across * (-self.radius / across.norm());
        let [up, down] = self.ends();
        match self.kind {
            Kind::Cylinder => [
                self.center + *self.axis * up + below,
                self.center - *self.axis * down + below,
            ],
            Kind::Cone => [
                self.center + *self.axis * up,
                self.center - *self.axis * down + below,
            ],
        }
    }

    /// How far the top is above the center, and the base below it.
    pub(super) fn ends(&self) -> [f64; 2] {
        match self.kind {
            Kind::Cylinder => [0.5 * self.height; 2],
            Kind::Cone => [0.75 * self.height, 0.25 * self.height],
        }
    }

    /// Sine and cosine of the angle between the axis and a line of the surface.
    pub(super) fn half_angle(&self) -> [f64; 2] {
        match self.kind {
            Kind::Cylinder => [0.0, 1.0],
            Kind::Cone => {
                let slant = self.radius.hypot(self.height);
                [self.radius / slant, self.height / slant]
            }
        }
    }

    /// Return the size that lengths are relative to.
    pub(super) fn size(&self) -> f64 {
        self.radius.max(self.height)
    }
}
