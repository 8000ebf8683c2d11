//! The places in an interval at which a polynomial changes its sign: all of them, in order.
//!
//! On 0..1 a polynomial lies within the range of its Bernstein coefficients, and changes its sign no more often than they do,
//! and as often or by an even number less (Descartes' rule of signs). De Casteljau's algorithm cuts it in halves until each part has one
//! change or none; so no pair of zeros is missed, however close, as long as rounding leaves them apart.
//!
//! Source: Farouki, Comput. Aided Geom. Des. 29 (2012) 379, §5 and §7.

/// How often the interval is halved at most: two zeros closer than that are one place without a change.
const HALVINGS: u32 = 50;

/// The places in 0..1 at which `Σ c_k s^k` changes its sign, ascending, each to the last digits of a double.
///
/// `before`: the sign, 1 or −1, that the polynomial has before the interval, when that is known. A change at the very start is
/// found by it; without it the polynomial is taken to begin with its own sign. Zero counts as positive.
/// A polynomial with a coefficient that is not finite has none.
#[must_use]
pub(crate) fn sign_changes(coefficients: &[f64], before: Option<f64>) -> Vec<f64> {
    if !may_change(coefficients, before) {
        return Vec::new();
    }
    let mut bernstein = to_bernstein(coefficients);
    let first = before.unwrap_or_else(|| sign(bernstein[0]));
    if let Some(start) = bernstein.first_mut()
        && sign(*start) != first
    {
        // What rounding has left on the other side; a change of sign follows at once, unless the polynomial comes back.
        *start = if first > 0.0 { 0.0 } else { -f64::MIN_POSITIVE };
    }
    let mut changes = Vec::new();
    let mut parts = vec![(bernstein, 0.0_f64, 0_u32)];
    while let Some((part, start, halvings)) = parts.pop() {
        let length = 0.5_f64.powi(i32::try_from(halvings).unwrap_or(i32::MAX));
        match variations(&part) {
            0 => {}
            1 => changes.push(narrow(coefficients, sign(part[0]), start, start + length)),
            _ if halvings == HALVINGS => {
                if sign(part[0]) != sign(part[part.len() - 1]) {
                    changes.push(start + 0.5 * length);
                }
            }
            _ => {
                let (left, right) = halves(part);
                parts.push((right, start + 0.5 * length, halvings + 1));
                parts.push((left, start, halvings + 1));
            }
        }
    }
    changes
}

/// Whether the first coefficient does not outweigh all others, so that there may be a change at all.
fn may_change(coefficients: &[f64], before: Option<f64>) -> bool {
    let Some((first, others)) = coefficients.split_first() else {
        return false;
    };
    let rest: f64 = others.iter().map(|c| c.abs()).sum();
    let is_finite = first.is_finite() && rest.is_finite();
    is_finite && (first.abs() <= rest || before.is_some_and(|before| sign(*first) != before))
}

/// −1, or 1 also for zero.
fn sign(x: f64) -> f64 {
    if x < 0.0 { -1.0 } else { 1.0 }
}

fn variations(part: &[f64]) -> usize {
    part.windows(2)
        .filter(|pair| sign(pair[0]) != sign(pair[1]))
        .count()
}

/// `b_i = Σ_{k≤i} C(i, k)/C(n, k) c_k`.
fn to_bernstein(coefficients: &[f64]) -> Vec<f64> {
    let n = coefficients.len() - 1;
    let mut binomial = 1.0;
    let mut bernstein = Vec::with_capacity(n + 1);
    for (k, c) in coefficients.iter().enumerate() {
        bernstein.push(c / binomial);
        binomial *= (n - k) as f64 / (k + 1) as f64;
    }
    // Pascal's triangle, row by row.
    for row in 1..=n {
        for i in (row..=n).rev() {
            bernstein[i] += bernstein[i - 1];
        }
    }
    bernstein
}

/// Both halves (de Casteljau).
fn halves(mut part: Vec<f64>) -> (Vec<f64>, Vec<f64>) {
    let n = part.len() - 1;
    let mut left = Vec::with_capacity(n + 1);
    left.push(part[0]);
    for row in 1..=n {
        for i in 0..=n - row {
            part[i] = 0.5 * (part[i] + part[i + 1]);
        }
        left.push(part[0]);
    }
    // What is left is the right half.
    (left, part)
}

/// The one change in `low..high`, at whose start the sign is `first`, by halving.
fn narrow(coefficients: &[f64], first: f64, mut low: f64, mut high: f64) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return high;
        }
        let value = coefficients
            .iter()
            .rev()
            .fold(0.0, |sum, c| sum * middle + c);
        if sign(value) == first {
            low = middle;
        } else {
            high = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// `Π (s − r)`, lowest power first.
    fn with_zeros(zeros: &[f64]) -> Vec<f64> {
        zeros.iter().fold(vec![1.0], |product, zero| {
            let mut next = vec![0.0; product.len() + 1];
            for (k, c) in product.iter().enumerate() {
                next[k] -= zero * c;
                next[k + 1] += c;
            }
            next
        })
    }

    #[test]
    fn two_zeros_close_together_are_found_and_a_touch_is_none() {
        for gap in [1e-1, 1e-3, 1e-6] {
            let found = sign_changes(&with_zeros(&[0.3, 0.3 + gap, 0.9]), None);
            assert_eq!(found.len(), 3, "{gap}: {found:?}");
            for (place, zero) in found.iter().zip([0.3, 0.3 + gap, 0.9]) {
                assert!((place - zero).abs() < 1e-15 / gap, "{gap}: {place} {zero}");
            }
        }
        assert_eq!(sign_changes(&with_zeros(&[0.5, 0.5]), None).len(), 0);
        assert_eq!(sign_changes(&[1e-3, 0.0, 1.0], None).len(), 0);
        assert_eq!(sign_changes(&[], None).len(), 0);
        assert_eq!(sign_changes(&[f64::NAN, 1.0], None).len(), 0);
    }

    #[test]
    fn the_side_before_tells_of_a_change_at_the_start() {
        // −1e-18 + s: the sign before the interval decides whether something happens at its start.
        assert_eq!(sign_changes(&[-1e-18, 1.0], Some(-1.0)).len(), 1);
        assert_eq!(sign_changes(&[-1e-18, 1.0], Some(1.0)).len(), 0);
        let at_once = sign_changes(&[-1e-18, -1.0], Some(1.0));
        assert!(at_once.len() == 1 && at_once[0] < 1e-300, "{at_once:?}");
        assert_eq!(sign_changes(&[1e-18, -1.0], Some(-1.0)).len(), 0);
        assert_eq!(sign_changes(&[0.5, -0.25], Some(1.0)).len(), 0);
        assert_eq!(sign_changes(&[0.5, -0.5 - 1e-9], Some(1.0)).len(), 1);
    }

    proptest! {
        /// All zeros of a polynomial that is made of them, whether within the interval or not.
        #[test]
        fn as_many_as_there_are(mut zeros in prop::collection::vec(-1.0_f64..2.0, 1..7)) {
            zeros.sort_by(f64::total_cmp);
            let apart = zeros.windows(2).all(|pair| pair[1] - pair[0] > 1e-3);
            let clear = zeros.iter().all(|zero| zero.abs() > 1e-6 && (zero - 1.0).abs() > 1e-6);
            prop_assume!(apart && clear);
            let within: Vec<f64> = zeros.iter().copied().filter(|zero| (0.0..1.0).contains(zero)).collect();
            let found = sign_changes(&with_zeros(&zeros), None);
            prop_assert_eq!(found.len(), within.len());
            for (place, zero) in found.iter().zip(&within) {
                prop_assert!((place - zero).abs() < 1e-8);
            }
        }
    }
}
