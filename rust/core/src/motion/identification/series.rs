//! ω along a motion with its derivatives by the start and by the tensor: Taylor series in time.
//!
//! In principal axes, with constant h and N,
//!
//! ```text
//! I₁ ω̇₁ = (I₂ − I₃) ω₂ ω₃ − h₃ ω₂ + h₂ ω₃ + N₁                    and cyclic,
//! I δω̇ = −δω × (Iω + h) − ω × (I δω) − (δI ω̇ + ω × δI ω) .
//! ```
//!
//! Both are quadratic, so all coefficients follow from sums of products, and a step of order 20 is good to rounding. The attitude and the
//! small turns of it, δR = R [δθ]×, follow by
//!
//! ```text
//! q̇ = ½ q∘ω ,        δθ̇ = δω − ω × δθ .
//! ```

use std::ops::ControlFlow;

use nalgebra::{Matrix3, Vector3};

use crate::numerics::dispatch::{Kernel, dispatch};
use crate::numerics::eigen3::eigen3;
use crate::numerics::lane::Lane;

/// Terms of a series beyond the first.
const ORDER: usize = 20;
/// What a step leaves out, relative to the state.
const LEFT_OUT: f64 = 1e-16;
/// What the source of a derivative by the tensor is linear in: ω̇, and the products of the components of ω.
const FEATURES: usize = 9;
/// A motion of more steps than this for each unit of angle (its first rate times the time) has gone astray, and so has one of so large
/// an angle for each row of the log.
const STEPS: f64 = 30.0;
const TURNED: f64 = 10.0;

/// What turns: its tensor, the constant momentum inside, the constant torque; all in B.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spinning {
    pub(super) inertia: Matrix3<f64>,
    pub(super) momentum: Vector3<f64>,
    pub(super) torque: Vector3<f64>,
}

/// ω in B and its derivatives at a time of the record, in principal axes: `columns[i][c]`.
pub(super) struct Sample<'a, const C: usize> {
    pub(super) row: usize,
    pub(super) omega: &'a [f64; 3],
    pub(super) columns: &'a [[f64; C]; 3],
    /// If it is followed: the attitude (x, y, z, w) relative to that at the start, and its derivatives, in principal axes.
    pub(super) turn: Option<&'a Turn<C>>,
}

/// An attitude relative to the first one, in principal axes, and its derivatives as small turns in body axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Turn<const C: usize> {
    pub(super) quaternion: [f64; 4],
    pub(super) columns: [[f64; C]; 3],
}

/// Where a motion is, and its derivatives, in B.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place<const C: usize> {
    pub(super) omega: Vector3<f64>,
    pub(super) columns: [[f64; C]; 3],
}

impl<const C: usize> Place<C> {
    /// A start; the first three columns are derivatives by it.
    pub(super) fn start(omega: Vector3<f64>) -> Self {
        let mut columns = [[0.0; C]; 3];
        for (i, row) in columns.iter_mut().enumerate() {
            if let Some(x) = row.get_mut(i) {
                *x = 1.0;
            }
        }
        Self { omega, columns }
    }

    fn turned(&self, by: &Matrix3<f64>) -> Self {
        let mut columns = [[0.0; C]; 3];
        for (i, row) in columns.iter_mut().enumerate() {
            for (c, x) in row.iter_mut().enumerate() {
                *x = (0..3).map(|k| by[(i, k)] * self.columns[k][c]).sum();
            }
        }
        Self {
            omega: by * self.omega,
            columns,
        }
    }
}

/// Follows motions of one body.
pub(super) struct Follower<const C: usize> {
    /// Principal axes as columns, `v_B = V v_P`.
    pub(super) axes: Matrix3<f64>,
    series: Series<C>,
}

impl<const C: usize> Follower<C> {
    /// The columns after the first three are derivatives by the tensor along `directions`, in B; C may be 0. None where the tensor has no
    /// inverse.
    pub(super) fn of(body: &Spinning, directions: &[Matrix3<f64>]) -> Option<Self> {
        let eigen = eigen3(&body.inertia);
        let (moments, axes) = (eigen.values, eigen.vectors);
        if !(moments[0] > 0.0 && moments[2].is_finite()) {
            return None;
        }
        let to_axes = axes.transpose();
        let mut sources = [[[0.0; C]; FEATURES]; 3];
        for (c, direction) in directions.iter().enumerate() {
            let own = source(&(to_axes * direction * axes), &moments);
            for (i, features) in own.iter().enumerate() {
                for (f, x) in features.iter().enumerate() {
                    sources[i][f][3 + c] = *x;
                }
            }
        }
        Some(Self {
            axes,
            series: Series {
                moments,
                momentum: (to_axes * body.momentum).into(),
                torque: (to_axes * body.torque).into(),
                sources,
                x: [[0.0; 3]; ORDER + 1],
                d: [[[0.0; C]; 3]; ORDER + 1],
                turns: None,
            },
        })
    }

    /// Follow the attitude too, from the start of each run.
    pub(super) fn with_attitude(mut self) -> Self {
        let still = Turn {
            quaternion: [0.0; 4],
            columns: [[0.0; C]; 3],
        };
        self.series.turns = Some(Box::new([still; ORDER + 1]));
        self
    }

    /// Follows the motion from a place at the time `start` to the time `end`, and hands out what is at the ascending times `t`
    /// between them. The place at the end; None where it was not reached, or `sample` broke off.
    pub(super) fn run(
        &mut self,
        from: &Place<C>,
        (start, end): (f64, f64),
        t: &[f64],
        sample: impl FnMut(&Sample<'_, C>) -> ControlFlow<()>,
    ) -> Option<Place<C>> {
        let inside = from.turned(&self.axes.transpose());
        self.series.x[0] = inside.omega.into();
        self.series.d[0] = inside.columns;
        if let Some(turns) = &mut self.series.turns {
            turns[0] = Turn {
                quaternion: [0.0, 0.0, 0.0, 1.0],
                columns: [[0.0; C]; 3],
            };
        }
        let reached = dispatch(Run {
            series: &mut self.series,
            start,
            end,
            t,
            sample,
        });
        let (omega, columns) = reached?;
        let omega = Vector3::from(omega);
        Some(Place { omega, columns }.turned(&self.axes))
    }
}

/// −I⁻¹ (B ω̇ + ω × B ω) as a linear form of ω̇ and the products 12, 13, 23, 11, 22, 33; all in principal axes.
fn source(b: &Matrix3<f64>, moments: &[f64; 3]) -> [[f64; FEATURES]; 3] {
    let mut found = [[0.0; FEATURES]; 3];
    // (ω × B ω)₁ = ω₂ (Bω)₃ − ω₃ (Bω)₂ and cyclic.
    let product = |i: usize, j: usize| match (i.min(j), i.max(j)) {
        (0, 1) => 3,
        (0, 2) => 4,
        (1, 2) => 5,
        (i, _) => 6 + i,
    };
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        for l in 0..3 {
            found[i][l] -= b[(i, l)] / moments[i];
            found[i][product(j, l)] -= b[(k, l)] / moments[i];
            found[i][product(k, l)] += b[(j, l)] / moments[i];
        }
    }
    found
}

struct Series<const C: usize> {
    moments: [f64; 3],
    momentum: [f64; 3],
    torque: [f64; 3],
    sources: [[[f64; C]; FEATURES]; 3],
    /// Coefficients of ω and of its derivatives.
    x: [[f64; 3]; ORDER + 1],
    d: [[[f64; C]; 3]; ORDER + 1],
    /// Coefficients of the attitude and of its derivatives.
    turns: Option<Box<[Turn<C>; ORDER + 1]>>,
}

struct Run<'a, F, const C: usize> {
    series: &'a mut Series<C>,
    start: f64,
    end: f64,
    t: &'a [f64],
    sample: F,
}

impl<const C: usize, F: FnMut(&Sample<'_, C>) -> ControlFlow<()>> Kernel for Run<'_, F, C> {
    type Output = Option<([f64; 3], [[f64; C]; 3])>;
    #[inline(always)]
    fn run<L: Lane>(mut self) -> Self::Output {
        let end = self.end;
        let rate =
            length(&self.series.x[0]) + length(&self.series.momentum) / self.series.moments[0];
        let turned = (rate * (end - self.start)).min(TURNED * (1 + self.t.len()) as f64);
        let mut left = 1000.0 + STEPS * turned;
        let (mut now, mut row) = (self.start, 0);
        loop {
            self.series.expand();
            self.series.expand_attitude();
            let step = self.series.step();
            if !(step > 0.0 && left > 0.0 && now + step > now) {
                return None;
            }
            left -= 1.0;
            while row < self.t.len() && self.t[row] <= now + step {
                let (omega, columns) = self.series.at(self.t[row] - now);
                let turn = self.series.turn_at(self.t[row] - now);
                let one = Sample {
                    row,
                    omega: &omega,
                    columns: &columns,
                    turn: turn.as_ref(),
                };
                if (self.sample)(&one).is_break() {
                    return None;
                }
                row += 1;
            }
            if end <= now + step {
                return Some(self.series.at(end - now));
            }
            if let Some(turn) = self.series.turn_at(step)
                && let Some(turns) = &mut self.series.turns
            {
                turns[0] = turn;
            }
            (self.series.x[0], self.series.d[0]) = self.series.at(step);
            now += step;
        }
    }
}

#[inline(always)]
fn length(v: &[f64; 3]) -> f64 {
    v[0].abs().max(v[1].abs()).max(v[2].abs())
}

impl<const C: usize> Series<C> {
    /// Fills the coefficients from the first ones.
    #[inline(always)]
    fn expand(&mut self) {
        let [i1, i2, i3] = self.moments;
        let by = [(i2 - i3) / i1, (i3 - i1) / i2, (i1 - i2) / i3];
        let h = self.momentum;
        let turns = h != [0.0; 3];
        for k in 0..ORDER {
            let mut p = [0.0; 6];
            for m in 0..=k {
                let (a, b) = (&self.x[m], &self.x[k - m]);
                p[0] += a[0] * b[1];
                p[1] += a[0] * b[2];
                p[2] += a[1] * b[2];
                p[3] += a[0] * b[0];
                p[4] += a[1] * b[1];
                p[5] += a[2] * b[2];
            }
            let x = self.x[k];
            let mut rate = [by[0] * p[2], by[1] * p[1], by[2] * p[0]];
            if turns {
                rate[0] += (h[1] * x[2] - h[2] * x[1]) / i1;
                rate[1] += (h[2] * x[0] - h[0] * x[2]) / i2;
                rate[2] += (h[0] * x[1] - h[1] * x[0]) / i3;
            }
            if k == 0 {
                for i in 0..3 {
                    rate[i] += self.torque[i] / self.moments[i];
                }
            }
            let share = 1.0 / (k + 1) as f64;
            self.x[k + 1] = rate.map(|one| one * share);
            if C == 0 {
                continue;
            }
            let mut q = [[0.0; C]; 3];
            for m in 0..=k {
                let (d, x) = (&self.d[m], &self.x[k - m]);
                for c in 0..C {
                    q[0][c] += d[1][c] * x[2] + d[2][c] * x[1];
                    q[1][c] += d[0][c] * x[2] + d[2][c] * x[0];
                    q[2][c] += d[0][c] * x[1] + d[1][c] * x[0];
                }
            }
            let features = [
                rate[0], rate[1], rate[2], p[0], p[1], p[2], p[3], p[4], p[5],
            ];
            let d = self.d[k];
            for i in 0..3 {
                let (j, l) = ((i + 1) % 3, (i + 2) % 3);
                let mut own = [0.0; C];
                for (f, feature) in features.iter().enumerate() {
                    for c in 0..C {
                        own[c] += self.sources[i][f][c] * feature;
                    }
                }
                let (hj, hl) = (h[j] / self.moments[i], h[l] / self.moments[i]);
                for c in 0..C {
                    own[c] += by[i] * q[i][c] + hj * d[l][c] - hl * d[j][c];
                    self.d[k + 1][i][c] = own[c] * share;
                }
            }
        }
    }

    /// Fill the coefficients of the attitude, if it is followed, from its first ones.
    fn expand_attitude(&mut self) {
        let Some(turns) = &mut self.turns else {
            return;
        };
        for k in 0..ORDER {
            let (mut q, mut small) = ([0.0; 4], self.d[k]);
            for m in 0..=k {
                let ([a, b, c, w], [x, y, z]) = (turns[m].quaternion, self.x[k - m]);
                q[0] += w * x + b * z - c * y;
                q[1] += w * y + c * x - a * z;
                q[2] += w * z + a * y - b * x;
                q[3] -= a * x + b * y + c * z;
                for i in 0..3 {
                    let (j, l) = ((i + 1) % 3, (i + 2) % 3);
                    let (own, other) = (self.x[k - m][j], self.x[k - m][l]);
                    for column in 0..C {
                        small[i][column] -=
                            own * turns[m].columns[l][column] - other * turns[m].columns[j][column];
                    }
                }
            }
            let share = 1.0 / (k + 1) as f64;
            turns[k + 1] = Turn {
                quaternion: q.map(|one| one * (0.5 * share)),
                columns: small.map(|row| row.map(|one| one * share)),
            };
        }
    }

    /// The attitude and its derivatives at this time after the first.
    fn turn_at(&self, s: f64) -> Option<Turn<C>> {
        let turns = self.turns.as_ref()?;
        let mut found = turns[ORDER];
        for one in turns[..ORDER].iter().rev() {
            for (x, own) in found.quaternion.iter_mut().zip(one.quaternion) {
                *x = *x * s + own;
            }
            for (row, own) in found.columns.iter_mut().zip(&one.columns) {
                for (x, own) in row.iter_mut().zip(own) {
                    *x = *x * s + own;
                }
            }
        }
        let size = found.quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
        found.quaternion = found.quaternion.map(|x| x / size);
        Some(found)
    }

    /// The step at which the last terms are those of rounding. Derivatives have the same singularities, but higher poles.
    #[inline(always)]
    fn step(&self) -> f64 {
        let mut step = f64::INFINITY;
        let size = length(&self.x[0]).max(f64::MIN_POSITIVE);
        for k in [ORDER - 1, ORDER] {
            step = step.min(reach(length(&self.x[k]) / size, k));
        }
        if let Some(turns) = &self.turns {
            for k in [ORDER - 1, ORDER] {
                let most = turns[k]
                    .quaternion
                    .iter()
                    .fold(0.0_f64, |most, x| most.max(x.abs()));
                step = step.min(reach(most, k));
            }
        }
        let groups = [0..C.min(3), C.min(3)..C];
        let attitude = self.turns.iter().flat_map(|_| groups.clone());
        for (group, is_attitude) in
            (groups.iter().cloned().map(|one| (one, false))).chain(attitude.map(|one| (one, true)))
        {
            let most = |k: usize| {
                let rows = match &self.turns {
                    Some(turns) if is_attitude => &turns[k].columns,
                    _ => &self.d[k],
                };
                let mut most = 0.0_f64;
                for row in rows {
                    for x in &row[group.clone()] {
                        most = most.max(x.abs());
                    }
                }
                most
            };
            let mut size = most(0);
            if step < f64::INFINITY {
                size = size.max(most(1) * step);
            }
            if size > 0.0 {
                for k in [ORDER - 1, ORDER] {
                    step = step.min(reach(most(k) / size, k));
                }
            }
        }
        // A steady spin has no end to its series.
        step.min(1e300)
    }

    /// ω and its derivatives at this time after the first.
    #[inline(always)]
    fn at(&self, s: f64) -> ([f64; 3], [[f64; C]; 3]) {
        let (mut x, mut d) = (self.x[ORDER], self.d[ORDER]);
        for k in (0..ORDER).rev() {
            for i in 0..3 {
                x[i] = x[i] * s + self.x[k][i];
                for c in 0..C {
                    d[i][c] = d[i][c] * s + self.d[k][i][c];
                }
            }
        }
        (x, d)
    }
}

/// The s with `|x_k| sᵏ = LEFT_OUT`.
#[inline(always)]
fn reach(ratio: f64, k: usize) -> f64 {
    if ratio > 0.0 {
        (LEFT_OUT / ratio).powf(1.0 / k as f64)
    } else if ratio == 0.0 {
        f64::INFINITY
    } else {
        f64::NAN
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ends(body: &Spinning, omega: Vector3<f64>, directions: &[Matrix3<f64>]) -> Option<Place<9>> {
        let mut follower = Follower::<9>::of(body, directions)?;
        follower.run(&Place::start(omega), (0.0, 5.0), &[], |_| {
            ControlFlow::Continue(())
        })
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let body = Spinning {
            inertia: Matrix3::new(0.2, 0.01, -0.02, 0.01, 0.35, 0.03, -0.02, 0.03, 0.45),
            momentum: Vector3::new(0.1, -0.2, 0.05),
            torque: Vector3::new(0.01, 0.02, -0.03),
        };
        let omega = Vector3::new(1.0, 2.0, 0.5);
        let directions: Vec<Matrix3<f64>> = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
            .map(|(i, j)| {
                let mut one = Matrix3::zeros();
                one[(i, j)] = 1.0;
                one[(j, i)] = 1.0;
                one
            })
            .to_vec();
        let here = ends(&body, omega, &directions).expect("a motion");
        let h = 1e-5;
        for c in 0..9 {
            let at = |s: f64| {
                let (mut body, mut omega) = (body, omega);
                if c < 3 {
                    omega[c] += s;
                } else {
                    body.inertia += directions[c - 3] * s;
                }
                ends(&body, omega, &directions).expect("a motion").omega
            };
            let slope = (at(h) - at(-h)) / (2.0 * h);
            for i in 0..3 {
                assert!((slope[i] - here.columns[i][c]).abs() < 1e-6 * slope.norm().max(1.0));
            }
        }
    }

    /// The attitude turns as ω says, and small turns of it are differences of attitudes.
    #[test]
    fn attitudes_and_their_derivatives() {
        use nalgebra::{Quaternion, UnitQuaternion};
        let body = Spinning {
            inertia: Matrix3::from_diagonal(&Vector3::new(0.2, 0.35, 0.45)),
            momentum: Vector3::new(0.1, -0.2, 0.05),
            torque: Vector3::new(0.01, 0.02, -0.03),
        };
        let directions = [
            Matrix3::from_diagonal(&Vector3::new(1.0, 0.0, 0.0)),
            Matrix3::new(0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        ];
        let at = |body: &Spinning, omega: Vector3<f64>, t: f64| {
            let follower = Follower::<5>::of(body, &directions).expect("a tensor");
            let mut follower = follower.with_attitude();
            let axes = follower.axes;
            let (mut end, mut columns) = (UnitQuaternion::identity(), [[0.0; 5]; 3]);
            let run = follower.run(&Place::start(omega), (0.0, t), &[t], |sample| {
                let turn = sample.turn.expect("an attitude");
                let [x, y, z, w] = turn.quaternion;
                end = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
                for c in 0..5 {
                    let own = axes * Vector3::from_fn(|i, _| turn.columns[i][c]);
                    for i in 0..3 {
                        columns[i][c] = own[i];
                    }
                }
                ControlFlow::Continue(())
            });
            let axes = UnitQuaternion::from_matrix(&axes);
            (axes * end * axes.inverse(), columns, run.expect("a motion"))
        };
        let omega = Vector3::new(1.0, 2.0, 0.5);
        let (here, columns, place) = at(&body, omega, 5.0);
        let h = 1e-5;
        let (before, after) = (at(&body, omega, 5.0 - h).0, at(&body, omega, 5.0 + h).0);
        let rate = (before.inverse() * after).scaled_axis() / (2.0 * h);
        assert!((rate - place.omega).norm() < 1e-8);
        for c in 0..5 {
            let moved = |s: f64| {
                let (mut body, mut omega) = (body, omega);
                if c < 3 {
                    omega[c] += s;
                } else {
                    body.inertia += directions[c - 3] * s;
                }
                at(&body, omega, 5.0).0
            };
            let slope = (moved(-h).inverse() * moved(h)).scaled_axis() / (2.0 * h);
            for i in 0..3 {
                assert!((slope[i] - columns[i][c]).abs() < 1e-6 * slope.norm().max(1.0));
            }
        }
        assert!(here.angle() > 0.1);
    }

    /// A spin about an axis has no end to its series of ω, but one to that of its attitude.
    #[test]
    fn the_attitude_of_a_steady_spin() {
        let body = Spinning {
            inertia: Matrix3::from_diagonal(&Vector3::new(0.2, 0.35, 0.45)),
            momentum: Vector3::zeros(),
            torque: Vector3::zeros(),
        };
        let follower = Follower::<0>::of(&body, &[]).expect("a tensor");
        let mut follower = follower.with_attitude();
        let spin = Place::start(Vector3::new(0.0, 0.0, 2.0));
        let mut angles = Vec::new();
        let run = follower.run(&spin, (0.0, 100.0), &[1.0, 100.0], |sample| {
            let [_, _, z, w] = sample.turn.expect("an attitude").quaternion;
            angles.push(2.0 * z.atan2(w));
            ControlFlow::Continue(())
        });
        assert!(run.is_some());
        for (angle, exact) in angles.iter().zip([2.0_f64, 200.0]) {
            assert!((0.5 * (angle - exact)).sin().abs() < 1e-13);
        }
    }

    #[test]
    fn a_motion_that_has_gone_astray_ends() {
        let body = Spinning {
            inertia: Matrix3::from_diagonal(&Vector3::new(0.2, 0.35, 0.45)),
            momentum: Vector3::zeros(),
            torque: Vector3::zeros(),
        };
        let mut follower = Follower::<0>::of(&body, &[]).expect("a tensor");
        let start = Place::start(Vector3::new(1.0, 2.0, 0.5));
        let far = follower.run(
            &start,
            (0.0, 1e300),
            &[1e300],
            |_| ControlFlow::Continue(()),
        );
        assert!(far.is_none());
    }
}
