//! Sums over simplices: the segments of a wire, the triangles of a shell, the tetrahedra that the triangles of a closed
//! mesh span with a point.
//!
//! A uniform simplex with corners `v_0 … v_k`, `s = Σ v` and content w (length, area, volume) has
//! `∫ dm = w`, `∫ r dm = w s/(k + 1)`, `∫ r rᵀ dm = w (Σ v vᵀ + s sᵀ)/((k + 1)(k + 2))`.
//!
//! Coordinates are taken from a reference within the body, so that nothing cancels wherever the body stands. Simplex i
//! goes to lane `i mod 8` of block `i / 4096`; lanes and blocks are merged in a fixed tree (see
//! [`tree_sum`](crate::numerics::tree_sum)), so the bits depend neither on threads nor on how a stream is cut.

use std::convert::Infallible;
use std::marker::PhantomData;

use nalgebra::{Matrix3, Vector3};

use super::error_bound::UNIT;
use crate::error::Error;
use crate::numerics::dispatch::{Kernel, dispatch};
use crate::numerics::double_double::two_sum;
use crate::numerics::lane::{BASELINE, Double, Lane};
use crate::numerics::split_vector::along_axes;
use crate::numerics::structure_of_arrays::{ROWS, StructureOfArrays};
use crate::numerics::threads::{Watch, fill_blocks};
use crate::numerics::tree_sum::{self, BLOCK, depth, sum_blocks};
use crate::principal::principal_axes;

// What the sums over simplices come to in a frame.

/// What an element of other matter adds: content, first moment (3), second moment (6), what rounding can have done to the
/// content.
pub(super) const ELEMENT: usize = 11;

/// What was summed, in the coordinates and the unit of a frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sums {
    pub(in crate::mass) frame: LocalFrame,
    pub(in crate::mass) count: usize,
    /// `∫ dm`.
    pub(in crate::mass) content: f64,
    /// The same with every simplex counted as positive.
    pub(in crate::mass) magnitude: f64,
    pub(in crate::mass) first: Vector3<f64>,
    pub(in crate::mass) second: Matrix3<f64>,
    /// What the rounding of each simplex's content is relative to, by [`Kind::content`]; of other elements, along x what
    /// rounding can have done to the content.
    pub(in crate::mass) scale: Vector3<f64>,
    /// The largest coordinates.
    pub(in crate::mass) extent: Vector3<f64>,
}

impl Sums {
    pub(in crate::mass) fn new<K: Kind<N>, const N: usize>(
        partial: &Partial,
        count: usize,
        frame: &LocalFrame,
    ) -> Self {
        let [
            w,
            p,
            x,
            y,
            z,
            xx,
            xy,
            xz,
            yy,
            yz,
            zz,
            scale @ ..,
            e1,
            e2,
            e3,
        ] = *partial;
        Self {
            frame: *frame,
            count,
            content: K::FACTOR * w,
            magnitude: K::FACTOR * p,
            first: Vector3::new(x, y, z) * (K::FACTOR / K::VERTICES),
            second: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
                * (K::FACTOR / (K::VERTICES * (K::VERTICES + 1.0))),
            scale: Vector3::from(scale) * K::FACTOR,
            extent: Vector3::new(e1, e2, e3),
        }
    }

    /// The sums of `count` elements of positive content, in blocks.
    ///
    /// # Errors
    /// [`Error::Stopped`] where `watch` said so.
    pub(in crate::mass) fn of_elements(
        count: usize,
        frame: &LocalFrame,
        extent: Vector3<f64>,
        watch: &mut Watch<'_>,
        element: impl Fn(usize) -> [f64; ELEMENT] + Sync,
    ) -> Result<Self, Error> {
        let [w, x, y, z, xx, xy, xz, yy, yz, zz, error] = sum_blocks(count, watch, |range| {
            tree_sum::block_sum(range.start, range.end, &element)
        })?;
        Ok(Self {
            frame: *frame,
            count,
            content: w,
            magnitude: w,
            first: Vector3::new(x, y, z),
            second: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
            scale: Vector3::new(error, 0.0, 0.0),
            extent,
        })
    }

    /// Centre of mass from the reference, in the frame.
    pub(in crate::mass) fn center(&self) -> Vector3<f64> {
        self.first / self.content
    }

    /// Second moment about the centre of mass, per content, in the frame.
    pub(in crate::mass) fn central(&self) -> Matrix3<f64> {
        let c = self.center();
        self.second / self.content - c * c.transpose()
    }

    /// The number of roundings that a simplex passes on its way to the total, at most.
    pub(in crate::mass) fn roundings(&self) -> f64 {
        UNIT * (depth(self.count) + 24.0)
    }

    /// The frame of the body's own axes and centre, as far as these sums know them.
    pub(in crate::mass) fn own_frame(&self) -> LocalFrame {
        let old = self.frame.rotation();
        LocalFrame {
            reference: self.frame.reference + old * self.center() * self.frame.unit,
            unit: self.frame.unit,
            axes: Some(old * principal_axes(&self.central()).axes),
        }
    }
}

/// Sums over all simplices, on several threads when there are many.
///
/// # Errors
/// [`Error::Stopped`] where `watch` said so.
pub(super) fn sums<C: Corners<N>, K: Kind<N>, const N: usize>(
    corners: &C,
    frame: &LocalFrame,
    watch: &mut Watch<'_>,
) -> Result<Sums, Error> {
    let count = corners.count();
    let mut blocks = vec![[0.0; TERMS]; count.div_ceil(BLOCK)];
    fill_blocks(&mut blocks, 1, watch, |block, out| {
        out[0] = block_sum::<C, K, N>(
            corners,
            block * BLOCK,
            count.min((block + 1) * BLOCK),
            frame,
        );
        Ok::<(), Infallible>(())
    })?;
    Ok(Sums::new::<K, N>(&merge(&blocks), count, frame))
}

// What the content of a simplex is: a length, an area or a volume.

/// What the content of a simplex is.
pub(super) trait Kind<const N: usize> {
    /// Corners that count: those stored, and the reference itself in a solid.
    const VERTICES: f64;
    /// Content is this times [`Kind::content`].
    const FACTOR: f64;
    /// A multiple of the content, which may be negative, and what its rounding errors are relative to.
    fn content<L: Lane>(corners: &[[L; 3]; N]) -> (L, [L; 3]);
}

/// Segments: the length.
pub(super) struct Wire;

/// Triangles: the area.
pub(super) struct Shell;

/// Triangles whose normals may be too short to be squared: the area.
pub(super) struct FaintShell;

/// Tetrahedra from the reference to triangles: the signed volume.
pub(super) struct Solid;

impl Kind<2> for Wire {
    const VERTICES: f64 = 2.0;
    const FACTOR: f64 = 1.0;

    #[inline(always)]
    fn content<L: Lane>(corners: &[[L; 3]; 2]) -> (L, [L; 3]) {
        let zero = L::new(0.0);
        (norm(difference(corners[1], corners[0])), [zero; 3])
    }
}

impl Kind<3> for Shell {
    const VERTICES: f64 = 3.0;
    const FACTOR: f64 = 0.5;

    #[inline(always)]
    fn content<L: Lane>(corners: &[[L; 3]; 3]) -> (L, [L; 3]) {
        let (normal, scale) = area(corners);
        (norm(normal), scale)
    }
}

impl Kind<3> for FaintShell {
    const VERTICES: f64 = 3.0;
    const FACTOR: f64 = 0.5;

    #[inline(always)]
    fn content<L: Lane>(corners: &[[L; 3]; 3]) -> (L, [L; 3]) {
        let (normal, scale) = area(corners);
        let longest = normal[0].abs().max(normal[1].abs()).max(normal[2].abs());
        let (power, inverse) = longest.power_of_two_scale();
        let near = [normal[0] * power, normal[1] * power, normal[2] * power];
        (norm(near) * inverse, scale)
    }
}

/// Twice the area of a triangle along its normal, and what its rounding errors are relative to.
#[inline(always)]
fn area<L: Lane>(corners: &[[L; 3]; 3]) -> ([L; 3], [L; 3]) {
    let (e, f) = edges(corners);
    let (normal, positive) = cross(e, f);
    let length = |v: [L; 3]| v[0].abs() + v[1].abs() + v[2].abs();
    (
        normal,
        [length(positive), length(e) + length(f), L::new(0.0)],
    )
}

impl Kind<3> for Solid {
    const VERTICES: f64 = 4.0;
    const FACTOR: f64 = 1.0 / 6.0;

    // From the edges rather than from the corners: in a fine mesh they are short, and so are their rounding errors.
    #[inline(always)]
    fn content<L: Lane>(corners: &[[L; 3]; 3]) -> (L, [L; 3]) {
        let (e, f) = edges(corners);
        let (normal, positive) = cross(e, f);
        (dot(corners[0], normal), positive)
    }
}

#[inline(always)]
fn edges<L: Lane>(corners: &[[L; 3]; 3]) -> ([L; 3], [L; 3]) {
    (
        difference(corners[1], corners[0]),
        difference(corners[2], corners[0]),
    )
}

// Where the coordinates of a sum are taken from, and how exactly.

/// Where coordinates are taken from: `Vᵀ (r − reference)/unit`.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalFrame {
    pub(in crate::mass) reference: Vector3<f64>,
    /// A power of two, so that nothing is rounded: lengths of 1e±150 have fifth powers too.
    pub(in crate::mass) unit: f64,
    /// V, a rotation; `None` is the body axes.
    pub(in crate::mass) axes: Option<Matrix3<f64>>,
}

impl LocalFrame {
    /// In the middle of a box, in units of its size.
    pub(in crate::mass) fn of_box(low: &Vector3<f64>, high: &Vector3<f64>) -> Self {
        let size = (high * 0.5 - low * 0.5).max();
        // Of a denormal size the least normal power, whose reciprocal is a number.
        let power = f64::from_bits(size.to_bits() & 0x7ff0_0000_0000_0000).max(f64::MIN_POSITIVE);
        Self {
            reference: low * 0.5 + high * 0.5,
            unit: if power.is_finite() && size > 0.0 {
                power
            } else {
                1.0
            },
            axes: None,
        }
    }

    /// About a point, in body axes.
    #[inline]
    pub(in crate::mass) fn about(reference: Vector3<f64>) -> Self {
        Self {
            reference,
            unit: 1.0,
            axes: None,
        }
    }

    /// V.
    #[inline]
    pub(in crate::mass) fn rotation(&self) -> Matrix3<f64> {
        self.axes.unwrap_or_else(Matrix3::identity)
    }

    /// One point in it.
    pub(in crate::mass) fn place(&self, point: &[f64; 3]) -> Vector3<f64> {
        let r = point.map(Double::<BASELINE>::new);
        let placed = match &self.axes {
            None => ShiftedFrame::of(self).place(r),
            Some(axes) => RotatedFrame::of(self, axes).place(r),
        };
        Vector3::from(placed.map(Lane::get))
    }
}

/// How corners are placed in a frame.
trait CoordinateMap: Copy {
    fn place<L: Lane>(&self, r: [L; 3]) -> [L; 3];
}

/// `(r − reference)/unit`.
#[derive(Clone, Copy)]
struct ShiftedFrame {
    reference: [f64; 3],
    inverse: f64,
}

impl ShiftedFrame {
    fn of(frame: &LocalFrame) -> Self {
        Self {
            reference: frame.reference.into(),
            inverse: 1.0 / frame.unit,
        }
    }
}

impl CoordinateMap for ShiftedFrame {
    #[inline(always)]
    fn place<L: Lane>(&self, r: [L; 3]) -> [L; 3] {
        let inverse = L::new(self.inverse);
        let [x, y, z] = self.reference;
        [
            (r[0] - L::new(x)) * inverse,
            (r[1] - L::new(y)) * inverse,
            (r[2] - L::new(z)) * inverse,
        ]
    }
}

/// `Vᵀ (r − reference)/unit` with the rounding errors of difference and products carried along: across the thin direction
/// large terms cancel, and what is left must be that of the stored coordinates.
#[derive(Clone, Copy)]
struct RotatedFrame {
    reference: [f64; 3],
    inverse: f64,
    axes: [[f64; 3]; 3],
}

impl RotatedFrame {
    fn of(frame: &LocalFrame, axes: &Matrix3<f64>) -> Self {
        Self {
            reference: frame.reference.into(),
            inverse: 1.0 / frame.unit,
            axes: axes.data.0,
        }
    }
}

impl CoordinateMap for RotatedFrame {
    #[inline(always)]
    fn place<L: Lane>(&self, r: [L; 3]) -> [L; 3] {
        let inverse = L::new(self.inverse);
        let [x, y, z] = self.reference;
        let from = [
            two_sum(r[0] * inverse, L::new(-x * self.inverse)),
            two_sum(r[1] * inverse, L::new(-y * self.inverse)),
            two_sum(r[2] * inverse, L::new(-z * self.inverse)),
        ];
        along_axes(from, &self.axes)
    }
}

// The sums over a block of simplices, eight side by side, and blocks merged in a fixed tree.

/// N stored corners for each simplex.
pub(super) trait Corners<const N: usize>: Sync {
    fn count(&self) -> usize;
    /// The corners of one simplex; NaN where there is no such corner.
    fn corners(&self, index: usize) -> [[f64; 3]; N];
}

/// Content, its magnitude, first moment (3), second moment (6), what rounding is relative to (3), extents (3).
const TERMS: usize = 17;

/// The terms that are summed; of the others the largest counts.
const SUMMED: usize = 14;

const LANES: usize = 8;

/// The sums over one block, or over several.
pub(super) type Partial = [f64; TERMS];

#[inline(always)]
fn terms<L: Lane, K: Kind<N>, const N: usize>(corners: &[[L; 3]; N]) -> [L; TERMS] {
    let (w, scale) = K::content(corners);
    let mut s = corners[0];
    let mut extent = [
        corners[0][0].abs(),
        corners[0][1].abs(),
        corners[0][2].abs(),
    ];
    let mut n = 1;
    while n < N {
        let mut k = 0;
        while k < 3 {
            s[k] = s[k] + corners[n][k];
            extent[k] = extent[k].max(corners[n][k].abs());
            k += 1;
        }
        n += 1;
    }
    [
        w,
        w.abs(),
        w * s[0],
        w * s[1],
        w * s[2],
        w * product(corners, &s, 0, 0),
        w * product(corners, &s, 0, 1),
        w * product(corners, &s, 0, 2),
        w * product(corners, &s, 1, 1),
        w * product(corners, &s, 1, 2),
        w * product(corners, &s, 2, 2),
        scale[0],
        scale[1],
        scale[2],
        extent[0],
        extent[1],
        extent[2],
    ]
}

/// `Σ v_i v_j + s_i s_j`.
#[inline(always)]
fn product<L: Lane, const N: usize>(corners: &[[L; 3]; N], s: &[L; 3], i: usize, j: usize) -> L {
    let mut sum = s[i] * s[j];
    let mut n = 0;
    while n < N {
        sum = corners[n][i].mul_add(corners[n][j], sum);
        n += 1;
    }
    sum
}

/// Sums over the simplices of one block.
struct Block<'a, C, P, K, const N: usize> {
    corners: &'a C,
    from: usize,
    to: usize,
    place: P,
    /// Where a simplex has no content.
    nowhere: [f64; 3],
    kind: PhantomData<K>,
}

impl<C: Corners<N>, P: CoordinateMap, K: Kind<N>, const N: usize> Kernel for Block<'_, C, P, K, N> {
    type Output = Partial;

    #[inline(always)]
    fn run<L: Lane>(self) -> Partial {
        let place = self.place;
        let mut lanes = [[0.0; LANES]; TERMS];
        let mut batch = [StructureOfArrays::<3>::ZERO; N];
        let mut results = StructureOfArrays::<TERMS>::ZERO;
        let mut from = self.from;
        while from < self.to {
            let rows = ROWS.min(self.to - from);
            for row in 0..rows {
                let corners = self.corners.corners(from + row);
                for (planes, corner) in batch.iter_mut().zip(corners) {
                    planes.set(row, corner);
                }
            }
            // The last batch may be short: its other rows count nothing.
            for row in rows..ROWS {
                for planes in &mut batch {
                    planes.set(row, self.nowhere);
                }
            }
            for row in 0..ROWS {
                let mut placed = [[L::new(0.0); 3]; N];
                let mut n = 0;
                while n < N {
                    placed[n] = place.place(batch[n].lanes::<L>(row));
                    n += 1;
                }
                results.set_lanes(row, terms::<L, K, N>(&placed));
            }
            results.add_to(&mut lanes, SUMMED);
            from += rows;
        }
        let mut partial = [0.0; TERMS];
        for (k, (total, [a, b, c, d, e, f, g, h])) in partial.iter_mut().zip(lanes).enumerate() {
            *total = if k < SUMMED {
                ((a + e) + (c + g)) + ((b + f) + (d + h))
            } else {
                [b, c, d, e, f, g, h].into_iter().fold(a, f64::max)
            };
        }
        partial
    }
}

/// The sums over simplices `from..to`, at most a block of them, which `from` begins.
pub(super) fn block_sum<C: Corners<N>, K: Kind<N>, const N: usize>(
    corners: &C,
    from: usize,
    to: usize,
    frame: &LocalFrame,
) -> Partial {
    match &frame.axes {
        None => dispatch(Block::<C, _, K, N> {
            corners,
            from,
            to,
            place: ShiftedFrame::of(frame),
            nowhere: frame.reference.into(),
            kind: PhantomData,
        }),
        Some(axes) => dispatch(Block::<C, _, K, N> {
            corners,
            from,
            to,
            place: RotatedFrame::of(frame, axes),
            nowhere: frame.reference.into(),
            kind: PhantomData,
        }),
    }
}

/// The blocks merged in a fixed tree.
pub(super) fn merge(blocks: &[Partial]) -> Partial {
    match blocks {
        [] => [0.0; TERMS],
        [one] => *one,
        _ => {
            let half = blocks.len().next_power_of_two() / 2;
            let (mut sum, other) = (merge(&blocks[..half]), merge(&blocks[half..]));
            for k in 0..TERMS {
                sum[k] = if k < SUMMED {
                    sum[k] + other[k]
                } else {
                    sum[k].max(other[k])
                };
            }
            sum
        }
    }
}

// Differences and products of vectors in lanes.

#[inline(always)]
fn difference<L: Lane>(a: [L; 3], b: [L; 3]) -> [L; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn dot<L: Lane>(a: [L; 3], b: [L; 3]) -> L {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

#[inline(always)]
fn norm<L: Lane>(a: [L; 3]) -> L {
    dot(a, a).sqrt()
}

/// `e × f`, and the same with the magnitudes of all products.
#[inline(always)]
fn cross<L: Lane>(e: [L; 3], f: [L; 3]) -> ([L; 3], [L; 3]) {
    let (p, q) = component(e[1], f[2], e[2], f[1]);
    let (r, s) = component(e[2], f[0], e[0], f[2]);
    let (t, u) = component(e[0], f[1], e[1], f[0]);
    ([p, r, t], [q, s, u])
}

/// `a b − c d` and `|a b| + |c d|`.
#[inline(always)]
fn component<L: Lane>(a: L, b: L, c: L, d: L) -> (L, L) {
    let cd = c * d;
    (a.mul_add(b, -cd), a.abs().mul_add(b.abs(), cd.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_coordinate_keeps_what_large_terms_leave() {
        // Across a line through both points the exact coordinate is 2⁻⁶⁰ times a component of the axis.
        let third = 1.0 / 3.0_f64.sqrt();
        let axes = Matrix3::new(
            third,
            0.5_f64.sqrt(),
            0.0,
            third,
            -(0.5_f64.sqrt()),
            0.0,
            third,
            0.0,
            1.0,
        );
        let frame = LocalFrame {
            reference: Vector3::repeat(0.1),
            unit: 1.0,
            axes: Some(axes),
        };
        let tiny = 2.0_f64.powi(-50);
        let r = [1.1 + tiny, 1.1, 7.0].map(Double::<BASELINE>::new);
        let placed = RotatedFrame::of(&frame, &axes).place(r);
        let step = (1.1 + tiny) - 1.1;
        assert_eq!(placed[1].get(), step * 0.5_f64.sqrt());
    }

    #[test]
    fn the_unit_is_a_power_of_two_of_any_size() {
        for size in [1e-306, 3e-5, 1.0, 7e200, 1.7e308] {
            let frame = LocalFrame::of_box(&Vector3::zeros(), &Vector3::repeat(size));
            assert!((0.5..=1.0).contains(&(size / 2.0 / frame.unit / 2.0)));
        }
        let denormal = LocalFrame::of_box(&Vector3::zeros(), &Vector3::repeat(1e-310));
        assert_eq!(denormal.unit, f64::MIN_POSITIVE);
        let nothing = LocalFrame::of_box(&Vector3::zeros(), &Vector3::zeros());
        assert_eq!(nothing.unit, 1.0);
    }
}
