//! The coefficients of the method (Hairer & Wanner, Solving ODEs II, §IV.5 and §IV.8).

use nalgebra::Complex;

const ROOT_6: f64 = 2.449_489_742_783_178;
/// The points of collocation, in steps.
pub(super) const NODES: [f64; 3] = [(4.0 - ROOT_6) / 10.0, (4.0 + ROOT_6) / 10.0, 1.0];
/// The inverse of the method's matrix is `T Λ T⁻¹` with Λ of a real block γ and the block of α ± iβ.
pub(super) const REAL: f64 = 3.637_834_252_744_496;
pub(super) const COMPLEX: Complex<f64> =
    Complex::new(2.681_082_873_627_752, -3.050_430_199_247_410_5);
pub(super) const T: [[f64; 3]; 3] = [
    [
        0.094_438_762_488_975_24,
        -0.141_255_295_020_954_2,
        0.030_029_194_105_147_42,
    ],
    [
        0.250_213_122_965_333_3,
        0.204_129_352_293_799_94,
        -0.382_942_112_757_261_9,
    ],
    [1.0, 1.0, 0.0],
];
pub(super) const T_INVERSE: [[f64; 3]; 3] = [
    [
        4.178_718_591_551_904,
        0.327_682_820_761_062_4,
        0.523_376_445_499_449_5,
    ],
    [
        -4.178_718_591_551_904,
        -0.327_682_820_761_062_4,
        0.476_623_554_500_550_45,
    ],
    [
        0.502_872_634_945_786_8,
        -2.571_926_949_855_605,
        0.596_039_204_828_224_9,
    ],
];
/// The weights of the stages in the estimate of the error, of order 3.
pub(super) const ERROR: [f64; 3] = [
    (-13.0 - 7.0 * ROOT_6) / 3.0,
    (-13.0 + 7.0 * ROOT_6) / 3.0,
    -1.0 / 3.0,
];
/// The stages as the polynomial through them: rows of coefficients of x, x², x³, x in steps.
pub(super) const POLYNOMIAL: [[f64; 3]; 3] = [
    [
        (13.0 + 7.0 * ROOT_6) / 3.0,
        (-23.0 - 22.0 * ROOT_6) / 3.0,
        (10.0 + 15.0 * ROOT_6) / 3.0,
    ],
    [
        (13.0 - 7.0 * ROOT_6) / 3.0,
        (-23.0 + 22.0 * ROOT_6) / 3.0,
        (10.0 - 15.0 * ROOT_6) / 3.0,
    ],
    [1.0 / 3.0, -8.0 / 3.0, 10.0 / 3.0],
];

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix3;

    #[test]
    fn constants_are_those_of_the_method() {
        // Collocation: the row i of A integrates the Lagrange polynomials through the nodes from 0 to node i.
        let powers = |x: f64| [x, x * x / 2.0, x * x * x / 3.0];
        let vandermonde = Matrix3::from_fn(|j, k| NODES[j].powi(i32::try_from(k).expect("small")));
        let integrals = Matrix3::from_fn(|i, k| powers(NODES[i])[k]);
        let method = integrals * vandermonde.try_inverse().expect("distinct nodes");
        let matrix = |rows: &[[f64; 3]; 3]| Matrix3::from_fn(|i, j| rows[i][j]);
        let blocks = Matrix3::new(
            REAL,
            0.0,
            0.0,
            0.0,
            COMPLEX.re,
            -COMPLEX.im,
            0.0,
            COMPLEX.im,
            COMPLEX.re,
        );
        let eigen = |sign: f64| {
            let mut blocks = blocks;
            blocks[(1, 2)] *= sign;
            blocks[(2, 1)] *= sign;
            matrix(&T) * blocks * matrix(&T_INVERSE) - method.try_inverse().expect("regular")
        };
        assert!((matrix(&T) * matrix(&T_INVERSE) - Matrix3::identity()).norm() < 1e-14);
        assert!(eigen(1.0).norm() < 1e-13, "{}", eigen(1.0));
        // The dense output passes through the stages.
        for (i, node) in NODES.into_iter().enumerate() {
            for (j, row) in POLYNOMIAL.iter().enumerate() {
                let value = node * (row[0] + node * (row[1] + node * row[2]));
                assert!((value - if i == j { 1.0 } else { 0.0 }).abs() < 1e-14);
            }
        }
    }
}
