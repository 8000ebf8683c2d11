//! Whether a boundary passes through itself.
//!
//! Two edges may cross. Where they only touch, at a corner or along a line, how often the boundary winds around the points
//! on both sides tells whether it passes through itself there: a simple one winds around its inside once, around nothing else.

use nalgebra::Vector2;

use crate::error::{Error, PolygonFault};
use crate::mass::error_bound::UNIT;
use crate::numerics::split_vector::{SplitVector, cross2};
use crate::numerics::threads::Watch;

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
    let touching = boundary.touching(watch)?;
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
    fn touching(&self, watch: &mut Watch<'_>) -> Result<Vec<[usize; 2]>, Error> {
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
                match meeting(self.ends(i), self.ends(j)) {
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

fn meeting([a, b]: [[f64; 2]; 2], [c, d]: [[f64; 2]; 2]) -> Meeting {
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
    use std::ops::ControlFlow;

    use super::*;

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
