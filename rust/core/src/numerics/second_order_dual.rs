//! Numbers that move along a line: value, slope and curvature.

use std::ops::{Add, Div, Mul, Neg, Sub};

use num_traits::{One, Zero};

use super::number::Real;

/// `value + slope ε + curvature ε²`, what follows cut off: a number as one steps from where its variables are along one line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SecondOrderDual {
    /// Where it starts.
    pub value: f64,
    /// The first derivative along the line.
    pub slope: f64,
    /// Half of the second derivative.
    pub curvature: f64,
}

impl SecondOrderDual {
    /// A number that stays as it is.
    #[must_use]
    pub(crate) const fn constant(value: f64) -> Self {
        Self {
            value,
            slope: 0.0,
            curvature: 0.0,
        }
    }

    /// A number that moves evenly.
    #[must_use]
    pub(crate) const fn line(value: f64, slope: f64) -> Self {
        Self {
            value,
            slope,
            curvature: 0.0,
        }
    }

    /// A function of the number, with its value, first and second derivative there.
    #[must_use]
    pub(crate) fn through(self, [value, first, second]: [f64; 3]) -> Self {
        Self {
            value,
            slope: first * self.slope,
            curvature: first * self.curvature + 0.5 * second * (self.slope * self.slope),
        }
    }
}

impl Add for SecondOrderDual {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            slope: self.slope + other.slope,
            curvature: self.curvature + other.curvature,
        }
    }
}

impl Neg for SecondOrderDual {
    type Output = Self;

    fn neg(self) -> Self {
        self * -1.0
    }
}

impl Sub for SecondOrderDual {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for SecondOrderDual {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            slope: self.value * other.slope + self.slope * other.value,
            curvature: self.value * other.curvature
                + self.slope * other.slope
                + self.curvature * other.value,
        }
    }
}

impl Mul<f64> for SecondOrderDual {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self {
            value: self.value * factor,
            slope: self.slope * factor,
            curvature: self.curvature * factor,
        }
    }
}

impl Div for SecondOrderDual {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        let slope = (self.slope - value * other.slope) / other.value;
        Self {
            value,
            slope,
            curvature: (self.curvature - value * other.curvature - slope * other.slope)
                / other.value,
        }
    }
}

impl Div<f64> for SecondOrderDual {
    type Output = Self;

    fn div(self, divisor: f64) -> Self {
        Self {
            value: self.value / divisor,
            slope: self.slope / divisor,
            curvature: self.curvature / divisor,
        }
    }
}

super::assign::assign_operators!([] SecondOrderDual);

impl Zero for SecondOrderDual {
    fn zero() -> Self {
        Self::default()
    }

    fn is_zero(&self) -> bool {
        *self == Self::default()
    }
}

impl One for SecondOrderDual {
    fn one() -> Self {
        Self::constant(1.0)
    }
}

impl From<f64> for SecondOrderDual {
    fn from(value: f64) -> Self {
        Self::constant(value)
    }
}

impl Real for SecondOrderDual {
    fn pair(high: f64, low: f64) -> Self {
        Self::constant(high + low)
    }

    fn rounded(self) -> f64 {
        self.value
    }

    fn root(self) -> Self {
        let root = self.value.sqrt();
        self.through([root, 0.5 / root, -0.25 / (root * self.value)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_a_line() {
        let x = SecondOrderDual::line(3.0, 2.0);
        assert_eq!(
            x * x,
            SecondOrderDual {
                value: 9.0,
                slope: 12.0,
                curvature: 4.0
            }
        );
        assert_eq!((x * x) / x, x);
        assert_eq!((x * x).root(), x);
        assert_eq!(-(x - x * 2.0), x);
        assert_eq!((x / 2.0) * 2.0, x);
        // 1/x = 1/3 − (2/9) ε + (4/27) ε²
        let inverse = SecondOrderDual::one() / x;
        assert!(
            (inverse.slope + 2.0 / 9.0).abs() < 1e-16
                && (inverse.curvature - 4.0 / 27.0).abs() < 1e-16
        );
        let mut sum = x;
        sum += x;
        sum -= x;
        sum *= x;
        sum /= x;
        assert_eq!(sum, x);
    }
}
