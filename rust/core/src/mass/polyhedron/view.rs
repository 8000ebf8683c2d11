//! Vertices in memory and the faces that count them.

use nalgebra::Vector3;

use super::boundary::Triangle;
use crate::error::MeshFault;
use crate::mass::simplex::{Corners, LocalFrame};

/// An integer that numbers vertices.
pub trait Index: Copy + Send + Sync {
    /// The position it stands for; one that no list has where it is negative.
    #[inline(always)]
    fn position(self) -> usize {
        // A negative number wraps to one that is larger than the length of any list.
        usize::try_from(self.to_i64().cast_unsigned()).unwrap_or(usize::MAX)
    }

    /// The number itself.
    fn to_i64(self) -> i64;
}

macro_rules! index {
    ($($integer:ty)*) => {$(
        impl Index for $integer {
            #[inline(always)]
            fn to_i64(self) -> i64 {
                i64::try_from(self).unwrap_or(i64::MAX)
            }
        }
    )*};
}
index!(i32 u32 i64 u64 usize);

/// Vertices and faces, as several threads share them.
#[derive(Clone, Copy)]
pub(in crate::mass) struct View<'a, I> {
    pub(in crate::mass) vertices: &'a [[f64; 3]],
    pub(in crate::mass) faces: &'a [[I; 3]],
}

impl<I: Index> Corners<3> for View<'_, I> {
    fn count(&self) -> usize {
        self.faces.len()
    }

    #[inline(always)]
    fn corners(&self, index: usize) -> Triangle {
        let corners = self.faces[index].map(Index::position);
        let [a, b, c] = corners.map(|position| self.vertices.get(position));
        // All at once: a choice for each corner would be made number by number.
        match (a, b, c) {
            (Some(a), Some(b), Some(c)) => [*a, *b, *c],
            _ => [a, b, c].map(|vertex| vertex.copied().unwrap_or([f64::NAN; 3])),
        }
    }
}

impl<I: Index> View<'_, I> {
    /// The box of the vertices, in units of its size.
    pub(in crate::mass) fn frame(&self) -> LocalFrame {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for vertex in self.vertices {
            widen(&mut low, &mut high, vertex);
        }
        LocalFrame::of_box(&Vector3::from(low), &Vector3::from(high))
    }

    /// The box of the corners that faces use.
    pub(in crate::mass) fn used_frame(&self) -> LocalFrame {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for corner in (0..self.faces.len()).flat_map(|face| self.corners(face)) {
            widen(&mut low, &mut high, &corner);
        }
        LocalFrame::of_box(&Vector3::from(low), &Vector3::from(high))
    }

    /// The first index that names no vertex, or the first coordinate that is not finite.
    pub(in crate::mass) fn find_unusable(&self) -> Option<MeshFault> {
        let vertices = self.vertices.len();
        for (face, corners) in self.faces.iter().enumerate() {
            if let Some(index) = corners.iter().find(|k| k.position() >= vertices) {
                return Some(MeshFault::IndexOutOfRange {
                    face,
                    index: index.to_i64(),
                    vertices,
                });
            }
        }
        for (vertex, coordinates) in self.vertices.iter().enumerate() {
            if let Some(&value) = coordinates.iter().find(|x| !x.is_finite()) {
                return Some(MeshFault::NonFiniteVertex { vertex, value });
            }
        }
        None
    }
}

#[inline(always)]
pub(in crate::mass) fn widen(low: &mut [f64; 3], high: &mut [f64; 3], point: &[f64; 3]) {
    for k in 0..3 {
        // A single instruction each, where `min` would also look for NaN in `low`.
        low[k] = if point[k] < low[k] { point[k] } else { low[k] };
        high[k] = if point[k] > high[k] {
            point[k]
        } else {
            high[k]
        };
    }
}
