//! Formulas as Taylor series in time: each operation is a node, and its coefficients come order by order.
//!
//! A formula is written once for any [`Arithmetic`]: in doubles it gives a value, in [`Node`]s it records its operations in a
//! [`PowerSeries`]. With `a_k = a⁽ᵏ⁾/k!` the operations have the coefficients
//!
//! ```text
//! (a b)_k = Σ_j a_j b_{k−j},   c = a/b: c_k = (a_k − Σ_{j<k} c_j b_{k−j})/b_0,   s = √a: s_k = (a_k − Σ_{0<j<k} s_j s_{k−j})/(2 s_0)
//! ```
//!
//! and a variable has `x_{k+1} = ẋ_k/(k + 1)` from the node of its rate.
//! Source: Griewank & Walther, Evaluating Derivatives (2008), §13.2.

use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::jet::Jet;
use super::number::Real;

/// Numbers in which a formula is written.
pub(crate) trait Arithmetic:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + Add<f64, Output = Self>
    + Mul<f64, Output = Self>
{
    /// Compute the square root.
    fn root(self) -> Self;
}

impl Arithmetic for f64 {
    fn root(self) -> Self {
        self.sqrt()
    }
}

impl<const N: usize> Arithmetic for Jet<N> {
    fn root(self) -> Self {
        Real::root(self)
    }
}

/// Compute a·b.
pub(crate) fn dot<N: Arithmetic>(a: [N; 3], b: [N; 3]) -> N {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Compute a×b.
pub(crate) fn cross<N: Arithmetic>(a: [N; 3], b: [N; 3]) -> [N; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Compute a + b.
pub(crate) fn plus<N: Arithmetic>(a: [N; 3], b: [N; 3]) -> [N; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// Compute a − b.
pub(crate) fn minus<N: Arithmetic>(a: [N; 3], b: [N; 3]) -> [N; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Compute s a.
pub(crate) fn scaled<N: Arithmetic>(a: [N; 3], s: N) -> [N; 3] {
    a.map(|x| x * s)
}

/// Compute M a for a constant matrix.
pub(crate) fn transformed<N: Arithmetic>(matrix: &nalgebra::Matrix3<f64>, a: [N; 3]) -> [N; 3] {
    [0, 1, 2].map(|i| a[0] * matrix[(i, 0)] + a[1] * matrix[(i, 1)] + a[2] * matrix[(i, 2)])
}

/// An operation; its operands are numbers of nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Operation {
    Constant(f64),
    /// The variable of this number.
    Variable(usize),
    Sum(usize, usize),
    Difference(usize, usize),
    Product(usize, usize),
    Quotient(usize, usize),
    Root(usize),
    Multiple(usize, f64),
    /// A node plus a number.
    Shift(usize, f64),
}

/// The operations of a formula as they are recorded.
#[derive(Debug, Default)]
pub(crate) struct Recorder {
    operations: RefCell<Vec<Operation>>,
}

/// The result of an operation that is recorded.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Node<'r> {
    recorder: &'r Recorder,
    index: usize,
}

impl Recorder {
    /// Record the variable of number `number`.
    pub(crate) fn variable(&self, number: usize) -> Node<'_> {
        self.record(Operation::Variable(number))
    }

    fn record(&self, operation: Operation) -> Node<'_> {
        let mut operations = self.operations.borrow_mut();
        let known = operations.iter().position(|known| *known == operation);
        let index = known.unwrap_or_else(|| {
            operations.push(operation);
            operations.len() - 1
        });
        Node {
            recorder: self,
            index,
        }
    }
}

impl Node<'_> {
    fn constant(&self) -> Option<f64> {
        match self.recorder.operations.borrow()[self.index] {
            Operation::Constant(x) => Some(x),
            _ => None,
        }
    }

    fn is_zero(&self) -> bool {
        self.constant() == Some(0.0)
    }

    fn then(self, operation: Operation) -> Self {
        self.recorder.record(operation)
    }
}

impl Add for Node<'_> {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        match (self.constant(), other.constant()) {
            (Some(x), _) => other + x,
            (_, Some(y)) => self + y,
            _ => self.then(Operation::Sum(self.index, other.index)),
        }
    }
}

impl Sub for Node<'_> {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        match (self.constant(), other.constant()) {
            (_, Some(y)) => self + -y,
            (Some(x), _) => -other + x,
            _ => self.then(Operation::Difference(self.index, other.index)),
        }
    }
}

impl Mul for Node<'_> {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        match (self.constant(), other.constant()) {
            (Some(x), _) => other * x,
            (_, Some(y)) => self * y,
            _ => {
                let (a, b) = (self.index, other.index);
                self.then(Operation::Product(a.min(b), a.max(b)))
            }
        }
    }
}

impl Div for Node<'_> {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        if self.is_zero() {
            return self;
        }
        match other.constant() {
            Some(y) => self * (1.0 / y),
            None => self.then(Operation::Quotient(self.index, other.index)),
        }
    }
}

impl Neg for Node<'_> {
    type Output = Self;

    fn neg(self) -> Self {
        self * -1.0
    }
}

impl Add<f64> for Node<'_> {
    type Output = Self;

    fn add(self, number: f64) -> Self {
        match self.constant() {
            Some(x) => self.then(Operation::Constant(x + number)),
            None if number == 0.0 => self,
            None => self.then(Operation::Shift(self.index, number)),
        }
    }
}

impl Mul<f64> for Node<'_> {
    type Output = Self;

    fn mul(self, number: f64) -> Self {
        match self.constant() {
            _ if number == 0.0 => self.then(Operation::Constant(0.0)),
            Some(x) => self.then(Operation::Constant(x * number)),
            None if number == 1.0 => self,
            None => self.then(Operation::Multiple(self.index, number)),
        }
    }
}

impl Arithmetic for Node<'_> {
    fn root(self) -> Self {
        match self.constant() {
            Some(x) => self.then(Operation::Constant(x.sqrt())),
            None => self.then(Operation::Root(self.index)),
        }
    }
}

/// The most coefficients of a series.
pub(crate) const COUNT: usize = 27;

/// The series of the variables of a system of differential equations.
#[derive(Clone, Debug)]
pub(crate) struct PowerSeries {
    /// The coefficients of all nodes: variables, constants, and operations in the order of `runs`.
    nodes: Vec<[f64; COUNT]>,
    runs: Vec<Run>,
    /// The node of the rate of each variable, and those that are asked for besides.
    rates: Vec<usize>,
    outputs: Vec<usize>,
}

/// Operations of one kind, one after the other in `nodes`. A processor that meets the same operation many times in turn guesses right
/// what comes next; with another operation at each node it takes three times as long.
#[derive(Clone, Debug)]
struct Run {
    kind: Kind,
    first: usize,
    operands: Vec<Operands>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// `factors[0] a + factors[1] b + shift`
    Linear,
    Product,
    Quotient,
    Root,
}

const KINDS: [Kind; 4] = [Kind::Linear, Kind::Product, Kind::Quotient, Kind::Root];

#[derive(Clone, Copy, Debug)]
struct Operands {
    nodes: [usize; 2],
    factors: [f64; 2],
    shift: f64,
}

impl Operation {
    /// Return the kind of an operation and what it needs; nothing for a constant or a variable.
    fn parts(self) -> Option<(Kind, Operands)> {
        let linear = |nodes, factors, shift| {
            let operands = Operands {
                nodes,
                factors,
                shift,
            };
            (Kind::Linear, operands)
        };
        let of = |kind, nodes| (kind, linear(nodes, [1.0; 2], 0.0).1);
        Some(match self {
            Self::Constant(_) | Self::Variable(_) => return None,
            Self::Sum(a, b) => linear([a, b], [1.0, 1.0], 0.0),
            Self::Difference(a, b) => linear([a, b], [1.0, -1.0], 0.0),
            Self::Multiple(a, number) => linear([a, a], [number, 0.0], 0.0),
            Self::Shift(a, number) => linear([a, a], [1.0, 0.0], number),
            Self::Product(a, b) => of(Kind::Product, [a, b]),
            Self::Quotient(a, b) => of(Kind::Quotient, [a, b]),
            Self::Root(a) => of(Kind::Root, [a, a]),
        })
    }
}

impl PowerSeries {
    /// Make the series of the variables that `rates`, nodes of `recorder`, are the rates of; and of other nodes, `outputs`.
    pub(crate) fn new(recorder: &Recorder, rates: &[Node<'_>], outputs: &[Node<'_>]) -> Self {
        let operations = recorder.operations.borrow();
        let mut nodes = vec![[0.0; COUNT]; rates.len()];
        let mut places = vec![None; operations.len()];
        let mut open = Vec::new();
        for (index, operation) in operations.iter().enumerate() {
            match *operation {
                Operation::Variable(number) => places[index] = Some(number),
                Operation::Constant(x) => {
                    places[index] = Some(nodes.len());
                    let mut series = [0.0; COUNT];
                    series[0] = x;
                    nodes.push(series);
                }
                _ => open.extend(
                    operation
                        .parts()
                        .map(|(kind, needed)| (index, kind, needed)),
                ),
            }
        }
        let mut runs = Vec::new();
        while !open.is_empty() {
            let known = |needed: &Operands, places: &[Option<usize>]| match needed
                .nodes
                .map(|node| places[node])
            {
                [Some(a), Some(b)] => Some([a, b]),
                _ => None,
            };
            let mut ready = [0; KINDS.len()];
            for (_, kind, needed) in &open {
                ready[*kind as usize] += usize::from(known(needed, &places).is_some());
            }
            let Some(kind) = KINDS.into_iter().max_by_key(|kind| ready[*kind as usize]) else {
                break;
            };
            // And what can be done after operations of the same kind.
            let mut run = Run {
                kind,
                first: nodes.len(),
                operands: Vec::new(),
            };
            open.retain(|(index, own, needed)| {
                let Some(found) = known(needed, &places).filter(|_| *own == kind) else {
                    return true;
                };
                places[*index] = Some(nodes.len());
                nodes.push([0.0; COUNT]);
                run.operands.push(Operands {
                    nodes: found,
                    ..*needed
                });
                false
            });
            runs.push(run);
        }
        let places_of =
            |nodes: &[Node<'_>]| nodes.iter().filter_map(|node| places[node.index]).collect();
        Self {
            runs,
            rates: places_of(rates),
            outputs: places_of(outputs),
            nodes,
        }
    }

    /// Compute the coefficients of all variables up to `order` from their values.
    pub(crate) fn expand(&mut self, values: &[f64], order: usize) {
        self.start(values);
        for sweep in &SWEEPS[..order] {
            sweep(self);
        }
    }

    /// Compute the same where a variable, whose rate is zero, stands for an unknown series: `coefficient` gets each order, how often it
    /// was tried and the variables with one order more. It returns the coefficient of that order to try, until it returns none.
    pub(crate) fn expand_with_unknown(
        &mut self,
        values: &[f64],
        order: usize,
        unknown: usize,
        mut coefficient: impl FnMut(usize, usize, &mut [[f64; COUNT]]) -> Option<f64>,
    ) {
        self.start(values);
        let count = self.rates.len();
        for (k, sweep) in SWEEPS[..order].iter().enumerate() {
            sweep(self);
            let mut trial = 0;
            while let Some(found) = coefficient(k, trial, &mut self.nodes[..count]) {
                self.nodes[unknown][k] = found;
                sweep(self);
                trial += 1;
            }
        }
    }

    fn start(&mut self, values: &[f64]) {
        let count = self.rates.len();
        for (variable, value) in self.nodes[..count].iter_mut().zip(values) {
            variable[0] = *value;
        }
    }

    /// Compute the coefficients of order K of all nodes, and the next ones of the variables: each order is code of its own, in which
    /// the sums have a known length.
    fn sweep<const K: usize>(&mut self) {
        let nodes = &mut self.nodes[..];
        for run in &self.runs {
            let operands = run.operands.iter().zip(run.first..);
            match run.kind {
                Kind::Linear => {
                    for (needed, node) in operands {
                        let ([a, b], [p, q]) = (needed.nodes, needed.factors);
                        let shift = if K == 0 { needed.shift } else { 0.0 };
                        nodes[node][K] = nodes[a][K] * p + nodes[b][K] * q + shift;
                    }
                }
                Kind::Product => {
                    for (needed, node) in operands {
                        let [a, b] = needed.nodes;
                        nodes[node][K] = product(&nodes[a][..=K], &nodes[b][..=K]);
                    }
                }
                Kind::Quotient => {
                    for (needed, node) in operands {
                        let [a, b] = needed.nodes;
                        let known = product(&nodes[node][..K], &nodes[b][1..=K]);
                        nodes[node][K] = (nodes[a][K] - known) / nodes[b][0];
                    }
                }
                Kind::Root => {
                    for (needed, node) in operands {
                        let a = needed.nodes[0];
                        nodes[node][K] = if K == 0 {
                            nodes[a][0].sqrt()
                        } else {
                            let known = product(&nodes[node][1..K], &nodes[node][1..K]);
                            (nodes[a][K] - known) / (2.0 * nodes[node][0])
                        };
                    }
                }
            }
        }
        for (variable, rate) in self.rates.iter().enumerate() {
            self.nodes[variable][K + 1] = self.nodes[*rate][K] / (K + 1) as f64;
        }
    }

    /// Return the coefficients of each variable.
    pub(crate) fn coefficients(&self) -> &[[f64; COUNT]] {
        &self.nodes[..self.rates.len()]
    }

    /// Return the coefficients of an output; it has one less than the variables.
    pub(crate) fn output(&self, number: usize) -> &[f64; COUNT] {
        &self.nodes[self.outputs[number]]
    }
}

/// The sweep of each order.
const SWEEPS: [fn(&mut PowerSeries); COUNT - 1] = [
    PowerSeries::sweep::<0>,
    PowerSeries::sweep::<1>,
    PowerSeries::sweep::<2>,
    PowerSeries::sweep::<3>,
    PowerSeries::sweep::<4>,
    PowerSeries::sweep::<5>,
    PowerSeries::sweep::<6>,
    PowerSeries::sweep::<7>,
    PowerSeries::sweep::<8>,
    PowerSeries::sweep::<9>,
    PowerSeries::sweep::<10>,
    PowerSeries::sweep::<11>,
    PowerSeries::sweep::<12>,
    PowerSeries::sweep::<13>,
    PowerSeries::sweep::<14>,
    PowerSeries::sweep::<15>,
    PowerSeries::sweep::<16>,
    PowerSeries::sweep::<17>,
    PowerSeries::sweep::<18>,
    PowerSeries::sweep::<19>,
    PowerSeries::sweep::<20>,
    PowerSeries::sweep::<21>,
    PowerSeries::sweep::<22>,
    PowerSeries::sweep::<23>,
    PowerSeries::sweep::<24>,
    PowerSeries::sweep::<25>,
];

/// Compute the coefficient `Σ_j a_j b_{n−j}` of a product from as many coefficients of both.
#[inline(always)]
fn product(a: &[f64], b: &[f64]) -> f64 {
    // Four sums side by side: each addition waits for the one before it in its sum alone.
    let mut sums = [0.0; 4];
    let (mut left, mut right) = (a.chunks_exact(4), b.rchunks_exact(4));
    for (x, y) in (&mut left).zip(&mut right) {
        for i in 0..4 {
            sums[i] += x[i] * y[3 - i];
        }
    }
    for ((x, y), sum) in (left.remainder().iter())
        .zip(right.remainder().iter().rev())
        .zip(&mut sums)
    {
        *sum += x * y;
    }
    (sums[0] + sums[1]) + (sums[2] + sums[3])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Record `ẋ = f(x)`, and compute the series of x from `start`.
    fn series(start: f64, rate: impl Fn(Node<'_>) -> Node<'_>) -> [f64; COUNT] {
        let recorder = Recorder::default();
        let rate = rate(recorder.variable(0));
        let mut series = PowerSeries::new(&recorder, &[rate], &[rate]);
        series.expand(&[start], COUNT - 1);
        series.coefficients()[0]
    }

    #[test]
    fn series_of_known_functions() {
        // ẋ = x² from 1: 1/(1 − t).
        assert!(
            series(1.0, |x| x * x)
                .iter()
                .all(|c| (c - 1.0).abs() < 1e-15)
        );
        // ẋ = 1/x from 1: √(1 + 2t); as ẋ = 1/√(x²) too.
        let mut exact = 1.0;
        let (quotient, root) = (
            series(1.0, |x| (x * 0.0 + 1.0) / x),
            series(1.0, |x| x / (x * x) / (x * x).root() * x),
        );
        for k in 0..COUNT {
            let size = f64::abs(exact);
            assert!((quotient[k] - exact).abs() <= 1e-13 * size, "{k}");
            assert!((root[k] - exact).abs() <= 1e-12 * size, "{k}");
            exact *= (1.0 - 2.0 * k as f64) / (k + 1) as f64;
        }
    }

    #[test]
    fn constants_are_folded() {
        let recorder = Recorder::default();
        let x = recorder.variable(0);
        let zero = x * 0.0;
        assert_eq!((x + zero).index, x.index);
        assert_eq!((x * (zero + 1.0)).index, x.index);
        assert_eq!((x - zero).index, x.index);
        assert!((zero / x).is_zero() && (zero * x).is_zero());
        assert_eq!((zero + 4.0).root().constant(), Some(2.0));
        assert_eq!(((zero + 4.0) / (zero + 2.0)).constant(), Some(2.0));
        // What was computed is not computed again.
        assert_eq!((x * x).index, (x * x).index);
        assert_eq!(((zero + 3.0) - x * x).constant(), None);
    }

    #[test]
    fn vectors() {
        let (a, b) = ([1.0, 2.0, 3.0], [-2.0, 0.5, 4.0]);
        assert_eq!(dot(a, cross(a, b)), 0.0);
        assert_eq!(plus(minus(a, b), b), a);
        assert_eq!(
            scaled(a, 2.0),
            transformed(&(nalgebra::Matrix3::identity() * 2.0), a)
        );
    }
}
