//! What a change of the tensor makes of moments, axes and radii of gyration: to first order, and after a whole step.

use nalgebra::{Matrix3, Vector3};

use crate::principal::PrincipalAxes;
use crate::principal::derivative::DEGENERATE_RTOL;

/// A change of a tensor, in its principal axes.
pub(super) struct Turned {
    /// W.
    pub(super) change: Matrix3<f64>,
    /// `I_k`.
    moments: [f64; 3],
}

impl Turned {
    pub(super) fn of(principal: &PrincipalAxes, change: &Matrix3<f64>) -> Self {
        Self {
            change: principal.axes.tr_mul(&(change * principal.axes)),
            moments: principal.moments,
        }
    }

    pub(super) fn moments(&self) -> [f64; 3] {
        std::array::from_fn(|k| self.change[(k, k)])
    }

    /// φ; zero about an axis between equal moments, where there is none.
    pub(super) fn angles(&self) -> [f64; 3] {
        let turn = |i: usize, j: usize| {
            let gap = self.moments[j] - self.moments[i];
            if gap.abs() > DEGENERATE_RTOL * self.moments[2] {
                self.change[(i, j)] / gap
            } else {
                0.0
            }
        };
        [turn(2, 1), turn(0, 2), turn(1, 0)]
    }
}

/// What moments and axes have become after a step.
pub(super) struct Stepped {
    /// By how much the moments are others.
    pub(super) moments: [f64; 3],
    /// And the radii of gyration; NaN where a body has none.
    pub(super) radii: [f64; 3],
    /// The rotation of the axes, about themselves.
    pub(super) angles: [f64; 3],
}

impl Stepped {
    pub(super) fn from(
        start: &PrincipalAxes,
        radii: [f64; 3],
        end: &PrincipalAxes,
        mass: f64,
    ) -> Self {
        let mut turn = start.axes.tr_mul(&end.axes);
        // Axes have no sense: each is taken as near as it can be, and the last one right-handed.
        for k in 0..2 {
            if turn[(k, k)] < 0.0 {
                turn.column_mut(k).neg_mut();
            }
        }
        let third = turn.column(0).cross(&turn.column(1));
        turn.set_column(2, &third);
        Self {
            moments: std::array::from_fn(|k| end.moments[k] - start.moments[k]),
            radii: std::array::from_fn(|k| {
                let square = end.moments[k] / mass;
                if radii[k] > 0.0 {
                    square.sqrt() - radii[k]
                } else {
                    0.0
                }
            }),
            angles: rotation_vector(&turn).into(),
        }
    }
}

/// The rotation vector of a rotation, to the last digits of small angles too.
fn rotation_vector(turn: &Matrix3<f64>) -> Vector3<f64> {
    let twice_sine = Vector3::new(
        turn[(2, 1)] - turn[(1, 2)],
        turn[(0, 2)] - turn[(2, 0)],
        turn[(1, 0)] - turn[(0, 1)],
    );
    let size = twice_sine.norm();
    let angle = size.atan2(turn.trace() - 1.0);
    twice_sine * if size > 0.0 { angle / size } else { 0.5 }
}

#[cfg(test)]
mod tests {
    use nalgebra::Rotation3;

    use super::*;
    use crate::mass::body::RigidBody;
    use crate::principal::principal_axes;

    fn body(moments: [f64; 3]) -> RigidBody {
        RigidBody::from_principal(1.0, &moments, &Matrix3::identity(), &Vector3::zeros(), 0.0)
            .expect("body")
    }

    #[test]
    fn first_order_is_that_of_differences() {
        let principal = body([2.0, 3.0, 4.0]).principal();
        let slope = Matrix3::new(0.5, -0.3, 0.7, -0.3, 0.2, 0.4, 0.7, 0.4, -0.6);
        let first = Turned::of(&principal, &slope);
        let h = 1e-4;
        let tensor = Matrix3::from_diagonal(&Vector3::from(principal.moments));
        let [above, below] = [h, -h].map(|h| {
            Stepped::from(
                &principal,
                [1.0; 3],
                &principal_axes(&(tensor + slope * h)),
                1.0,
            )
        });
        for k in 0..3 {
            let moment = (above.moments[k] - below.moments[k]) / (2.0 * h);
            let angle = (above.angles[k] - below.angles[k]) / (2.0 * h);
            assert!(
                (moment - first.moments()[k]).abs() < 1e-7
                    && (angle - first.angles()[k]).abs() < 1e-7
            );
        }
    }

    #[test]
    fn rotation_vectors_come_back() {
        for size in [0.0, 1e-300, 1e-17, 1e-8, 0.1, 1.5, 3.0] {
            let vector = Vector3::new(0.6, -0.48, 0.64) * size;
            let found = rotation_vector(Rotation3::new(vector).matrix());
            assert!(
                (found - vector).norm() <= 1e-15 + 1e-15 * size,
                "{size} {found}"
            );
        }
    }
}
