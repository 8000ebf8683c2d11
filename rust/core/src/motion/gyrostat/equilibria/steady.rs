//! What is told of each steady rotation, and of where their number changes.

use nalgebra::{Matrix3, Vector3};

use super::axes::{Group, ReducedAxes, Vector, norm};
use super::secular::{Multiplier, NOTHING, Secular};
use crate::numerics::double_double::DoubleDouble;
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
    pub fn turned(mut self, axes: &Matrix3<f64>) -> Self {
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
    made.finished()
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

    fn finished(mut self) -> Equilibria {
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
