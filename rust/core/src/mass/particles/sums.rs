//! Sums over particles, eight particles side by side.
//!
//! Particle i goes to the virtual lane i mod 8 of its block, see [`tree_sum`](crate::numerics::tree_sum).

use nalgebra::{Matrix3, Vector3};

use crate::numerics::dispatch::{Kernel, dispatch};
use crate::numerics::double_double::two_sum;
use crate::numerics::lane::Lane;
use crate::numerics::split_vector::along_axes;
use crate::numerics::tree_sum::{LANES, merge_lanes};

/// What one particle adds to `K` sums.
pub(crate) trait Addend<const K: usize>: Copy + Sync {
    /// The sums with the particle of this mass at this position. Mark the implementation `#[inline(always)]`.
    fn add<L: Lane>(&self, mass: L, position: [L; 3], sums: [L; K]) -> [L; K];

    /// Two sets of sums as one. Mark an implementation `#[inline(always)]`.
    #[inline(always)]
    fn merge(a: [f64; K], b: [f64; K]) -> [f64; K] {
        std::array::from_fn(|k| a[k] + b[k])
    }
}

/// The sums over one block of particles.
#[inline]
pub(crate) fn block_sums<const K: usize, A: Addend<K>>(
    masses: &[f64],
    positions: &[[f64; 3]],
    addend: A,
) -> [f64; K] {
    dispatch(Block {
        masses,
        positions,
        addend,
    })
}

struct Block<'a, const K: usize, A> {
    masses: &'a [f64],
    positions: &'a [[f64; 3]],
    addend: A,
}

impl<const K: usize, A: Addend<K>> Kernel for Block<'_, K, A> {
    type Output = [f64; K];

    #[inline(always)]
    fn run<L: Lane>(self) -> Self::Output {
        let mut sums = [[L::new(0.0); LANES]; K];
        let (masses, odd_masses) = self.masses.as_chunks::<LANES>();
        let (positions, odd_positions) = self.positions.as_chunks::<LANES>();
        for (masses, positions) in masses.iter().zip(positions) {
            add_eight(masses, positions, &self.addend, &mut sums);
        }
        if let Some(&last) = odd_positions.last() {
            // Filled up with particles of no mass, which add exactly zero.
            let (mut masses, mut positions) = ([0.0; LANES], [last; LANES]);
            masses[..odd_masses.len()].copy_from_slice(odd_masses);
            positions[..odd_positions.len()].copy_from_slice(odd_positions);
            add_eight(&masses, &positions, &self.addend, &mut sums);
        }
        // The lanes are merged here, where they are still in registers.
        let mut lanes = [[0.0; K]; LANES];
        for (lane, own) in lanes.iter_mut().enumerate() {
            for (sum, own) in own.iter_mut().zip(&sums) {
                *sum = own[lane].get();
            }
        }
        merge_lanes(lanes, A::merge)
    }
}

/// One particle to each lane. All of its sums in one loop over the lanes: a loop so long is not unrolled before it is
/// vectorised, and the sums stay in registers.
#[inline(always)]
fn add_eight<const K: usize, A: Addend<K>, L: Lane>(
    masses: &[f64; LANES],
    positions: &[[f64; 3]; LANES],
    addend: &A,
    sums: &mut [[L; LANES]; K],
) {
    for lane in 0..LANES {
        let mut own = [L::new(0.0); K];
        let mut k = 0;
        while k < K {
            own[k] = sums[k][lane];
            k += 1;
        }
        let [x, y, z] = positions[lane];
        let r = [L::new(x), L::new(y), L::new(z)];
        let own = addend.add(L::new(masses[lane]), r, own);
        let mut k = 0;
        while k < K {
            sums[k][lane] = own[k];
            k += 1;
        }
    }
}

/// The sums of [`Central`] and [`CentralInAxes`]: m; m y (3); m y yᵀ (xx, xy, xz, yy, yz, zz); masses below zero.
pub(crate) const MOMENTS: usize = 11;

/// Moments about a point, in body axes: `y = r − reference`.
#[derive(Clone, Copy)]
pub(crate) struct Central {
    pub(crate) reference: Vector3<f64>,
}

impl Addend<MOMENTS> for Central {
    #[inline(always)]
    fn add<L: Lane>(&self, mass: L, r: [L; 3], sums: [L; MOMENTS]) -> [L; MOMENTS] {
        let [x, y, z] = r;
        let c = &self.reference;
        let y = [x - L::new(c.x), y - L::new(c.y), z - L::new(c.z)];
        moments(mass, y, sums)
    }
}

/// Moments about a point in the given axes: `y = axesᵀ (r − reference)`, with the rounding errors of difference and
/// products carried along. Across the thin direction large terms cancel, and what is left must be that of the stored
/// coordinates.
#[derive(Clone, Copy)]
pub(crate) struct CentralInAxes {
    pub(crate) reference: Vector3<f64>,
    pub(crate) axes: Matrix3<f64>,
}

impl Addend<MOMENTS> for CentralInAxes {
    #[inline(always)]
    fn add<L: Lane>(&self, mass: L, r: [L; 3], sums: [L; MOMENTS]) -> [L; MOMENTS] {
        let c = &self.reference;
        let from = [
            two_sum(r[0], L::new(-c.x)),
            two_sum(r[1], L::new(-c.y)),
            two_sum(r[2], L::new(-c.z)),
        ];
        moments(mass, along_axes(from, &self.axes.data.0), sums)
    }
}

#[inline(always)]
fn moments<L: Lane>(m: L, [x, y, z]: [L; 3], sums: [L; MOMENTS]) -> [L; MOMENTS] {
    let [s, sx, sy, sz, xx, xy, xz, yy, yz, zz, below] = sums;
    let (mx, my, mz) = (m * x, m * y, m * z);
    [
        s + m,
        sx + mx,
        sy + my,
        sz + mz,
        mx.mul_add(x, xx),
        mx.mul_add(y, xy),
        mx.mul_add(z, xz),
        my.mul_add(y, yy),
        my.mul_add(z, yz),
        mz.mul_add(z, zz),
        below + m.min(L::new(0.0)),
    ]
}
