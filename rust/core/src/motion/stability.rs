//! Steady spins of a free body about its principal axes, and whether they are stable (part II; the tennis racket).

/// Squared angular frequency, seen in B, of small oscillations about the steady spin around each principal axis:
/// `ω² (I_k − I_i)(I_k − I_j)/(I_i I_j)`.
///
/// `moments`: ascending, about C of a free body or about a fixed point without torque. `rate`: ω of the spin.
/// Positive: a stable spin, whose axis circles with that frequency. Negative: an unstable one, the intermediate axis of
/// an asymmetric body, from which departures grow as exp(t √−value). Zero: neither; the axis is one of two or three with
/// equal moments, and a disturbed spin drifts to a neighbouring one. A zero moment is that of a thin symmetric rod.
/// Source: linearized Euler's equations; Landau and Lifshitz, Mechanics, §37.
///
/// # Examples
///
/// ```
/// use polhode::motion::stability::stability;
///
/// let [least, middle, greatest] = stability(&[1.0, 2.0, 3.0], 1.0);
/// assert_eq!((least, middle, greatest), (1.0 / 3.0, -1.0 / 3.0, 1.0)); // the middle axis is not stable
/// ```
#[doc(alias = "tennis racket theorem")]
#[doc(alias = "intermediate axis theorem")]
#[must_use]
pub fn stability(moments: &[f64; 3], rate: f64) -> [f64; 3] {
    let &[i1, i2, i3] = moments;
    // Ratios first, so that neither molecules nor planets leave the range of float64.
    let squared = |k: f64, i: f64, j: f64| {
        if i == 0.0 || j == 0.0 {
            0.0 * rate
        } else {
            ((k - i) / i) * ((k - j) / j) * (rate * rate)
        }
    };
    [
        squared(i1, i2, i3),
        squared(i2, i3, i1),
        squared(i3, i1, i2),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intermediate_axis_is_unstable() {
        let [first, second, third] = stability(&[1.0, 2.0, 2.5], 2.0);
        assert!((first - 4.0 * 1.0 * 1.5 / 5.0).abs() < 1e-15);
        assert!((second + 4.0 * 1.0 * 0.5 / 2.5).abs() < 1e-15);
        assert!((third - 4.0 * 1.5 * 0.5 / 2.0).abs() < 1e-15);
    }

    #[test]
    fn limits() {
        assert_eq!(stability(&[2.0; 3], 5.0), [0.0; 3]);
        assert_eq!(stability(&[0.0; 3], 5.0), [0.0; 3]);
        assert_eq!(stability(&[0.0, 3.0, 3.0], 2.0), [4.0, 0.0, 0.0]);
        // A flat disk wobbles twice as fast as it spins, seen from space; once as fast, seen from itself.
        assert_eq!(stability(&[1.0, 1.0, 2.0], 3.0), [0.0, 0.0, 9.0]);
        assert!(
            stability(&[1.0, 2.0, f64::NAN], 1.0)
                .iter()
                .all(|x| x.is_nan())
        );
        assert!(stability(&[0.0; 3], f64::NAN).iter().all(|x| x.is_nan()));
        assert_eq!(
            stability(&[1e-300, 2e-300, 2e-300], 1.0),
            stability(&[1e300, 2e300, 2e300], 1.0)
        );
    }
}
