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
        let (sine, cosine) = (0.5 * root).sin_cos();
        let double = 2.0 * sine * cosine;
        (2.0 * sine * sine / x, (root - double) / (x * root))
    } else {
        // The root is not small: neither difference cancels.
        let root = (-x).sqrt();
        let rising = (0.5 * root).exp();
        let falling = 1.0 / rising;
        let (sine, cosine) = (0.5 * (rising - falling), 0.5 * (rising + falling));
        let double = 2.0 * sine * cosine;
        (2.0 * sine * sine / -x, (double - root) / (-x * root))
    };
    [1.0 - x * c2, s * (1.0 - x * c3), s * s * c2, s * s * s * c3]
}

/// `G_k(s + h)` for k = 0..3 from those of s, for a β h² so small that its square is below rounding.
///
/// Those of sums: `G_0 = G_0(s) G_0(h) − β G_1(s) G_1(h)`, `G_1 = G_1(s) G_0(h) + G_0(s) G_1(h)`, and as `∂G_k/∂h = G_{k−1}`,
/// `G_2 = G_2(s) + G_1(s) G_1(h) + G_0(s) G_2(h)`, `G_3 = G_3(s) + G_2(s) h + G_1(s) G_2(h) + G_0(s) G_3(h)`.
pub(super) fn moved(g: &[f64; 4], beta: f64, h: f64) -> [f64; 4] {
    let square = h * h;
    let (less, h1) = (0.5 * beta * square, h * (1.0 - beta * square / 6.0));
    let (h2, h3) = (0.5 * square, square * h / 6.0);
    let [g0, g1, g2, g3] = *g;
    [
        g0 - (g0 * less + beta * g1 * h1),
        g1 + (g0 * h1 - g1 * less),
        g2 + (g1 * h1 + g0 * h2),
        g3 + (g2 * h + g1 * h2 + g0 * h3),
    ]
}
