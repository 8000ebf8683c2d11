//! Steady rotations of a gyrostat with a given total angular momentum: all of them, whether they are stable, and where
//! their number changes.
//!
//! A body with a constant momentum h inside turns steadily where ω is along L = I ω + h, `ω = μ L`, so that in principal
//! axes `L_i = h_i/(1 − μ I_i)`, and μ is a root of
//!
//! ```text
//! f(μ) = Σ h_i²/(1 − μ I_i)² = L².
//! ```
//!
//! f has poles at `1/I_i`, falls to zero on either side of all of them and is convex between two of them. So there is one
//! root on either side and none or two between two poles, as f's minimum there lies above or below L²: two, four or
//! six equilibria, counted without any polynomial. The minimum itself says where the number changes, by a *fold*. A pole
//! without its `h_i` is none, and `μ = 1/I_i` is then a multiplier of its own, with `L_i` of either sign and all that the other
//! components leave of L²; where they leave nothing, both meet a root of f: a *pitchfork*.
//!
//! On the sphere of L in the body an equilibrium is a stationary point of the energy `½ (L − h)·I⁻¹(L − h)`, whose second
//! variation is that of `I⁻¹ − μ` across L. Its determinant D gives the motion close by: L circles with the
//! frequency `|L| √D`, or departs as `exp(|L| √−D t)`.
//!
//! Everything is computed to twice the precision, each root as its distance from a pole in units of what is left of h there.
//! Derived here; phase portraits and bifurcations in papers by Elipe and Lanchares, stability in Hughes, Spacecraft Attitude
//! Dynamics.

use nalgebra::{Matrix3, Vector3};

use crate::numerics::double_double::DoubleDouble;
use crate::numerics::number::Real;
use crate::numerics::power_of_two::{exponent, times_power_of_two};

/// What the energy is at an equilibrium, among all states with this angular momentum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The least close by: stable, also with internal dissipation.
    Minimum,
    /// The most close by: stable without dissipation.
    Maximum,
    /// Neither: unstable.
    Saddle,
    /// The second variation does not decide: equilibria meet here.
    Degenerate,
}

impl Kind {
    /// Its word.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Minimum => "minimum",
            Self::Maximum => "maximum",
            Self::Saddle => "saddle",
            Self::Degenerate => "degenerate",
        }
    }
}

/// How many equilibria there are at one multiplier.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Extent {
    /// One.
    Point,
    /// A circle of them about this axis (principal axes), of a body with two equal moments.
    Circle([f64; 3]),
    /// Every state: a body with three equal moments and nothing inside.
    Sphere,
}

/// A steady rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equilibrium {
    /// L/|L| in principal axes; one of them where there are more.
    pub direction: [f64; 3],
    /// ω in principal axes.
    pub omega: [f64; 3],
    /// ½ ω·I ω.
    pub kinetic_energy: f64,
    /// `D L²`: the squared frequency with which L circles about a stable equilibrium in the body; negative: minus the
    /// squared rate at which departures grow.
    pub squared_rate: f64,
    /// What the energy is here.
    pub kind: Kind,
    /// How many there are.
    pub extent: Extent,
}

/// How the number of equilibria changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meeting {
    /// A saddle and a stable one meet and are gone.
    Fold,
    /// Two of one kind, mirror images, meet in a third; or a circle of them shrinks to it.
    Pitchfork,
}

/// Where the number of equilibria changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bifurcation {
    /// How.
    pub meeting: Meeting,
    /// L/|L| there, in principal axes.
    pub direction: [f64; 3],
    /// The |L| of the bifurcation for this h. The two equilibria that meet, at a pitchfork the pair, exist only for larger |L|.
    pub momentum: f64,
    /// The |h| of the bifurcation for this |L| and this direction of h. The same two equilibria exist only for smaller |h|.
    pub rotor: f64,
}

/// All equilibria with one |L|, and where their number changes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Equilibria {
    /// In ascending order of the multiplier, so of `ω·L`.
    pub found: Vec<Equilibrium>,
    /// In descending order of |h|.
    pub bifurcations: Vec<Bifurcation>,
}

impl Equilibria {
    /// With all directions in the frame in which these axes (columns) are given.
    #[must_use]
    pub(super) fn rotate(mut self, axes: &Matrix3<f64>) -> Self {
        let turn = |v: &mut [f64; 3]| *v = (axes * Vector3::from(*v)).into();
        for one in &mut self.found {
            turn(&mut one.direction);
            turn(&mut one.omega);
            if let Extent::Circle(axis) = &mut one.extent {
                turn(axis);
            }
        }
        for one in &mut self.bifurcations {
            turn(&mut one.direction);
        }
        self
    }
}

/// Equilibria of a gyrostat: positive principal moments, ascending; the momentum inside in principal axes; |L| > 0.
///
/// Components of h below 1e-290 |L| are taken for zero. Empty where |L| or a moment is not positive and finite.
#[must_use]
pub fn equilibria(moments: &Vector, rotor: &Vector, momentum: DoubleDouble) -> Equilibria {
    let positive = |x: &DoubleDouble| x.high > 0.0 && x.high.is_finite();
    if !moments.iter().all(positive)
        || !positive(&momentum)
        || rotor.iter().any(|x| !x.high.is_finite())
    {
        return Equilibria::default();
    }
    let scales = Scales {
        inertia: exponent(moments[2].high),
        momentum: exponent(momentum.high),
    };
    let scaled = moments.map(|x| x.times_power_of_two(-scales.inertia));
    let length = momentum.times_power_of_two(-scales.momentum);
    let share = rotor.map(|x| {
        let share = x.times_power_of_two(-scales.momentum) / length;
        if share.high.abs() < 1e-290 {
            DoubleDouble::default()
        } else {
            share
        }
    });
    let frame = ReducedAxes::of(&scaled, &share);
    let secular = Secular::of(&frame);
    let mut made = Maker {
        frame: &frame,
        length,
        scales,
        found: Vec::new(),
        bifurcations: Vec::new(),
    };
    for place in secular.roots() {
        made.root(&place);
    }
    for minimum in secular.minima() {
        made.fold(&minimum);
    }
    for group in frame.without_rotor() {
        made.pole(&group);
    }
    made.finish()
}

/// Powers of two that were taken out.
#[derive(Clone, Copy)]
struct Scales {
    inertia: i32,
    momentum: i32,
}

/// Makes results of multipliers.
struct Maker<'a> {
    frame: &'a ReducedAxes,
    length: DoubleDouble,
    scales: Scales,
    found: Vec<(DoubleDouble, Equilibrium)>,
    bifurcations: Vec<Bifurcation>,
}

impl Maker<'_> {
    /// The equilibrium at a root of f.
    fn root(&mut self, place: &Multiplier) {
        let n = place.shares(self.frame);
        self.add(place, &n, Extent::Point);
    }

    /// The fold that a minimum of f stands for.
    fn fold(&mut self, minimum: &Multiplier) {
        let n = minimum.shares(self.frame);
        self.meet(Meeting::Fold, &n, norm(&n));
    }

    /// What is at the pole of moments without a part of h: two points, a circle, or every state.
    fn pole(&mut self, group: &Group) {
        let place = Multiplier::at_pole(group.first);
        let mut n = place.shares(self.frame);
        let others = norm(&n);
        if others.high > 0.0 && group.count < 3 {
            self.meet(Meeting::Pitchfork, &n, others);
        }
        if others.high > 2.0 {
            return; // its square may overflow
        }
        let left = DoubleDouble::from(1.0) - others * others;
        if left.high <= NOTHING {
            return;
        }
        let extent = match group.count {
            1 => Extent::Point,
            2 => Extent::Circle([0, 1, 2].map(|i| f64::from(u8::from(!group.contains(i))))),
            _ => Extent::Sphere,
        };
        n[group.first] = left.sqrt();
        self.add(&place, &n, extent);
        if extent == Extent::Point {
            n[group.first] = -n[group.first];
            self.add(&place, &n, extent);
        }
    }

    fn meet(&mut self, meeting: Meeting, n: &Vector, at: DoubleDouble) {
        let direction = self
            .frame
            .outward(&n.map(|x| x / at))
            .map(DoubleDouble::rounded);
        let rotor = norm(&self.frame.rotor) / at;
        self.bifurcations.push(Bifurcation {
            meeting,
            direction,
            momentum: times_power_of_two((self.length * at).high, self.scales.momentum),
            rotor: times_power_of_two((self.length * rotor).high, self.scales.momentum),
        });
    }

    fn add(&mut self, place: &Multiplier, n: &Vector, extent: Extent) {
        let I = &self.frame.moments;
        let length = norm(n);
        let n = n.map(|x| x / length);
        // I⁻¹ − μ along the axes, and what its differences were made of.
        let (along, terms) = place.across(self.frame);
        // In units of the largest, whose products do not overflow.
        let unit = exponent(terms.iter().copied().fold(0.0, f64::max));
        let along = along.map(|x| x.times_power_of_two(-unit));
        let terms = terms.map(|x| times_power_of_two(x, -unit));
        let others = |i: usize| ((i + 1) % 3, (i + 2) % 3);
        let mut determinant = DoubleDouble::default();
        let mut scale = 0.0;
        let mut trace = 0.0;
        for i in 0..3 {
            let (j, k) = others(i);
            determinant += n[i] * n[i] * along[j] * along[k];
            scale += n[i].high.powi(2) * terms[j] * terms[k];
            trace += (n[j].high.powi(2) + n[k].high.powi(2)) * along[i].high;
        }
        let kind = match extent {
            Extent::Sphere => Kind::Degenerate,
            Extent::Point if determinant.high.abs() <= NOTHING * scale => Kind::Degenerate,
            Extent::Point if determinant.high < 0.0 => Kind::Saddle,
            _ if trace > 0.0 => Kind::Minimum,
            _ if trace < 0.0 => Kind::Maximum,
            _ => Kind::Degenerate,
        };
        let squared = match (kind, extent) {
            (Kind::Degenerate, _) | (_, Extent::Circle(_)) => 0.0,
            _ => (determinant * self.length * self.length).high,
        };
        let multiplier = place.multiplier(self.frame);
        let unit_of_rate = exponent(multiplier.high);
        let rate = multiplier.times_power_of_two(-unit_of_rate) * self.length;
        let mean = I
            .iter()
            .zip(&n)
            .fold(DoubleDouble::default(), |sum, (&I, &n)| sum + I * n * n);
        let energy = (rate * rate * mean).scaled(0.5);
        let direction = self.frame.outward(&n);
        let per_time = self.scales.momentum - self.scales.inertia;
        let equilibrium = Equilibrium {
            direction: direction.map(DoubleDouble::rounded),
            omega: direction.map(|x| times_power_of_two((rate * x).high, per_time + unit_of_rate)),
            kinetic_energy: times_power_of_two(
                energy.high,
                per_time + self.scales.momentum + 2 * unit_of_rate,
            ),
            squared_rate: times_power_of_two(squared, 2 * (per_time + unit)),
            kind,
            extent,
        };
        self.found.push((multiplier, equilibrium));
    }

    fn finish(mut self) -> Equilibria {
        let order = |x: DoubleDouble, y: DoubleDouble| (x - y).high.total_cmp(&0.0);
        self.found.sort_by(|(x, _), (y, _)| order(*x, *y));
        self.bifurcations
            .sort_by(|x, y| y.rotor.total_cmp(&x.rotor));
        Equilibria {
            found: self.found.into_iter().map(|(_, found)| found).collect(),
            bifurcations: self.bifurcations,
        }
    }
}

/// What is below this, relative to its own terms, is zero: inputs are doubles, and the arithmetic has 31 digits.
const NOTHING: f64 = 1e-28;

/// Steps of Newton's method at most; from a double it takes two or three.
const STEPS: usize = 60;

/// A multiplier, as its distance `1 − μ I_k = unit·s` from the pole of an axis: no digit of it is lost close by.
#[derive(Clone, Copy, Debug)]
struct Multiplier {
    /// k.
    axis: usize,
    /// A power of two at a small `h_k`, so that s is of order one at the pole's roots.
    unit: i32,
    /// The distance.
    s: DoubleDouble,
}

/// One axis as seen from a pole: `1 − μ I_j = gap + ratio·unit·s`, and the part of h.
#[derive(Clone, Copy)]
struct Term<T> {
    gap: T,
    ratio: T,
    part: T,
    /// The pole's own axis: no gap, and its part is in units of `unit`.
    is_own: bool,
}

/// f as seen from one pole.
#[derive(Clone, Copy)]
struct SecularAtPole<T> {
    unit: i32,
    terms: [Term<T>; 3],
}

impl<T: Real> SecularAtPole<T> {
    /// `f/L² − 1` and, per s, half its slope.
    fn value_and_slope(&self, s: T) -> (T, T) {
        let (mut value, mut slope) = (-T::from(1.0), T::default());
        for term in &self.terms {
            let (n, rate) = term.share(s, self.unit);
            value += n * n;
            slope -= n * n * rate;
        }
        (value, slope)
    }

    /// `½ df/ds` and its slope, for the minimum; in units in which nothing overflows.
    fn slope_and_curvature(&self, s: T) -> (T, T) {
        let largest = self
            .terms
            .iter()
            .fold(1.0, |most: f64, term| most.max(term.part.rounded().abs()));
        let unit = power::<T>(-(exponent(largest) & !127));
        let (mut slope, mut curvature) = (T::default(), T::default());
        for term in &self.terms {
            let (n, rate) = term.share(s, self.unit);
            let n = n * unit;
            slope -= n * n * rate;
            curvature += T::from(3.0) * n * n * rate * rate;
        }
        (slope, curvature)
    }
}

impl<T: Real> Term<T> {
    /// `n_j = part/(1 − μ I_j)`, and the relative rate of the denominator per s.
    fn share(&self, s: T, unit: i32) -> (T, T) {
        if self.part.rounded() == 0.0 {
            return (T::default(), T::default());
        }
        if self.is_own {
            return (self.part / s, T::from(1.0) / s);
        }
        let rate = self.ratio * power(unit);
        let distance = self.gap + rate * s;
        (self.part / distance, rate / distance)
    }
}

/// 2^e as a number.
fn power<T: Real>(e: i32) -> T {
    T::from(times_power_of_two(1.0, e))
}

/// f, from all of its poles.
struct Secular<'a> {
    frame: &'a ReducedAxes,
    /// Axes whose poles f has, these ascending.
    poles: Vec<usize>,
}

impl<'a> Secular<'a> {
    fn of(frame: &'a ReducedAxes) -> Self {
        let poles = frame.with_rotor();
        Self { frame, poles }
    }

    /// All multipliers at which f is L².
    fn roots(&self) -> Vec<Multiplier> {
        let (Some(&first), Some(&last)) = (self.poles.first(), self.poles.last()) else {
            return Vec::new();
        };
        let mut roots = vec![self.outer(first, 1.0)];
        for (minimum, pair) in self.minima().iter().zip(self.poles.windows(2)) {
            let below = DoubleDouble::from(1.0) - norm(&minimum.shares(self.frame));
            if below.high > NOTHING {
                roots.push(self.inner(minimum, pair[0], pair[1], below));
                roots.push(self.inner(minimum, pair[1], pair[0], below));
            } else if below.high >= -NOTHING {
                roots.push(*minimum);
            }
        }
        roots.push(self.outer(last, -1.0));
        roots
    }

    /// The minimum of f between each two neighbouring poles.
    fn minima(&self) -> Vec<Multiplier> {
        self.poles
            .windows(2)
            .map(|pair| self.minimum(pair[0], pair[1]))
            .collect()
    }

    /// The root beyond all poles, on the side where `1 − μ I_k` has this sign.
    fn outer(&self, k: usize, side: f64) -> Multiplier {
        let view = self.view::<f64>(k);
        let is_above = |s: f64| view.value_and_slope(s).0 > 0.0;
        let near = side * view.terms[k].part.abs();
        let mut far = near;
        // It ends: infinitely far f is zero.
        while is_above(far) {
            far *= 16.0;
        }
        let start = bisect(near, far, is_above);
        self.refine(k, start.into())
    }

    /// The root between the pole of one axis and the minimum toward another pole.
    fn inner(
        &self,
        minimum: &Multiplier,
        from: usize,
        to: usize,
        below: DoubleDouble,
    ) -> Multiplier {
        if below.high < 1e-9 {
            // Too close for doubles to see a side: f is a parabola.
            let view = self.view::<DoubleDouble>(minimum.axis);
            let curvature = view.slope_and_curvature(minimum.s).1.high;
            let width = (2.0 * below.high / curvature).sqrt();
            // μ ascends as s falls, and poles ascend as moments fall.
            let is_lower = self.frame.moments[from].high > self.frame.moments[to].high;
            let side = if is_lower { width } else { -width };
            return self.refine(minimum.axis, minimum.s + side.into());
        }
        // The half of the way to the other pole in which the root is names the pole that it is seen from.
        let near = self.view::<f64>(from);
        let middle = self.middle(from, to);
        let is_in_near_half = if minimum.axis == from {
            true
        } else {
            near.value_and_slope(middle).0 < 0.0
        };
        if is_in_near_half {
            let start = middle.signum() * near.terms[from].part.abs();
            let end = if minimum.axis == from {
                minimum.s.high
            } else {
                middle
            };
            let is_above = |s: f64| near.value_and_slope(s).0 > 0.0;
            return self.refine(from, bisect(start, end, is_above).into());
        }
        let far = self.view::<f64>(to);
        let is_above = |s: f64| far.value_and_slope(s).0 > 0.0;
        let start = bisect(self.middle(to, from), minimum.s.high, is_above);
        self.refine(to, start.into())
    }

    /// Half of the way from one pole to another, as seen from the first.
    fn middle(&self, from: usize, to: usize) -> f64 {
        let I = &self.frame.moments;
        let half = ((I[to] - I[from]) / I[to]).high * 0.5;
        times_power_of_two(half, -self.unit(from))
    }

    /// The minimum between the poles of two axes, the lower pole first.
    fn minimum(&self, low: usize, high: usize) -> Multiplier {
        // f falls from the lower pole on: in which half does it rise again?
        let view = self.view::<f64>(low);
        let middle = self.middle(low, high);
        let falls = |view: &SecularAtPole<f64>, s: f64| view.slope_and_curvature(s).0 > 0.0;
        let (k, end, from_low) = if falls(&view, middle) {
            (high, self.middle(high, low), false)
        } else {
            (low, middle, true)
        };
        let view = self.view::<f64>(k);
        let start = end * f64::EPSILON.powi(20);
        let s = bisect(start, end, |s| falls(&view, s) == from_low);
        let view = self.view::<DoubleDouble>(k);
        let mut s = DoubleDouble::from(s);
        for _ in 0..4 {
            let (slope, curvature) = view.slope_and_curvature(s);
            let step = slope / curvature;
            if !step.high.is_finite() || step.high.abs() > 1e-8 * s.high.abs() {
                break;
            }
            s -= step;
        }
        self.place(k, s)
    }

    /// Newton's method to twice the precision.
    fn refine(&self, k: usize, start: DoubleDouble) -> Multiplier {
        let view = self.view::<DoubleDouble>(k);
        let mut s = start;
        for _ in 0..STEPS {
            let (value, slope) = view.value_and_slope(s);
            let step = value / (slope + slope);
            if !step.high.is_finite() {
                break;
            }
            s -= step;
            if step.high.abs() <= 1e-30 * s.high.abs() {
                break;
            }
        }
        self.place(k, s)
    }

    fn place(&self, axis: usize, s: DoubleDouble) -> Multiplier {
        Multiplier {
            axis,
            unit: self.unit(axis),
            s,
        }
    }

    fn unit(&self, axis: usize) -> i32 {
        exponent(self.frame.rotor[axis].high).min(0)
    }

    fn view<T: Real>(&self, k: usize) -> SecularAtPole<T> {
        let ReducedAxes { moments, rotor, .. } = self.frame;
        let number = |x: DoubleDouble| T::pair(x.high, x.low);
        let unit = self.unit(k);
        let terms = [0, 1, 2].map(|j| Term {
            gap: number((moments[k] - moments[j]) / moments[k]),
            ratio: number(moments[j] / moments[k]),
            part: number(if j == k {
                let h = rotor[j];
                h.times_power_of_two(-unit)
            } else {
                rotor[j]
            }),
            is_own: j == k,
        });
        SecularAtPole { unit, terms }
    }
}

impl Multiplier {
    /// The multiplier `1/I_k` itself, of an axis without a part of h.
    fn at_pole(axis: usize) -> Self {
        Self {
            axis,
            unit: 0,
            s: DoubleDouble::default(),
        }
    }

    /// `1 − μ I_j`, and the sum of the sizes of its terms.
    fn distance(&self, frame: &ReducedAxes, j: usize) -> (DoubleDouble, f64) {
        let I = &frame.moments;
        let own = self.s.times_power_of_two(self.unit);
        if I[j] == I[self.axis] {
            return (own, own.high.abs());
        }
        let gap = (I[self.axis] - I[j]) / I[self.axis];
        let moved = I[j] / I[self.axis] * own;
        (gap + moved, gap.high.abs() + moved.high.abs())
    }

    /// L/|L| along the axes; zero along those without a part of h.
    fn shares(&self, frame: &ReducedAxes) -> Vector {
        [0, 1, 2].map(|j| {
            let h = frame.rotor[j];
            if h.high == 0.0 {
                return DoubleDouble::default();
            }
            if j == self.axis {
                let scaled = h.times_power_of_two(-self.unit);
                return scaled / self.s;
            }
            h / self.distance(frame, j).0
        })
    }

    /// `1/I_j − μ` along each axis, and the size of what it is a difference of.
    fn across(&self, frame: &ReducedAxes) -> (Vector, [f64; 3]) {
        let both = [0, 1, 2].map(|j| {
            let (distance, size) = self.distance(frame, j);
            (distance / frame.moments[j], size / frame.moments[j].high)
        });
        (both.map(|(x, _)| x), both.map(|(_, size)| size))
    }

    /// μ.
    fn multiplier(&self, frame: &ReducedAxes) -> DoubleDouble {
        let own = self.distance(frame, self.axis).0;
        (DoubleDouble::from(1.0) - own) / frame.moments[self.axis]
    }
}

/// The last double from `near` toward `far`, of one sign, at which a condition holds that holds at `near` and not at `far`:
/// by halving among the doubles, so that sixty steps cross all magnitudes.
fn bisect(near: f64, far: f64, holds: impl Fn(f64) -> bool) -> f64 {
    let sign = if far < 0.0 { -1.0 } else { 1.0 };
    let (mut low, mut high) = (near.abs().to_bits(), far.abs().to_bits());
    while low.abs_diff(high) > 1 {
        let middle = low / 2 + high / 2 + (low & high & 1);
        if holds(sign * f64::from_bits(middle)) {
            low = middle;
        } else {
            high = middle;
        }
    }
    sign * f64::from_bits(low)
}

/// Three components to twice the precision.
type Vector = [DoubleDouble; 3];

/// Axes of which no two with equal moments both have a part of h.
struct ReducedAxes {
    /// Ascending.
    moments: Vector,
    /// h/|L| along the axes.
    rotor: Vector,
    /// The axes, one after the other, in principal axes.
    axes: [Vector; 3],
}

/// Neighbouring axes with equal moments.
#[derive(Clone, Copy)]
struct Group {
    /// The first of them, which has all of their part of h.
    first: usize,
    /// How many.
    count: usize,
}

impl Group {
    /// Whether an axis belongs to it.
    fn contains(self, i: usize) -> bool {
        (self.first..self.first + self.count).contains(&i)
    }
}

impl ReducedAxes {
    /// Of ascending moments, and h/|L| in principal axes.
    fn of(moments: &Vector, rotor: &Vector) -> Self {
        let (zero, one) = (DoubleDouble::default(), DoubleDouble::from(1.0));
        let mut frame = Self {
            moments: *moments,
            rotor: *rotor,
            axes: [0, 1, 2].map(|i| [0, 1, 2].map(|j| if i == j { one } else { zero })),
        };
        for group in frame.groups() {
            // The last first: its part goes to the axis before it.
            for i in (group.first..group.first + group.count - 1).rev() {
                frame.turn(i);
            }
        }
        frame
    }

    /// Turn an axis and the next, so that all of h in their plane is along the first.
    fn turn(&mut self, i: usize) {
        let (a, b) = (self.rotor[i], self.rotor[i + 1]);
        let length = norm(&[a, b, DoubleDouble::default()]);
        if b.high == 0.0 || length.high == 0.0 {
            return;
        }
        let (c, s) = (a / length, b / length);
        let (x, y) = (self.axes[i], self.axes[i + 1]);
        self.axes[i] = [0, 1, 2].map(|k| c * x[k] + s * y[k]);
        self.axes[i + 1] = [0, 1, 2].map(|k| c * y[k] - s * x[k]);
        self.rotor[i] = length;
        self.rotor[i + 1] = DoubleDouble::default();
    }

    /// Axes with equal moments together.
    fn groups(&self) -> Vec<Group> {
        let mut groups: Vec<Group> = Vec::with_capacity(3);
        for i in 0..3 {
            match groups.last_mut() {
                Some(group) if self.moments[group.first] == self.moments[i] => group.count += 1,
                _ => groups.push(Group { first: i, count: 1 }),
            }
        }
        groups
    }

    /// Groups in which there is nothing of h.
    fn without_rotor(&self) -> Vec<Group> {
        let mut groups = self.groups();
        groups.retain(|group| self.rotor[group.first].high == 0.0);
        groups
    }

    /// Axes with a part of h, the largest moment first: their poles ascend.
    fn with_rotor(&self) -> Vec<usize> {
        (0..3)
            .rev()
            .filter(|&i| self.rotor[i].high != 0.0)
            .collect()
    }

    /// A vector in these axes, in principal ones.
    fn outward(&self, v: &Vector) -> Vector {
        [0, 1, 2].map(|k| {
            v.iter()
                .zip(&self.axes)
                .fold(DoubleDouble::default(), |sum, (&x, axis)| sum + x * axis[k])
        })
    }
}

/// The length, which does not overflow.
fn norm(v: &Vector) -> DoubleDouble {
    let largest = v.iter().fold(0.0, |most: f64, x| most.max(x.high.abs()));
    if largest == 0.0 {
        return DoubleDouble::default();
    }
    let unit = exponent(largest);
    let [x, y, z] = v.map(|x| x.times_power_of_two(-unit));
    (x * x + y * y + z * z).sqrt().times_power_of_two(unit)
}

#[cfg(test)]
mod tests;
