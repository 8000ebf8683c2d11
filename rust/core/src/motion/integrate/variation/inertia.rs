//! The tensor of inertia about the reference point, in principal axes, and what may vary in it.

use nalgebra::Matrix3;

use super::numbers::{Block, Matrix, Number, Rows, Vector, WIDTH, ZERO, product, times, turned};
use super::parameters::{CENTER, MASS, MOMENTS, PRODUCTS};
use crate::motion::problem::Task;
use crate::numerics::power_of_two::power_below;

/// Moments and products in principal axes, in a unit of their own; mass and centre of mass.
#[derive(Clone, Debug)]
pub(super) struct Inertia {
    /// The unit of moments: the power of two at or below the largest.
    pub(super) unit: f64,
    /// The columns are the principal axes, in B.
    pub(super) axes: Matrix3<f64>,
    pub(super) inverse: Matrix,
    pub(super) mass: Number,
    /// `c_P` from the reference point, and C from the origin of B; components in principal axes.
    pub(super) arm: Vector,
    pub(super) center: Vector,
    /// I₂ − I₃, I₃ − I₁, I₁ − I₂.
    differences: Vector,
    /// The elements 23, 31, 12: zero, but their variations are not.
    products: Vector,
    /// Whether they vary.
    tilts: bool,
}

impl Inertia {
    pub(super) fn new(task: &Task<'_>, block: Block) -> Self {
        let (moments, axes) = (task.euler.moments(), *task.euler.axes());
        let subject = &task.subject;
        let unit = power_below(moments[2]);
        // A zero moment has no neighbours on one side: nothing about the tensor is varied.
        let is_massless = moments.contains(&0.0);
        let variable = |value: f64, column: usize| {
            let number = if is_massless {
                Number::constant(value)
            } else {
                block.variable(value, column)
            };
            number * (1.0 / unit)
        };
        let i = [0, 1, 2].map(|n| variable(moments[n], MOMENTS + n));
        let products = [0, 1, 2].map(|n| variable(0.0, PRODUCTS + n));
        let [d1, d2, d3] = task.euler.differences();
        let exact = |d: f64, difference: Number| Number {
            value: d / unit,
            ..difference
        };
        let over = [0, 1, 2].map(|n| {
            if moments[n] > 0.0 {
                Number::constant(1.0) / i[n]
            } else {
                ZERO
            }
        });
        // To first order in the products, δ(I⁻¹) = −I⁻¹ δI I⁻¹.
        let off = |n: usize, a: usize, b: usize| -(products[n] * over[a] * over[b]);
        let center = turned(
            &axes.transpose(),
            &block.vector(&(subject.point + subject.center), CENTER),
        );
        Self {
            unit,
            axes,
            inverse: [
                [over[0], off(2, 0, 1), off(1, 2, 0)],
                [off(2, 0, 1), over[1], off(0, 1, 2)],
                [off(1, 2, 0), off(0, 1, 2), over[2]],
            ],
            mass: block.variable(subject.mass, MASS),
            arm: if subject.pivoted { center } else { [ZERO; 3] },
            center,
            differences: [
                exact(d1, i[1] - i[2]),
                exact(d2, i[2] - i[0]),
                exact(d3, i[0] - i[1]),
            ],
            products,
            tilts: products.iter().any(|x| x.slopes != [0.0; WIDTH]),
        }
    }

    /// The coefficient of order `k` of −x×I x: with `I_ij` off the diagonal, cyclic in i, j, k,
    ///
    /// ```text
    /// (I_j − I_k) x_j x_k − I_ki x_i x_j + I_ij x_k x_i + I_jk (x_k² − x_j²)
    /// ```
    pub(super) fn gyration(&self, x: &Rows<3>, k: usize) -> Vector {
        let mixed = [(1, 2), (2, 0), (0, 1)].map(|(i, j)| product(&x[i], &x[j], k));
        let mut sum = [0, 1, 2].map(|i| self.differences[i] * mixed[i]);
        if self.tilts {
            let squares = [0, 1, 2].map(|i| product(&x[i], &x[i], k));
            let p = &self.products;
            for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
                let tilted = p[k] * mixed[j] - p[j] * mixed[k] + p[i] * (squares[k] - squares[j]);
                sum[i] = sum[i] + tilted;
            }
        }
        sum
    }

    /// A vector of B, components in principal axes, times a factor.
    pub(super) fn principal(&self, vector: &Vector, factor: f64) -> Vector {
        times(&turned(&self.axes.transpose(), vector), factor)
    }
}
