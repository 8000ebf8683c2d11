//! Particles, stacks of them and accumulators: the same bits however the work is cut, at every level and on any threads.

use crate::watch::go_on;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::time::Duration;

use crate::settings::take_turn;
use polhode::error::BodyFault;
use polhode::mass::particles::{Particles, particle_stack, particles, particles_watched};
use polhode::mass::voxels::{Grid, voxels};
use polhode::mass::{MassAccumulator, RigidBody};
use polhode::parallel::{Level, level, set_level, set_thread_limit, set_watch_interval};
use polhode::{Error, PrincipalAxes};
use proptest::prelude::*;

/// Pseudo-random numbers in [0, 1).
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A cloud, squeezed along two oblique directions.
fn cloud(count: usize, squeeze: f64, seed: u64) -> (Vec<f64>, Vec<[f64; 3]>) {
    let mut next = numbers(seed);
    let masses = (0..count).map(|_| 0.1 + next()).collect();
    let positions = (0..count)
        .map(|_| {
            let (a, b, c) = (next() - 0.5, squeeze * next(), squeeze * next());
            [
                a + 2.0 * b + 2.0 * c,
                2.0 * a + b - 2.0 * c,
                2.0 * a - 2.0 * b + c,
            ]
        })
        .collect();
    (masses, positions)
}

fn streamed(masses: &[f64], positions: &[[f64; 3]]) -> RigidBody {
    let mut sums = MassAccumulator::new();
    sums.add(masses, positions, None, &mut go_on)
        .expect("particles");
    sums.finish().expect("body")
}

/// One body of each source, large enough to be shared among threads.
fn of_every_source() -> Vec<RigidBody> {
    let (masses, positions) = cloud(600_011, 0.5, 1);
    let (thin_masses, thin_positions) = cloud(600_011, 1e-7, 2);
    let (cells, spacing) = (&masses[..80 * 80 * 80], [1.0, 2.0, 0.5]);
    let grid = Grid::of_boxes(cells, [80; 3], spacing, [0.0; 3]).expect("a grid");
    let mut bodies = vec![
        particles(&masses, &positions).expect("cloud"),
        particles(&thin_masses, &thin_positions).expect("rod"),
        streamed(&masses, &positions),
        voxels(&grid, &mut go_on).expect("voxels"),
    ];
    let row = |k: usize| {
        let range = 20 * k..20 * (k + 1);
        Particles::new(&masses[range.clone()], &positions[range])
    };
    bodies.extend(particle_stack(30_000, |_| 20, row, &mut go_on).expect("stack"));
    bodies
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let _turn = take_turn();
    set_thread_limit(NonZeroUsize::new(1));
    let alone = of_every_source();
    for count in [2, 5] {
        set_thread_limit(NonZeroUsize::new(count));
        assert!(of_every_source() == alone, "{count} threads");
    }
    set_thread_limit(None);
}

#[test]
fn fused_levels_have_the_same_bits_and_the_baseline_agrees() {
    let _turn = take_turn();
    let best = level();
    let expected = of_every_source();
    for level in Level::ALL {
        if !set_level(level) {
            continue;
        }
        let found = of_every_source();
        let is_fused = |level| level != Level::Baseline;
        if is_fused(level) == is_fused(best) {
            assert!(found == expected, "{level}");
        }
        for (a, b) in found.iter().zip(&expected) {
            let (PrincipalAxes { moments, .. }, other) = (a.principal(), b.principal().moments);
            for k in 0..3 {
                assert!((moments[k] / other[k] - 1.0).abs() <= 1e-13, "{level}");
            }
            let difference = (a.inertia() - b.inertia()).amax();
            let bounds = a.error_bound().inertia + b.error_bound().inertia;
            assert!(difference <= bounds, "{level}: {difference:e} {bounds:e}");
        }
    }
    set_level(best);
}

#[test]
fn whoever_watches_may_stop_the_work() {
    let _turn = take_turn();
    set_thread_limit(NonZeroUsize::new(1));
    set_watch_interval(Duration::ZERO);
    let (masses, positions) = cloud(100_000, 1e-7, 3);
    let mut sums = MassAccumulator::new();
    let stop = &mut |_: f64| ControlFlow::Break(());
    let stopped = particles_watched(&masses, &positions, stop);
    assert_eq!(stopped, Err(Error::Stopped));
    assert_eq!(
        sums.add(&masses, &positions, None, stop),
        Err(Error::Stopped)
    );
    assert_eq!(sums, MassAccumulator::new());
    set_watch_interval(Duration::from_millis(20));
    set_thread_limit(None);
}

#[test]
fn numbers_of_particles_end_below_two_to_the_64() {
    let (masses, positions) = cloud(5, 0.5, 1);
    let at = |start: u64| {
        let mut sums = MassAccumulator::new();
        let added = sums.add(&masses, &positions, Some(start), &mut go_on);
        added.map(|()| sums)
    };
    let last = u64::MAX - 5;
    let mut sums = at(last).expect("just in reach");
    assert!(matches!(
        at(last + 1),
        Err(Error::OutOfDomain { what: "start", .. })
    ));
    // What has no places comes after the last, where there is no room.
    let mut other = MassAccumulator::new();
    (other.add(&masses, &positions, None, &mut go_on)).expect("particles");
    let before = sums.clone();
    assert!(matches!(
        sums.merge(&other),
        Err(Error::OutOfDomain { what: "start", .. })
    ));
    assert_eq!(sums, before);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn chunks_of_any_size_in_any_order_give_the_same_bits(
        count in 1_usize..30_000, cuts in proptest::collection::vec(any::<prop::sample::Index>(), 0..8), seed in 0_u64..1000,
        squeeze in prop_oneof![Just(0.5), Just(1e-8)], keys in proptest::collection::vec(0_u32..1000, 9),
    ) {
        let _turn = take_turn();
        let (masses, positions) = cloud(count, squeeze, seed);
        let mut edges: Vec<usize> = cuts.iter().map(|cut| cut.index(count)).collect();
        edges.extend([0, count]);
        edges.sort_unstable();
        let mut chunks: Vec<_> = edges.windows(2).map(|w| w[0]..w[1]).collect();
        let mut order: Vec<usize> = (0..chunks.len()).collect();
        order.sort_by_key(|&k| keys[k]);
        chunks = order.iter().map(|&k| chunks[k].clone()).collect();
        let mut parts = [MassAccumulator::new(), MassAccumulator::new()];
        for (k, chunk) in chunks.into_iter().enumerate() {
            let start = Some(chunk.start as u64);
            parts[k % 2]
                .add(&masses[chunk.clone()], &positions[chunk], start, &mut go_on)
                .expect("chunk");
        }
        let [mut whole, other] = parts;
        let other = MassAccumulator::from_bytes(&other.to_bytes()).expect("bytes");
        whole.merge(&other).expect("disjoint");
        prop_assert_eq!(whole.count(), count as u64);
        prop_assert!(whole.finish().expect("body") == streamed(&masses, &positions));
    }

    #[test]
    fn bytes_that_were_cut_short_are_refused(cut in any::<prop::sample::Index>()) {
        let (masses, positions) = cloud(5000, 0.5, 1);
        let mut sums = MassAccumulator::new();
        sums.add(&masses, &positions, None, &mut go_on).expect("particles");
        let bytes = sums.to_bytes();
        prop_assert!(MassAccumulator::from_bytes(&bytes).as_ref() == Ok(&sums));
        let kept = cut.index(bytes.len());
        prop_assert_eq!(MassAccumulator::from_bytes(&bytes[..kept]), Err(BodyFault::NotAnAccumulator.into()));
    }

    #[test]
    fn a_body_is_the_same_alone_and_in_a_stack(seed in 0_u64..1000, size in 1_usize..70, squeeze in prop_oneof![Just(0.5), Just(1e-9)]) {
        let _turn = take_turn();
        let (masses, positions) = cloud(size * 70, squeeze, seed);
        let row = |k: usize| {
            let range = size * k..size * (k + 1);
            Particles::new(&masses[range.clone()], &positions[range])
        };
        let stack = particle_stack(70, |_| size, row, &mut go_on).expect("stack");
        for (k, body) in stack.iter().enumerate() {
            let range = size * k..size * (k + 1);
            prop_assert!(*body == particles(&masses[range.clone()], &positions[range]).expect("body"));
        }
    }
}
