//! The integrals over a shell in the coordinates of a frame: what its faces sweep.

use nalgebra::{Matrix3, Vector3};

use super::offset::Offset;
use crate::error::Error;
use crate::mass::error_bound::UNIT;
use crate::mass::simplex::{LocalFrame, Sums};
use crate::numerics::power_of_two::{exponent, times_power_of_two};
use crate::numerics::reduce::{block_sum, sum_blocks};
use crate::numerics::threads::{Halt, Watch};

/// A shell in the coordinates and the unit of a frame.
pub(super) struct Placed<'a> {
    offset: &'a Offset,
    corners: Vec<Vector3<f64>>,
    directions: Vec<Vector3<f64>>,
    /// Half the thickness, and the same in its own power of two.
    half: f64,
    weight: f64,
    extent: Vector3<f64>,
}

/// Volume, first moment (3), second moment (6), what rounding can have done to the volume.
const TERMS: usize = 11;

impl<'a> Placed<'a> {
    pub(super) fn new(
        offset: &'a Offset,
        vertices: &[[f64; 3]],
        thickness: f64,
        frame: &LocalFrame,
    ) -> Self {
        let corners: Vec<Vector3<f64>> = vertices.iter().map(|r| frame.place(r)).collect();
        let directions: Vec<Vector3<f64>> = match &frame.axes {
            None => offset.directions.clone(),
            Some(axes) => offset.directions.iter().map(|d| axes.tr_mul(d)).collect(),
        };
        let half = 0.5 * thickness / frame.unit;
        let mut extent = Vector3::zeros();
        for &k in offset.faces.iter().flatten() {
            extent = extent.sup(&(corners[k].abs() + directions[k].abs() * half));
        }
        Self {
            offset,
            corners,
            directions,
            half,
            weight: 0.5 * times_power_of_two(thickness, -exponent(thickness)),
            extent,
        }
    }

    /// The integrals over the shell, and what rounding can have done to the volume.
    pub(super) fn sums(
        &self,
        frame: LocalFrame,
        watch: &mut Watch<'_>,
    ) -> Result<(Sums, f64), Halt<Error>> {
        let count = self.offset.faces.len();
        let [w, x, y, z, xx, xy, xz, yy, yz, zz, slack] = sum_blocks(count, watch, |range| {
            block_sum(range.start, range.end, &|face| self.terms(face))
        })
        .map_err(|_| Halt::Stopped)?;
        let sums = Sums {
            frame,
            count,
            content: w,
            magnitude: w,
            first: Vector3::new(x, y, z),
            second: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
            scale: Vector3::zeros(),
            extent: self.extent,
        };
        let error = 2.0 * (slack + sums.roundings() * w);
        Ok((sums, error))
    }

    /// What one face sweeps.
    #[inline]
    fn terms(&self, face: usize) -> [f64; TERMS] {
        /// √(3/5), with the weight 5/9; the middle has 8/9.
        const NODE: f64 = 0.774_596_669_241_483_4;
        let corners = self.offset.faces[face];
        let of_face = |of: &[Vector3<f64>]| [of[corners[0]], of[corners[1]], of[corners[2]]];
        let (v, d) = (of_face(&self.corners), of_face(&self.directions));
        let longest = d.iter().fold(0.0_f64, |longest, d| longest.max(d.norm()));
        let worst = corners
            .iter()
            .fold(0.0_f64, |worst, &k| worst.max(self.offset.errors[k]));
        let mut terms = [0.0; TERMS];
        for (node, weight) in [(-NODE, 5.0), (0.0, 8.0), (NODE, 5.0)] {
            let (s, weight) = (node * self.half, weight * self.weight / 9.0);
            let r = [v[0] + d[0] * s, v[1] + d[1] * s, v[2] + d[2] * s];
            let (e, f) = (r[1] - r[0], r[2] - r[0]);
            let area = e.cross(&f);
            let j = [d[0].dot(&area), d[1].dot(&area), d[2].dot(&area)];
            let (g, sum) = (j[0] + j[1] + j[2], r[0] + r[1] + r[2]);
            let weighted = r[0] * j[0] + r[1] * j[1] + r[2] * j[2];
            // ∫ λ_i x xᵀ dλ = (s sᵀ + Σ x_j x_jᵀ + x_i sᵀ + s x_iᵀ + 2 x_i x_iᵀ)/120, s = Σ x_j.
            let second = |k: usize, l: usize| {
                let (mut squares, mut own) = (sum[k] * sum[l], 0.0);
                for (r, j) in r.iter().zip(j) {
                    squares += r[k] * r[l];
                    own += j * r[k] * r[l];
                }
                (g * squares + weighted[k] * sum[l] + sum[k] * weighted[l] + 2.0 * own) / 120.0
            };
            let first = (sum * g + weighted) / 24.0;
            let (e, f) = (e.norm(), f.norm());
            let roundings = e * f + self.extent.norm() * (e + f) * (1.0 + f64::abs(node) * longest);
            let slack = area.norm() * worst + 16.0 * UNIT * longest * roundings;
            let parts = [
                g / 6.0,
                first.x,
                first.y,
                first.z,
                second(0, 0),
                second(0, 1),
                second(0, 2),
                second(1, 1),
                second(1, 2),
                second(2, 2),
                0.5 * slack,
            ];
            for (term, part) in terms.iter_mut().zip(parts) {
                *term += weight * part;
            }
        }
        terms
    }
}
