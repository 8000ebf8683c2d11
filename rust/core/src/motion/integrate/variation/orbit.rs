//! The gravity gradient on a Kepler orbit, whose state as seen from the body goes along with the motion.

use nalgebra::Vector3;

use super::inertia::Inertia;
use super::numbers::{
    Block, Number, ORDER, Quadruple, Row, Rows, Vector, ZERO, at, begin, cross_product, dot,
    extend, increment, plus, product, seen, times,
};
use super::pace::Pace;
use crate::motion::loads::{GravityGradient, Subject};
use crate::numerics::power_of_two::power_below;

/// Position r and velocity v of C from the attractor, components in principal axes:
///
/// ```text
/// ṙ = r×ω + v,   v̇ = v×ω − μ r/r³,   N = 3μ/r⁵ r×I r
/// ```
///
/// Lengths are over one that is near r at the start. Powers `p = u^a` of `u = r·r` follow from `u ṗ = a u̇ p`.
#[derive(Clone, Debug)]
pub(super) struct Orbiting<'a> {
    gradient: &'a GravityGradient,
    /// The units of length and of rates.
    length: f64,
    rate: f64,
    /// μ, and three times how often the torque acts.
    mu: Number,
    strength: f64,
    position: Rows<3>,
    velocity: Rows<3>,
    squares: Row,
    /// r⁻³, r⁻⁵.
    cubes: Row,
    fifths: Row,
    /// −r×I r.
    levers: Rows<3>,
    pace: Pace,
}

impl<'a> Orbiting<'a> {
    /// At the start of the motion, components in N; `first` is the column of μ, `rate` the unit of rates.
    pub(super) fn new(
        gradient: &'a GravityGradient,
        subject: &Subject,
        block: Block,
        first: usize,
        rate: f64,
    ) -> Self {
        let epoch = gradient.epoch().unwrap_or(subject.start);
        let (r, v) = gradient.orbit_at(subject, epoch);
        let length = power_below(r.norm());
        let mu = block.variable(gradient.mu(), first);
        let mut orbiting = Self {
            gradient,
            length,
            rate,
            mu: [length, length, length, rate, rate]
                .iter()
                .fold(mu, |mu, unit| mu * (1.0 / unit)),
            strength: gradient.coefficient() / gradient.mu(),
            position: Rows::default(),
            velocity: Rows::default(),
            squares: Row::new(),
            cubes: Row::new(),
            fifths: Row::new(),
            levers: Rows::default(),
            pace: Pace::default(),
        };
        let position = times(&block.vector(&r, first + 1), 1.0 / length);
        begin(&mut orbiting.position, &position);
        let velocity = times(&block.vector(&v, first + 4), 1.0 / length / rate);
        begin(&mut orbiting.velocity, &velocity);
        orbiting.roll((subject.start - epoch) * rate);
        orbiting
    }

    /// From the epoch to the start, in N: whole revolutions at once, of which only their number times the change of the period
    /// remains, the rest step by step.
    fn roll(&mut self, time: f64) {
        let mut left = time;
        if let Some(period) = self.period() {
            let revolutions = (time / period.value).round();
            left -= revolutions * period.value;
            let r = at(&self.position, 0);
            let cube = dot(&r, &r).value.powf(-1.5);
            for (i, x) in r.iter().enumerate() {
                let rates = [self.velocity[i][0].value, -self.mu.value * cube * x.value];
                for (row, rate) in [&mut self.position, &mut self.velocity]
                    .into_iter()
                    .zip(rates)
                {
                    for (slope, longer) in row[i][0].slopes.iter_mut().zip(period.slopes) {
                        *slope -= revolutions * longer * rate;
                    }
                }
            }
        }
        let still: Rows<3> = std::array::from_fn(|_| vec![ZERO; ORDER]);
        while left != 0.0 {
            self.start();
            for k in 0..ORDER {
                self.advance(k, &still);
            }
            let h = self.longest();
            // Not a number ends it too: the first step of the motion says so.
            let h = if h < left.abs() {
                h.copysign(left)
            } else {
                left
            };
            self.step(h);
            left -= h;
        }
    }

    /// `2π μ/β^{3/2}`, `β = 2μ/r − v²`, of an ellipse.
    fn period(&self) -> Option<Number> {
        let (r, v) = (at(&self.position, 0), at(&self.velocity, 0));
        let to_the = |a: f64, base: Number| {
            let mut powers = Row::new();
            power(a, &[base], &mut powers);
            powers[0]
        };
        let beta = self.mu * to_the(-0.5, dot(&r, &r)) * 2.0 - dot(&v, &v);
        (beta.value > 0.0).then(|| self.mu * to_the(-1.5, beta) * std::f64::consts::TAU)
    }

    /// From components in N to those as seen in the attitude q.
    pub(super) fn board(&mut self, q: &Quadruple) {
        for rows in [&mut self.position, &mut self.velocity] {
            let vector = seen(q, &at(rows, 0));
            begin(rows, &vector);
        }
    }

    /// Takes another unit of rates.
    pub(super) fn rescale(&mut self, rate: f64) {
        let ratio = self.rate / rate;
        let velocity = times(&at(&self.velocity, 0), ratio);
        begin(&mut self.velocity, &velocity);
        self.mu = self.mu * ratio * ratio;
        self.rate = rate;
        self.pace = Pace::default();
    }

    /// Takes the values, though not their derivatives, of the closed form at the time `t` in the attitude q.
    pub(super) fn settle(&mut self, subject: &Subject, t: f64, q: &Quadruple) {
        let (r, v) = self.gradient.orbit_at(subject, t);
        let upright = q.map(|x| Number::constant(x.value));
        let seen = |x: Vector3<f64>| seen(&upright, &[x.x, x.y, x.z].map(Number::constant));
        let exact = [seen(r / self.length), seen(v / self.length / self.rate)];
        for (rows, exact) in [&mut self.position, &mut self.velocity]
            .into_iter()
            .zip(exact)
        {
            for (row, exact) in rows.iter_mut().zip(exact) {
                row[0].value = exact.value;
            }
        }
    }

    /// Begins the series anew.
    pub(super) fn start(&mut self) {
        for rows in [&mut self.position, &mut self.velocity] {
            let vector = at(rows, 0);
            begin(rows, &vector);
        }
        for row in [&mut self.squares, &mut self.cubes, &mut self.fifths] {
            row.clear();
        }
        self.levers.iter_mut().for_each(Row::clear);
    }

    /// The coefficients of order k + 1 of position and velocity, from those of ω up to k.
    pub(super) fn advance(&mut self, k: usize, omega: &Rows<3>) {
        let (r, v) = (&self.position, &self.velocity);
        let square = (r.iter()).fold(ZERO, |sum, x| sum + product(x, x, k));
        self.squares.push(square);
        power(-1.5, &self.squares, &mut self.cubes);
        power(-2.5, &self.squares, &mut self.fifths);
        let moves = plus(&cross_product(r, omega, k), &at(v, k));
        let turns = cross_product(v, omega, k);
        let pulled = [0, 1, 2].map(|i| product(&self.cubes, &r[i], k) * self.mu);
        let falls = [0, 1, 2].map(|i| turns[i] - pulled[i]);
        extend(&mut self.position, &moves);
        extend(&mut self.velocity, &falls);
    }

    /// The coefficient of order `k` of the torque over the unit of moments and the square of that of rates.
    ///
    /// After [`Self::advance`].
    pub(super) fn torque(&mut self, k: usize, inertia: &Inertia) -> Vector {
        let lever = inertia.gyration(&self.position, k);
        for (row, x) in self.levers.iter_mut().zip(lever) {
            row.push(x);
        }
        let factor = self.mu * -self.strength;
        [0, 1, 2].map(|i| product(&self.fifths, &self.levers[i], k) * factor)
    }

    /// The longest step.
    pub(super) fn longest(&mut self) -> f64 {
        let Self {
            position,
            velocity,
            pace,
            ..
        } = self;
        pace.longest(&[position, velocity])
    }

    /// By the time `h`.
    pub(super) fn step(&mut self, h: f64) {
        for row in self.position.iter_mut().chain(&mut self.velocity) {
            row[0] = row[0] + increment(row, h);
        }
    }
}

/// The next coefficient of the power `a` of a series.
fn power(a: f64, base: &[Number], powers: &mut Row) {
    let k = powers.len();
    let next = if k == 0 {
        let value = base[0].value.powf(a);
        let slope = a * value / base[0].value;
        Number {
            value,
            slopes: base[0].slopes.map(|x| x * slope),
        }
    } else {
        let weighted = (1..=k).fold(ZERO, |sum, j| {
            sum + base[j] * powers[k - j] * (a * j as f64 - (k - j) as f64)
        });
        weighted * (1.0 / k as f64) / base[0]
    };
    powers.push(next);
}
