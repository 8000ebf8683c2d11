//! Bodies of voxels: a density for each cell of a rectangular grid, each cell a homogeneous box.
//!
//! # Examples
//!
//! ```
//! use std::ops::ControlFlow;
//! use polhode::RigidBody;
//! use polhode::mass::voxels::{Grid, Voxel, voxels};
//!
//! /// A cube of 1 m, of cells with these densities.
//! fn cube<T: Voxel>(density: &[T]) -> Result<RigidBody, polhode::Error> {
//!     let grid = Grid::of_boxes(density, [2; 3], [0.5; 3], [0.25; 3])?;
//!     voxels(&grid, &mut |_| ControlFlow::Continue(()))
//! }
//! let body = cube(&[1000.0_f32; 8])?; // as a scanner stores them
//! assert_eq!(body.mass(), 1000.0);
//! assert!((body.inertia()[(0, 0)] - 1000.0 / 6.0).abs() < 1e-12); // m a²/6: cells are no points
//! assert_eq!(cube(&[1000.0; 8])?.center_of_mass(), body.center_of_mass());
//! # Ok::<(), polhode::Error>(())
//! ```

use std::convert::Infallible;

use nalgebra::{Matrix3, Vector3};

use super::body::RigidBody;
use super::error_bound::ErrorBound;
use super::integrator::{Matter, integrate};
use super::particles::Watch;
use super::particles::sums::{CentralInAxes, block_sums};
use super::provenance::{BodySource, Checks, Provenance};
use super::scaling::Units;
use super::second_moment::SecondMoment;
use super::simplex::LocalFrame;
use crate::error::{BodyFault, Error, all_finite, finite};
use crate::numerics::dispatch::{Kernel, dispatch};
use crate::numerics::lane::Lane;
use crate::numerics::power_of_two::{exponent, times_power_of_two};
use crate::numerics::threads::fill_blocks;
use crate::numerics::tree_sum::{depth, sum_blocks, sum_terms};

// The body of a grid of cells.

/// Densities on a grid: that of cell (i, j, k) at `(i ny + j) nz + k`, its centre at `origin + i e₁ + j e₂ + k e₃`.
#[derive(Clone, Copy, Debug)]
pub struct Grid<'a, T> {
    /// The densities.
    pub density: &'a [T],
    /// Cells along the three edges.
    pub shape: [usize; 3],
    /// Edges of a cell: the steps e from its centre to the next ones. They may be skew, and left-handed.
    pub edges: [[f64; 3]; 3],
    /// Centre of the cell (0, 0, 0).
    pub origin: [f64; 3],
}

impl<'a, T> Grid<'a, T> {
    /// A grid of boxes, with edges of these lengths along x, y and z.
    ///
    /// # Errors
    /// When a length is not positive and finite.
    pub fn of_boxes(
        density: &'a [T],
        shape: [usize; 3],
        spacing: [f64; 3],
        origin: [f64; 3],
    ) -> Result<Self, Error> {
        Ok(Self {
            density,
            shape,
            edges: edges_of_boxes(spacing)?,
            origin,
        })
    }
}

/// The edges of a box by their lengths.
///
/// # Errors
/// When a length is not positive and finite.
pub fn edges_of_boxes(spacing: [f64; 3]) -> Result<[[f64; 3]; 3], Error> {
    for value in spacing {
        finite("spacing", value)?;
        if value <= 0.0 {
            return Err(Error::OutOfDomain {
                what: "spacing",
                law: "positive",
                value,
            });
        }
    }
    let [x, y, z] = spacing;
    Ok([[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]])
}

/// Edges of which the volume is a smaller part of the product of their lengths are in one plane to rounding.
const FLAT: f64 = 1e-14;

/// The edges of a cell, and what follows from them.
#[derive(Clone, Copy)]
pub(super) struct Edges {
    /// As columns.
    pub(super) matrix: Matrix3<f64>,
    is_box: bool,
}

impl Edges {
    pub(super) fn of(edges: &[[f64; 3]; 3]) -> Self {
        let matrix = Matrix3::from_columns(&edges.map(Vector3::from));
        Self {
            matrix,
            is_box: matrix == Matrix3::from_diagonal(&matrix.diagonal()),
        }
    }

    /// The exponents of their lengths.
    pub(super) fn exponents(&self) -> [i32; 3] {
        [0, 1, 2].map(|k| exponent(self.matrix.column(k).amax()))
    }

    /// The same, divided by a power of two.
    pub(super) fn scaled(&self, power: i32) -> Self {
        Self {
            matrix: self.matrix.map(|x| times_power_of_two(x, -power)),
            ..*self
        }
    }

    /// The volume of a cell, divided by a power of two for each edge.
    pub(super) fn volume(&self) -> f64 {
        let powers = self.exponents();
        let own = |i: usize, k: usize| times_power_of_two(self.matrix[(i, k)], -powers[k]);
        if self.is_box {
            return (own(0, 0) * own(1, 1) * own(2, 2)).abs();
        }
        Matrix3::from_fn(own).determinant().abs()
    }

    /// That they are finite and span a volume.
    ///
    /// # Errors
    /// The number that offends.
    pub(super) fn check(&self) -> Result<(), Error> {
        all_finite("affine", self.matrix.as_slice())?;
        let powers = self.exponents();
        let lengths: f64 = (0..3)
            .map(|k| {
                let edge = self.matrix.column(k);
                edge.map(|x| times_power_of_two(x, -powers[k])).norm()
            })
            .product();
        let value = self.volume() / lengths;
        if value > FLAT {
            return Ok(());
        }
        let value = if value.is_nan() { 0.0 } else { value };
        Err(Error::OutOfDomain {
            what: "affine",
            law: "a matrix whose first three columns, the edges of a voxel, are not in one plane: their volume over the product of their lengths must be above 1e-14",
            value,
        })
    }

    /// The second moment of a cell of unit mass about its own centre.
    pub(super) fn of_cell(&self) -> Matrix3<f64> {
        self.matrix * self.matrix.transpose() / 12.0
    }

    /// A vector in steps along the edges.
    fn steps(&self, vector: &Vector3<f64>) -> Vector3<f64> {
        if self.is_box {
            return vector.component_div(&self.matrix.diagonal());
        }
        let inverse = self.matrix.try_inverse();
        inverse.map_or_else(Vector3::zeros, |inverse| inverse * vector)
    }
}

/// The body of these cells: `I = Σ ρ V ((r² 1 − r rᵀ) + I_cell)`, the second moment of a cell about its own centre being
/// `V h²/12` along each of its edges.
///
/// One pass over the densities; a thin body is summed again in its own axes. Sums are about the middle of the grid, or
/// about the centre of mass where that stands so far from the middle that digits would be lost.
///
/// # Errors
/// When a density is negative or not finite, all are zero, an edge is not positive, the grid has no cells, or `watch`,
/// asked about every 20 ms, stops the work.
///
/// # Panics
/// When the number of densities is not that of the cells.
pub fn voxels<T: Voxel>(grid: &Grid<'_, T>, watch: &mut Watch<'_>) -> Result<RigidBody, Error> {
    assert_eq!(
        grid.density.len(),
        grid.shape.iter().product::<usize>(),
        "one density for each cell"
    );
    if grid.density.is_empty() {
        return Err(Error::Empty { what: "density" });
    }
    let edges = Edges::of(&grid.edges);
    edges.check()?;
    all_finite("origin", &grid.origin)?;
    let [x, y, z] = edges.exponents();
    let length = x.max(y).max(z);
    let mut units = Units {
        mass: x + y + z,
        length,
        place: length,
    };
    let own = |lengths: [f64; 3]| lengths.map(|x| times_power_of_two(x, -length));
    let near = Grid {
        edges: grid.edges.map(own),
        origin: own(grid.origin),
        ..*grid
    };
    let found = near.about_center(watch)?;
    // Sums this small may have lost digits to underflow, larger ones overflowed: densities too are counted in units.
    let range = 2.0_f64.powi(-800)..2.0_f64.powi(900);
    if range.contains(&found.mass) {
        return units.in_user_units(&near.body(&found, watch)?);
    }
    grid.check()?;
    let densities = || grid.density.iter().map(|&density| density.into());
    let densest = densities().fold(0.0, f64::max);
    units.mass += exponent(densest);
    let scaled: Vec<f64> = densities()
        .map(|density| times_power_of_two(density, -exponent(densest)))
        .collect();
    let scaled = Grid {
        density: &scaled,
        shape: near.shape,
        edges: near.edges,
        origin: near.origin,
    };
    units.in_user_units(&scaled.body(&scaled.about_center(watch)?, watch)?)
}

impl<T: Voxel> Grid<'_, T> {
    /// Second moment about the centre of mass in body axes.
    fn about_center(&self, watch: &mut Watch<'_>) -> Result<SecondMoment, Error> {
        let middle = Vector3::from(self.shape.map(|count| (count / 2) as f64));
        let found = self.second_moment(middle, watch)?;
        let d = found.center_of_mass - self.place(&middle);
        if found.mass * d.norm_squared() > found.central.trace() {
            return self.second_moment(self.cell(&found.center_of_mass), watch);
        }
        Ok(found)
    }

    /// The body of this second moment, taken again in its own axes where it is thin.
    fn body(&self, found: &SecondMoment, watch: &mut Watch<'_>) -> Result<RigidBody, Error> {
        let provenance = Provenance::of_matter(
            BodySource::Voxels,
            self.density.len(),
            Checks::FINITE.and(Checks::MASSES),
        );
        integrate(self, found, provenance, watch)
    }

    /// The point at these indices, whole or not.
    fn place(&self, index: &Vector3<f64>) -> Vector3<f64> {
        Vector3::from(self.origin) + Edges::of(&self.edges).matrix * index
    }

    /// How far the way to the place at these indices goes: over the origin of the grid and along the edges, and each part of it
    /// is rounded.
    fn reach(&self, index: &Vector3<f64>) -> Vector3<f64> {
        let edges = Edges::of(&self.edges);
        let way = self.place(index).abs() + Vector3::from(self.origin).abs();
        if edges.is_box {
            return way;
        }
        way + edges.matrix.abs() * index.abs()
    }

    /// The indices of the cell that a point is in.
    fn cell(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let from_origin = point - Vector3::from(self.origin);
        Edges::of(&self.edges).steps(&from_origin).map(f64::round)
    }

    /// Second moment about the centre of mass in body axes, from sums about the cell with these indices.
    fn second_moment(
        &self,
        reference: Vector3<f64>,
        watch: &mut Watch<'_>,
    ) -> Result<SecondMoment, Error> {
        let [nx, ny, nz] = self.shape;
        let mut slabs = vec![[0.0; SLAB]; nx];
        fill_blocks(&mut slabs, 1, watch, |i, out| {
            out[0] = dispatch(Slab {
                density: &self.density[i * ny * nz..(i + 1) * ny * nz],
                length: nz,
                reference: [reference.y, reference.z],
            });
            Ok::<(), Infallible>(())
        })?;
        let sums = sum_terms(nx, |i| {
            let x = i as f64 - reference.x;
            let [s, y, z, yy, yz, zz, below] = slabs[i];
            let sx = s * x;
            [s, sx, y, z, sx * x, x * y, x * z, yy, yz, zz, below]
        });
        let [s, x, y, z, xx, xy, xz, yy, yz, zz, below] = sums;
        if !(s > 0.0 && below == 0.0 && sums.iter().all(|sum| sum.is_finite())) {
            self.check()?;
        }
        let edges = Edges::of(&self.edges);
        let volume = edges.volume();
        let mass = s * volume;
        let first = edges.matrix * Vector3::new(x, y, z) * volume;
        let sums = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let second =
            edges.matrix * sums * edges.matrix.transpose() * volume + edges.of_cell() * mass;
        let place = self.place(&reference);
        let additions = ny as f64 + depth(nx) + depth(nz);
        let reach = self.reach(&reference);
        let bound = ErrorBound::of_additions(additions, mass, &reach, second.trace());
        Ok(SecondMoment::about_reference(
            &place, mass, &first, &second, bound,
        ))
    }

    /// The first density that cannot be, where there is one.
    fn check(&self) -> Result<(), Error> {
        let [_, ny, nz] = self.shape;
        for (cell, &density) in self.density.iter().enumerate() {
            let density = finite("density", density.into())?;
            if density < 0.0 {
                let index = [cell / (ny * nz), cell / nz % ny, cell % nz];
                return Err(BodyFault::NegativeDensity { index, density }.into());
            }
        }
        if self.density.iter().all(|&density| density.into() == 0.0) {
            let law = "positive in at least one cell";
            return Err(Error::OutOfDomain {
                what: "density",
                law,
                value: 0.0,
            });
        }
        Ok(())
    }
}

impl<T: Voxel> Matter for Grid<'_, T> {
    type Moments = SecondMoment;

    /// Second moment about the centre of mass in its own axes.
    ///
    /// The cells count as particles at their whole indices, and the edges are part of the axes: so the thin direction
    /// meets no rounding but that of the edges and axes themselves.
    fn moments(&self, frame: &LocalFrame, watch: &mut Watch<'_>) -> Result<SecondMoment, Error> {
        let [_, ny, nz] = self.shape;
        let axes = frame.rotation();
        let edges = Edges::of(&self.edges);
        let from_origin = frame.reference - Vector3::from(self.origin);
        let addend = CentralInAxes {
            reference: edges.steps(&from_origin),
            axes: edges.matrix.transpose() * axes,
        };
        let count = self.density.len();
        let sums = sum_blocks(count, watch, |block| {
            let masses: Vec<f64> = self.density[block.clone()]
                .iter()
                .map(|&density| density.into())
                .collect();
            let cells: Vec<[f64; 3]> = block
                .map(|cell| [cell / (ny * nz), cell / nz % ny, cell % nz].map(|index| index as f64))
                .collect();
            block_sums(&masses, &cells, addend)
        })?;
        let volume = edges.volume();
        let [mass, x, y, z, xx, xy, xz, yy, yz, zz, _] = sums.map(|sum| sum * volume);
        let first = Vector3::new(x, y, z);
        let second = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
            + axes.tr_mul(&edges.of_cell()) * axes * mass;
        let place = self.place(&addend.reference);
        let bound =
            ErrorBound::of_sums(count, mass, &self.reach(&addend.reference), second.trace());
        let about = SecondMoment::about_reference(&Vector3::zeros(), mass, &first, &second, bound);
        Ok(SecondMoment {
            center_of_mass: place + axes * about.center_of_mass,
            axes,
            ..about
        })
    }
}

// Sums over the voxels of equal x.

/// A number that a density may be stored as: `f32` or `f64`. Sums are taken in double precision.
pub trait Voxel: Copy + Into<f64> + Send + Sync {
    /// Whether it is sooner to add four rows of cells at once than one after the other: where the sums that are kept take
    /// longer to read than the densities.
    const FOUR_AT_ONCE: bool;
}

impl Voxel for f32 {
    const FOUR_AT_ONCE: bool = true;
}

impl Voxel for f64 {
    const FOUR_AT_ONCE: bool = false;
}

/// The sums over a slab of cells of equal x: ρ, ρ y, ρ z, ρ y², ρ y z, ρ z², densities below zero; y and z in indices.
const SLAB: usize = 7;

/// The cells of equal x.
struct Slab<'a, T> {
    /// Their densities.
    density: &'a [T],
    /// Cells along z.
    length: usize,
    /// The indices along y and z that are counted from.
    reference: [f64; 2],
}

/// Sums along y for each z.
struct Columns<L> {
    /// ρ.
    sum: Vec<L>,
    /// ρ y.
    first: Vec<L>,
    /// ρ y².
    second: Vec<L>,
    /// Densities below zero.
    below: Vec<L>,
}

impl<L: Lane> Columns<L> {
    #[inline(always)]
    fn new(length: usize) -> Self {
        let zero = || vec![L::new(0.0); length];
        Self {
            sum: zero(),
            first: zero(),
            second: zero(),
            below: zero(),
        }
    }

    /// Adds a row of cells at y.
    #[inline(always)]
    fn add<T: Voxel>(&mut self, row: &[T], y: L) {
        let y_squared = y * y;
        let sums = self.sum.iter_mut().zip(&mut self.first);
        let sums = sums.zip(&mut self.second).zip(&mut self.below);
        for (&density, (((sum, first), second), below)) in row.iter().zip(sums) {
            let density = L::new(density.into());
            *sum = *sum + density;
            *first = density.mul_add(y, *first);
            *second = density.mul_add(y_squared, *second);
            *below = *below + density.min(L::new(0.0));
        }
    }

    /// Adds four rows, in the order of additions of one by one.
    #[inline(always)]
    fn add_four<T: Voxel>(&mut self, rows: &[T], y: [L; 4]) {
        let length = self.sum.len();
        let rows: [&[T]; 4] = std::array::from_fn(|n| &rows[n * length..(n + 1) * length]);
        let first = &mut self.first[..length];
        let second = &mut self.second[..length];
        let below = &mut self.below[..length];
        for k in 0..length {
            for n in 0..4 {
                let density = L::new(rows[n][k].into());
                self.sum[k] = self.sum[k] + density;
                first[k] = density.mul_add(y[n], first[k]);
                second[k] = density.mul_add(y[n] * y[n], second[k]);
                below[k] = below[k] + density.min(L::new(0.0));
            }
        }
    }
}

impl<T: Voxel> Kernel for Slab<'_, T> {
    type Output = [f64; SLAB];

    #[inline(always)]
    fn run<L: Lane>(self) -> [f64; SLAB] {
        let y = |j: usize| L::new(j as f64 - self.reference[0]);
        let mut columns = Columns::new(self.length);
        let mut j = 0;
        let mut rest = self.density;
        if T::FOUR_AT_ONCE {
            let fours = rest.chunks_exact(4 * self.length);
            rest = fours.remainder();
            for rows in fours {
                columns.add_four(rows, [y(j), y(j + 1), y(j + 2), y(j + 3)]);
                j += 4;
            }
        }
        for row in rest.chunks_exact(self.length) {
            columns.add(row, y(j));
            j += 1;
        }
        sum_terms(self.length, |k| {
            let of = |column: &[L]| column[k].get();
            let (s, y, yy) = (of(&columns.sum), of(&columns.first), of(&columns.second));
            let z = k as f64 - self.reference[1];
            [s, y, s * z, yy, y * z, s * z * z, of(&columns.below)]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::ControlFlow;

    fn body(grid: &Grid<'_, f64>) -> RigidBody {
        voxels(grid, &mut |_| ControlFlow::Continue(())).expect("body")
    }

    fn boxes<T>(
        density: &[T],
        shape: [usize; 3],
        spacing: [f64; 3],
        origin: [f64; 3],
    ) -> Grid<'_, T> {
        Grid::of_boxes(density, shape, spacing, origin).expect("boxes")
    }

    /// A cell with skew edges is a parallelepiped: `m/12 Σ (|e|² 1 − e eᵀ)`, whichever hand its edges have.
    #[test]
    fn a_skew_cell_is_a_parallelepiped() {
        let edges = [[1.0, 0.5, 0.0], [0.0, -2.0, 0.25], [0.5, 0.0, 4.0]];
        let found = body(&Grid {
            density: &[3.0],
            shape: [1; 3],
            edges,
            origin: [1.0, 2.0, 3.0],
        });
        // |e₁·(e₂ × e₃)|
        let volume: f64 = 1.0 * (-2.0 * 4.0) - 0.5 * (0.0 * 4.0 - 0.25 * 0.5);
        assert!((found.mass() - 3.0 * volume.abs()).abs() < 1e-14);
        assert_eq!(found.center_of_mass(), Vector3::new(1.0, 2.0, 3.0));
        let mut expected = Matrix3::zeros();
        for edge in edges.map(Vector3::from) {
            expected += Matrix3::identity() * edge.norm_squared() - edge * edge.transpose();
        }
        expected *= found.mass() / 12.0;
        assert!((found.inertia() - expected).amax() < 1e-13);
        let flat = Grid {
            density: &[1.0],
            shape: [1; 3],
            edges: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]],
            origin: [0.0; 3],
        };
        assert!(voxels(&flat, &mut |_| ControlFlow::Continue(())).is_err());
    }

    #[test]
    fn one_cell_is_a_box_wherever_it_is_in_the_grid() {
        for cell in [0, 7, 59] {
            let mut density = vec![0.0; 60];
            density[cell] = 2.0;
            let shape = [3, 4, 5];
            let index = [cell / 20, cell / 5 % 4, cell % 5].map(|i| i as f64);
            let spacing = [1.0, 2.0, 4.0];
            let found = body(&boxes(&density, shape, spacing, [10.0, 20.0, 30.0]));
            assert_eq!(found.mass(), 16.0);
            let center = [0, 1, 2].map(|a| 10.0 * (1.0 + a as f64) + spacing[a] * index[a]);
            assert_eq!(found.center_of_mass(), Vector3::from(center));
            let expected = Vector3::new(20.0, 17.0, 5.0) * (16.0 / 12.0);
            assert!((found.inertia() - Matrix3::from_diagonal(&expected)).amax() < 1e-14);
        }
    }

    #[test]
    fn a_diagonal_row_of_cells_keeps_its_smallest_moment() {
        // Cells (i, i, 0): a rod along (1, 1, 0). Across it only the cells' own extent is left, 2 m h²/12.
        let n = 200;
        let mut density = vec![0.0; n * n];
        (0..n).for_each(|i| density[i * n + i] = 1.0);
        let found = body(&boxes(&density, [n, n, 1], [1.0; 3], [0.0; 3]));
        let exact = n as f64 / 6.0;
        assert!((found.principal().moments[0] / exact - 1.0).abs() < 1e-15);
    }

    #[test]
    fn four_rows_at_once_are_four_rows_one_by_one() {
        // In float32 four rows go together, in float64 each by itself; the last ones are left over.
        for rows in 1..=9 {
            let shape = [2, rows, 3];
            let count = shape.iter().product::<usize>();
            let single: Vec<f32> = (0..count).map(|k| 1.0 / (1.0 + k as f32)).collect();
            let double: Vec<f64> = single.iter().map(|&density| density.into()).collect();
            let (spacing, origin) = ([1.0, 0.3, 0.7], [0.1, -2.0, 5.0]);
            let together = boxes(&single[..], shape, spacing, origin);
            let by_itself = boxes(&double[..], shape, spacing, origin);
            let together = voxels(&together, &mut |_| ControlFlow::Continue(())).expect("body");
            assert!(together == body(&by_itself), "{rows} rows");
        }
    }
}
