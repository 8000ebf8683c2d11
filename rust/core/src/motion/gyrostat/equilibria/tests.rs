use super::*;
use crate::numerics::double_double::DoubleDouble;
use proptest::prelude::*;

fn exact(v: [f64; 3]) -> Vector {
    v.map(DoubleDouble::from)
}

fn of(moments: [f64; 3], rotor: [f64; 3], momentum: f64) -> Equilibria {
    equilibria(&exact(moments), &exact(rotor), momentum.into())
}

fn kinds(all: &Equilibria) -> Vec<Kind> {
    all.found.iter().map(|one| one.kind).collect()
}

fn near(got: f64, want: f64, relative: f64) -> bool {
    (got - want).abs() <= relative * want.abs()
}

/// One case of the table: inputs, equilibria (μ, n, energy, D L²), and the |L| of folds.
#[derive(Default)]
struct Case {
    input: Vec<f64>,
    found: Vec<Vec<f64>>,
    folds: Vec<f64>,
}

/// Roots of a polynomial to 120 digits: `python -m oracles.gyrostat_equilibria`.
fn table() -> Vec<Case> {
    let mut cases: Vec<Case> = Vec::new();
    for line in include_str!("polynomial.txt").lines() {
        let mut words = line.split(' ');
        let name = words.next();
        let numbers: Vec<f64> = words.map(|word| word.parse().unwrap_or(f64::NAN)).collect();
        match (name, cases.last_mut()) {
            (Some("case"), _) => cases.push(Case {
                input: numbers,
                ..Case::default()
            }),
            (Some("at"), Some(case)) => case.found.push(numbers),
            (_, Some(case)) => case.folds.extend(numbers),
            _ => {}
        }
    }
    cases
}

#[test]
fn all_roots_of_the_polynomial() {
    let cases = table();
    assert!(cases.len() > 150);
    let mut worst = [0.0_f64; 4];
    for case in &cases {
        let input = &case.input;
        let (moments, rotor) = (
            [input[0], input[1], input[2]],
            [input[3], input[4], input[5]],
        );
        let all = of(moments, rotor, input[6]);
        assert_eq!(all.found.len(), case.found.len(), "{input:?} {all:?}");
        for (got, want) in all.found.iter().zip(&case.found) {
            let told = [got.kinetic_energy, got.squared_rate];
            let is_finite = |x: &f64| x.is_finite();
            assert!(
                told.iter()
                    .chain(&got.direction)
                    .chain(&got.omega)
                    .all(is_finite)
            );
            for i in 0..3 {
                worst[0] = worst[0].max((got.direction[i] - want[1 + i]).abs());
                let rate = want[0] * input[6];
                worst[1] = worst[1].max((got.omega[i] - rate * want[1 + i]).abs() / rate.abs());
            }
            worst[2] = worst[2].max((got.kinetic_energy / want[4] - 1.0).abs());
            worst[3] = worst[3].max((got.squared_rate / want[5] - 1.0).abs());
            assert_eq!(got.kind == Kind::Saddle, want[5] < 0.0, "{input:?} {got:?}");
        }
        let mut folds: Vec<f64> = all
            .bifurcations
            .iter()
            .filter(|one| one.meeting == Meeting::Fold)
            .map(|one| one.momentum)
            .collect();
        folds.sort_by(f64::total_cmp);
        assert_eq!(folds.len(), case.folds.len(), "{input:?}");
        for (got, want) in folds.iter().zip(&case.folds) {
            assert!(near(*got, *want, 4e-16), "{input:?}: {got} {want}");
        }
    }
    println!(
        "directions {:e}, ω {:e}, energy {:e}, rates {:e}",
        worst[0], worst[1], worst[2], worst[3]
    );
    assert!(worst.iter().all(|&error| error < 1e-15), "{worst:?}");
}

#[test]
fn without_rotor_it_is_the_free_body() {
    let all = of([1.0, 2.0, 2.5], [0.0; 3], 5.0);
    assert_eq!(
        kinds(&all),
        [
            Kind::Minimum,
            Kind::Minimum,
            Kind::Saddle,
            Kind::Saddle,
            Kind::Maximum,
            Kind::Maximum
        ]
    );
    assert!(all.bifurcations.is_empty());
    // D L² is what `stability` says of a spin with ω = L/I.
    let squared = crate::motion::stability::stability(&[1.0, 2.0, 2.5], 5.0);
    assert!(near(all.found[5].squared_rate, squared[0], 1e-15));
    let squared = crate::motion::stability::stability(&[1.0, 2.0, 2.5], 2.5);
    assert!(near(all.found[2].squared_rate, squared[1], 1e-15));
    assert_eq!(all.found[5].omega.map(f64::abs), [5.0, 0.0, 0.0]);
    assert_eq!(all.found[5].kinetic_energy, 12.5);
}

#[test]
fn a_tiny_rotor_moves_six_equilibria_by_little() {
    for h in [1e-4, 1e-8, 1e-16, 1e-100, 1e-280, 1e-300] {
        let all = of([1.0, 2.0, 2.5], [h, -2.0 * h, 3.0 * h], 5.0);
        assert_eq!(all.found.len(), 6, "{h}");
        for one in &all.found {
            let n = one.direction;
            let largest = n.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            assert!(1.0 - largest <= 10.0 * h * h + 2e-16, "{h} {n:?}");
        }
    }
    // And a large one leaves two, along h and against it.
    for h in [1e2, 1e8, 1e100, 1e200] {
        let all = of([1.0, 2.0, 2.5], [h, -2.0 * h, 3.0 * h], 5.0);
        assert_eq!(
            kinds(&all),
            [Kind::Minimum, Kind::Maximum].map(|kind| kind),
            "{h}"
        );
        assert!(
            all.bifurcations
                .iter()
                .all(|one| one.momentum > 5.0 && one.rotor < 3.0)
        );
    }
}

/// A component below the limit is none: equilibria stay mirror images, which meet in a pitchfork.
#[test]
fn the_least_component_that_counts() {
    let mirrored = |share: f64| {
        let all = of([2.0, 3.0, 4.0], [share, 0.0, 0.3], 1.0);
        let meetings = all.bifurcations.iter().map(|one| one.meeting);
        meetings
            .filter(|&meeting| meeting == Meeting::Pitchfork)
            .count()
    };
    assert_eq!([0.0, 0.999e-290].map(mirrored), [2, 2]);
    assert_eq!([1e-290, 1e-3].map(mirrored), [1, 1]);
}

#[test]
fn along_an_axis_two_pitchforks() {
    // h = h₂: the middle axis becomes stable above L = h₂/(1 − I₂/I₃) … and pairs leave it there.
    let all = of([2.0, 3.0, 4.0], [0.0, 1.0, 0.0], 1.0);
    assert_eq!(kinds(&all).len(), 2);
    let at: Vec<(Meeting, f64)> = all
        .bifurcations
        .iter()
        .map(|one| (one.meeting, one.momentum))
        .collect();
    assert_eq!(at, [(Meeting::Pitchfork, 2.0), (Meeting::Pitchfork, 4.0)]);
    assert_eq!(all.bifurcations[0].rotor, 0.5);
    assert_eq!(of([2.0, 3.0, 4.0], [0.0, 1.0, 0.0], 3.0).found.len(), 4);
    assert_eq!(of([2.0, 3.0, 4.0], [0.0, 1.0, 0.0], 5.0).found.len(), 6);
    // On it the three are one, and the second variation does not decide.
    let all = of([2.0, 3.0, 4.0], [0.0, 1.0, 0.0], 2.0);
    assert_eq!(kinds(&all), [Kind::Minimum, Kind::Degenerate]);
}

#[test]
fn a_cusp_is_one_degenerate_equilibrium() {
    // f has a minimum of exactly 384 at μ = 3/8.
    let at = |factor: f64| {
        let momentum = DoubleDouble::from(384.0).sqrt() * factor.into();
        equilibria(&exact([2.0, 3.0, 4.0]), &exact([4.0, 1.0, 4.0]), momentum)
    };
    let all = at(1.0);
    let degenerate: Vec<_> = all
        .found
        .iter()
        .filter(|one| one.kind == Kind::Degenerate)
        .collect();
    assert_eq!((all.found.len(), degenerate.len()), (3, 1));
    for (got, want) in degenerate[0].direction.iter().zip([16.0, -8.0, -8.0]) {
        assert!(near(*got, want / 384.0_f64.sqrt(), 1e-15));
    }
    assert_eq!(all.bifurcations[0].momentum, 384.0_f64.sqrt());
    assert_eq!(at(1.0 - 2.0_f64.powi(-53)).found.len(), 2);
    assert_eq!(at(1.0 + 2.0_f64.powi(-52)).found.len(), 4);
}

#[test]
fn equal_moments() {
    // Nothing along the axis: h across it is along one axis, the circle of equilibria has become points.
    let across = of([1.0, 1.0, 2.0], [0.3, 0.4, 0.0], 5.0);
    assert!(across.found.iter().all(|one| one.extent == Extent::Point));
    assert_eq!(across.found.len(), 4);
    let along = of([1.0, 1.0, 2.0], [0.0, 0.0, 0.5], 5.0);
    assert_eq!(along.found.len(), 3);
    assert_eq!(along.found[2].extent, Extent::Circle([0.0, 0.0, 1.0]));
    assert_eq!(along.found[2].kind, Kind::Maximum);
    // L₃ = h₃/(1 − I₃/I₁) on the circle.
    assert!(near(along.found[2].direction[2], -0.1, 1e-15));
    let ball = of([2.0; 3], [0.1, -0.2, 0.2], 3.0);
    assert_eq!(kinds(&ball), [Kind::Minimum, Kind::Maximum]);
    assert!(near(ball.found[0].direction[1], -2.0 / 3.0, 1e-15));
    // L precesses about h at |h|/I.
    assert!(near(ball.found[0].squared_rate, 0.15_f64.powi(2), 1e-15));
    let still = of([2.0; 3], [0.0; 3], 3.0);
    assert_eq!(still.found[0].extent, Extent::Sphere);
}

#[test]
fn scales_and_what_is_none() {
    let plain = of([1.0, 2.0, 2.5], [0.1, 0.2, -0.3], 5.0);
    let scaled = of(
        [1.0, 2.0, 2.5].map(|x| x * 2.0_f64.powi(-156)),
        [0.1, 0.2, -0.3].map(|x| x * 2.0_f64.powi(-120)),
        5.0 * 2.0_f64.powi(-120),
    );
    assert_eq!(plain.found.len(), scaled.found.len());
    for (a, b) in plain.found.iter().zip(&scaled.found) {
        assert_eq!(a.direction, b.direction);
        assert_eq!(a.omega.map(|x| x * 2.0_f64.powi(36)), b.omega);
        assert_eq!(a.squared_rate * 2.0_f64.powi(72), b.squared_rate);
    }
    for momentum in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(of([1.0, 2.0, 2.5], [0.1; 3], momentum).found.is_empty());
    }
    assert!(of([0.0, 1.0, 1.0], [0.1; 3], 1.0).found.is_empty());
    assert!(of([1.0, 2.0, 2.5], [f64::NAN; 3], 1.0).found.is_empty());
}

#[test]
fn far_longer_and_far_shorter_than_what_is_inside() {
    for (h, count) in [(1e-289, 6), (1e-160, 6), (1.0, 4), (1e160, 2), (1e289, 2)] {
        let all = of([1.0, 2.0, 2.5], [0.0, 0.0, h], 1.0);
        assert_eq!(all.found.len(), count, "{h}");
        for one in &all.found {
            assert!(one.direction.iter().all(|x| x.is_finite()) && one.kind != Kind::Degenerate);
        }
        // L = h/(1 − I₃/I₁), h/(1 − I₃/I₂).
        let at = all.bifurcations.iter().map(|one| one.momentum / h);
        assert!(
            at.zip([1.0 / 1.5, 4.0])
                .all(|(got, want)| near(got, want, 1e-15)),
            "{h}"
        );
    }
    // ω = (L − h)/I₃, about which L circles with that rate.
    let h = 1e160;
    for one in of([h, 2.0 * h, 2.5 * h], [0.0, 0.0, h], 1.0).found {
        assert!(near(one.omega[2], -0.4, 1e-15));
        assert!(near(one.squared_rate, 0.16, 1e-15));
        assert!(near(one.kinetic_energy, 0.2 * h, 1e-15));
    }
}

proptest! {
    /// Steady, as many as the folds say, and as many minima and maxima as saddles and two.
    #[test]
    fn what_holds_of_all(
        mut parts in prop::array::uniform3(0.01_f64..1.0),
        h in prop::array::uniform3(-1.0_f64..1.0),
        orders in prop::array::uniform3(-12.0_f64..3.0),
    ) {
        parts.sort_by(f64::total_cmp);
        let [a, b, c] = parts;
        let moments = [a + b, a + c, b + c];
        let rotor: [f64; 3] = std::array::from_fn(|i| h[i] * 10.0_f64.powf(orders[i]));
        let all = of(moments, rotor, 1.0);
        let passed = all.bifurcations.iter().filter(|one| one.momentum < 1.0).count();
        prop_assert_eq!(all.found.len(), 2 + 2 * passed);
        let saddles = all.found.iter().filter(|one| one.kind == Kind::Saddle).count();
        prop_assert_eq!(all.found.len(), 2 * saddles + 2);
        for one in &all.found {
            let n = one.direction;
            let size = n.iter().map(|x| x * x).sum::<f64>();
            prop_assert!((size - 1.0).abs() < 4e-16 * 4.0);
            // L = I ω + h, |L| = 1.
            for i in 0..3 {
                let momentum = moments[i] * one.omega[i] + rotor[i];
                let terms = (moments[i] * one.omega[i]).abs() + rotor[i].abs();
                prop_assert!((momentum - n[i]).abs() < 1e-15 * (1.0 + terms), "{momentum} {}", n[i]);
            }
        }
    }
}
