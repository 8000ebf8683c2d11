//! The series of an orbit about its attractor, in the frame that the orbit has at the start of a step.

use super::batch::Batch;
use super::series::MAX_COUNT;
use crate::numerics::number::Number;

/// A Kepler orbit in its plane, lengths over the distance at the start of the step, time in the unit of rates.
///
/// With `z = r e^{iθ}` the quotient `ż/z = λ + iη` and the pull `ε = μ/r³` obey
///
/// ```text
/// λ̇ = η² − λ² − ε,   η̇ = −2 λ η,   ε̇ = −3 λ ε
/// ```
///
/// and the half turn times a power of the distance, `c = r^{−3/4} e^{iθ/2} = a + ib`, obeys `ċ = (−¾ λ + ½ i η) c`. Nothing here
/// depends on the body.
#[derive(Clone, Debug)]
#[repr(align(64))] // see Batch
pub(super) struct OrbitSeries<T> {
    radial: [T; MAX_COUNT],
    around: [T; MAX_COUNT],
    pull: [T; MAX_COUNT],
    /// a and b.
    half: [[T; 2]; MAX_COUNT],
}

impl<L: Number, const R: usize> OrbitSeries<Batch<L, R>> {
    /// The series at rest, without the first half turn.
    pub(super) const ZERO: Self = Self {
        radial: [Batch::ZERO; MAX_COUNT],
        around: [Batch::ZERO; MAX_COUNT],
        pull: [Batch::ZERO; MAX_COUNT],
        half: [[Batch::ZERO; 2]; MAX_COUNT],
    };

    pub(super) fn new() -> Self {
        let mut series = Self::ZERO;
        series.half[0][0] = Batch::new(1.0);
        series
    }

    /// Set the rates λ, η and ε of one row at the start of a step.
    pub(super) fn set(&mut self, row: usize, [radial, around, pull]: [L::Real; 3]) {
        self.radial[0].put(row, radial);
        self.around[0].put(row, around);
        self.pull[0].put(row, pull);
    }

    /// Set the rates of all rows.
    #[inline(always)]
    pub(super) fn set_all(&mut self, [radial, around, pull]: [Batch<L, R>; 3]) {
        (self.radial[0], self.around[0], self.pull[0]) = (radial, around, pull);
    }

    /// Return the rates of one row.
    pub(super) fn rates(&self, row: usize) -> [L::Real; 3] {
        [&self.radial, &self.around, &self.pull].map(|series| series[0].real(row))
    }

    /// Return the coefficients of c from order 0 on.
    #[inline(always)]
    pub(super) fn half_turn(&self) -> &[[Batch<L, R>; 2]; MAX_COUNT] {
        &self.half
    }

    /// Set the coefficients of c from order 1 on: pairs in a slice for each row, from an index to its end, computed in a unit of rates
    /// that is `ratio` of that of the row. All rows of an order are set together, because a register is stored at once.
    #[inline(always)]
    pub(super) fn put_half_turns(&mut self, known: &[&[f64]; R], from: usize, ratio: Batch<L, R>) {
        let mut power = ratio;
        let (mut at, end) = (from, known[0].len());
        for half in &mut self.half[1..] {
            if at + 1 >= end {
                break;
            }
            let [mut a, mut b] = [Batch::new(0.0); 2];
            for row in 0..R {
                a.set(row, known[row][at]);
                b.set(row, known[row][at + 1]);
            }
            *half = [a * power, b * power];
            (power, at) = (power * ratio, at + 2);
        }
    }

    /// Compute the coefficients up to an order.
    #[inline(always)]
    pub(super) fn expand(&mut self, order: usize) {
        for k in 0..order {
            let [mut outward, mut sideways, mut swept, mut falling] = [Batch::new(0.0); 4];
            let [mut ar, mut br, mut at, mut bt] = [Batch::new(0.0); 4];
            let rates = self.radial[..=k].iter().zip(&self.around[..=k]);
            let turns = (self.around[..=k].iter().rev()).zip(self.half[..=k].iter().rev());
            let others = (self.radial[..=k].iter().rev()).zip(self.pull[..=k].iter().rev());
            for (((radial, around), (other, pull)), (turn, [a, b])) in rates.zip(others).zip(turns)
            {
                outward = radial.mul_add(*other, outward);
                sideways = around.mul_add(*turn, sideways);
                swept = radial.mul_add(*turn, swept);
                falling = radial.mul_add(*pull, falling);
                ar = radial.mul_add(*a, ar);
                br = radial.mul_add(*b, br);
                at = around.mul_add(*a, at);
                bt = around.mul_add(*b, bt);
            }
            let over = Batch::over(k + 1);
            let (half, three_quarters) = (Batch::new(0.5) * over, Batch::new(-0.75) * over);
            self.radial[k + 1] = (sideways - outward - self.pull[k]) * over;
            self.around[k + 1] = swept * over * Batch::new(-2.0);
            self.pull[k + 1] = falling * over * Batch::new(-3.0);
            self.half[k + 1] = [
                three_quarters * ar - half * bt,
                half.mul_add(at, three_quarters * br),
            ];
        }
    }

    /// Compute the rates λ, η, ε and c at a time after the start of the step.
    #[inline(always)]
    pub(super) fn after(&self, order: usize, h: Batch<L, R>) -> [Batch<L, R>; 5] {
        let mut sums = [Batch::new(0.0); 5];
        for k in (0..=order).rev() {
            let [a, b] = self.half[k];
            let at = [self.radial[k], self.around[k], self.pull[k], a, b];
            for i in 0..5 {
                sums[i] = sums[i].mul_add(h, at[i]);
            }
        }
        sums
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::motion::loads::kepler::Orbit;
    use crate::numerics::lane::{BASELINE, Double};

    /// Beside the orbit by Kepler's equation, in steps as long as the motions make them.
    #[test]
    fn the_series_goes_where_the_orbit_goes() {
        // From periapsis: the speed of eccentricity e is √(1 + e) there.
        for eccentricity in [0.0, 0.3, 0.95, 1.0, 1.7, 4.3, 10.0_f64] {
            let speed = (1.0 + eccentricity).sqrt();
            let orbit = Orbit::new(1.0, &Vector3::x(), &(Vector3::y() * speed)).expect("an orbit");
            for begin in [0.0, 0.2, -0.7, 3.0] {
                let (r, v) = orbit.at(begin);
                let (distance, h) = (r.norm(), 0.1 * (1.0 + begin * begin).sqrt() / speed);
                let mut orbit_series = OrbitSeries::<Batch<Double<BASELINE>, 1>>::new();
                let around = r.cross(&v).norm() / distance / distance;
                orbit_series.set(
                    0,
                    [r.dot(&v) / distance / distance, around, distance.powi(-3)],
                );
                orbit_series.expand(22);
                let after = orbit_series.after(22, Batch::new(h)).map(|x| x.get(0));
                let (there, then) = orbit.at(begin + h);
                let [radial, around, pull, a, b] = after;
                let longer = (a * a + b * b).powf(-2.0 / 3.0);
                let angle = r.x.mul_add(there.y, -r.y * there.x).atan2(r.dot(&there));
                let far = there.norm();
                let expected = [
                    (radial, there.dot(&then) / far / far),
                    (around, there.cross(&then).norm() / far / far),
                    (pull, far.powi(-3)),
                    (longer, far / distance),
                    (2.0 * b.atan2(a), angle),
                ];
                for (found, exact) in expected {
                    let error = (found - exact).abs();
                    assert!(
                        error < 2e-14 * (1.0 + speed),
                        "{eccentricity} {begin}: {error:e}"
                    );
                }
            }
        }
    }
}
