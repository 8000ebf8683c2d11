//! Principal axes against nalgebra's `SymmetricEigen`: `cargo bench --bench eigen3`.

use nalgebra::Matrix3;
use polhode::inside::{eigen3, eigen3_many, eigenvalues3_many};
use polhode::parallel::{Level, level, set_level};

mod harness;

use harness::{Candidate, compare};

const ROWS: usize = 200_000;

/// Inertia tensors of random bodies of a few particles each; a few in a hundred are thin enough for Jacobi's method.
fn bodies() -> Vec<Matrix3<f64>> {
    let mut state = 1u64;
    let mut uniform = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / 9_007_199_254_740_992.0 - 0.5
    };
    let body = |_| {
        let mut tensor = Matrix3::zeros();
        for _ in 0..5 {
            let (x, y, z) = (uniform(), uniform(), uniform());
            let diagonal = Matrix3::from_diagonal_element(x * x + y * y + z * z);
            let r = nalgebra::Vector3::new(x, y, z);
            tensor += diagonal - r * r.transpose();
        }
        tensor
    };
    (0..ROWS).map(body).collect()
}

fn main() {
    let tensors = bodies();
    let rows: Vec<[f64; 9]> = tensors
        .iter()
        .map(|a| {
            let [[a00, a10, a20], [a01, a11, a21], [a02, a12, a22]] = a.data.0;
            [a00, a01, a02, a10, a11, a12, a20, a21, a22]
        })
        .collect();
    let mut values = vec![[0.0; 3]; ROWS];
    let mut vectors = vec![[0.0; 9]; ROWS];
    let mut moments = vec![[0.0; 3]; ROWS];
    let (mut solved, mut alone) = (Vec::with_capacity(ROWS), Vec::with_capacity(ROWS));

    // Answers before times.
    eigen3_many(&rows, &mut values, &mut vectors);
    for (a, w) in tensors.iter().zip(&values) {
        let mut peer: Vec<f64> = a.symmetric_eigenvalues().iter().copied().collect();
        peer.sort_by(f64::total_cmp);
        assert!(
            peer.iter()
                .zip(w)
                .all(|(x, y)| (x - y).abs() <= 4e-15 * w[2])
        );
    }

    let best = level();
    let mut candidates = vec![
        Candidate::new("nalgebra SymmetricEigen", || {
            solved.clear();
            solved.extend(tensors.iter().map(|a| a.symmetric_eigen()));
        }),
        Candidate::new("eigen3, one by one", || {
            alone.clear();
            alone.extend(tensors.iter().map(eigen3));
        }),
    ];
    let (values, vectors) = (
        std::cell::RefCell::new(&mut values),
        std::cell::RefCell::new(&mut vectors),
    );
    for candidate in Level::ALL.into_iter().filter(|level| level.is_available()) {
        let (values, vectors, rows) = (&values, &vectors, &rows);
        candidates.push(Candidate::new(
            format!("eigen3_many, {candidate}"),
            move || {
                set_level(candidate);
                eigen3_many(rows, &mut values.borrow_mut(), &mut vectors.borrow_mut());
                set_level(best);
            },
        ));
    }
    compare("eigenvalues and eigenvectors", ROWS, candidates);

    let mut peer = Vec::with_capacity(ROWS);
    compare(
        "eigenvalues alone",
        ROWS,
        vec![
            Candidate::new("nalgebra symmetric_eigenvalues", || {
                peer.clear();
                peer.extend(tensors.iter().map(Matrix3::symmetric_eigenvalues));
            }),
            Candidate::new(format!("eigenvalues3_many, {best}"), || {
                eigenvalues3_many(&rows, &mut moments);
            }),
        ],
    );
}
