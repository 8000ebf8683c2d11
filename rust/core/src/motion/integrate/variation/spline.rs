//! A sampled torque as a cubic in time, with its derivatives by the samples.

use nalgebra::Vector3;

use super::inertia::Inertia;
use super::motion::{Motion, Units};
use super::numbers::{
    Block, Quadruple, Rows, Vector, WIDTH, ZERO, begin, cross_product, extend, seen, turned,
};
use crate::error::Error;
use crate::motion::loads::{Frame, Sampled};
use crate::numerics::jet::Jet;

/// One sampled term in a span between two samples.
#[derive(Clone, Debug)]
pub(super) struct Spline {
    torque: Sampled,
    /// For each variable of the block the spline through its sample alone.
    samples: Vec<Option<Sampled>>,
    units: Units,
    middle: f64,
    /// The coefficients around the start of the step, components in principal axes or, with the axes of N as seen from the body,
    /// in N.
    cubic: [Vector; 4],
    axes: Option<[Rows<3>; 3]>,
}

impl Spline {
    /// In the piece around `middle`; the samples are the columns from `first` on, three each.
    ///
    /// # Errors
    /// When a spline through one sample alone is beyond float64.
    pub(super) fn new(
        torque: &Sampled,
        middle: f64,
        block: Block,
        first: usize,
        units: Units,
    ) -> Result<Self, Error> {
        let knots = torque.knots();
        let samples = (block.first..block.first + WIDTH).map(|column| {
            let number = column.checked_sub(first).filter(|n| *n < 3 * knots.len());
            let alone = |number: usize| {
                let mut values = vec![Vector3::zeros(); knots.len()];
                values[number / 3][number % 3] = 1.0;
                Sampled::new(knots, &values, torque.frame())
            };
            number.map(alone).transpose()
        });
        let axes = match torque.frame() {
            Frame::Body => None,
            Frame::Space => Some(Default::default()),
        };
        Ok(Self {
            torque: torque.clone(),
            samples: samples.collect::<Result<_, Error>>()?,
            units,
            middle,
            cubic: [[ZERO; 3]; 4],
            axes,
        })
    }

    /// Begins the series of a step at the time `t` in the attitude q.
    pub(super) fn start(&mut self, t: f64, inertia: &Inertia, q: &Quadruple) {
        let values = centered(&self.torque, self.middle, t);
        let samples = (self.samples.iter()).map(|sample| {
            sample
                .as_ref()
                .map(|sample| centered(sample, self.middle, t))
        });
        let samples: Vec<_> = samples.collect();
        let mut scale = self.units.over_torque();
        for (k, coefficient) in self.cubic.iter_mut().enumerate() {
            *coefficient = [0, 1, 2].map(|i| {
                let slope = |n: usize| samples[n].map_or(0.0, |cubic| cubic[k][i]);
                Jet {
                    value: values[k][i],
                    slopes: std::array::from_fn(slope),
                } * scale
            });
            if self.axes.is_none() {
                *coefficient = turned(&inertia.axes.transpose(), coefficient);
            }
            scale /= self.units.rate;
        }
        if let Some(axes) = &mut self.axes {
            for (i, axis) in axes.iter_mut().enumerate() {
                let mut unit = [ZERO; 3];
                unit[i].value = 1.0;
                begin(axis, &seen(q, &unit));
            }
        }
    }

    /// The coefficient of order `k` of the torque.
    pub(super) fn coefficient(&mut self, k: usize, motion: &Motion) -> Vector {
        let Some(axes) = &mut self.axes else {
            return self.cubic.get(k).copied().unwrap_or([ZERO; 3]);
        };
        let mut sum = [ZERO; 3];
        for (j, coefficient) in self.cubic.iter().enumerate().take(k + 1) {
            for (axis, component) in axes.iter().zip(coefficient) {
                for (total, row) in sum.iter_mut().zip(axis) {
                    *total = *total + row[k - j] * *component;
                }
            }
        }
        for axis in axes {
            let turns = cross_product(axis, &motion.omega, k);
            extend(axis, &turns);
        }
        sum
    }
}

/// The coefficients of a spline's piece around `middle` in powers of the time since `t`.
fn centered(spline: &Sampled, middle: f64, t: f64) -> [Vector3<f64>; 4] {
    let (from, [c0, c1, c2, c3]) = spline.piece(middle);
    let x = t - from;
    [
        c0 + (c1 + (c2 + c3 * x) * x) * x,
        c1 + (c2 * 2.0 + c3 * (3.0 * x)) * x,
        c2 + c3 * (3.0 * x),
        *c3,
    ]
}
