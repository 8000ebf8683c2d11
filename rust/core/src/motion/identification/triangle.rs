//! Least squares of any number of rows by the triangle of their QR factors, and steps of Levenberg and Marquardt.

/// Rows that are taken in at once.
const BLOCK: usize = 96;
/// An expected fall of the cost that matters little beside the noise: (0.1 sigma)².
const NEAR: f64 = 1e-2;

/// The triangle R of rows (J | r), to which rows are added: |J δ − r|² is |R δ − q|² and a rest.
///
/// Its singular values are those of the rows; those of the normal equations would have lost half of the digits.
#[derive(Clone, Debug)]
pub(super) struct Triangle {
    /// Unknowns and one.
    width: usize,
    /// Columns of `width` numbers each, of which those above the diagonal and on it count.
    r: Vec<f64>,
    /// Columns of rows that wait.
    waiting: Vec<f64>,
    rows: usize,
}

impl Triangle {
    pub(super) fn new(unknowns: usize) -> Self {
        let width = unknowns + 1;
        Self {
            width,
            r: vec![0.0; width * width],
            waiting: vec![0.0; width * BLOCK],
            rows: 0,
        }
    }

    pub(super) fn unknowns(&self) -> usize {
        self.width - 1
    }

    /// Adds a row of derivatives, and what they should make.
    pub(super) fn push(&mut self, row: impl IntoIterator<Item = f64>, target: f64) {
        for (column, x) in row.into_iter().enumerate() {
            self.waiting[column * BLOCK + self.rows] = x;
        }
        self.waiting[(self.width - 1) * BLOCK + self.rows] = target;
        self.rows += 1;
        if self.rows == BLOCK {
            self.fold();
        }
    }

    /// Takes the waiting rows in: a reflection for each column.
    pub(super) fn fold(&mut self) {
        if self.rows == 0 {
            return;
        }
        let width = self.width;
        for column in self.waiting.chunks_exact_mut(BLOCK) {
            column[self.rows..].fill(0.0);
        }
        for j in 0..width {
            let (before, after) = self.waiting.split_at_mut((j + 1) * BLOCK);
            let own = &mut before[j * BLOCK..];
            let size = largest(own);
            if size == 0.0 || !size.is_finite() {
                continue;
            }
            let top = self.r[j * width + j];
            let size = size.max(top.abs());
            let squares = own.iter().map(|x| (x / size).powi(2)).sum::<f64>();
            let norm = size * ((top / size).powi(2) + squares).sqrt();
            let alpha = if top > 0.0 { -norm } else { norm };
            let first = top - alpha;
            self.r[j * width + j] = alpha;
            // The reflection is 1 − v vᵀ/(norm (norm + |top|)), v = (first, own).
            let share = 1.0 / (norm * (norm + top.abs()));
            for (k, other) in after.chunks_exact_mut(BLOCK).enumerate() {
                let above = &mut self.r[(j + 1 + k) * width + j];
                let by = share * (first * *above + dot(own, other));
                *above -= by * first;
                for (x, v) in other.iter_mut().zip(own.iter()) {
                    *x -= by * v;
                }
            }
        }
        self.rows = 0;
    }

    /// The number in a row and column of R; the last column is q.
    pub(super) fn at(&self, row: usize, column: usize) -> f64 {
        if row <= column {
            self.r[column * self.width + row]
        } else {
            0.0
        }
    }

    /// Lengths of the columns.
    pub(super) fn lengths(&self) -> Vec<f64> {
        (0..self.unknowns())
            .map(|c| (0..=c).map(|r| self.at(r, c).powi(2)).sum::<f64>().sqrt())
            .collect()
    }

    /// The step that minimizes |R δ − q|² + damping Σ (sizes δ)², and by how much it makes the sum of squares smaller as
    /// long as the rows are linear; None where they are not finite.
    pub(super) fn step(&self, damping: f64, sizes: &[f64]) -> Option<(Vec<f64>, f64)> {
        let n = self.unknowns();
        let mut damped = self.clone();
        damped.fold();
        let own = damped.clone();
        if damping > 0.0 {
            for (i, size) in sizes.iter().enumerate() {
                let row = (0..n).map(|c| if c == i { damping.sqrt() * size } else { 0.0 });
                damped.push(row, 0.0);
            }
            damped.fold();
        }
        let mut step = vec![0.0; n];
        for i in (0..n).rev() {
            let mut left = damped.at(i, n);
            for k in i + 1..n {
                left -= damped.at(i, k) * step[k];
            }
            step[i] = left / damped.at(i, i);
        }
        if !step.iter().all(|x| x.is_finite()) {
            return None;
        }
        let (mut before, mut after) = (0.0, 0.0);
        for i in 0..n {
            let made: f64 = (i..n).map(|k| own.at(i, k) * step[k]).sum();
            before += own.at(i, n).powi(2);
            after += (own.at(i, n) - made).powi(2);
        }
        Some((step, before - after))
    }

    /// |R δ|².
    pub(super) fn square(&self, step: &[f64]) -> f64 {
        (0..step.len())
            .map(|i| {
                (i..step.len())
                    .map(|k| self.at(i, k) * step[k])
                    .sum::<f64>()
                    .powi(2)
            })
            .sum()
    }
}

fn largest(column: &[f64]) -> f64 {
    column.iter().fold(0.0, |most: f64, x| most.max(x.abs()))
}

/// The scalar product in eight sums, which processors take at once.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    for (a, b) in a.iter().zip(b) {
        for i in 0..8 {
            sums[i] += a[i] * b[i];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

/// What is known where a cost was computed.
pub(super) struct Linear {
    /// The triangle of its derivatives.
    pub(super) triangle: Triangle,
    /// Twice −log L.
    pub(super) cost: f64,
}

impl Linear {
    /// By how much the cost could fall, as long as the rows are linear.
    fn gain_left(&self, sizes: &[f64]) -> f64 {
        let step = self.triangle.step(1e-24, sizes);
        step.map_or(f64::INFINITY, |(_, gain)| gain)
    }
}

/// How an iteration ends.
pub(super) struct Stop {
    /// An expected change of the cost that is too small to be of interest.
    pub(super) gain: f64,
    pub(super) passes: usize,
}

/// Go down from `start` by the method of Levenberg and Marquardt (J. J. Moré, Lecture Notes in Mathematics 630, 1978, 105).
///
/// `evaluate` computes a place, or returns None where it is none or its cost exceeds a limit; `step_from` makes a step. The last value says
/// whether the end was reached, or is nearer than a tenth of a sigma: in a valley that bends, steps are short.
pub(super) fn descend<P: Clone>(
    start: P,
    stop: &Stop,
    mut evaluate: impl FnMut(&P, f64) -> Option<Linear>,
    step_from: impl Fn(&P, &[f64]) -> Option<P>,
) -> Option<(P, Linear, bool)> {
    let mut here = start;
    let mut linear = evaluate(&here, f64::INFINITY)?;
    let mut sizes = linear.triangle.lengths();
    let (mut damping, mut faster) = (1e-6, 2.0);
    for _ in 0..stop.passes {
        for (size, now) in sizes.iter_mut().zip(linear.triangle.lengths()) {
            *size = size.max(now);
        }
        let floor = 1e-300 + 1e-10 * sizes.iter().fold(0.0_f64, |most, x| most.max(*x));
        let scales: Vec<f64> = sizes.iter().map(|size| size.max(floor)).collect();
        let Some((step, gain)) = linear.triangle.step(damping, &scales) else {
            damping = (damping * 10.0_f64).max(1e-8);
            continue;
        };
        let next = step_from(&here, &step);
        let found = next.and_then(|next| Some((evaluate(&next, linear.cost)?, next)));
        if let Some((new, next)) = found
            && new.cost <= linear.cost
        {
            let (won, quality) = (linear.cost - new.cost, (linear.cost - new.cost) / gain);
            (here, linear) = (next, new);
            damping *= if quality > 0.75 {
                0.01
            } else if quality > 0.25 {
                0.3
            } else {
                2.0
            };
            faster = 2.0;
            // Damping may hide what is left to be won.
            if linear.gain_left(&scales) < stop.gain && won < 1e3 * stop.gain {
                return Some((here, linear, true));
            }
        } else {
            // Nothing to be won but rounding.
            if gain < stop.gain.min(1e-9 * linear.cost.abs()) {
                return Some((here, linear, true));
            }
            damping = (damping * 4.0 * faster).max(1e-6);
            faster *= 2.0;
            if damping > 1e12 {
                break;
            }
        }
    }
    let is_near = linear.gain_left(&sizes) < NEAR;
    Some((here, linear, is_near))
}
