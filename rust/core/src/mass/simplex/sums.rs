//! What the sums over simplices come to in a frame.

use std::convert::Infallible;

use nalgebra::{Matrix3, Vector3};

use super::block::{Corners, Partial, TERMS, block_sum, merge};
use super::frame::LocalFrame;
use super::kinds::Kind;
use crate::mass::error_bound::UNIT;
use crate::numerics::reduce::{BLOCK, depth};
use crate::numerics::threads::{Watch, fill_blocks};

/// What was summed, in the coordinates and the unit of a frame.
#[derive(Clone, Copy, Debug)]
pub(in crate::mass) struct Sums {
    pub(in crate::mass) frame: LocalFrame,
    pub(in crate::mass) count: usize,
    /// `∫ dm`.
    pub(in crate::mass) content: f64,
    /// The same with every simplex counted as positive.
    pub(in crate::mass) magnitude: f64,
    pub(in crate::mass) first: Vector3<f64>,
    pub(in crate::mass) second: Matrix3<f64>,
    /// What the rounding of each simplex's content is relative to, by [`Kind::content`].
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
    pub(in crate::mass) fn own_frame(&self, axes: &Matrix3<f64>) -> LocalFrame {
        let old = self.frame.axes.unwrap_or_else(Matrix3::identity);
        LocalFrame {
            reference: self.frame.reference + old * self.center() * self.frame.unit,
            unit: self.frame.unit,
            axes: Some(old * axes),
        }
    }
}

/// Sums over all simplices, on several threads when there are many; `None` where `watch` said stop.
pub(in crate::mass) fn sums<C: Corners<N>, K: Kind<N>, const N: usize>(
    corners: &C,
    frame: &LocalFrame,
    watch: &mut Watch<'_>,
) -> Option<Sums> {
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
    })
    .ok()?;
    Some(Sums::new::<K, N>(&merge(&blocks), count, frame))
}
