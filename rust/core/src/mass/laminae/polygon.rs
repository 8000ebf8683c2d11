//! Triangles and simple polygons in the x-y plane, where their corners are.
//!
//! Two passes: the second one sums again about the centre of mass, in the axes that the first one found, from coordinates
//! that carry the rounding errors of difference and rotation along. The smallest moment of a narrow sliver is then as
//! accurate as its corners are, wherever it stands and however it is turned.

use nalgebra::{Matrix2, Matrix3, Rotation2, Vector2, Vector3};

use super::super::amount::{Amount, Measure, Unit, closed_form, of_matter};
use super::super::body::RigidBody;
use super::super::error_bound::{ErrorBound, UNIT};
use super::super::provenance::Source;
use super::super::second_moment::SecondMoment;
use super::simple::check_simple;
use crate::error::{Error, PolygonFault, finite};
use crate::numerics::power_of_two::times_power_of_two;
use crate::numerics::reduce::{depth, sum_terms};
use crate::numerics::split_vector::{SplitVector, cross2};
use crate::numerics::threads::Watch;

/// Triangle with these corners, in any order: `S = m (e₁e₁ᵀ + e₂e₂ᵀ + e₃e₃ᵀ)/36` with its edges e, C their mean.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, laminae};
///
/// let corner = laminae::triangle(&[[0.0, 0.0], [3.0, 0.0], [0.0, 3.0]], Amount::Density(2.0))?;
/// assert_eq!(corner.mass(), 9.0);
/// assert!((corner.center_of_mass().x - 1.0).abs() < 1e-15);
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// When a coordinate is not finite, or the amount is not positive.
pub fn triangle(vertices: &[[f64; 2]; 3], amount: Amount) -> Result<RigidBody, Error> {
    check_finite(vertices)?;
    let [a, b, c] = *vertices;
    let (u, v) = (
        SplitVector::difference(&b, &a),
        SplitVector::difference(&c, &a),
    );
    let center = Vector2::from(a) + (Vector2::from(u.high) + Vector2::from(v.high)) / 3.0;
    let extents = [u, v].map(|edge| Vector2::from(edge.high).amax());
    let (unit, _) = Unit::of(extents);
    let [u, v, w] = [u, v, SplitVector::difference(&c, &b)].map(|edge| unit.counts(&edge));
    let area = 0.5 * cross2(&u, &v).abs();
    let sum = |edges: [Vector2<f64>; 3]| {
        edges
            .map(|e| e * e.transpose())
            .iter()
            .sum::<Matrix2<f64>>()
    };
    let of_mass = |mass: f64| {
        let axes =
            long_axes(&(sum([u, v, w].map(|edge| Vector2::from(edge.high))) * (mass / 36.0)));
        let central = sum([u, v, w].map(|edge| turned(&edge, &axes))) * (mass / 36.0);
        let mut error_bound = closed_form(amount, mass, 2.0 * central.trace());
        error_bound.center_of_mass = 4.0 * UNIT * (center.amax() + extents[0] + extents[1]);
        if matches!(amount, Amount::Density(_)) {
            error_bound.inertia += error_bound.mass / mass * 2.0 * central.trace();
        }
        embedded(mass, &center, &central, &axes, error_bound)
    };
    of_matter(unit, Measure::Area(area), amount, Source::Lamina, of_mass)
}

/// Simple polygon with these corners along its boundary, either way round; the last corner joins the first.
///
/// Triangles (C, a, b) from a reference to each edge, signed: `A = Σ D/2`, `∫ d dA = Σ D (a + b)/6`,
/// `∫ d dᵀ dA = Σ D (a aᵀ + b bᵀ + s sᵀ)/24` with `D = a × b` and `s = a + b`.
///
/// `watch` is asked now and then whether to go on: edges that lie above each other are compared pair by pair.
///
/// # Examples
///
/// ```
/// use polhode::mass::{Amount, laminae};
/// use std::ops::ControlFlow;
///
/// let square = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]];
/// let plate = laminae::polygon(&square, Amount::Mass(3.0), &mut |_| ControlFlow::Continue(()))?;
/// assert!((plate.principal().moments[2] - 2.0).abs() < 1e-14); // m (a² + b²)/12
/// # Ok::<(), polhode::Error>(())
/// ```
///
/// # Errors
/// [`PolygonFault`] when edges cross or enclose nothing; when a coordinate is not finite, or the amount is not positive;
/// [`Error::Stopped`] where `watch` said so.
pub fn polygon(
    vertices: &[[f64; 2]],
    amount: Amount,
    watch: &mut Watch<'_>,
) -> Result<RigidBody, Error> {
    let count = vertices.len();
    if count < 3 {
        return Err(PolygonFault::TooFew { count }.into());
    }
    check_finite(vertices)?;
    let (low, high) = vertices.iter().fold(
        (
            Vector2::repeat(f64::INFINITY),
            Vector2::repeat(f64::NEG_INFINITY),
        ),
        |(low, high), &v| (low.inf(&v.into()), high.sup(&v.into())),
    );
    let middle = low * 0.5 + high * 0.5;
    let size = (high - low).max();
    let (unit, [own_size]) = Unit::of([size]);
    let own = |&[x, y]: &[f64; 2]| [x, y].map(|x| times_power_of_two(x, -unit.0));
    let in_units: Vec<[f64; 2]> = vertices.iter().map(own).collect();
    check_simple(&in_units, watch)?;
    let told = |lengths: Vector2<f64>| lengths.map(|x| times_power_of_two(x, unit.0));
    let (first, magnitude) = sums(vertices, unit, &middle, &Matrix2::identity());
    if first.area.abs() <= 8.0 * UNIT * depth(count) * magnitude {
        let area = times_power_of_two(first.area, 2 * unit.0);
        return Err(PolygonFault::NoArea { area, size }.into());
    }
    let rough = middle + told(first.moment / first.area);
    let axes = long_axes(&first.about_centroid());
    let (sums, magnitude) = sums(vertices, unit, &rough, &axes);
    let area = sums.area.abs();
    let center = rough + told(axes * (sums.moment / sums.area));
    let relative = 2.0 * UNIT * (depth(count) + 24.0) * (magnitude / area);
    let of_mass = |mass: f64| {
        let central = sums.about_centroid() * (mass / sums.area);
        let error_bound = ErrorBound {
            mass: match amount {
                Amount::Mass(_) => 0.0,
                Amount::Density(_) => relative * mass,
            },
            center_of_mass: 2.0 * relative * size + 4.0 * UNIT * center.amax(),
            inertia: 4.0 * relative * mass * own_size * own_size,
        };
        embedded(mass, &center, &central, &axes, error_bound)
    };
    let body = of_matter(unit, Measure::Area(area), amount, Source::Lamina, of_mass)?;
    // What rounding hid from the search for edges that pass through one another.
    (body.check_possible()).map_err(|_| Error::from(PolygonFault::Overlapping))?;
    Ok(body)
}

/// What a lamina with this second moment, in these axes of its plane, is in space.
fn embedded(
    mass: f64,
    center: &Vector2<f64>,
    central: &Matrix2<f64>,
    axes: &Matrix2<f64>,
    error_bound: ErrorBound,
) -> SecondMoment {
    let mut embedded = (Matrix3::zeros(), Matrix3::identity());
    embedded.0.fixed_view_mut::<2, 2>(0, 0).copy_from(central);
    embedded.1.fixed_view_mut::<2, 2>(0, 0).copy_from(axes);
    SecondMoment {
        mass,
        center_of_mass: Vector3::new(center.x, center.y, 0.0),
        central: embedded.0,
        axes: embedded.1,
        error_bound,
    }
}

/// The principal axes of a symmetric 2×2 matrix, as a rotation; the coordinate axes where it is diagonal.
fn long_axes(s: &Matrix2<f64>) -> Matrix2<f64> {
    if s[(0, 1)] == 0.0 {
        return Matrix2::identity();
    }
    let angle = 0.5 * (2.0 * s[(0, 1)]).atan2(s[(0, 0)] - s[(1, 1)]);
    Rotation2::new(angle).into_inner()
}

/// The vector in these axes, each component rounded once.
fn turned(v: &SplitVector<2>, axes: &Matrix2<f64>) -> Vector2<f64> {
    Vector2::from_fn(|k, _| v.dot(&axes.column(k).into()))
}

/// `∫ dA`, `∫ d dA` and `∫ d dᵀ dA` with `d = axesᵀ (r − reference)`.
struct AreaSums {
    area: f64,
    moment: Vector2<f64>,
    second: Matrix2<f64>,
}

impl AreaSums {
    fn about_centroid(&self) -> Matrix2<f64> {
        self.second - self.moment * self.moment.transpose() / self.area
    }
}

/// The sums with lengths in `unit`, and the area with every product counted as positive.
fn sums(
    vertices: &[[f64; 2]],
    unit: Unit,
    reference: &Vector2<f64>,
    axes: &Matrix2<f64>,
) -> (AreaSums, f64) {
    let at = |k: usize| {
        let v = SplitVector::difference(&vertices[k % vertices.len()], &(*reference).into());
        turned(&unit.counts(&v), axes)
    };
    let [area, magnitude, x, y, xx, xy, yy] = sum_terms(vertices.len(), |k| {
        let (a, b) = (at(k), at(k + 1));
        let (d, s) = (a.perp(&b), a + b);
        [
            d,
            (a.x * b.y).abs() + (a.y * b.x).abs(),
            d * s.x,
            d * s.y,
            d * (a.x * a.x + b.x * b.x + s.x * s.x),
            d * (a.x * a.y + b.x * b.y + s.x * s.y),
            d * (a.y * a.y + b.y * b.y + s.y * s.y),
        ]
    });
    let sums = AreaSums {
        area: area / 2.0,
        moment: Vector2::new(x, y) / 6.0,
        second: Matrix2::new(xx, xy, xy, yy) / 24.0,
    };
    (sums, magnitude / 2.0)
}

fn check_finite(vertices: &[[f64; 2]]) -> Result<(), Error> {
    vertices
        .iter()
        .flatten()
        .try_for_each(|&x| finite("vertices", x).map(drop))
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;

    fn polygon(vertices: &[[f64; 2]], amount: Amount) -> Result<RigidBody, Error> {
        super::polygon(vertices, amount, &mut |_| ControlFlow::Continue(()))
    }

    #[test]
    fn polygon_is_its_triangle_and_its_rectangle() {
        let corners = [[1.0, 2.0], [4.0, 2.5], [2.0, 5.0]];
        let amount = Amount::Density(2.0);
        let by_edges = triangle(&corners, amount).expect("triangle");
        assert!(by_edges.is_close(&polygon(&corners, amount).expect("polygon"), 1e-15, 0.0));
        let square = [[1e8, 0.0], [1e8 + 2.0, 0.0], [1e8 + 2.0, 3.0], [1e8, 3.0]];
        let body = polygon(&square, Amount::Mass(12.0)).expect("polygon");
        assert_eq!(body.principal().moments, [4.0, 9.0, 13.0]);
        assert_eq!(body.center_of_mass(), Vector3::new(1e8 + 1.0, 1.5, 0.0));
    }

    #[test]
    fn crossing_edges_are_told() {
        let bow = [[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]];
        let fault = polygon(&bow, Amount::Mass(1.0)).expect_err("bow");
        let crossing = PolygonFault::Crossing {
            first: 0,
            second: 2,
        };
        assert_eq!(fault, Error::Polygon(crossing));
        // Two triangles, one the other way round, the smaller far away: more second moment is negative than not.
        let through = [
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [0.0, 0.0],
            [-30.0, 0.0],
            [-30.0, 0.1],
        ];
        let fault = polygon(&through, Amount::Mass(1.0)).expect_err("through itself");
        assert_eq!(fault, Error::Polygon(PolygonFault::Overlapping));
        let line = [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]];
        let fault = polygon(&line, Amount::Mass(1.0)).expect_err("line");
        assert!(matches!(fault, Error::Polygon(PolygonFault::NoArea { .. })));
    }
}
