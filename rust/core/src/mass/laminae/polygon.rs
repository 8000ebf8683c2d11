//! Triangles and simple polygons in the x-y plane, where their corners are.
//!
//! Two passes: the second one sums again about the centre of mass, in the axes that the first one found, from coordinates
//! that carry the rounding errors of difference and rotation along. The smallest moment of a narrow sliver is then as
//! accurate as its corners are, wherever it stands and however it is turned.

use nalgebra::{Matrix2, Matrix3, Rotation2, Vector2, Vector3};

use crate::error::{Error, PolygonFault, finite};
use crate::mass::amount::{Amount, Measure, Unit, closed_form, of_matter};
use crate::mass::body::RigidBody;
use crate::mass::error_bound::{ErrorBound, UNIT};
use crate::mass::provenance::BodySource;
use crate::mass::second_moment::SecondMoment;
use crate::numerics::power_of_two::times_power_of_two;
use crate::numerics::split_vector::{SplitVector, cross2};
use crate::numerics::threads::Watch;
use crate::numerics::tree_sum::{depth, sum_terms};

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
        let central = sum([u, v, w].map(|edge| rotate(&edge, &axes))) * (mass / 36.0);
        let mut error_bound = closed_form(amount, mass, 2.0 * central.trace());
        error_bound.center_of_mass = 4.0 * UNIT * (center.amax() + extents[0] + extents[1]);
        if matches!(amount, Amount::Density(_)) {
            error_bound.inertia += error_bound.mass / mass * 2.0 * central.trace();
        }
        embed(mass, &center, &central, &axes, error_bound)
    };
    of_matter(
        unit,
        Measure::Area(area),
        amount,
        BodySource::Lamina,
        of_mass,
    )
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
        embed(mass, &center, &central, &axes, error_bound)
    };
    let body = of_matter(
        unit,
        Measure::Area(area),
        amount,
        BodySource::Lamina,
        of_mass,
    )?;
    // What rounding hid from the search for edges that pass through one another.
    (body.check_possible()).map_err(|_| Error::from(PolygonFault::Overlapping))?;
    Ok(body)
}

/// What a lamina with this second moment, in these axes of its plane, is in space.
fn embed(
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
fn rotate(v: &SplitVector<2>, axes: &Matrix2<f64>) -> Vector2<f64> {
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
        rotate(&unit.counts(&v), axes)
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

// Whether a boundary passes through itself.
//
// Two edges may cross. Where they only touch, at a corner or along a line, how often the boundary winds around the points
// on both sides tells whether it passes through itself there: a simple one winds around its inside once, around nothing else.

/// Edges that are compared between two questions whether to go on.
const MANY: usize = 100_000;

/// The corners along a boundary.
struct Boundary<'a>(&'a [[f64; 2]]);

/// How two edges lie to each other.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Meeting {
    /// Nothing in common.
    Apart,
    /// A point, or more, within rounding.
    Touch,
    /// The ends of each on different sides of the other.
    Cross,
}

/// No two edges cross, and where they touch the boundary winds around both sides once or not at all, always the same way.
pub(super) fn check_simple(vertices: &[[f64; 2]], watch: &mut Watch<'_>) -> Result<(), Error> {
    let boundary = Boundary(vertices);
    let touching = boundary.find_touching_edges(watch)?;
    if touching.is_empty() {
        return Ok(());
    }
    let mut way = 0;
    for (done, piece) in boundary.pieces(&touching).into_iter().enumerate() {
        if watch(done as f64 / touching.len() as f64).is_break() {
            return Err(Error::Stopped);
        }
        for turns in boundary.windings(piece) {
            if turns.abs() > 1 || turns * way < 0 {
                return Err(PolygonFault::Overlapping.into());
            }
            way += turns * i32::from(way == 0);
        }
    }
    Ok(())
}

impl Boundary<'_> {
    fn ends(&self, edge: usize) -> [[f64; 2]; 2] {
        [self.0[edge], self.0[(edge + 1) % self.0.len()]]
    }

    fn range(&self, edge: usize, axis: usize) -> (f64, f64) {
        let [a, b] = self.ends(edge);
        (a[axis].min(b[axis]), a[axis].max(b[axis]))
    }

    fn are_neighbours(&self, i: usize, j: usize) -> bool {
        let count = self.0.len();
        (i + 1) % count == j || (j + 1) % count == i
    }

    /// The pairs of edges that touch and do not follow one another.
    fn find_touching_edges(&self, watch: &mut Watch<'_>) -> Result<Vec<[usize; 2]>, Error> {
        let count = self.0.len();
        // Along x, each edge against those that start before it ends.
        let mut order: Vec<usize> = (0..count).collect();
        order.sort_by(|&i, &j| self.range(i, 0).0.total_cmp(&self.range(j, 0).0));
        let mut compared = 0;
        let mut touching = Vec::new();
        for (place, &i) in order.iter().enumerate() {
            let ((_, end), (low, high)) = (self.range(i, 0), self.range(i, 1));
            let overlapping = order[place + 1..]
                .iter()
                .take_while(|&&j| self.range(j, 0).0 <= end)
                .inspect(|_| compared += 1)
                .filter(|&&j| self.range(j, 1).0 <= high && self.range(j, 1).1 >= low);
            for &j in overlapping {
                match classify_meeting(self.ends(i), self.ends(j)) {
                    Meeting::Cross => {
                        let (first, second) = (i.min(j), i.max(j));
                        return Err(PolygonFault::Crossing { first, second }.into());
                    }
                    Meeting::Touch if !self.are_neighbours(i, j) => touching.push([i, j]),
                    Meeting::Touch | Meeting::Apart => {}
                }
            }
            compared += 1;
            if compared > MANY {
                compared = 0;
                if watch(place as f64 / count as f64).is_break() {
                    return Err(Error::Stopped);
                }
            }
        }
        Ok(touching)
    }

    /// The parts between touches of the edges that touch others: edge, and how far along it the middle of the part lies.
    ///
    /// Beside all others the boundary winds as beside these.
    fn pieces(&self, touching: &[[usize; 2]]) -> Vec<(usize, f64)> {
        let mut cuts: Vec<(usize, f64)> = Vec::new();
        for &[i, j] in touching {
            for (own, other) in [(i, j), (j, i)] {
                let [a, b] = self.ends(own);
                let along = from(&a, &b);
                for corner in self.ends(other) {
                    let part = along.dot(&from(&a, &corner)) / along.norm_squared();
                    cuts.push((
                        own,
                        if part.is_nan() {
                            0.0
                        } else {
                            part.clamp(0.0, 1.0)
                        },
                    ));
                }
                cuts.extend([(own, 0.0), (own, 1.0)]);
            }
        }
        cuts.sort_by(|p, q| p.0.cmp(&q.0).then(p.1.total_cmp(&q.1)));
        let pairs = cuts
            .windows(2)
            .filter(|pair| pair[0].0 == pair[1].0 && pair[0].1 < pair[1].1);
        pairs
            .map(|pair| (pair[0].0, 0.5 * (pair[0].1 + pair[1].1)))
            .collect()
    }

    /// How often the boundary winds around a point close by on the left of an edge, and around one on the right.
    fn windings(&self, (edge, part): (usize, f64)) -> [i32; 2] {
        let count = self.0.len();
        let [start, end] = self.ends(edge);
        let along = from(&start, &end);
        let middle = along * part;
        // Corners from the start of this edge, so that those near it keep their digits.
        let corner = |k: usize| from(&start, &self.0[k % count]) - middle;
        // Beyond those edges that run along this one within rounding, and before all others.
        let rounding = 64.0 * UNIT * along.norm();
        let nearest = (0..count)
            .filter(|&k| k != edge)
            .map(|k| distance(&corner(k), &corner(k + 1)))
            .filter(|&distance| distance > rounding)
            .fold(along.norm(), f64::min);
        let aside = Vector2::new(-along.y, along.x) * (0.5 * nearest / along.norm());
        [aside, -aside].map(|point| {
            (0..count)
                .map(|k| winds(&(corner(k) - point), &(corner(k + 1) - point)))
                .sum()
        })
    }
}

fn from(a: &[f64; 2], b: &[f64; 2]) -> Vector2<f64> {
    SplitVector::difference(b, a).high.into()
}

/// From the origin to the edge between two points.
fn distance(a: &Vector2<f64>, b: &Vector2<f64>) -> f64 {
    let along = b - a;
    let part = (-a.dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
    let nearest = if part.is_nan() { *a } else { a + along * part };
    nearest.norm()
}

/// What an edge from a to b adds to the windings around the origin: where it passes the half axis x > 0, upward or downward.
fn winds(a: &Vector2<f64>, b: &Vector2<f64>) -> i32 {
    let is_left = a.perp(b) > 0.0;
    match (a.y <= 0.0, b.y <= 0.0) {
        (true, false) if is_left => 1,
        (false, true) if !is_left => -1,
        _ => 0,
    }
}

fn classify_meeting([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> Meeting {
    let side = |p: [f64; 2], q: [f64; 2], r: [f64; 2]| {
        let (u, v) = (
            SplitVector::difference(&q, &p),
            SplitVector::difference(&r, &p),
        );
        let size = (u.high[0] * v.high[1]).abs() + (u.high[1] * v.high[0]).abs();
        let area = cross2(&u, &v);
        // Beyond what the rounding of the products' rests can have done.
        if area.abs() <= 8.0 * UNIT * UNIT * size {
            0.0
        } else {
            area.signum()
        }
    };
    let products = [side(a, b, c) * side(a, b, d), side(c, d, a) * side(c, d, b)];
    if products.iter().any(|&product| product > 0.0) {
        Meeting::Apart
    } else if products.contains(&0.0) {
        Meeting::Touch
    } else {
        Meeting::Cross
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::ControlFlow;

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

    fn check(vertices: &[[f64; 2]]) -> Result<(), Error> {
        let go_on = &mut |_| ControlFlow::Continue(());
        let turned: Vec<[f64; 2]> = vertices.iter().rev().copied().collect();
        let far: Vec<[f64; 2]> = vertices.iter().map(|[x, y]| [x + 1e6, y * 1e-3]).collect();
        let outcome = check_simple(vertices, go_on);
        assert_eq!(check_simple(&turned, go_on).is_ok(), outcome.is_ok());
        assert_eq!(check_simple(&far, go_on).is_ok(), outcome.is_ok());
        outcome
    }

    /// A square, and a smaller one within that is gone round the other way; each ends where it begins.
    const OUTSIDE: [[f64; 2]; 5] = [[0.0, 0.0], [5.0, 0.0], [5.0, 5.0], [0.0, 5.0], [0.0, 0.0]];

    const INSIDE: [[f64; 2]; 5] = [[1.0, 1.0], [1.0, 3.0], [3.0, 3.0], [3.0, 1.0], [1.0, 1.0]];

    #[test]
    fn what_touches_itself_and_does_not_pass_through_is_simple() {
        // Two triangles that share a corner, gone round the same way.
        let corner = [
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [0.0, 0.0],
            [-3.0, 0.0],
            [-3.0, -0.5],
        ];
        assert_eq!(check(&corner), Ok(()));
        // A square with a square hole, joined by a cut that is gone along twice.
        let cut = [OUTSIDE, INSIDE].concat();
        assert_eq!(check(&cut), Ok(()));
        // A corner that lies on another edge, from within; a spike; a corner that stands twice.
        let on_edge = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 0.0], [0.0, 4.0]];
        assert_eq!(check(&on_edge), Ok(()));
        let spike = [[0.0, 0.0], [4.0, 0.0], [6.0, 0.0], [4.0, 0.0], [4.0, 4.0]];
        assert_eq!(check(&spike), Ok(()));
        let twice = [[0.0, 0.0], [4.0, 0.0], [4.0, 0.0], [4.0, 4.0]];
        assert_eq!(check(&twice), Ok(()));
    }

    #[test]
    fn what_passes_through_itself_where_it_touches_is_told() {
        let overlapping = Err(Error::Polygon(PolygonFault::Overlapping));
        // The second triangle the other way round, at a corner of both.
        let corner = [
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [0.0, 0.0],
            [-3.0, -0.5],
            [-3.0, 0.0],
        ];
        assert_eq!(check(&corner), overlapping);
        // Through the middle of an edge, at a corner of its own.
        let on_edge = [
            [0.0, 0.0],
            [4.0, 0.0],
            [4.0, 4.0],
            [2.0, 0.0],
            [1.0, -2.0],
            [0.0, -1.0],
        ];
        assert_eq!(check(&on_edge), overlapping);
        // A square gone round twice, and the hole of a square the same way as the square.
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert_eq!(check(&[square, square].concat()), overlapping);
        let mut round = INSIDE;
        round.reverse();
        let island = [OUTSIDE, round].concat();
        assert_eq!(check(&island), overlapping);
    }
}
