//! The symmetric top: its axis, the moment along it and the moment across it.

use nalgebra::Vector3;

use super::axes::PrincipalAxes;
use super::tops::gaps;
use crate::error::{BodyFault, Error, check_rtol};

/// A symmetric top, in the letters of textbooks that single out its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SymmetricTop {
    /// Unit vector along the symmetry axis, in B.
    pub axis: Vector3<f64>,
    /// `I_s`, the moment about the symmetry axis.
    pub axial: f64,
    /// `I_t`, the moment about every axis across it.
    pub transverse: f64,
}

impl SymmetricTop {
    /// The symmetric top with these principal axes, moments closer than `rtol` times the largest taken as equal.
    ///
    /// The closer two are the pair across the axis, the lower two where both gaps are equal, and `I_t` is their mean. Of a
    /// spherical top, for which every axis will do, that is one of three.
    ///
    /// # Examples
    ///
    /// ```
    /// use polhode::mass::{Amount, solids};
    /// use polhode::principal::{SymmetricTop, TOP_RTOL};
    ///
    /// let coin = solids::cylinder(1.0, 0.0, Amount::Mass(4.0))?;
    /// let top = SymmetricTop::of(&coin.principal(), TOP_RTOL)?;
    /// assert_eq!(top.axis.z.abs(), 1.0);
    /// # Ok::<(), polhode::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`BodyFault::NotASymmetricTop`]; `rtol` that is not at least 0 and less than 1.
    pub fn of(principal: &PrincipalAxes, rtol: f64) -> Result<Self, Error> {
        check_rtol(rtol)?;
        let PrincipalAxes { moments, axes } = principal;
        let [i1, i2, i3] = *moments;
        let [lower, upper] = gaps(moments);
        let gap = lower.min(upper);
        if gap > rtol {
            return Err(BodyFault::NotASymmetricTop {
                moments: *moments,
                gap,
                allowed: rtol,
            }
            .into());
        }
        let mean = |a: f64, b: f64| a + 0.5 * (b - a);
        let (column, axial, transverse) = if lower <= upper {
            (2, i3, mean(i1, i2))
        } else {
            (0, i1, mean(i2, i3))
        };
        Ok(Self {
            axis: axes.column(column).into_owned(),
            axial,
            transverse,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::principal::TOP_RTOL;
    use nalgebra::Matrix3;

    fn top(moments: [f64; 3], rtol: f64) -> Result<SymmetricTop, Error> {
        let axes = Matrix3::identity();
        SymmetricTop::of(&PrincipalAxes { moments, axes }, rtol)
    }

    #[test]
    fn axis_of_each_kind() {
        let found = |moments| {
            let SymmetricTop {
                axis,
                axial,
                transverse,
            } = top(moments, TOP_RTOL).expect("symmetric");
            (axis, axial, transverse)
        };
        assert_eq!(found([1.0, 1.0, 1.5]), (Vector3::z(), 1.5, 1.0));
        assert_eq!(found([0.5, 1.0, 1.0]), (Vector3::x(), 0.5, 1.0));
        assert_eq!(found([0.0, 1.0, 1.0]), (Vector3::x(), 0.0, 1.0));
        assert_eq!(found([1.0, 1.0, 1.0]), (Vector3::z(), 1.0, 1.0));
        assert_eq!(found([0.0; 3]), (Vector3::z(), 0.0, 0.0));
    }

    #[test]
    fn asymmetric_top_is_refused_unless_asked_for() {
        let fault = top([1.0, 1.01, 2.0], TOP_RTOL).expect_err("asymmetric");
        assert!(
            matches!(fault, Error::Body(BodyFault::NotASymmetricTop { gap, .. }) if (gap - 0.005).abs() < 1e-15)
        );
        assert_eq!(
            top([1.0, 1.01, 2.0], 0.01).expect("asked for").transverse,
            1.005
        );
    }
}
