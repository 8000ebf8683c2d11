//! Derivatives of principal moments and axes: what a small change of the tensor does to them.
//!
//! With I = V diag(I₁, I₂, I₃) Vᵀ, a tangent dI, and W = Vᵀ dI V,
//!
//! - d`I_k` = `W_kk`,
//! - dV = V Ω with `Ω_ij` = `W_ij` / (`I_j` − `I_i`), antisymmetric: the axes turn.
//!
//! Both follow from differentiating I V = V diag(I) and Vᵀ V = 1 (Magnus, Econometric Theory 1, 1985).

use nalgebra::Matrix3;

use super::axes::PrincipalAxes;

/// Moments closer than this, relative to the largest magnitude, count as equal unless the caller says otherwise: nearer
/// than that rounding of the tensor turns the axes about as much as any tangent.
pub const DEGENERATE_RTOL: f64 = 1e-12;

/// The pairs of axes, in the order of [`PrincipalDerivative::degenerate`].
pub const PAIRS: [(usize, usize); 3] = [(0, 1), (0, 2), (1, 2)];

/// The change of principal moments and axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrincipalDerivative {
    /// d`I_k`.
    pub moments: [f64; 3],
    /// dV, by columns; V + dV is a rotation to first order.
    pub axes: Matrix3<f64>,
    /// Which of the [`PAIRS`] have equal moments. Within such a pair neither the axes nor the single moments have a
    /// derivative: `axes` then leaves out the rotation in the plane of the pair, and of the two `moments` only the sum
    /// has a meaning that does not depend on the choice of axes.
    pub degenerate: [bool; 3],
}

/// The derivative in the direction `tangent`, symmetric, of which the lower triangle is read; moments closer than `rtol`
/// times the largest magnitude count as equal.
///
/// At a relative gap g between two moments the rotation between their axes carries a relative error of about ε/g.
///
/// # Examples
///
/// ```
/// use polhode::nalgebra::{Matrix3, Vector3};
/// use polhode::principal::derivative::PAIRS;
/// use polhode::principal::{DEGENERATE_RTOL, PrincipalDerivative, derivative, principal_axes};
///
/// // A product of inertia between the axes 1 and 2 turns them by I_xy/(I₂ − I₁) and changes no moment.
/// let principal = principal_axes(&Matrix3::from_diagonal(&Vector3::new(1.0, 3.0, 3.5)));
/// let mut tangent = Matrix3::zeros();
/// (tangent[(0, 1)], tangent[(1, 0)]) = (1e-3, 1e-3);
/// let PrincipalDerivative { moments, axes, degenerate } = derivative(&principal, &tangent, DEGENERATE_RTOL);
/// assert_eq!(moments, [0.0; 3]);
/// assert!((axes[(0, 1)] - 1e-3 / 2.0).abs() < 1e-18);
/// assert_eq!(degenerate, PAIRS.map(|_| false));
/// ```
#[must_use]
pub fn derivative(
    principal: &PrincipalAxes,
    tangent: &Matrix3<f64>,
    rtol: f64,
) -> PrincipalDerivative {
    let (v, moments) = (&principal.axes, &principal.moments);
    let mut symmetric = *tangent;
    symmetric.fill_upper_triangle_with_lower_triangle();
    let w = v.tr_mul(&(symmetric * v));
    let close = rtol * moments[0].abs().max(moments[2].abs());
    let mut rates = Matrix3::zeros();
    let degenerate = PAIRS.map(|(i, j)| {
        let gap = moments[j] - moments[i];
        let equal = gap <= close;
        if !equal {
            rates[(i, j)] = w[(i, j)] / gap;
            rates[(j, i)] = -rates[(i, j)];
        }
        equal
    });
    PrincipalDerivative {
        moments: [w[(0, 0)], w[(1, 1)], w[(2, 2)]],
        axes: v * rates,
        degenerate,
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::{DEGENERATE_RTOL, derivative};
    use crate::principal::principal_axes;

    const TENSOR: Matrix3<f64> = Matrix3::new(3.0, 0.1, 0.2, 0.1, 4.0, 0.3, 0.2, 0.3, 5.0);
    const TANGENT: Matrix3<f64> = Matrix3::new(0.5, -0.3, 0.7, -0.3, 0.2, 0.4, 0.7, 0.4, -0.6);

    #[test]
    fn agrees_with_central_differences() {
        let exact = derivative(&principal_axes(&TENSOR), &TANGENT, DEGENERATE_RTOL);
        assert_eq!(exact.degenerate, [false; 3]);
        let h = 1e-5;
        let (after, before) = (
            principal_axes(&(TENSOR + TANGENT * h)),
            principal_axes(&(TENSOR - TANGENT * h)),
        );
        for k in 0..3 {
            let slope = (after.moments[k] - before.moments[k]) / (2.0 * h);
            assert!((slope - exact.moments[k]).abs() < 1e-9);
        }
        assert!(
            ((after.axes - before.axes) / (2.0 * h) - exact.axes)
                .abs()
                .max()
                < 1e-9
        );
    }

    #[test]
    fn equal_moments_are_reported_and_turn_nothing_in_their_plane() {
        let top = principal_axes(&Matrix3::from_diagonal(&[1.0, 2.0, 2.0].into()));
        let found = derivative(&top, &TANGENT, DEGENERATE_RTOL);
        assert_eq!(found.degenerate, [false, false, true]);
        assert_eq!(top.axes.column(1).dot(&found.axes.column(2)), 0.0);
        assert!(found.axes.iter().all(|x| x.is_finite()));
        // The sum of the pair's moments: the trace less the other moment.
        let sum = TANGENT.trace() - found.moments[0];
        assert!((found.moments[1] + found.moments[2] - sum).abs() < 1e-15);
        let sphere = principal_axes(&Matrix3::identity());
        assert_eq!(
            derivative(&sphere, &TANGENT, DEGENERATE_RTOL).degenerate,
            [true; 3]
        );
    }

    #[test]
    fn what_is_not_a_number_stays_so() {
        let nan = derivative(
            &principal_axes(&Matrix3::repeat(f64::NAN)),
            &TANGENT,
            DEGENERATE_RTOL,
        );
        assert!(
            nan.moments
                .iter()
                .chain(nan.axes.iter())
                .all(|x| x.is_nan())
        );
        assert_eq!(nan.degenerate, [false; 3]);
    }
}
