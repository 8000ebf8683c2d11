//! A lamina with corners, for coordinates with derivatives.

use super::follow::Change;
use crate::error::Error;
use crate::mass::amount::Amount;
use crate::mass::ten::{Size, Ten};

/// A polygon in the x-y plane from x, y of its corners in order, and the factor by which its mass or density is another than
/// this.
///
/// By Green's theorem, from the triangles that a first corner makes with each edge:
/// `∫ dA = Σ Δ`, `∫ r dA = Σ Δ (a + b)/3`, `∫ r rᵀ dA = Σ Δ (2 a aᵀ + a bᵀ + b aᵀ + 2 b bᵀ)/12`, with `Δ = ½ a × b`.
#[derive(Clone, Copy, Debug)]
pub struct OfPolygon(pub Amount);

impl Change for OfPolygon {
    fn of<X: Size<Body = Ten<X>>>(&self, _: &[Ten<X>], numbers: &[X]) -> Result<Ten<X>, Error> {
        let [corners @ .., factor] = numbers else {
            return Err(Error::Empty { what: "vertices" });
        };
        let start = [corners[0], corners[1]];
        let (mut area, mut first, mut second) = (X::zero(), [X::zero(); 2], [X::zero(); 3]);
        for edge in corners[2..]
            .chunks_exact(2)
            .zip(corners[4..].chunks_exact(2))
        {
            let [a, b] = [edge.0, edge.1].map(|r| [r[0] - start[0], r[1] - start[1]]);
            let triangle = (a[0] * b[1] - a[1] * b[0]) * 0.5;
            area += triangle;
            for k in 0..2 {
                first[k] += triangle * (a[k] + b[k]) / 3.0;
            }
            for (k, (i, j)) in [(0, 0), (1, 1), (0, 1)].into_iter().enumerate() {
                let products = (a[i] * a[j] + b[i] * b[j]) * 2.0 + a[i] * b[j] + b[i] * a[j];
                second[k] += triangle * products / 12.0;
            }
        }
        let per_area = match self.0 {
            Amount::Mass(mass) => X::from(mass) / area,
            // Corners may go round either way.
            Amount::Density(density) => X::from(density * area.rounded().signum()),
        } * *factor;
        let [x, y] = first.map(|sum| sum / area);
        let [xx, yy, xy] = [
            second[0] - area * x * x,
            second[1] - area * y * y,
            second[2] - area * x * y,
        ]
        .map(|moment| moment * per_area);
        let zero = X::zero();
        Ok(Ten {
            mass: area * per_area,
            center: [start[0] + x, start[1] + y, zero],
            inertia: [yy, xx, xx + yy, -xy, zero, zero],
        })
    }
}
