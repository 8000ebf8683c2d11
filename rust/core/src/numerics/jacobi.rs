//! Jacobi's elliptic functions of one number, by descending means, and Carlson's integral of the second kind.

/// Two means this close, relative to themselves, are one after one more step.
const CLOSE: f64 = 1e-8;
/// The most steps of the means: k′ = 1e-300 takes fifteen.
const STEPS: usize = 24;

/// `(sn u, cn u, dn u)` for |u| ≤ K and 0 ≤ k′ ≤ 1, each to full relative precision but for the rounding of u.
///
/// Every step is made of sums with one sign, so that cn and dn keep their digits where they are small.
/// Source: R. Bulirsch, Numerical calculation of elliptic integrals and elliptic functions, Numer. Math. 7 (1965) 78.
#[must_use]
pub(crate) fn jacobi(u: f64, k_prime: f64) -> (f64, f64, f64) {
    if k_prime == 0.0 {
        let c = u.cosh().recip();
        return (u.tanh(), c, c);
    }
    let mut means = [(0.0, 0.0); STEPS];
    let (mut arithmetic, mut geometric, mut used) = (1.0_f64, k_prime, 0);
    let mut mean = 1.0;
    while used < STEPS {
        means[used] = (arithmetic, geometric);
        used += 1;
        mean = 0.5 * (arithmetic + geometric);
        if (arithmetic - geometric).abs() <= CLOSE * arithmetic {
            break;
        }
        geometric = (arithmetic * geometric).sqrt();
        arithmetic = mean;
    }
    let (sine, cosine) = (u * mean).sin_cos();
    if sine.abs() < 1e-9 {
        return (u, 1.0, 1.0);
    }
    let (mut a, mut c, mut dn) = (cosine / sine, mean * (cosine / sine), 1.0);
    for &(arithmetic, geometric) in means[..used].iter().rev() {
        a *= c;
        c *= dn;
        dn = (geometric + a) / (arithmetic + a);
        a = c / arithmetic;
    }
    let sn = (c * c + 1.0).sqrt().recip().copysign(sine);
    (sn, c * sn, dn)
}

/// Carlson's symmetric integral `R_D(x, y, z) = (3/2) ∫₀^∞ dt/[√((t + x)(t + y)) (t + z)^{3/2}]`, for z > 0 and x, y not
/// negative, of which at most one is zero.
///
/// Source: B. C. Carlson, Computing elliptic integrals by duplication, Numer. Math. 33 (1979) 1.
#[must_use]
#[inline]
pub(crate) fn carlson_rd(x: f64, y: f64, z: f64) -> f64 {
    let mut arguments = [x, y, z];
    let (mut sum, mut weight) = (0.0, 1.0);
    // Each duplication divides the differences by four. NaN stays NaN.
    for _ in 0..2 * STEPS {
        let mean = (arguments[0] + arguments[1] + 3.0 * arguments[2]) / 5.0;
        let [x, y, z] = arguments;
        let (dx, dy, dz) = (1.0 - x / mean, 1.0 - y / mean, 1.0 - z / mean);
        if dx.abs().max(dy.abs()).max(dz.abs()) < 1.5e-3 {
            let (ea, eb) = (dx * dy, dz * dz);
            let (ec, ed) = (ea - eb, ea - 6.0 * eb);
            let ee = ed + 2.0 * ec;
            let series = ed * (-3.0 / 14.0 + 9.0 / 88.0 * ed - 4.5 / 26.0 * dz * ee)
                + dz * (ee / 6.0 + dz * (-9.0 / 22.0 * ec + dz * (3.0 / 26.0) * ea));
            return 3.0 * sum + weight * (1.0 + series) / (mean * mean.sqrt());
        }
        let (rx, ry, rz) = (x.sqrt(), y.sqrt(), z.sqrt());
        let shift = rx * (ry + rz) + ry * rz;
        sum += weight / (rz * (arguments[2] + shift));
        weight *= 0.25;
        arguments = [0.25 * (x + shift), 0.25 * (y + shift), 0.25 * (z + shift)];
    }
    f64::NAN
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (k′, u, sn, cn, dn) by mpmath 1.3 with 60 digits.
    const JACOBI: [(f64, f64, f64, f64, f64); 8] = [
        (
            0.9,
            0.7,
            0.636_677_953_775_603,
            0.771_129_809_549_670_5,
            0.960_719_430_845_166_8,
        ),
        (
            0.9,
            -1.6,
            -0.998_791_908_130_630_9,
            0.049_139_843_841_564_96,
            0.900_254_851_477_084_3,
        ),
        (
            0.5,
            2.1,
            0.999_600_455_451_588_5,
            0.028_265_340_277_040_443,
            0.500_598_838_488_197_8,
        ),
        (
            0.001,
            4.0,
            0.999_329_548_207_322_2,
            0.036_612_212_166_833_094,
            0.036_625_847_966_908_855,
        ),
        (
            0.001,
            8.2,
            0.999_999_995_564_104_7,
            9.419_018_283_375_033e-05,
            0.001_004_426_095_673_775_6,
        ),
        (
            1e-09,
            20.0,
            1.0,
            4.061_661_595_450_892e-09,
            4.182_952_894_303_339_5e-09,
        ),
        (
            1e-09,
            22.1,
            1.0,
            9.560_343_696_486_324e-12,
            1.000_045_699_041_596_4e-09,
        ),
        (
            0.0,
            3.0,
            0.995_054_753_686_730_5,
            0.099_327_927_419_433_2,
            0.099_327_927_419_433_2,
        ),
    ];

    /// (x, y, z, `R_D`) by the same.
    const SECOND: [(f64, f64, f64, f64); 8] = [
        (1.0, 2.0, 3.0, 0.290_460_281_028_990_63),
        (0.0, 1.0, 0.25, 10.750_833_851_096_779),
        (0.0, 1.0, 1e-18, 3e+18),
        (0.3, 1.0, 1.0, 1.364_863_180_559_17),
        (1e-12, 1.0, 2e-12, 878_679_656_420.505_5),
        (0.0, 1e-20, 1.0, 70.236_435_873_181_04),
        // As unequal as arguments of the series are at most: each of its terms counts.
        (0.997_507_5, 0.997_507_5, 1.0, 1.001_498_167_696_254_4),
        (1.002_495, 1.002_495, 1.0, 0.998_505_662_701_257_6),
    ];

    #[test]
    fn functions_of_jacobi() {
        for (k_prime, u, sn, cn, dn) in JACOBI {
            let found = jacobi(u, k_prime);
            // The rounding of u moves cn by k′ ε u at least.
            let slack = 4.0 * f64::EPSILON * u.abs() * k_prime;
            for (value, exact) in [found.0, found.1, found.2].into_iter().zip([sn, cn, dn]) {
                let error = (value - exact).abs();
                assert!(
                    error < 1e-14 * exact.abs() + slack,
                    "{k_prime} {u}: {value} {exact}"
                );
            }
        }
        assert_eq!(jacobi(0.0, 0.3), (0.0, 1.0, 1.0));
        assert!(jacobi(f64::NAN, 0.3).0.is_nan());
    }

    #[test]
    fn integral_of_the_second_kind() {
        for (x, y, z, exact) in SECOND {
            assert!(
                (carlson_rd(x, y, z) / exact - 1.0).abs() < 2e-15,
                "{x} {y} {z}"
            );
        }
        assert!(carlson_rd(f64::NAN, 1.0, 1.0).is_nan());
    }
}
