//! Windows of time in which a load acts.

use crate::error::{Error, MotionFault, finite};

/// Windows of time, ascending and apart: switched on at the start of each and off at its end.
///
/// # Examples
///
/// ```
/// use polhode::motion::loads::Windows;
///
/// let burns = Windows::new(&[(0.0, 1.0), (5.0, f64::INFINITY)])?;
/// assert!(burns.contains(0.5) && !burns.contains(1.0) && burns.contains(1e9));
/// assert_eq!(burns.switches(), [0.0, 1.0, 5.0]);
/// let day = Windows::new(&[(0.5, 6.0)])?;
/// assert_eq!(burns.within(&day).as_slice(), [(0.5, 1.0), (5.0, 6.0)]);
/// # Ok::<(), polhode::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Windows(Vec<(f64, f64)>);

impl Windows {
    /// Checked windows; an end may be +∞.
    ///
    /// # Errors
    /// [`Error::NonFinite`], [`MotionFault::WindowOrder`].
    pub fn new(windows: &[(f64, f64)]) -> Result<Self, Error> {
        let mut previous = f64::NEG_INFINITY;
        for (index, &(on, off)) in windows.iter().enumerate() {
            finite("the start of a window", on)?;
            if off.is_nan() || off == f64::NEG_INFINITY {
                return Err(Error::NonFinite {
                    what: "the end of a window",
                    value: off,
                });
            }
            if on <= previous || off <= on {
                return Err(MotionFault::WindowOrder {
                    index,
                    on,
                    off,
                    previous,
                }
                .into());
            }
            previous = off;
        }
        Ok(Self(windows.to_vec()))
    }

    /// The windows: when each opens and closes.
    #[must_use]
    pub fn as_slice(&self) -> &[(f64, f64)] {
        &self.0
    }

    /// Whether it is on at `t`; half-open, so that one of two windows that touch would count.
    #[must_use]
    pub fn contains(&self, t: f64) -> bool {
        let next = self.0.partition_point(|&(on, _)| on <= t);
        next > 0 && t < self.0[next - 1].1
    }

    /// The times of its switches.
    #[must_use]
    pub fn switches(&self) -> Vec<f64> {
        self.0
            .iter()
            .flat_map(|&(on, off)| [on, off])
            .filter(|t| t.is_finite())
            .collect()
    }

    /// Where both it and `other` are on.
    #[must_use]
    pub fn within(&self, other: &Self) -> Self {
        let (mut own, mut others) = (self.0.iter().peekable(), other.0.iter().peekable());
        let mut common = Vec::new();
        while let (Some(&&(on, off)), Some(&&(from, to))) = (own.peek(), others.peek()) {
            let (start, end) = (on.max(from), off.min(to));
            if start < end {
                common.push((start, end));
            }
            // Nothing later meets the one that ends first.
            if off <= to {
                own.next();
            } else {
                others.next();
            }
        }
        Self(common)
    }
}

#[cfg(feature = "serde")]
crate::numerics::stored_form::form! {
    Times of Windows as it { windows: Vec<(f64, Option<f64>)> = ends(it) } => {
        let end = |&(on, off): &(f64, Option<f64>)| (on, off.unwrap_or(f64::INFINITY));
        Self::new(&it.windows.iter().map(end).collect::<Vec<_>>())
    };
}

/// Windows of which the last may have no end.
#[cfg(feature = "serde")]
fn ends(windows: &Windows) -> Vec<(f64, Option<f64>)> {
    let end = |&(on, off): &(f64, f64)| (on, off.is_finite().then_some(off));
    windows.as_slice().iter().map(end).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn on_and_off() {
        let windows = Windows::new(&[(0.0, 1.0), (2.0, f64::INFINITY)]).expect("ordered");
        let states = [-0.1, 0.0, 0.9, 1.0, 2.0, 1e300].map(|t| windows.contains(t));
        assert_eq!(states, [false, true, true, false, true, true]);
        assert_eq!(windows.switches(), [0.0, 1.0, 2.0]);
        let other = Windows::new(&[(0.5, 3.0)]).expect("ordered");
        assert_eq!(
            windows.within(&other),
            Windows(vec![(0.5, 1.0), (2.0, 3.0)])
        );
        for wrong in [
            vec![(1.0, 0.0)],
            vec![(0.0, 2.0), (1.0, 3.0)],
            vec![(f64::NAN, 1.0)],
            vec![(0.0, f64::NAN)],
        ] {
            assert!(Windows::new(&wrong).is_err());
        }
    }
}
