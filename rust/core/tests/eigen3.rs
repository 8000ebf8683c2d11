//! The 3×3 symmetric eigensolver against double-double residuals, and its promise of the same bits everywhere.
//!
//! The eigenvalues themselves are held against a reference of more than 50 digits in `tests/principal/test_principal_axes.py`.

use crate::watch::go_on;

use crate::settings::take_turn;
use nalgebra::{Matrix3, Rotation3, Vector3};
use polhode::inside::{Double, Kernel, Lane, dispatch, eigen3, eigen3_many, eigenvalues3_many};
use polhode::parallel::{Level, level, set_level, set_thread_limit};
use polhode::principal::{principal_axes, principal_axes_many};

type Row = [f64; 9];

/// Runs `check` at every level of this machine.
fn at_every_level(mut check: impl FnMut(Level)) {
    let _turn = take_turn();
    let before = level();
    for candidate in Level::ALL {
        assert_eq!(set_level(candidate), candidate.is_available());
        if candidate.is_available() {
            check(candidate);
        }
    }
    set_level(before);
}

/// Uniform numbers in [−1, 1) (Steele & Vigna's `SplitMix64`).
struct Uniform(u64);

impl Uniform {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 * (2.0 / 9_007_199_254_740_992.0) - 1.0
    }

    fn vector(&mut self) -> Vector3<f64> {
        Vector3::new(self.next(), self.next(), self.next())
    }

    fn symmetric(&mut self) -> Matrix3<f64> {
        let (d, o) = (self.vector(), self.vector());
        Matrix3::new(d.x, o.x, o.y, o.x, d.y, o.z, o.y, o.z, d.z)
    }

    fn with_eigenvalues(&mut self, values: &Vector3<f64>) -> Matrix3<f64> {
        let turn = Rotation3::from_scaled_axis(self.vector() * 3.0).into_inner();
        let product = turn * Matrix3::from_diagonal(values) * turn.transpose();
        (product + product.transpose()) * 0.5
    }
}

/// Matrices of every kind that eigensolvers stumble over, exactly symmetric.
fn matrices() -> Vec<Row> {
    let mut uniform = Uniform(3);
    let mut all = vec![Matrix3::zeros(), Matrix3::identity(), -Matrix3::identity()];
    for _ in 0..400 {
        let general = uniform.symmetric();
        all.push(general);
        let gap = 10f64.powf(-8.0 + 7.0 * uniform.next());
        all.push(uniform.with_eigenvalues(&Vector3::new(1.0, 1.0 + gap, 2.0)));
        all.push(uniform.with_eigenvalues(&Vector3::new(1.0, 2.0, 2.0 + gap)));
        all.push(Matrix3::identity() + uniform.symmetric() * gap);
        let d = Matrix3::from_diagonal(&uniform.vector().map(|x| 10f64.powf(8.0 * (x - 1.0))));
        all.push(d * uniform.with_eigenvalues(&Vector3::new(0.2, 0.5, 1.0)) * d);
        let x = uniform.vector();
        all.push(x * x.transpose());
        let y = uniform.vector();
        all.push(x * x.transpose() + y * y.transpose());
        all.push(Matrix3::from_diagonal(&uniform.vector()));
        let mut nearly_diagonal = Matrix3::from_diagonal(&Vector3::new(2.0, 2.0, 1.0));
        nearly_diagonal[(1, 0)] = gap;
        nearly_diagonal[(0, 1)] = gap;
        all.push(nearly_diagonal);
        for scale in [1e-300, 1e-150, 1e-47, 1e37, 1e150, 5e307] {
            all.push(general * scale);
        }
    }
    all.iter()
        .map(|a| {
            let [[a00, a10, a20], [_, a11, a21], [_, _, a22]] = a.data.0;
            [a00, a10, a20, a10, a11, a21, a20, a21, a22]
        })
        .collect()
}

fn decompose(rows: &[Row]) -> (Vec<[f64; 3]>, Vec<Row>) {
    let mut values = vec![[0.0; 3]; rows.len()];
    let mut vectors = vec![[0.0; 9]; rows.len()];
    eigen3_many(rows, &mut values, &mut vectors);
    (values, vectors)
}

/// Σ aᵢ bᵢ as the nearest double: products and sums carry their rounding errors along (Ogita, Rump & Oishi's Dot2).
fn dot(pairs: impl IntoIterator<Item = (f64, f64)>) -> f64 {
    let (mut sum, mut rest) = (0.0, 0.0);
    for (a, b) in pairs {
        let product = a * b;
        let total: f64 = sum + product;
        let part = total - sum;
        rest += a.mul_add(b, -product) + ((sum - (total - part)) + (product - part));
        sum = total;
    }
    sum + rest
}

fn row_major(a: &Row, i: usize, j: usize) -> f64 {
    a[3 * i + j]
}

#[test]
fn residuals_orthonormality_order_and_handedness() {
    let rows = matrices();
    at_every_level(|level| {
        let (values, vectors) = decompose(&rows);
        for ((a, w), v) in rows.iter().zip(&values).zip(&vectors) {
            assert!(w.is_sorted(), "{level}: {a:?}");
            let norm = w[0].abs().max(w[2].abs());
            // Scaled exactly, so that nothing under- or overflows.
            let (scale, _) = Double::<{ Level::Baseline as u8 }>::new(norm).power_of_two_scale();
            let scaled = |x: f64| x * scale.get();
            for (k, &eigenvalue) in w.iter().enumerate() {
                let residual = [0, 1, 2].map(|i| {
                    let products = (0..3).map(|j| (scaled(row_major(a, i, j)), row_major(v, j, k)));
                    dot(products.chain([(-scaled(eigenvalue), row_major(v, i, k))]))
                });
                assert!(
                    Vector3::from(residual).norm() <= 1.2e-15 * scaled(norm),
                    "{level}: {a:?}"
                );
                for l in 0..=k {
                    let product = dot((0..3).map(|i| (row_major(v, i, k), row_major(v, i, l))));
                    let error = product - f64::from(u8::from(k == l));
                    assert!(error.abs() <= 2e-15, "{level}: {a:?}");
                }
            }
            let determinant = Matrix3::from_row_slice(v).determinant();
            assert!((determinant - 1.0).abs() < 1e-14, "{level}: {a:?}");
            for k in 0..2 {
                let column = [0, 1, 2].map(|i| row_major(v, i, k));
                let largest = column.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
                let leading = column.iter().find(|x| x.abs() >= largest * (1.0 - 1e-8));
                assert!(leading.is_some_and(|&x| x > 0.0), "{level}: {a:?}");
            }
        }
    });
}

#[test]
fn the_axes_of_nearly_spherical_bodies_are_as_accurate_as_their_spread() {
    let mut uniform = Uniform(5);
    let rows: Vec<(Matrix3<f64>, Matrix3<f64>)> = (0..2000)
        .map(|_| {
            // Multiples of 2⁻⁵⁰, so that 1 + spread is exact.
            let unit = 2f64.powi(-50);
            let spread = (uniform.symmetric() * 1000.0).map(|x| x.round() * unit);
            (Matrix3::identity() + spread, spread)
        })
        .collect();
    at_every_level(|level| {
        for (a, spread) in &rows {
            let v = eigen3(a).vectors;
            let mean = spread.trace() / 3.0;
            let deviator = (spread - Matrix3::identity() * mean) * 2f64.powi(50);
            let turned = v.transpose() * deviator * v;
            let crossed = turned[(1, 0)]
                .abs()
                .max(turned[(2, 0)].abs())
                .max(turned[(2, 1)].abs());
            assert!(crossed <= 3e-15 * deviator.abs().max(), "{level}: {a}");
        }
    });
}

#[test]
fn a_row_has_the_same_bits_alone_in_any_stack_and_at_every_fused_level() {
    let rows = matrices();
    let mut fused: Option<(Vec<[f64; 3]>, Vec<Row>)> = None;
    at_every_level(|level| {
        let whole = decompose(&rows);
        let mut values = vec![[0.0; 3]; rows.len()];
        eigenvalues3_many(&rows, &mut values);
        assert_eq!(values, whole.0, "{level}: without vectors");
        for (i, a) in rows.iter().enumerate() {
            let alone = eigen3(&Matrix3::from_row_slice(a));
            assert_eq!(
                (alone.values, alone.vectors),
                (whole.0[i], Matrix3::from_row_slice(&whole.1[i]))
            );
        }
        for length in [1, 2, 31, 32, 33, 64, 200] {
            let start = rows.len() - length - 7;
            let part = decompose(&rows[start..start + length]);
            assert_eq!(
                part.0,
                whole.0[start..start + length],
                "{level}: {length} rows"
            );
            assert_eq!(
                part.1,
                whole.1[start..start + length],
                "{level}: {length} rows"
            );
        }
        let backwards: Vec<Row> = rows.iter().rev().copied().collect();
        let (values, vectors) = decompose(&backwards);
        assert!(
            values.iter().rev().eq(&whole.0) && vectors.iter().rev().eq(&whole.1),
            "{level}: permuted"
        );
        if level != Level::Baseline {
            assert_eq!(
                &whole,
                fused.get_or_insert_with(|| whole.clone()),
                "{level}"
            );
        }
    });
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let _turn = take_turn();
    let rows: Vec<Row> = matrices().into_iter().cycle().take(200_000).collect();
    let expected = decompose(&rows);
    for count in [1, 2, 3] {
        set_thread_limit(std::num::NonZeroUsize::new(count));
        let mut moments = vec![[0.0; 3]; rows.len()];
        let mut axes = vec![[0.0; 9]; rows.len()];
        let outcome = principal_axes_many(&rows, 0.0, &mut moments, &mut axes, &mut go_on);
        assert_eq!(outcome, Ok(()));
        assert!(
            moments == expected.0 && axes == expected.1,
            "{count} threads"
        );
    }
    set_thread_limit(None);
}

#[test]
fn diagonal_matrices_are_exact() {
    let _turn = take_turn();
    for (diagonal, sorted) in [
        ([3.0, 2.0, 1.0], [1.0, 2.0, 3.0]),
        ([2.0, 3.0, 1e-300], [1e-300, 2.0, 3.0]),
        ([-0.1, 5e-324, -5e307], [-5e307, -0.1, 5e-324]),
    ] {
        let a = Matrix3::from_diagonal(&diagonal.into());
        let found = principal_axes(&a);
        assert_eq!(found.moments, sorted);
        assert!(
            found
                .axes
                .iter()
                .all(|&x| x.abs() == 1.0 || x.to_bits() == 0)
        );
        assert_eq!(found.axes.determinant(), 1.0);
        assert_eq!(
            found.axes * Matrix3::from_diagonal(&sorted.into()) * found.axes.transpose(),
            a
        );
    }
}

#[test]
fn only_the_lower_triangle_is_read() {
    let _turn = take_turn();
    let a = Matrix3::new(3.0, 0.1, 0.2, 0.1, 4.0, 0.3, 0.2, 0.3, 5.0);
    let mut garbage = a;
    garbage[(0, 1)] = f64::NAN;
    garbage[(0, 2)] = 7.0;
    garbage[(1, 2)] = f64::INFINITY;
    assert_eq!(eigen3(&garbage), eigen3(&a));
}

#[test]
fn what_is_not_finite_is_nan_for_its_own_row_alone() {
    let clean = matrices();
    at_every_level(|level| {
        let expected = decompose(&clean);
        for (element, number) in [
            (0, f64::NAN),
            (3, f64::INFINITY),
            (8, f64::NEG_INFINITY),
            (7, f64::NAN),
        ] {
            let mut rows = clean.clone();
            rows[100][element] = number;
            let (values, vectors) = decompose(&rows);
            for i in 0..rows.len() {
                if i == 100 {
                    assert!(
                        values[i].iter().chain(&vectors[i]).all(|x| x.is_nan()),
                        "{level}"
                    );
                } else {
                    assert!(
                        values[i] == expected.0[i] && vectors[i] == expected.1[i],
                        "{level}: row {i}"
                    );
                }
            }
        }
    });
}

#[test]
fn dispatch_runs_a_kernel_at_every_level() {
    struct TwicePlusOne(f64);

    impl Kernel for TwicePlusOne {
        type Output = f64;
        #[inline(always)]
        fn run<L: Lane>(self) -> f64 {
            L::new(self.0).mul_add(L::new(2.0), L::new(1.0)).get()
        }
    }

    at_every_level(|_| assert_eq!(dispatch(TwicePlusOne(3.0)), 7.0));
}
