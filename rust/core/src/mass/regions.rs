//! Regions of space that a density is integrated over, each covered by smooth charts from boxes of parameters.

use nalgebra::Vector3;
use std::f64::consts::{PI, TAU};

use super::amount::{Amount, check_order, length};
use super::polyhedron::{Index, Options, View, find_components, polyhedron_watched};
use crate::error::{Error, all_finite};
use crate::numerics::power_of_two::{exponent, times_power_of_two};
use crate::numerics::quadrature::{Cell, Rule};
use crate::numerics::threads::Watch;

/// Where there is matter. Its boundary is where a density may end with a jump.
#[derive(Clone, Debug, PartialEq)]
pub struct Region(Kind);

#[derive(Clone, Debug, PartialEq)]
enum Kind {
    /// Parameters: x, y, z.
    Box {
        low: Vector3<f64>,
        high: Vector3<f64>,
    },
    /// Parameters: fraction of the radius, polar angle, azimuth.
    Ellipsoid {
        center: Vector3<f64>,
        semi_axes: Vector3<f64>,
        /// The cavity, as a fraction of the radius.
        inner: f64,
    },
    /// Parameters: radius, azimuth, height.
    Cylinder {
        center: Vector3<f64>,
        inner_radius: f64,
        radius: f64,
        height: f64,
    },
    /// One chart for each face: the signed tetrahedron from a point amid its component, drawn together at that point and
    /// at the first corner.
    Mesh {
        apexes: Vec<Vector3<f64>>,
        faces: Vec<Face>,
    },
}

#[derive(Clone, Debug, PartialEq)]
struct Face {
    /// Which component of the mesh it belongs to.
    component: usize,
    corners: [Vector3<f64>; 3],
}

impl Region {
    /// Box between two opposite corners, its faces normal to the axes.
    ///
    /// # Errors
    /// When a coordinate is not finite or `low` is not below `high` along each axis.
    pub fn cuboid(low: &Vector3<f64>, high: &Vector3<f64>) -> Result<Self, Error> {
        all_finite("low", low)?;
        all_finite("high", high)?;
        for axis in 0..3 {
            let (a, b) = (low[axis], high[axis]);
            if a >= b {
                let (smaller, larger) = ("low", "high");
                return Err(Error::NotBelow {
                    smaller,
                    a,
                    larger,
                    b,
                });
            }
        }
        let (low, high) = (*low, *high);
        Ok(Self(Kind::Box { low, high }))
    }

    /// Ball, hollow when the inner radius is not zero.
    ///
    /// # Errors
    /// When a number is not finite, or the radii do not leave any volume.
    pub fn ball(radius: f64, center: &Vector3<f64>, inner_radius: f64) -> Result<Self, Error> {
        below(inner_radius, radius)?;
        all_finite("center", center)?;
        Ok(Self(Kind::Ellipsoid {
            center: *center,
            semi_axes: Vector3::repeat(radius),
            inner: inner_radius / radius,
        }))
    }

    /// Ellipsoid with its axes along x, y, z.
    ///
    /// # Errors
    /// When a number is not finite or a semi-axis not positive.
    pub fn ellipsoid(semi_axes: &Vector3<f64>, center: &Vector3<f64>) -> Result<Self, Error> {
        for &semi_axis in semi_axes {
            positive("semi_axes", semi_axis)?;
        }
        all_finite("center", center)?;
        Ok(Self(Kind::Ellipsoid {
            center: *center,
            semi_axes: *semi_axes,
            inner: 0.0,
        }))
    }

    /// Cylinder along z, hollow when the inner radius is not zero.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::nalgebra::Vector3;
    /// use polhode::Error;
    /// use polhode::mass::density::{Effort, from_density};
    /// use polhode::mass::regions::Region;
    ///
    /// let drum = Region::cylinder(1.0, 2.0, &Vector3::zeros(), 0.0)?;
    /// let even = |_: &[[f64; 3]], out: &mut [f64]| {
    ///     out.fill(3.0);
    ///     Ok::<_, Error>(())
    /// };
    /// let effort = Effort { rtol: 1e-10, max_evaluations: 1_000_000 };
    /// let body = from_density(&drum, even, effort)?.require_converged()?;
    /// assert!((body.mass() - 6.0 * std::f64::consts::PI).abs() < 1e-9);
    /// # Ok::<(), polhode::Error>(())
    /// ```
    ///
    /// # Errors
    /// When a number is not finite, the radii do not leave any volume or the height is not positive.
    pub fn cylinder(
        radius: f64,
        height: f64,
        center: &Vector3<f64>,
        inner_radius: f64,
    ) -> Result<Self, Error> {
        below(inner_radius, radius)?;
        positive("height", height)?;
        all_finite("center", center)?;
        Ok(Self(Kind::Cylinder {
            center: *center,
            inner_radius,
            radius,
            height,
        }))
    }

    /// The inside of a closed, consistently wound triangle mesh.
    ///
    /// # Errors
    /// When the mesh does not bound a solid; [`Error::Stopped`] where `watch` said so.
    pub fn mesh<I: Index>(
        vertices: &[[f64; 3]],
        faces: &[[I; 3]],
        watch: &mut Watch<'_>,
    ) -> Result<Self, Error> {
        // Whatever is wrong with the mesh is told here.
        let solid = polyhedron_watched(
            vertices,
            faces,
            Amount::Mass(1.0),
            Options::default(),
            watch,
        )?;
        let found =
            find_components(&View { vertices, faces }, watch).map_err(|_| Error::Stopped)?;
        let component = |face: usize| found.as_ref().map_or(0, |(of_faces, _)| of_faces[face]);
        let faces: Vec<Face> = (faces.iter().enumerate())
            .map(|(number, face)| Face {
                component: component(number),
                corners: face.map(|k| Vector3::from(vertices[k.position()])),
            })
            .collect();
        let apexes = match &found {
            None => vec![solid.body.center_of_mass()],
            Some((_, count)) => middles(&faces, *count),
        };
        Ok(Self(Kind::Mesh { apexes, faces }))
    }

    /// The region in units of its own size, and which power of two they are.
    pub(super) fn in_units(&self) -> (Self, i32) {
        let size = match &self.0 {
            Kind::Box { low, high } => (high * 0.5 - low * 0.5).amax(),
            Kind::Ellipsoid { semi_axes, .. } => semi_axes.amax(),
            Kind::Cylinder { radius, height, .. } => radius.max(*height),
            Kind::Mesh { apexes, faces } => (faces.iter().flat_map(|face| &face.corners))
                .fold(0.0, |size: f64, corner| {
                    size.max((corner * 0.5 - apexes[0] * 0.5).amax())
                }),
        };
        let power = exponent(size);
        let own = |x: f64| times_power_of_two(x, -power);
        let scaled = match &self.0 {
            Kind::Box { low, high } => Kind::Box {
                low: low.map(own),
                high: high.map(own),
            },
            Kind::Ellipsoid {
                center,
                semi_axes,
                inner,
            } => Kind::Ellipsoid {
                center: center.map(own),
                semi_axes: semi_axes.map(own),
                inner: *inner,
            },
            Kind::Cylinder {
                center,
                inner_radius,
                radius,
                height,
            } => Kind::Cylinder {
                center: center.map(own),
                inner_radius: own(*inner_radius),
                radius: own(*radius),
                height: own(*height),
            },
            Kind::Mesh { apexes, faces } => Kind::Mesh {
                apexes: apexes.iter().map(|apex| apex.map(own)).collect(),
                faces: faces
                    .iter()
                    .map(|face| Face {
                        component: face.component,
                        corners: face.corners.map(|corner| corner.map(own)),
                    })
                    .collect(),
            },
        };
        (Self(scaled), power)
    }

    /// The rule that suits the size of the region's charts: a mesh has many small ones.
    pub(super) fn rule(&self) -> Rule {
        match self.0 {
            Kind::Mesh { .. } => Rule::seven(),
            _ => Rule::fifteen(),
        }
    }

    /// Boxes of parameters that cover the region once.
    pub(super) fn cells(&self) -> Vec<Cell<3>> {
        let whole = |low: [f64; 3], high: [f64; 3]| Cell {
            chart: 0,
            low,
            high,
        };
        match &self.0 {
            Kind::Box { .. } => whole([0.0; 3], [1.0; 3]).divide([2, 2, 2]),
            Kind::Ellipsoid { inner, .. } => {
                whole([*inner, 0.0, 0.0], [1.0, PI, TAU]).divide([1, 2, 4])
            }
            Kind::Cylinder {
                inner_radius,
                radius,
                ..
            } => whole([*inner_radius, 0.0, 0.0], [*radius, TAU, 1.0]).divide([1, 4, 2]),
            Kind::Mesh { faces, .. } => (0..faces.len())
                .map(|chart| Cell {
                    chart,
                    low: [0.0; 3],
                    high: [1.0; 3],
                })
                .collect(),
        }
    }

    /// The point with these parameters, and the volume element there.
    pub(super) fn point(&self, chart: usize, parameters: &[f64; 3]) -> (Vector3<f64>, f64) {
        let [u, v, w] = *parameters;
        match &self.0 {
            Kind::Box { low, high } => {
                let size = high - low;
                let at = low + size.component_mul(&Vector3::new(u, v, w));
                (at, size.product())
            }
            Kind::Ellipsoid {
                center, semi_axes, ..
            } => {
                let ((sin, cos), (sin_phi, cos_phi)) = (v.sin_cos(), w.sin_cos());
                let direction = Vector3::new(sin * cos_phi, sin * sin_phi, cos);
                let at = center + semi_axes.component_mul(&direction) * u;
                (at, semi_axes.product() * (u * u * sin))
            }
            Kind::Cylinder { center, height, .. } => {
                let (sin, cos) = v.sin_cos();
                let at = center + Vector3::new(u * cos, u * sin, height * (w - 0.5));
                (at, u * height)
            }
            Kind::Mesh { apexes, faces } => {
                let Face { component, corners } = &faces[chart];
                let apex = apexes[*component];
                let [a, b, c] = corners.map(|corner| corner - apex);
                let at = a + ((b - a) + (c - b) * w) * v;
                (apex + at * u, a.dot(&b.cross(&c)) * (u * u * v))
            }
        }
    }
}

/// A point amid each component: the signed tetrahedra from a point far away would cancel one another.
fn middles(faces: &[Face], count: usize) -> Vec<Vector3<f64>> {
    let mut boxes = vec![None; count];
    for Face { component, corners } in faces {
        for corner in corners {
            let (low, high): &mut (Vector3<f64>, Vector3<f64>) =
                boxes[*component].get_or_insert((*corner, *corner));
            (*low, *high) = (low.inf(corner), high.sup(corner));
        }
    }
    let middle = |ends: Option<(Vector3<f64>, Vector3<f64>)>| {
        ends.map_or_else(Vector3::zeros, |(low, high)| low * 0.5 + high * 0.5)
    };
    boxes.into_iter().map(middle).collect()
}

fn positive(what: &'static str, value: f64) -> Result<(), Error> {
    length(what, value)?;
    if value == 0.0 {
        let law = "positive";
        return Err(Error::OutOfDomain { what, law, value });
    }
    Ok(())
}

/// `0 ≤ inner radius < radius`.
fn below(inner_radius: f64, radius: f64) -> Result<(), Error> {
    check_order(("inner_radius", inner_radius), ("radius", radius))?;
    if inner_radius < radius {
        return Ok(());
    }
    let (smaller, a, larger, b) = ("inner_radius", inner_radius, "radius", radius);
    Err(Error::NotBelow {
        smaller,
        a,
        larger,
        b,
    })
}
