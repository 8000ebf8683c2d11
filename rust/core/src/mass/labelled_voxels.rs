//! Bodies of voxels with labels, of one density each: all of an image in one pass.
//!
//! A label's cells add up to whole numbers: their count n, `Σ i`, `Σ i iᵀ` of their indices i. So the second moment about the centre,
//! `Q/(12 n)` with `Q = 12 (n Σ i iᵀ − Σ i Σ iᵀ) + n² 1` for cells of unit edges, is exact before the edges of a cell turn it
//! into lengths, and no second pass is needed for any number of bodies, wherever they are.
//!
//! # Examples
//!
//! ```
//! use polhode::mass::labelled_voxels::{LabelledCells, count_labels};
//! use polhode::mass::voxels::edges_of_boxes;
//! use std::ops::ControlFlow;
//!
//! // Two cells of label 7 and one of label 9 in a row, cells of 1 × 1 × 1.
//! let found = count_labels(&[7_u8, 7, 9], [1, 1, 3], &mut |_| ControlFlow::Continue(()))?;
//! let first: &LabelledCells = &found[0];
//! let body = first.body(&edges_of_boxes([1.0; 3])?, &[0.0; 3], 6.0)?;
//! assert_eq!((first.label, first.count(), body.mass()), (7, 2, 12.0));
//! assert_eq!(body.center_of_mass().z, 0.5);
//! assert_eq!(body.inertia()[(0, 0)], 5.0); // m (1² + 2²)/12
//! # Ok::<(), polhode::Error>(())
//! ```

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use nalgebra::{Matrix3, Vector3};

use super::amount::Amount;
use super::body::RigidBody;
use super::error_bound::ErrorBound;
use super::integrator::{Matter, integrate};
use super::provenance::{BodySource, Checks, Provenance};
use super::scaling::Units;
use super::second_moment::SecondMoment;
use super::simplex::LocalFrame;
use super::voxels::Edges;
use crate::error::{Error, all_finite};
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::power_of_two::{exponent, times_power_of_two};
use crate::numerics::threads::{Watch, fill_blocks};

/// An image with more labels is one of values.
const MOST_LABELS: usize = 1 << 20;

/// An image with more cells along an edge has sums beyond whole numbers of 64 bits.
const MOST_CELLS: usize = 1 << 20;

/// A number that labels may be stored as.
///
/// # Examples
///
/// ```
/// use polhode::mass::labelled_voxels::Label;
///
/// assert_eq!(7_u8.whole(), Ok(7));
/// assert_eq!(3.0_f64.whole(), Ok(3));
/// assert_eq!(0.5_f64.whole(), Err(0.5));
/// ```
pub trait Label: Copy + PartialEq + Sync {
    /// The label as a whole number.
    ///
    /// # Errors
    /// The number, where it is not whole or beyond 64 bits.
    fn whole(self) -> Result<i64, f64>;
}

macro_rules! whole {
    ($($kind:ty)*) => {
        $(impl Label for $kind {
            fn whole(self) -> Result<i64, f64> {
                Ok(self.into())
            }
        })*
    };
}

whole!(u8 i8 u16 i16 u32 i32 i64);

impl Label for u64 {
    fn whole(self) -> Result<i64, f64> {
        i64::try_from(self).map_err(|_| self as f64)
    }
}

impl Label for f64 {
    fn whole(self) -> Result<i64, f64> {
        if self.abs() < 2.0_f64.powi(53) && self.trunc() == self {
            #[expect(clippy::cast_possible_truncation, reason = "whole and below 2^53")]
            return Ok(self as i64);
        }
        Err(self)
    }
}

impl Label for f32 {
    fn whole(self) -> Result<i64, f64> {
        f64::from(self).whole()
    }
}

/// The cells of one label in a grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LabelledCells {
    /// The label.
    pub label: i64,
    /// The first cell along each edge, and the one after the last.
    pub range: [[usize; 2]; 3],
    /// `Σ 1`, `Σ i` and `Σ i iᵀ`: xx, yy, zz, xy, xz, yz.
    count: u128,
    first: [u128; 3],
    second: [u128; 6],
}

/// Sums over the cells of a label with equal first index: 1, j, k, j², k², j k.
#[derive(Clone, Copy, Default)]
struct Slab {
    sums: [u128; 6],
    range: [[usize; 2]; 2],
}

/// Count the cells of every label of a grid, and their indices and squares; labels in ascending order. That of cell (i, j, k) is at
/// `(i ny + j) nz + k`.
///
/// `watch` is asked about every 20 ms whether to go on.
///
/// # Errors
/// When the grid is empty or has more than 2²⁰ cells along an edge, or more than 2²⁰ labels, or a label is not whole or beyond 64 bits;
/// [`Error::Stopped`] where `watch` said so.
///
/// # Panics
/// When the number of labels is not that of the cells.
pub fn count_labels<L: Label>(
    labels: &[L],
    shape: [usize; 3],
    watch: &mut Watch<'_>,
) -> Result<Vec<LabelledCells>, Error> {
    let [nx, ny, nz] = shape;
    assert_eq!(labels.len(), nx * ny * nz, "one label for each cell");
    if labels.is_empty() {
        return Err(Error::Empty { what: "labels" });
    }
    let longest = nx.max(ny).max(nz);
    if longest > MOST_CELLS {
        return Err(Error::OutOfDomain {
            what: "cells along an edge of labels",
            law: "at most 2^20",
            value: longest as f64,
        });
    }
    let all: Mutex<HashMap<i64, LabelledCells>> = Mutex::default();
    let mut done = vec![(); nx];
    fill_blocks(&mut done, 1, watch, |i, _| {
        let slab = slab(&labels[i * ny * nz..(i + 1) * ny * nz], nz)?;
        let mut all = all.lock().unwrap_or_else(PoisonError::into_inner);
        for (label, found) in slab {
            all.entry(label)
                .or_insert_with(|| LabelledCells::none(label, i, &found))
                .add(i, &found);
        }
        if all.len() > MOST_LABELS {
            return Err(Error::OutOfDomain {
                what: "number of different labels",
                law: "at most 2^20: an image of densities or grey values goes to from_voxels",
                value: all.len() as f64,
            });
        }
        Ok(())
    })?;
    let all = all.into_inner().unwrap_or_else(PoisonError::into_inner);
    let mut cells: Vec<LabelledCells> = all.into_values().collect();
    cells.sort_by_key(|cells| cells.label);
    Ok(cells)
}

/// The sums of each label over rows of so many cells. Cells of equal label that follow each other are one run.
///
/// # Errors
/// When a label is not whole.
fn slab<L: Label>(labels: &[L], length: usize) -> Result<Vec<(i64, Slab)>, Error> {
    let mut found: Vec<(i64, Slab)> = Vec::new();
    let mut places: HashMap<i64, usize> = HashMap::new();
    // Where labels of this last byte were found last: a table is sooner read than a map.
    let mut recent = [(0, usize::MAX); 256];
    for (j, row) in labels.chunks_exact(length).enumerate() {
        let mut from = 0;
        while from < length {
            let label = row[from].whole().map_err(|value| Error::OutOfDomain {
                what: "labels",
                law: "whole numbers below 2^63, below 2^53 where they are floats: densities and grey values go to from_voxels",
                value,
            })?;
            let to = from + run(&row[from..]);
            let known = &mut recent[usize::from(label.to_le_bytes()[0])];
            if known.1 == usize::MAX || known.0 != label {
                let place = *places.entry(label).or_insert(found.len());
                if place == found.len() {
                    let range = [[j, j + 1], [from, to]];
                    found.push((
                        label,
                        Slab {
                            range,
                            ..Slab::default()
                        },
                    ));
                }
                *known = (label, place);
            }
            found[known.1].1.add(j, from, to);
            from = to;
        }
    }
    Ok(found)
}

/// How many cells from the first one on have its label.
fn run<L: PartialEq>(row: &[L]) -> usize {
    /// Cells that are compared at once.
    const PIECE: usize = 16;
    let is_same = |other: &L| *other == row[0];
    let mut length = 0;
    for piece in row.chunks_exact(PIECE) {
        if !piece.iter().fold(true, |all, other| all & is_same(other)) {
            break;
        }
        length += PIECE;
    }
    let rest = row[length..].iter();
    length + rest.take_while(|other| is_same(other)).count()
}

impl Slab {
    /// Adds the cells k of `from..to` in row j.
    fn add(&mut self, j: usize, from: usize, to: usize) {
        // Indices are below 2²⁰, so the sums of a row are below 2⁶⁰.
        let (row, a, b) = (j as u64, from as u64, to as u64);
        let count = b - a;
        let first = count * (a + b - 1) / 2;
        let squares = |n: u64| n * (n + 1) * (2 * n + 1) / 6; // of 1 to n
        let up_to = |n: u64| if n == 0 { 0 } else { squares(n - 1) };
        let second = up_to(b) - up_to(a);
        let terms = [
            count,
            row * count,
            first,
            row * row * count,
            second,
            row * first,
        ];
        for (sum, term) in self.sums.iter_mut().zip(terms) {
            *sum += u128::from(term);
        }
        for (range, ends) in self.range.iter_mut().zip([[j, j + 1], [from, to]]) {
            *range = [range[0].min(ends[0]), range[1].max(ends[1])];
        }
    }
}

impl LabelledCells {
    fn none(label: i64, i: usize, slab: &Slab) -> Self {
        let [y, z] = slab.range;
        Self {
            label,
            range: [[i, i + 1], y, z],
            count: 0,
            first: [0; 3],
            second: [0; 6],
        }
    }

    fn add(&mut self, i: usize, slab: &Slab) {
        let [n, y, z, yy, zz, yz] = slab.sums;
        let x = i as u128;
        self.count += n;
        for (sum, term) in self.first.iter_mut().zip([x * n, y, z]) {
            *sum += term;
        }
        let terms = [x * x * n, yy, zz, x * y, x * z, yz];
        for (sum, term) in self.second.iter_mut().zip(terms) {
            *sum += term;
        }
        let [y, z] = slab.range;
        for (range, ends) in self.range.iter_mut().zip([[i, i + 1], y, z]) {
            *range = [range[0].min(ends[0]), range[1].max(ends[1])];
        }
    }

    /// The number of cells.
    #[must_use]
    pub fn count(&self) -> usize {
        self.count as usize
    }

    /// The body of these cells, of one density, with these edges of a cell and the centre of the cell (0, 0, 0).
    ///
    /// # Errors
    /// When the density is not positive, the edges span no volume, or the body is beyond the range of float64.
    pub fn body(
        &self,
        edges: &[[f64; 3]; 3],
        origin: &[f64; 3],
        density: f64,
    ) -> Result<RigidBody, Error> {
        Amount::Density(density).check()?;
        let edges = Edges::of(edges);
        edges.check()?;
        all_finite("origin", origin)?;
        let [x, y, z] = edges.exponents();
        let length = x.max(y).max(z);
        let units = Units {
            mass: x + y + z + exponent(density),
            length,
            place: length,
        };
        let near = edges.scaled(length);
        let matter = Placed {
            cells: self,
            edges: near,
            origin: Vector3::from(*origin).map(|x| times_power_of_two(x, -length)),
            mass: times_power_of_two(density, -exponent(density))
                * (self.count as f64)
                * edges.volume(),
        };
        let go_on: &mut Watch<'_> = &mut |_| std::ops::ControlFlow::Continue(());
        let first = matter.moments(&LocalFrame::about(Vector3::zeros()), go_on)?;
        let checks = Checks::FINITE.and(Checks::MASSES);
        let provenance = Provenance::of_matter(BodySource::Voxels, self.count(), checks);
        units.in_user_units(&integrate(&matter, &first, provenance, go_on)?)
    }

    /// Q, an exact whole number each.
    #[expect(clippy::cast_possible_wrap, reason = "sums below 2^124")]
    fn exact(&self) -> [[DoubleDouble; 3]; 3] {
        let n = self.count;
        let [xx, yy, zz, xy, xz, yz] = self.second;
        let second = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]];
        std::array::from_fn(|a| {
            std::array::from_fn(|b| {
                let central = (n * second[a][b]) as i128 - (self.first[a] * self.first[b]) as i128;
                let own = if a == b { (n * n) as i128 } else { 0 };
                whole(central) * 12.0.into() + whole(own)
            })
        })
    }
}

/// A whole number of up to 106 bits.
#[expect(
    clippy::cast_possible_truncation,
    reason = "a float of less than 2^127"
)]
fn whole(number: i128) -> DoubleDouble {
    let high = number as f64;
    DoubleDouble::sum(high, (number - high as i128) as f64)
}

/// Cells with their edges, lengths in a unit.
struct Placed<'a> {
    cells: &'a LabelledCells,
    edges: Edges,
    origin: Vector3<f64>,
    mass: f64,
}

impl Matter for Placed<'_> {
    type Moments = SecondMoment;

    /// About the centre, in the given axes.
    fn moments(&self, frame: &LocalFrame, _: &mut Watch<'_>) -> Result<SecondMoment, Error> {
        let axes = frame.rotation();
        let n = self.cells.count as f64;
        let mean = Vector3::from(self.cells.first.map(|sum| sum as f64 / n));
        let center_of_mass = self.origin + self.edges.matrix * mean;
        let exact = self.cells.exact();
        let product = |a: f64, b: f64| DoubleDouble::product(a, b);
        // Edges in the axes, Vᵀ L, to twice the precision: across a thin direction large terms cancel.
        let edges: [[DoubleDouble; 3]; 3] = std::array::from_fn(|a| {
            std::array::from_fn(|k| {
                let parts = (0..3).map(|i| product(axes[(i, a)], self.edges.matrix[(i, k)]));
                parts.fold(DoubleDouble::default(), |sum, part| sum + part)
            })
        });
        let per_mass = 1.0 / (12.0 * n * n);
        let central = Matrix3::from_fn(|a, b| {
            let mut sum = DoubleDouble::default();
            for (i, row) in exact.iter().enumerate() {
                for (j, &element) in row.iter().enumerate() {
                    sum += edges[a][i] * element * edges[b][j];
                }
            }
            sum.rounded() * per_mass * self.mass
        });
        let reach = self.origin.abs() + self.edges.matrix.abs() * mean;
        let bound = ErrorBound::of_additions(4.0, self.mass, &reach, central.trace());
        Ok(SecondMoment {
            mass: self.mass,
            center_of_mass,
            central: (central + central.transpose()) * 0.5,
            axes,
            error_bound: bound,
        })
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::mass::voxels::{Grid, voxels};

    #[test]
    fn labels_are_whole_numbers_of_any_kind() {
        let go_on = &mut |_: f64| ControlFlow::Continue(());
        let row: Vec<i64> = (0..200).map(|k| [-3, 7, 263][k / 5 % 7 % 3]).collect();
        let found = count_labels(&row, [1, 1, 200], go_on).expect("cells");
        let floats: Vec<f32> = row.iter().map(|&label| label as f32).collect();
        assert_eq!(count_labels(&floats, [1, 1, 200], go_on), Ok(found));
        for label in [0.5, f64::NAN, f64::INFINITY, 2.0_f64.powi(53)] {
            let refused = count_labels(&[1.0, label], [1, 2, 1], go_on);
            assert!(matches!(
                refused,
                Err(Error::OutOfDomain { what: "labels", .. })
            ));
        }
        assert!(count_labels(&[u64::MAX], [1, 1, 1], go_on).is_err());
    }

    #[test]
    fn a_run_ends_at_the_first_other_label() {
        for length in 1..70 {
            for end in 1..=length {
                let row: Vec<u8> = (0..length).map(|k| u8::from(k >= end)).collect();
                assert_eq!(run(&row), end);
            }
        }
    }

    /// The bodies of all labels at once are those of each label alone.
    #[test]
    fn labels_together_are_labels_alone() {
        let shape = [5, 6, 7];
        let count = shape.iter().product::<usize>();
        let labels: Vec<i16> = (0..count)
            .map(|k| [3, -2, 3, 3, 40][k * k % 11 % 5])
            .collect();
        let edges = [[0.5, 0.1, 0.0], [0.0, -0.7, 0.2], [0.1, 0.0, 0.9]];
        let (origin, go_on) = ([10.0, -20.0, 3.0], &mut |_: f64| ControlFlow::Continue(()));
        let found = count_labels(&labels, shape, go_on).expect("cells");
        assert_eq!(
            found.iter().map(|cells| cells.label).collect::<Vec<_>>(),
            [-2, 3, 40]
        );
        assert_eq!(found.iter().map(LabelledCells::count).sum::<usize>(), count);
        for cells in found {
            let body = cells.body(&edges, &origin, 2.5).expect("a body");
            let of_label = |&label: &i16| {
                if i64::from(label) == cells.label {
                    2.5
                } else {
                    0.0
                }
            };
            let density: Vec<f64> = labels.iter().map(of_label).collect();
            let grid = Grid {
                density: &density,
                shape,
                edges,
                origin,
            };
            let alone = voxels(&grid, go_on).expect("a body");
            assert!(body.is_close(&alone, 1e-14, 1e-14));
        }
    }

    /// A diagonal row of cells far from the first one keeps its smallest moment, `m h²/6`.
    #[test]
    fn a_thin_row_keeps_its_smallest_moment() {
        let n = 300;
        let mut labels = vec![0_u8; n * n];
        (100..n).for_each(|i| labels[i * n + i] = 1);
        let go_on = &mut |_: f64| ControlFlow::Continue(());
        let found = count_labels(&labels, [n, n, 1], go_on).expect("cells");
        let edges = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let body = found[1].body(&edges, &[0.0; 3], 1.0).expect("a body");
        assert_eq!(body.mass(), 200.0);
        assert_eq!(found[1].range, [[100, 300], [100, 300], [0, 1]]);
        let [smallest, ..] = body.principal().moments;
        assert!((smallest / (200.0 / 6.0) - 1.0).abs() < 1e-14, "{smallest}");
    }
}
