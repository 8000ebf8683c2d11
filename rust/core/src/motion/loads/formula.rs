//! A torque that is not linear in ω, as a formula: steps that an engine of series goes through order by order.

use nalgebra::Matrix3;

use super::principal_frame::LawNumber;

/// A step of a formula. Scalars and vectors are numbered in the order of the steps that make them; the vector 0 is ω.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FormulaStep {
    /// The scalar ω·ω.
    Square,
    /// The scalar |ω|, the root of the scalar of this number, which is ω·ω.
    Speed(usize),
    /// A scalar times a vector.
    Times(usize, usize),
}

/// A scalar of a formula, and its degree in ω.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scalar {
    number: usize,
    degree: i32,
}

/// A vector of a formula, and its degree in ω.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vector {
    number: usize,
    degree: i32,
}

/// ω.
pub(crate) const OMEGA: Vector = Vector {
    number: 0,
    degree: 1,
};

/// The torque `M v` about the reference point: a matrix, and a vector that is made of ω step by step; in principal axes.
#[derive(Clone, Debug)]
pub(crate) struct TorqueFormula<X: LawNumber> {
    /// How the vector is made.
    pub steps: Vec<FormulaStep>,
    /// The number of the vector.
    pub vector: usize,
    /// Its degree in ω, so that the torque is known in every unit of rates.
    pub degree: i32,
    /// M.
    pub matrix: Matrix3<X>,
}

impl<X: LawNumber> TorqueFormula<X> {
    /// Whether |ω| is a step of it.
    pub(super) fn has_speed(&self) -> bool {
        self.steps
            .iter()
            .any(|step| matches!(step, FormulaStep::Speed(_)))
    }
}

/// A formula as a law states it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Steps {
    list: Vec<FormulaStep>,
    scalars: usize,
    vectors: usize,
}

impl Steps {
    fn scalar(&mut self, step: FormulaStep, degree: i32) -> Scalar {
        self.list.push(step);
        self.scalars += 1;
        Scalar {
            number: self.scalars - 1,
            degree,
        }
    }

    /// `ω·ω`.
    pub(crate) fn square(&mut self) -> Scalar {
        self.scalar(FormulaStep::Square, 2)
    }

    /// |ω|. Where ω passes through zero, a step must end: see [`TorqueFormula::has_speed`].
    pub(crate) fn speed(&mut self) -> Scalar {
        let square = self.square();
        self.scalar(FormulaStep::Speed(square.number), 1)
    }

    /// A scalar times a vector.
    pub(crate) fn times(&mut self, factor: Scalar, vector: Vector) -> Vector {
        self.list
            .push(FormulaStep::Times(factor.number, vector.number));
        self.vectors += 1;
        Vector {
            number: self.vectors,
            degree: factor.degree + vector.degree,
        }
    }

    /// The torque `matrix · vector`, the matrix in principal axes.
    pub(crate) fn torque<X: LawNumber>(
        self,
        matrix: Matrix3<X>,
        vector: Vector,
    ) -> TorqueFormula<X> {
        TorqueFormula {
            steps: self.list,
            vector: vector.number,
            degree: vector.degree,
            matrix,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_are_counted() {
        let mut steps = Steps::default();
        let (speed, square) = (steps.speed(), steps.square());
        let once = steps.times(speed, OMEGA);
        let twice = steps.times(square, once);
        let formula = steps.torque(Matrix3::<f64>::identity(), twice);
        assert_eq!((formula.degree, formula.vector), (4, 2));
        let all = [
            FormulaStep::Square,
            FormulaStep::Speed(0),
            FormulaStep::Square,
            FormulaStep::Times(1, 0),
            FormulaStep::Times(2, 1),
        ];
        assert_eq!(formula.steps, all);
        assert!(formula.has_speed());
        let mut steps = Steps::default();
        let square = steps.square();
        let cubic = steps.times(square, OMEGA);
        assert!(!steps.torque(Matrix3::<f64>::identity(), cubic).has_speed());
    }
}
