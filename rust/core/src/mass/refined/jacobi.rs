//! Jacobi's rotations to twice the precision.

use super::vectors::Vector;
use crate::numerics::double_double::DoubleDouble;

/// Below this tangent `tan 2φ = 2 tan φ` and `1 − cos φ = ½ tan² φ`, to what a sweep needs.
const SMALL: f64 = 1e-9;
/// The most sweeps; two or three are enough.
const SWEEPS: usize = 8;
/// Elements off the diagonal below this part of the largest moment are zero to twice the precision.
const NEGLIGIBLE: f64 = 1e-31;

/// Turns the axes until the tensor b in them is diagonal.
///
/// The elements off the diagonal start at rounding; each sweep squares them, so two reach twice the precision.
pub(super) fn diagonalize(b: &mut [Vector; 3], axes: &mut [Vector; 3]) {
    let size = b[2][2].rounded().abs();
    for _ in 0..SWEEPS {
        let off = [(0, 1), (0, 2), (1, 2)]
            .map(|(i, j)| b[i][j].rounded().abs())
            .into_iter()
            .fold(0.0, f64::max);
        if off <= NEGLIGIBLE * size {
            break;
        }
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            rotate(b, axes, i, j);
        }
    }
}

/// Jacobi's rotation of the axes i and j that makes their product of inertia vanish.
fn rotate(b: &mut [Vector; 3], axes: &mut [Vector; 3], i: usize, j: usize) {
    let product = b[i][j];
    if product.rounded() == 0.0 {
        return;
    }
    let gap = b[j][j] - b[i][i];
    let tangent = if product.high.abs() < SMALL * gap.high.abs() {
        (product.high / gap.high).into()
    } else {
        // cot 2φ, and the smaller root t = tan φ of t² + 2 t cot 2φ − 1 = 0.
        let cotangent = gap / (product + product);
        let one = DoubleDouble::from(1.0);
        let root = one / (cotangent.abs() + (one + cotangent * cotangent).sqrt());
        if cotangent.rounded() < 0.0 {
            -root
        } else {
            root
        }
    };
    // 1 − cos φ; to rounding of its first term where φ is small.
    let square = tangent * tangent;
    let versine = if square.high < SMALL * SMALL {
        square.scaled(0.5)
    } else {
        let root = (DoubleDouble::from(1.0) + square).sqrt();
        square / (root * (root + 1.0.into()))
    };
    let sine = tangent - tangent * versine;
    let turned = |u: DoubleDouble, v: DoubleDouble| {
        (u - (sine * v + versine * u), v + (sine * u - versine * v))
    };
    let (u, v) = (axes[i], axes[j]);
    let pairs: [(DoubleDouble, DoubleDouble); 3] = std::array::from_fn(|c| turned(u[c], v[c]));
    axes[i] = pairs.map(|pair| pair.0);
    axes[j] = pairs.map(|pair| pair.1);
    let k = 3 - i - j;
    let shift = tangent * product;
    b[i][i] -= shift;
    b[j][j] += shift;
    (b[i][k], b[j][k]) = turned(b[i][k], b[j][k]);
    (b[k][i], b[k][j]) = (b[i][k], b[j][k]);
    (b[i][j], b[j][i]) = (DoubleDouble::default(), DoubleDouble::default());
}
