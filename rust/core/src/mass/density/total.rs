//! The whole of many cells, about its own centre of mass.

use nalgebra::{Matrix3, Vector3};

use crate::mass::regions::Region;
use crate::numerics::quadrature::{Cell, Leaf};
use crate::numerics::reduce::sum_terms;

/// m, x, y, z, xx, xy, xz, yy, yz, zz.
pub(super) type Moments = [f64; 10];

/// The whole about its own centre of mass.
pub(super) struct Total {
    pub(super) mass: f64,
    pub(super) center: Vector3<f64>,
    pub(super) second: Matrix3<f64>,
    pub(super) sizes: Sizes,
}

/// Sums over the leaves without their signs.
pub(super) struct Sizes {
    pub(super) mass: f64,
    /// Of mass times the largest coordinate.
    pub(super) first: f64,
    /// Of the traces of the second moments.
    pub(super) spread: f64,
}

impl Total {
    pub(super) fn of(region: &Region, leaves: &[Leaf<3, 10>]) -> Self {
        let middles: Vec<Vector3<f64>> = leaves
            .iter()
            .map(|leaf| middle(region, &leaf.cell))
            .collect();
        let heaviest = (0..leaves.len())
            .max_by(|&i, &j| leaves[i].sums[0].total_cmp(&leaves[j].sums[0]))
            .unwrap_or(0);
        let reference = middles[heaviest];
        let [mass, x, y, z] = sum_terms(leaves.len(), |i| {
            let (mass, first, _) = about(&leaves[i].sums, &(middles[i] - reference));
            [mass, first.x, first.y, first.z]
        });
        let center = reference + Vector3::new(x, y, z) / mass;
        let [xx, xy, xz, yy, yz, zz, masses, first, spread] = sum_terms(leaves.len(), |i| {
            let (m, _, s) = about(&leaves[i].sums, &(middles[i] - center));
            let (size, spread) = (m.abs(), s.trace().abs());
            let first = size * middles[i].amax();
            [
                s.m11, s.m12, s.m13, s.m22, s.m23, s.m33, size, first, spread,
            ]
        });
        Self {
            mass,
            center,
            second: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
            sizes: Sizes {
                mass: masses,
                first,
                spread,
            },
        }
    }

    /// √(tr S/m), the body's own length.
    pub(super) fn width(&self) -> f64 {
        (self.second.trace() / self.mass).sqrt()
    }
}

/// Moments about a point that the cell's middle is `q` away from.
pub(super) fn about(moments: &Moments, q: &Vector3<f64>) -> (f64, Vector3<f64>, Matrix3<f64>) {
    let [m, x, y, z, xx, xy, xz, yy, yz, zz] = *moments;
    let f = Vector3::new(x, y, z);
    let mixed = f * q.transpose();
    let second = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    (
        m,
        f + q * m,
        second + mixed + mixed.transpose() + q * (q.transpose() * m),
    )
}

pub(super) fn middle(region: &Region, cell: &Cell<3>) -> Vector3<f64> {
    region.point(cell.chart, &cell.middle()).0
}
