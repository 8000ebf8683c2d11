//! One matrix and stacks of them: which method a row goes to, and the passage from rows to planes and back.
//!
//! Every row goes through the closed form. The few whose smallest eigenvalue is small beside the largest, and the
//! diagonal ones, are queued and done again by Jacobi's method. Which of the two a row gets depends on the row alone.

use std::ops::Range;

use super::closed_form::closed_form;
use super::deviator::{self, Deviator};
use super::jacobi::{self, Iterate, SWEEPS, UNFINISHED, jacobi};
use super::symmetric::{Eigen3, Spectrum, Symmetric, lower_triangle};
use crate::numerics::dispatch::Kernel;
use crate::numerics::lane::Lane;
use crate::numerics::planes::{Formula, Planes, ROWS};

/// An eigenvalue below this part of the largest, by magnitude, is found by Jacobi's method. The closed form's error, a
/// few units in the last place of the largest, stays below twenty times as much of any other.
const GRADED: f64 = 0.05;

/// The numbers computed for a row: its eigenvalues, and 1 where it has to be done again, else 0.
pub(super) const VALUES_ONLY: usize = 4;
/// The same and the elements of V, row by row.
pub(super) const WITH_VECTORS: usize = 13;

/// Whether the closed form's spectrum is to be found again; also where it is not a number.
#[inline(always)]
fn needs_jacobi<L: Lane>(deviator: &Deviator<L>, spectrum: &Spectrum<L>) -> bool {
    let [first, middle, last] = spectrum.values.map(L::abs);
    let is_level = first.min(middle).min(last) > first.max(last) * L::new(GRADED);
    deviator.is_diagonal() || !is_level
}

/// The decomposition of one matrix.
pub(super) struct One(pub(super) [f64; 9]);

impl Kernel for One {
    // As the caller returns it: a copy would wait until it is written.
    type Output = Eigen3;

    #[inline(always)]
    fn run<L: Lane>(self) -> Eigen3 {
        let a = Symmetric::from_lower_triangle(lower_triangle(&self.0).map(L::new));
        let deviator = Deviator::of(&a);
        let found = closed_form(&deviator);
        let spectrum = if needs_jacobi(&deviator, &found) {
            jacobi(&a)
        } else {
            found
        };
        let Spectrum {
            values, vectors, ..
        } = spectrum.with_sign_rule();
        Eigen3 {
            values: values.map(L::get),
            vectors: vectors.map(|column| column.map(L::get)).into(),
        }
    }
}

/// The decompositions of a stack: the first `N` results of each row, the same bits for any `N`.
pub(super) struct Stack<'a, const N: usize> {
    pub(super) matrices: &'a [[f64; 9]],
    pub(super) values: &'a mut [[f64; 3]],
    /// Empty unless `WITH_VECTORS`.
    pub(super) vectors: &'a mut [[f64; 9]],
}

/// The planes of one batch.
struct Work<const N: usize> {
    matrices: Planes<6>,
    deviators: Planes<{ deviator::NUMBERS }>,
    iterates: Planes<{ jacobi::NUMBERS }>,
    results: Planes<N>,
}

impl<const N: usize> Kernel for Stack<'_, N> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(mut self) {
        let mut work = Work {
            matrices: Planes::ZERO,
            deviators: Planes::ZERO,
            iterates: Planes::ZERO,
            results: Planes::ZERO,
        };
        let mut queue = [0; 2 * ROWS];
        let mut queued = 0;
        let mut start = 0;
        while start < self.matrices.len() {
            let end = self.matrices.len().min(start + ROWS);
            self.closed_form_rows::<L>(start..end, &mut work);
            for row in start..end {
                queue[queued] = row;
                let [again] = work.results.get(row - start, VALUES_ONLY - 1);
                queued += usize::from(again != 0.0);
            }
            if queued >= ROWS {
                queued -= ROWS;
                self.jacobi_rows::<L>(&queue[queued..queued + ROWS], &mut work);
            }
            start = end;
        }
        self.jacobi_rows::<L>(&queue[..queued], &mut work);
    }
}

impl<const N: usize> Stack<'_, N> {
    #[inline(always)]
    fn closed_form_rows<L: Lane>(&mut self, rows: Range<usize>, work: &mut Work<N>) {
        read_rows(&self.matrices[rows.clone()], &mut work.matrices);
        // In two loops: a processor looks only so far ahead, and overlaps the rows of a short loop better.
        work.matrices
            .map::<L, Deviate, { deviator::NUMBERS }>(rows.len(), &mut work.deviators);
        work.deviators
            .map::<L, Solve, N>(rows.len(), &mut work.results);
        write_values(&work.results, &mut self.values[rows.clone()]);
        if N == WITH_VECTORS {
            write_vectors(&work.results, &mut self.vectors[rows]);
        }
    }

    #[inline(always)]
    fn jacobi_rows<L: Lane>(&mut self, rows: &[usize], work: &mut Work<N>) {
        for (i, &row) in rows.iter().enumerate() {
            work.matrices.set(i, lower_triangle(&self.matrices[row]));
        }
        work.matrices
            .map::<L, Start, { jacobi::NUMBERS }>(rows.len(), &mut work.iterates);
        let mut sweep = 0;
        while sweep < SWEEPS && work.iterates.any(UNFINISHED, rows.len()) {
            work.iterates.update::<L, Sweep>(rows.len());
            sweep += 1;
        }
        work.iterates
            .map::<L, Finish, N>(rows.len(), &mut work.results);
        for (i, &row) in rows.iter().enumerate() {
            self.values[row] = work.results.get(i, 0);
            if N == WITH_VECTORS {
                self.vectors[row] = work.results.get(i, VALUES_ONLY);
            }
        }
    }
}

// Turning rows into planes and back moves numbers and computes nothing. These functions stay outside the kernel, since
// inside the compiler would use the scatter instructions of AVX-512, which take twice as long.

#[inline(never)]
fn read_rows(matrices: &[[f64; 9]], planes: &mut Planes<6>) {
    for (i, matrix) in matrices.iter().enumerate().take(ROWS) {
        planes.set(i, lower_triangle(matrix));
    }
}

#[inline(never)]
fn write_values<const N: usize>(results: &Planes<N>, values: &mut [[f64; 3]]) {
    for (i, row) in values.iter_mut().enumerate().take(ROWS) {
        *row = results.get(i, 0);
    }
}

#[inline(never)]
fn write_vectors<const N: usize>(results: &Planes<N>, vectors: &mut [[f64; 9]]) {
    for (i, row) in vectors.iter_mut().enumerate().take(ROWS) {
        *row = results.get(i, VALUES_ONLY);
    }
}

struct Deviate;

impl Formula<6, { deviator::NUMBERS }> for Deviate {
    #[inline(always)]
    fn apply<L: Lane>(lower_triangle: [L; 6]) -> [L; deviator::NUMBERS] {
        Deviator::of(&Symmetric::from_lower_triangle(lower_triangle)).into_numbers()
    }
}

struct Solve;

impl<const N: usize> Formula<{ deviator::NUMBERS }, N> for Solve {
    #[inline(always)]
    fn apply<L: Lane>(numbers: [L; deviator::NUMBERS]) -> [L; N] {
        let deviator = Deviator::from_numbers(numbers);
        let spectrum = closed_form(&deviator);
        results(spectrum, needs_jacobi(&deviator, &spectrum))
    }
}

struct Start;

impl Formula<6, { jacobi::NUMBERS }> for Start {
    #[inline(always)]
    fn apply<L: Lane>(lower_triangle: [L; 6]) -> [L; jacobi::NUMBERS] {
        Iterate::start(&Symmetric::from_lower_triangle(lower_triangle)).into_numbers()
    }
}

struct Sweep;

impl Formula<{ jacobi::NUMBERS }, { jacobi::NUMBERS }> for Sweep {
    #[inline(always)]
    fn apply<L: Lane>(numbers: [L; jacobi::NUMBERS]) -> [L; jacobi::NUMBERS] {
        Iterate::from_numbers(numbers).swept().into_numbers()
    }
}

struct Finish;

impl<const N: usize> Formula<{ jacobi::NUMBERS }, N> for Finish {
    #[inline(always)]
    fn apply<L: Lane>(numbers: [L; jacobi::NUMBERS]) -> [L; N] {
        results(Iterate::from_numbers(numbers).spectrum(), false)
    }
}

/// The results of a row, or the first `N` of them.
#[inline(always)]
fn results<L: Lane, const N: usize>(spectrum: Spectrum<L>, again: bool) -> [L; N] {
    let again = L::new(if again { 1.0 } else { 0.0 });
    let Spectrum {
        values: [w0, w1, w2],
        vectors: [a, b, c],
        ..
    } = spectrum.with_sign_rule();
    let all = [
        w0, w1, w2, again, a[0], b[0], c[0], a[1], b[1], c[1], a[2], b[2], c[2],
    ];
    let mut some = [again; N];
    let mut k = 0;
    while k < N {
        some[k] = all[k];
        k += 1;
    }
    some
}
