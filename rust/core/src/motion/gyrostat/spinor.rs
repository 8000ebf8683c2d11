//! The spinor of n as two theta functions of order two, from the start.
//!
//! `χ = √D ψ = e^{iνt} (Mₑ Θₑ + Mₒ Θₒ)`, with `Θₑ = Σ Q^{j²} Z^{2j}`, `Θₒ = Σ Q^{j²+j} Z^{2j+1}`, `Z = Z₀ e^{κt}`, j over all
//! integers, Q the nome of the curve for a doubled imaginary period. With `y = Z₀⁻²` the terms at the start are `Q^{j²} y^{−j}`
//! and `Q^{j²+j} y^{−j}`, the latter over Z₀; none is large for `√|Q| ≤ |y| ≤ 1`.

use super::curve::Curve;
use super::curve::{Logarithm, logarithm};
use super::start::Quartic;
use crate::numerics::complex::Complex;
use crate::numerics::double_double::DoubleDouble;

type Number = Complex<DoubleDouble>;

/// The theta functions of a motion and what stands before them; the second one over Z₀.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spinor {
    pub(super) regime: Regime,
    /// Q; zero where it does not matter.
    pub(super) nome: DoubleDouble,
    /// Whether Q is negative, however small.
    pub(super) is_alternating: bool,
    /// |κ|: radians, or powers of e, for a unit of time.
    pub(super) rate: DoubleDouble,
    /// The sign of κ, or of κ/i.
    pub(super) sense: f64,
    /// y.
    pub(super) start: Number,
    /// `Z₀`.
    pub(super) argument: Number,
    /// `Mₑ` and `Mₒ`.
    pub(super) columns: [[Number; 2]; 2],
    /// ν, but for what all bodies have: of what turns by half of what the body turns.
    pub(super) phase: DoubleDouble,
    /// Of a motion that is hyperbolic and periodic: its period and its ν.
    pub(super) in_time: Option<(DoubleDouble, DoubleDouble)>,
}

/// How Z moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Regime {
    /// In a circle.
    Circular,
    /// As the exponential of the time.
    Hyperbolic,
    /// On the curve with three equal roots: `Θₑ = 1`, `Θₒ = t + k t²`, and `argument` is k.
    Rational,
}

fn real(x: DoubleDouble) -> Number {
    Complex::new(x, DoubleDouble::default())
}

/// A start is near an equilibrium where ρ is smaller.
const NEAR: f64 = 1e-9;
/// Below this nome all but three terms are beyond twice the precision.
const NO_NOME: f64 = 1e-62;
/// Terms below this part are left out.
const SMALL: f64 = 1e-33;
/// The most terms on each side.
const TERMS: i32 = 8;

impl Spinor {
    /// Of the quartic of the start, its curve and ρ. The start: ψ = (1, 0), `ψ̇ = ½i (ω_n, ρ)`.
    pub(super) fn of(quartic: &Quartic, curve: &Curve, rho: DoubleDouble) -> Self {
        let [value, derivative] = quartic.place();
        let place = if curve.is_turned {
            [-value, -derivative.times_i()]
        } else {
            [value, derivative]
        };
        let found = logarithm(&curve.apart, place);
        let slope = if curve.is_turned {
            -found.slope.times_i()
        } else {
            found.slope
        };
        let (sense, argument, start) = place_of(&found);
        let nome = if curve.nome.high.abs() < NO_NOME {
            DoubleDouble::default()
        } else {
            curve.nome
        };
        let rate = if curve.is_turned {
            real(found.mean)
        } else {
            Complex::new(DoubleDouble::default(), found.mean)
        };
        let rate = rate.scaled(sense);
        let [even, odd] = series(nome, start, rate);
        let mut columns = columns(quartic, slope, [even, odd], rho);
        if rho.high < NEAR {
            // One column is nearly (0, 1), and what it has of the first component a difference of far larger ones.
            let root = curve.apart.root;
            let far = quartic.far(if curve.is_turned { -root } else { root });
            let ratio = |column: &[Number; 2]| column[0].size() / column[1].size();
            let k = usize::from(ratio(&columns[1]) < ratio(&columns[0]));
            columns[k][0] = columns[k][1] * far.times(DoubleDouble::from(1.0) / rho);
        }
        let in_time = (curve.is_turned)
            .then(|| curve.in_time())
            .flatten()
            .map(|means| {
                let found = logarithm(&means, [value, derivative]);
                let turn = DoubleDouble::PI.scaled(2.0) / found.mean;
                (turn, -found.slope.im.scaled(0.5))
            });
        Self {
            regime: if curve.is_turned {
                Regime::Hyperbolic
            } else {
                Regime::Circular
            },
            nome,
            is_alternating: curve.gap.high < 0.0,
            rate: found.mean,
            sense,
            start,
            argument,
            columns,
            phase: -slope.im.scaled(0.5),
            in_time,
        }
    }

    /// Of a curve with three equal roots: `P = (t − s)⁻²`, which is zero for a quartic with four equal zeros.
    pub(super) fn cusp(quartic: &Quartic, rho: DoubleDouble) -> Self {
        let [value, derivative] = quartic.place();
        let mut slope = value.sqrt();
        if (slope * value).is_opposite_to(derivative) {
            slope = -slope;
        }
        let even = [Complex::one(), Complex::zero()];
        let odd = [Complex::zero(), Complex::one()];
        let zero = DoubleDouble::default();
        Self {
            regime: Regime::Rational,
            nome: zero,
            is_alternating: false,
            rate: zero,
            sense: 1.0,
            start: Complex::zero(),
            argument: slope.scaled(0.5),
            columns: columns(quartic, slope, [even, odd], rho),
            phase: -slope.im.scaled(0.5),
            in_time: None,
        }
    }
}

/// `Mₑ` and `Mₒ` from `d log ϑ₁`, the two functions with their rates, and ρ.
fn columns(
    quartic: &Quartic,
    slope: Number,
    [even, odd]: [[Number; 2]; 2],
    rho: DoubleDouble,
) -> [[Number; 2]; 2] {
    // ½(d log ϑ₁ − d log ẋ) − iν, with the phase of ψ that ω_n makes.
    let drift = (slope + quartic.turning()).scaled(0.5);
    let wronskian = Complex::<DoubleDouble>::one().over(even[0] * odd[1] - odd[0] * even[1]);
    let half = Complex::new(DoubleDouble::default(), rho.scaled(0.5)) * wronskian;
    [
        [(odd[1] - drift * odd[0]) * wronskian, -(half * odd[0])],
        [(drift * even[0] - even[1]) * wronskian, half * even[0]],
    ]
}

/// The sense in which Z moves, Z₀ and y: `e^{iv}` or `e^{−iv}`, whichever is larger.
fn place_of(found: &Logarithm) -> (f64, Number, Number) {
    let imaginary = Complex::new(DoubleDouble::default(), found.mean);
    let (sense, large) = if found.cotangent.im.high >= 0.0 {
        (1.0, found.cotangent + imaginary)
    } else {
        (-1.0, found.cotangent - imaginary)
    };
    let ratio = found.cosecant.over(large);
    (sense, large.over(found.cosecant), ratio.square())
}

/// Θₑ and Θₒ/Z₀ at the start with their rates.
fn series(nome: DoubleDouble, y: Number, rate: Number) -> [[Number; 2]; 2] {
    let zero = Complex::zero();
    let mut even = [Complex::one(), zero];
    let mut odd = [Complex::one(), Complex::one()];
    let y_next = if nome.high == 0.0 {
        zero
    } else {
        real(nome).over(y)
    };
    let mut add = |j: i32, term: Number, is_odd: bool| {
        let weight = f64::from(2 * j) + if is_odd { 1.0 } else { 0.0 };
        let sums = if is_odd { &mut odd } else { &mut even };
        sums[0] = sums[0] + term;
        sums[1] = sums[1] + term.times(weight.into());
        term.taxicab() > SMALL
    };
    // Upward Q^{j²} y^{−j} = Q^{j²−j} (Q/y)^j, downward Q^{j²} y^j; of Θₒ Q^{j²} (Q/y)^j and Q^{j²−j} y^j.
    let (mut less, mut full, mut step) = (DoubleDouble::from(1.0), nome, nome);
    let (mut up, mut down) = (y_next, y);
    for j in 1..=TERMS {
        let mut goes_on = add(j, up.times(less), false);
        goes_on |= add(-j, down.times(full), false);
        goes_on |= add(j, up.times(full), true);
        goes_on |= add(-j, down.times(less), true);
        if !goes_on {
            break;
        }
        (up, down) = (up * y_next, down * y);
        less = full * step;
        step *= nome;
        full = less * step;
    }
    [even, odd].map(|[value, slope]| [value, slope * rate])
}
