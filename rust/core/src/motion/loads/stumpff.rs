//! Stumpff's functions, of which the motion on any Kepler orbit is made: `G_k(s) = s^k c_k(β s²)`, `c_k(x) = Σ (−x)^j/(2j+k)!`.

/// Below this β s² the closed forms cancel, and eleven terms of the series are exact.
const SERIES: f64 = 2.5;

/// The coefficients of [`series`].
const fn coefficients(k: usize) -> [f64; 12] {
    let mut found = [0.0; 12];
    let (mut j, mut coefficient) = (0, 1.0);
    while j < 11 {
        let n = (2 * j + k) as f64;
        coefficient /= n * (n - 1.0);
        found[j] = coefficient;
        coefficient = -coefficient;
        j += 1;
    }
    found
}

/// `Σ_{0≤j<11} (−x)^j (k − 2)!/(2j + k)!`: `c_2`, `c_3`, `2 c_4` and `6 c_5`.
#[inline(always)]
fn series<const K: usize>(x: f64) -> f64 {
    let c = const { coefficients(K) };
    // Even and odd powers side by side: two short chains wait less than a long one.
    let y = x * x;
    let pairs = c.as_chunks::<2>().0.iter().rev();
    let [even, odd] = pairs.fold([0.0; 2], |sums, pair| {
        [sums[0] * y + pair[0], sums[1] * y + pair[1]]
    });
    even + x * odd
}

/// `G_4` and `G_5`, by `c_{k+2}(x) = (1/k! − c_k(x))/x`.
pub(super) fn further(beta: f64, s: f64) -> [f64; 2] {
    let x = beta * s * s;
    let [c4, c5] = if x.abs() < SERIES {
        [series::<4>(x) / 2.0, series::<5>(x) / 6.0]
    } else {
        let [_, _, g2, g3] = functions(beta, s);
        [(0.5 - g2 / (s * s)) / x, (1.0 / 6.0 - g3 / (s * s * s)) / x]
    };
    [c4 * s.powi(4), c5 * s.powi(5)]
}

/// `G_k(s) = s^k c_k(β s²)` for k = 0..3.
pub(super) fn functions(beta: f64, s: f64) -> [f64; 4] {
    let x = beta * s * s;
    let (c2, c3) = if x.abs() < SERIES {
        (series::<2>(x), series::<3>(x))
    } else if x > 0.0 {
        let root = x.sqrt();
        let half = (0.5 * root).sin();
        (2.0 * half * half / x, (root - root.sin()) / (x * root))
    } else {
        let root = (-x).sqrt();
        let half = (0.5 * root).sinh();
        (2.0 * half * half / -x, (root.sinh() - root) / (-x * root))
    };
    [1.0 - x * c2, s * (1.0 - x * c3), s * s * c2, s * s * s * c3]
}
