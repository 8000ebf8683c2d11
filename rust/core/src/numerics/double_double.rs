//! Error-free transformations: a sum or a product as a rounded value plus the exact rest.

/// `a + b = s + e` exactly, s the rounded sum (Knuth).
#[inline(always)]
#[must_use]
pub fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    let t = s - a;
    (s, (a - (s - t)) + (b - t))
}

/// `a + b = s + e` exactly when |a| ≥ |b| or a is zero (Dekker).
#[inline(always)]
#[must_use]
pub fn fast_two_sum(a: f64, b: f64) -> (f64, f64) {
    let s = a + b;
    (s, b - (s - a))
}

/// `a b = p + e` exactly, p the rounded product (Dekker), for factors below 2⁹⁹⁶.
///
/// Written with Veltkamp's splitting, since a fused multiply-add is a slow library call on machines without one.
#[inline(always)]
#[must_use]
pub fn two_product(a: f64, b: f64) -> (f64, f64) {
    let p = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    (
        p,
        ((a_high * b_high - p) + a_high * b_low + a_low * b_high) + a_low * b_low,
    )
}

/// The upper 26 bits of the significand and the rest.
#[inline(always)]
fn split(a: f64) -> (f64, f64) {
    let scaled = 134_217_729.0 * a; // 2^27 + 1
    let high = scaled - (scaled - a);
    (high, a - high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rests_are_exact() {
        assert_eq!(two_sum(1.0, 2.0_f64.powi(-60)), (1.0, 2.0_f64.powi(-60)));
        assert_eq!(fast_two_sum(1e16, 1.0), (1e16, 1.0));
        let x = 1.0 + 2.0_f64.powi(-30);
        assert_eq!(
            two_product(x, x),
            (1.0 + 2.0_f64.powi(-29), 2.0_f64.powi(-60))
        );
    }
}
