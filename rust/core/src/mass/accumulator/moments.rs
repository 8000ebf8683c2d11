//! Mass, centre of mass and second moment about it in double-double: what a chunk of particles leaves behind.

use nalgebra::{Matrix3, Vector3};

use crate::error::Error;
use crate::mass::error_bound::{ErrorBound, UNIT};
use crate::mass::particles::sums::{Addend, block_sums};
use crate::mass::particles::{Particles, check, sample_center};
use crate::mass::second_moment::SecondMoment;
use crate::numerics::double_double::{DoubleDouble, two_sum};
use crate::numerics::eigen3::eigen3;
use crate::numerics::lane::Lane;

type Vector = [DoubleDouble; 3];

/// Where xx, xy, xz, yy, yz, zz stand in a symmetric matrix.
const PAIRS: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// How often a block is summed again at most.
const AGAIN: usize = 4;

/// m, C, and S = Σ m (r − c)(r − c)ᵀ, each to 2⁻¹⁰⁰ or so of the whole: enough that the smallest principal moment of a
/// rod 1e-8 as thick as long keeps fourteen digits, wherever the rod stands and whichever way it points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Moments {
    pub(super) mass: DoubleDouble,
    pub(super) center: Vector,
    /// S: xx, xy, xz, yy, yz, zz.
    pub(super) central: [DoubleDouble; 6],
}

impl Moments {
    /// Of at most a block of particles.
    pub(super) fn of(particles: Particles<'_>) -> Result<Self, Error> {
        let mut reference = sample_center(particles);
        let mut found = Self::about(particles, reference)?;
        // A few particles far away may have drawn the sample out of the body.
        for _ in 0..AGAIN {
            let center = Vector3::from(found.center.map(DoubleDouble::rounded));
            let spread = found.central[0].high + found.central[3].high + found.central[5].high;
            if found.mass.high * (center - reference).norm_squared() <= spread {
                break;
            }
            reference = center;
            found = Self::about(particles, reference)?;
        }
        Ok(found)
    }

    fn about(particles: Particles<'_>, reference: Vector3<f64>) -> Result<Self, Error> {
        let Particles { masses, positions } = particles;
        let sums = block_sums(masses, positions, Precise { reference });
        if !(sums[BELOW] == 0.0 && sums.iter().all(|sum| sum.is_finite())) {
            check(particles)?;
        }
        let sum = |k: usize| DoubleDouble::sum(sums[2 * k], sums[2 * k + 1]);
        let mass = sum(0);
        if mass.high == 0.0 {
            return Ok(Self::default());
        }
        let first = [sum(1), sum(2), sum(3)];
        let d = first.map(|first| first / mass);
        Ok(Self {
            mass,
            center: std::array::from_fn(|k| d[k] + reference[k].into()),
            central: std::array::from_fn(|k| {
                let (i, j) = PAIRS[k];
                sum(4 + k) - first[i] * d[j]
            }),
        })
    }

    /// Both together, from centre to centre: `S = S₁ + S₂ + μ d dᵀ`, μ = m₁m₂/(m₁+m₂), d = C₂ − C₁. Nothing cancels.
    pub(super) fn merged(&self, other: &Self) -> Self {
        if self.mass.high == 0.0 {
            return *other;
        }
        let mass = self.mass + other.mass;
        let share = other.mass / mass;
        let reduced = self.mass * share;
        let d: Vector = std::array::from_fn(|k| other.center[k] - self.center[k]);
        Self {
            mass,
            center: std::array::from_fn(|k| self.center[k] + d[k] * share),
            central: std::array::from_fn(|k| {
                let (i, j) = PAIRS[k];
                self.central[k] + other.central[k] + reduced * d[i] * d[j]
            }),
        }
    }

    /// Rounded to doubles, in the principal axes so that the smallest moment survives; `additions` is the number that a
    /// particle has passed on its way here.
    pub(super) fn rounded(&self, additions: f64) -> SecondMoment {
        let [xx, xy, xz, yy, yz, zz] = self.central.map(DoubleDouble::rounded);
        let center_of_mass = Vector3::from(self.center.map(DoubleDouble::rounded));
        let axes = eigen3(&Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)).vectors;
        let mass = self.mass.rounded();
        let spread = xx + yy + zz;
        let sums = of_sums(additions);
        SecondMoment {
            mass,
            center_of_mass,
            central: self.turned(&axes),
            axes,
            error_bound: ErrorBound {
                mass: (2.0 * UNIT + sums) * mass,
                center_of_mass: sums * (spread / mass).sqrt() + 2.0 * UNIT * center_of_mass.amax(),
                inertia: (32.0 * UNIT + 2.0 * sums) * spread,
            },
        }
    }

    /// What rounding can have done to each of these principal moments of the rounded body: a few units of itself, and what
    /// the sums in double-double have lost of the whole.
    pub(super) fn moment_bounds(&self, moments: [f64; 3], additions: f64) -> [f64; 3] {
        let spread = self.central[0].high + self.central[3].high + self.central[5].high;
        // A principal value changes by no more than the matrix, whose norm is at most three times its largest element, and
        // a moment is the sum of two.
        moments.map(|moment| 64.0 * UNIT * moment + 6.0 * of_sums(additions) * spread)
    }

    /// `axesᵀ S axes`, rounded last. Axes that are orthogonal but for rounding change each principal value by as small a
    /// part of itself (Ostrowski's theorem).
    fn turned(&self, axes: &Matrix3<f64>) -> Matrix3<f64> {
        let mut s = [[DoubleDouble::default(); 3]; 3];
        for (&(i, j), &element) in PAIRS.iter().zip(&self.central) {
            (s[i][j], s[j][i]) = (element, element);
        }
        let axis = |k: usize| -> Vector { std::array::from_fn(|i| axes[(i, k)].into()) };
        let dot = |a: Vector, b: Vector| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let mut turned = Matrix3::zeros();
        for (i, j) in PAIRS {
            let element = dot(axis(i), s.map(|row| dot(row, axis(j)))).rounded();
            (turned[(i, j)], turned[(j, i)]) = (element, element);
        }
        turned
    }
}

/// Bound on the part of itself that a sum in double-double can lose, when its terms pass so many additions: the rests add up
/// in plain doubles, so their own rounding grows with the square (Ogita, Rump, Oishi 2005).
fn of_sums(additions: f64) -> f64 {
    2.0 * UNIT * UNIT * (additions * additions + 64.0)
}

/// Ten sums in two doubles each, m; m d (3); m d dᵀ (6); and the masses below zero.
const SUMS: usize = 21;
const BELOW: usize = 20;

/// Moments about a point with all rounding errors of differences, products and sums carried along: `d = r − reference`.
#[derive(Clone, Copy)]
struct Precise {
    reference: Vector3<f64>,
}

impl Addend<SUMS> for Precise {
    #[inline(always)]
    fn add<L: Lane>(&self, mass: L, r: [L; 3], sums: [L; SUMS]) -> [L; SUMS] {
        let c = &self.reference;
        let d = [
            two_sum(r[0], L::new(-c.x)),
            two_sum(r[1], L::new(-c.y)),
            two_sum(r[2], L::new(-c.z)),
        ];
        let md = [times(mass, d[0]), times(mass, d[1]), times(mass, d[2])];
        let zero = L::new(0.0);
        let mut sums = sums;
        add_to(&mut sums, 0, (mass, zero));
        add_to(&mut sums, 1, md[0]);
        add_to(&mut sums, 2, md[1]);
        add_to(&mut sums, 3, md[2]);
        add_to(&mut sums, 4, product(md[0], d[0]));
        add_to(&mut sums, 5, product(md[0], d[1]));
        add_to(&mut sums, 6, product(md[0], d[2]));
        add_to(&mut sums, 7, product(md[1], d[1]));
        add_to(&mut sums, 8, product(md[1], d[2]));
        add_to(&mut sums, 9, product(md[2], d[2]));
        sums[BELOW] = sums[BELOW] + mass.min(zero);
        sums
    }

    #[inline(always)]
    fn merge(a: [f64; SUMS], b: [f64; SUMS]) -> [f64; SUMS] {
        let mut merged = [a[BELOW] + b[BELOW]; SUMS];
        for k in (0..BELOW).step_by(2) {
            let sum = DoubleDouble::sum(a[k], a[k + 1]) + DoubleDouble::sum(b[k], b[k + 1]);
            (merged[k], merged[k + 1]) = (sum.high, sum.low);
        }
        merged
    }
}

/// A double times a double and a rest.
#[inline(always)]
fn times<L: Lane>(a: L, (b, b_rest): (L, L)) -> (L, L) {
    let (p, e) = a.two_product(b);
    (p, a.mul_add(b_rest, e))
}

/// The product of two doubles with rests, but for that of the rests.
#[inline(always)]
fn product<L: Lane>((a, a_rest): (L, L), (b, b_rest): (L, L)) -> (L, L) {
    let (p, e) = a.two_product(b);
    (p, a.mul_add(b_rest, a_rest.mul_add(b, e)))
}

/// Adds a double and its rest to sum k.
#[inline(always)]
fn add_to<L: Lane>(sums: &mut [L; SUMS], k: usize, (term, rest): (L, L)) {
    let (sum, error) = two_sum(sums[2 * k], term);
    sums[2 * k] = sum;
    sums[2 * k + 1] = sums[2 * k + 1] + (error + rest);
}
