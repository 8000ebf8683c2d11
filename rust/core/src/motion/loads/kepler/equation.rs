//! Kepler's equation.

use super::Orbit;
use crate::motion::loads::stumpff::{functions, moved};

/// A step of the iteration so small that another one would change nothing: its cube is below rounding.
const NEAR: f64 = 1e-6;
/// A step so small that the functions after it follow from those before it.
const SMALL: f64 = 1e-4;

impl Orbit {
    /// s at the time `t` and its functions.
    pub(super) fn solve(&self, t: f64) -> (f64, [f64; 4]) {
        if t == 0.0 || !t.is_finite() {
            return (t, functions(self.beta, t));
        }
        self.search(t)
    }

    /// A step of Laguerre's iteration from `s`, and whether it is the last.
    fn change(&self, s: f64, t: f64, g: &[f64; 4]) -> (f64, bool) {
        let (excess, slope) = (self.time_at(g) - t, self.distance_at(g));
        let bend = self.sigma * g[0] + (self.scaled_mu - self.beta * self.distance) * g[1];
        let radical = (16.0 * slope * slope - 20.0 * excess * bend).abs().sqrt();
        let change = -5.0 * excess / (slope + radical);
        let size = change.abs();
        // What is left is the cube of that.
        let is_near = size <= NEAR * s.abs() && size * bend.abs() <= NEAR * slope;
        (change, is_near || size <= f64::EPSILON * s.abs())
    }

    /// s and its functions after the last step of the iteration.
    fn end_at(&self, s: f64, g: &[f64; 4], change: f64) -> (f64, [f64; 4]) {
        let next = s + change;
        if change * change * self.beta.abs() < SMALL * SMALL {
            (next, moved(g, self.beta, change))
        } else {
            (next, functions(self.beta, next))
        }
    }

    /// s at the time `t` and its functions, by Laguerre's iteration kept within a bracket.
    fn search(&self, t: f64) -> (f64, [f64; 4]) {
        let (mut low, mut high, mut s);
        if self.beta > 0.0 {
            // E − M is at most the eccentricity, less than one, at both ends.
            let root = self.beta.sqrt();
            s = t * self.beta / self.scaled_mu;
            (low, high) = (s - 2.0 / root, s + 2.0 / root);
        } else if self.beta < 0.0 {
            // From the periapsis: e sinh H − H = M, so that H is at least asinh(M/e), and at most √−β t/q.
            let root = (-self.beta).sqrt();
            let over_one = -self.beta * self.distance / self.scaled_mu;
            let mean = t.abs() / self.scaled_mu * root.powi(3);
            let least = (mean / (1.0 + over_one)).asinh();
            let most = root * t.abs() / self.distance;
            let start = ((mean + least) / (1.0 + over_one)).asinh().min(most);
            let (least, most) = (least / root, most / root * (1.0 + 4.0 * f64::EPSILON));
            s = start / root * t.signum();
            (low, high) = if t > 0.0 {
                (0.9 * least, most)
            } else {
                (-most, -0.9 * least)
            };
        } else {
            s = t / self.distance;
            (low, high) = (0.0_f64.min(s), 0.0_f64.max(s));
            while (self.time_at(&functions(self.beta, s)) - t) * t.signum() < 0.0 {
                s *= 2.0;
                (low, high) = if t > 0.0 { (0.5 * s, s) } else { (s, 0.5 * s) };
            }
        }
        // Laguerre's iteration takes three or four rounds near the root; far out on a hyperbola, where the time grows like an
        // exponential, its steps do not shrink, and halving is faster.
        let mut before = high - low;
        for _ in 0..200 {
            let g = functions(self.beta, s);
            let excess = self.time_at(&g) - t;
            // Not a number where the exponentials overflow: far too far.
            if excess > 0.0 || excess.is_nan() && t > 0.0 {
                high = s;
            } else {
                low = s;
            }
            let (change, is_last) = self.change(s, t, &g);
            let (next, size) = (s + change, change.abs());
            if size <= f64::EPSILON * s.abs() {
                return self.end_at(s, &g, change);
            }
            if size <= 0.5 * before && next > low && next < high {
                if is_last {
                    return self.end_at(s, &g, change);
                }
                before = size;
                s = next;
                continue;
            }
            let middle = 0.5 * (low + high);
            if middle == low || middle == high {
                return (middle, functions(self.beta, middle));
            }
            before = (middle - s).abs();
            s = middle;
        }
        (s, functions(self.beta, s))
    }

    fn time_at(&self, [_, g1, g2, g3]: &[f64; 4]) -> f64 {
        self.distance * g1 + self.sigma * g2 + self.scaled_mu * g3
    }

    pub(super) fn distance_at(&self, [g0, g1, g2, _]: &[f64; 4]) -> f64 {
        self.distance * g0 + self.sigma * g1 + self.scaled_mu * g2
    }
}
