//! The principal frame of a motion, in the numbers of its run.

use nalgebra::Matrix3;

use crate::mass::refined::RefinedPrincipal;
use crate::motion::attitude::{components, from_axes};
use crate::motion::euler_equations::EulerEquations;
use crate::motion::loads::LawNumber;
use crate::motion::loads::variables::{Block, Fixed, MOMENTS, PRODUCTS, Variables, Varied, WIDTH};
use crate::motion::problem::Task;
use crate::numerics::double_double::DoubleDouble;
use crate::numerics::number::Real;
use crate::numerics::quaternion::normalized;

/// Moments and axes about the reference point.
#[derive(Clone, Copy, Debug)]
pub(super) struct PrincipalInertia<X> {
    /// I₁ ≤ I₂ ≤ I₃.
    pub(super) moments: [X; 3],
    /// I₂ − I₃, I₃ − I₁, I₁ − I₂.
    pub(super) differences: [X; 3],
    /// The elements 23, 31, 12 of the tensor: zero, but they may carry derivatives.
    pub(super) products: [X; 3],
    /// Columns, in B.
    pub(super) axes: Matrix3<X>,
    /// (x, y, z, w) of the rotation from principal axes to B.
    pub(super) q_bp: [X; 4],
}

/// The numbers of a run: doubles, double-double, or doubles with derivatives.
pub(super) trait Precision: LawNumber {
    /// Whether an orbit is continued from step to step by its own series, because Kepler's equation is solved in doubles only.
    const CARRIES_ORBITS: bool;
    /// Quadratic damping is left out while |ω| is below this part of its largest value. The error of ω, relative to the largest, is
    /// the cube of it; the error of derivatives is its square.
    const REST_SPEED: f64;
    /// Quadratic damping is also left out while |ω| is below this part of ω̇, in units of rates, so that the powers of the reciprocal
    /// in a series do not overflow. Relative to the other torques the damping is then as small as the square of it.
    const REST_SPEED_BESIDE_TORQUES: f64;
    /// Compute the principal frame of the body of a task.
    fn principal(task: &Task<'_>, variables: Self::Variables) -> PrincipalInertia<Self>;

    /// Subtract the derivatives of the tensor of wheels that turn freely, in these axes.
    fn subtract_wheels(
        principal: PrincipalInertia<Self>,
        _turning: impl FnOnce(&PrincipalInertia<Self>) -> Matrix3<Self>,
    ) -> PrincipalInertia<Self> {
        principal
    }

    /// Return the magnitudes of the value and of each derivative.
    fn magnitudes(self) -> [f64; WIDTH + 1] {
        let mut magnitudes = [0.0; WIDTH + 1];
        magnitudes[0] = self.rounded().abs();
        magnitudes
    }
}

impl Precision for f64 {
    const CARRIES_ORBITS: bool = false;
    const REST_SPEED: f64 = 2e-6;
    const REST_SPEED_BESIDE_TORQUES: f64 = 1e-10;

    fn principal(task: &Task<'_>, _: Fixed) -> PrincipalInertia<Self> {
        let axes = *task.euler.axes();
        PrincipalInertia {
            moments: task.euler.moments(),
            differences: task.euler.differences(),
            products: [0.0; 3],
            axes,
            q_bp: components(&from_axes(&axes)),
        }
    }
}

/// The numbers that define body and start are taken as exact: moments and axes, or the tensor; the direction of a quaternion.
impl Precision for DoubleDouble {
    const CARRIES_ORBITS: bool = true;
    const REST_SPEED: f64 = 2e-6;
    const REST_SPEED_BESIDE_TORQUES: f64 = 1e-7;

    fn principal(task: &Task<'_>, _: Fixed) -> PrincipalInertia<Self> {
        let refined = match &task.body_without_wheels {
            Some(body_without_wheels) => **body_without_wheels,
            None => RefinedPrincipal::about(task.body, &task.body_at_point.point),
        };
        let [i1, i2, i3] = refined.moments;
        let axes = refined.axes();
        PrincipalInertia {
            moments: refined.moments,
            differences: [i2 - i3, i3 - i1, i1 - i2],
            products: [Self::default(); 3],
            axes,
            q_bp: quaternion_of_matrix(&axes),
        }
    }
}

/// The tensor of a body with a zero moment has no derivatives: such a body has neighbours on one side only.
impl Precision for Varied {
    const CARRIES_ORBITS: bool = false;
    const REST_SPEED: f64 = 1e-8;
    const REST_SPEED_BESIDE_TORQUES: f64 = 1e-10;

    fn principal(task: &Task<'_>, block: Block) -> PrincipalInertia<Self> {
        let plain = <f64 as Precision>::principal(task, Fixed);
        let is_massless = plain.moments.contains(&0.0);
        let variable = |value: f64, column: usize| {
            if is_massless {
                Self::constant(value)
            } else {
                block.number(value, column)
            }
        };
        let mut principal = PrincipalInertia {
            moments: plain.moments.map(Self::constant),
            differences: plain.differences.map(Self::constant),
            products: [Self::constant(0.0); 3],
            axes: plain.axes.map(Self::constant),
            q_bp: plain.q_bp.map(Self::constant),
        };
        // The values are zero, the derivatives are not.
        let along = [0, 1, 2].map(|n| variable(0.0, MOMENTS + n));
        let [yz, zx, xy] = [0, 1, 2].map(|n| variable(0.0, PRODUCTS + n));
        let [x, y, z] = along;
        let mut tensor = Matrix3::new(x, xy, zx, xy, y, yz, zx, yz, z);
        if task.body_without_wheels.is_some() {
            // The variables are of the body with its wheels locked, in its axes.
            let whole = EulerEquations::refined_about(task.body, &task.body_at_point.point);
            let turn = (whole.axes().transpose() * plain.axes).map(Self::constant);
            tensor = turn.transpose() * tensor * turn;
        }
        principal.add(&tensor);
        principal
    }

    fn subtract_wheels(
        mut principal: PrincipalInertia<Self>,
        turning: impl FnOnce(&PrincipalInertia<Self>) -> Matrix3<Self>,
    ) -> PrincipalInertia<Self> {
        let turning = turning(&principal);
        principal.add(&(-turning));
        principal
    }

    fn magnitudes(self) -> [f64; WIDTH + 1] {
        let mut magnitudes = [self.value.abs(); WIDTH + 1];
        for (magnitude, slope) in magnitudes[1..].iter_mut().zip(&self.slopes) {
            *magnitude = slope.abs();
        }
        magnitudes
    }
}

impl PrincipalInertia<Varied> {
    /// Add the derivatives of a tensor in these axes.
    fn add(&mut self, tensor: &Matrix3<Varied>) {
        let slopes = |x: Varied| Varied { value: 0.0, ..x };
        for n in 0..3 {
            self.moments[n] += slopes(tensor[(n, n)]);
        }
        for (n, (i, j)) in [(1, 2), (2, 0), (0, 1)].into_iter().enumerate() {
            self.differences[n] += slopes(tensor[(i, i)] - tensor[(j, j)]);
            self.products[n] += slopes(tensor[(i, j)]);
        }
    }
}

/// Compute (x, y, z, w) of a rotation matrix, from the largest of the four.
///
/// Source: Shepperd, Journal of Guidance and Control 1 (1978) 223.
pub(super) fn quaternion_of_matrix<X: Real>(m: &Matrix3<X>) -> [X; 4] {
    let [x, y, z] = [0, 1, 2].map(|i| m[(i, i)]);
    let one = X::one();
    let squares = [
        one + x - y - z,
        one - x + y - z,
        one - x - y + z,
        one + x + y + z,
    ];
    let mut largest = 3;
    for i in 0..3 {
        if squares[i].rounded() > squares[largest].rounded() {
            largest = i;
        }
    }
    let sum = |i, j| m[(i, j)] + m[(j, i)];
    let difference = |i, j| m[(i, j)] - m[(j, i)];
    // Four times the products of component `largest` with all.
    let mut products = match largest {
        0 => [squares[0], sum(0, 1), sum(0, 2), difference(2, 1)],
        1 => [sum(0, 1), squares[1], sum(1, 2), difference(0, 2)],
        2 => [sum(0, 2), sum(1, 2), squares[2], difference(1, 0)],
        _ => [
            difference(2, 1),
            difference(0, 2),
            difference(1, 0),
            squares[3],
        ],
    };
    if products[3].rounded() < 0.0 {
        products = products.map(|x| -x);
    }
    normalized(products)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::quaternion::{conjugate, product};
    use nalgebra::{UnitQuaternion, Vector3};

    #[test]
    fn quaternions_of_matrices_turn_as_they_do() {
        for (roll, pitch, yaw) in [
            (0.3, -1.0, 2.0),
            (3.1, 0.1, -0.2),
            (0.1, 3.0, 0.2),
            (0.0, 0.1, 3.1),
        ] {
            let q = UnitQuaternion::from_euler_angles(roll, pitch, yaw);
            let q = <DoubleDouble as LawNumber>::quaternion(&q);
            let turned = |i: usize| {
                let mut e = [DoubleDouble::default(); 4];
                e[i] = 1.0.into();
                let [x, y, z, _] = product(product(q, e), conjugate(q));
                Vector3::new(x, y, z)
            };
            let matrix = Matrix3::from_columns(&[turned(0), turned(1), turned(2)]);
            let again = quaternion_of_matrix(&matrix);
            let sign = if q[3].rounded() < 0.0 { -1.0 } else { 1.0 };
            for (a, b) in again.iter().zip(q) {
                assert!((*a - b * sign.into()).rounded().abs() < 1e-31);
            }
            assert!(again[3].rounded() >= 0.0);
        }
    }
}
