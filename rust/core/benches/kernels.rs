//! Seconds that kernels take on one thread, a line each: `cargo bench --bench kernels`, with words to pick lines by.
//!
//! `benchmarks/crate.py` runs it as a stranger builds it and as the wheel is built.

#![allow(missing_docs, clippy::expect_used, reason = "a program that measures")]

use std::hint::black_box;
use std::num::NonZeroUsize;
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use polhode::mass::density::{Effort, from_density};
use polhode::mass::particles::{Particles, particle_stack};
use polhode::mass::polyhedron::polyhedron;
use polhode::mass::regions::Region;
use polhode::mass::tetrahedra::{CellDensity, tetrahedra};
use polhode::mass::thick_shell::thick_shell;
use polhode::mass::voxels::{Grid, voxels};
use polhode::mass::{Amount, solids};
use polhode::motion::euler_angles::Sequence;
use polhode::motion::free::FreeMotion;
use polhode::motion::heavy_top::{HeavyTop, PivotedTop};
use polhode::motion::integrate::taylor::solve_many;
use polhode::motion::loads::{
    Analytic, Callback, Damping, Drive, Frame, GravityGradient, Magnetic, MagneticField,
    PiecewiseSignal, Sampled, Term, Wheel,
};
use polhode::motion::simulate::{Method, NoEvents, Phase, Run, State, Task, Tolerance, simulate};
use polhode::nalgebra::{Matrix3, UnitQuaternion, Vector3};
use polhode::parallel::set_thread_limit;
use polhode::principal::{principal_axes_many, principal_moments_many};
use polhode::random::{Stream, distributions};
use polhode::{Error, RigidBody};

fn main() {
    set_thread_limit(NonZeroUsize::new(1));
    mass();
    principal();
    closed_forms();
    runs();
    small();
}

/// The least time of some calls: the others were disturbed. Of a short kernel there are more calls, since the first ones read
/// from the disk and fill the caches.
fn time<T>(name: &str, mut work: impl FnMut() -> T) {
    let mut picked = std::env::args()
        .skip(1)
        .filter(|word| !word.starts_with("--"))
        .peekable();
    if picked.peek().is_some() && !picked.any(|word| name.contains(&word)) {
        return;
    }
    let mut least = f64::INFINITY;
    let (begin, mut calls) = (Instant::now(), 0);
    while calls < 9 || begin.elapsed() < Duration::from_millis(20) {
        let start = Instant::now();
        black_box(work());
        least = least.min(start.elapsed().as_secs_f64());
        calls += 1;
    }
    println!("{name} {least:e}");
}

fn go_on(_: f64) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Numbers from −1 to 1 without any pattern.
fn numbers(count: usize) -> Vec<f64> {
    let stream = Stream::new(1, 0);
    (0..count as u64)
        .map(|k| 2.0 * distributions::uniform(stream.words(k, 0)[0]) - 1.0)
        .collect()
}

/// A ball of triangles: points on a grid of angles, their rings joined.
fn ball(rings: u32) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let round = 2 * rings;
    let angle = std::f64::consts::PI / f64::from(rings);
    let mut vertices = vec![[0.0, 0.0, 1.0]];
    for ring in 1..rings {
        let (s, z) = (angle * f64::from(ring)).sin_cos();
        vertices.extend((0..round).map(|k| {
            let (y, x) = (angle * f64::from(k)).sin_cos();
            [s * x, s * y, z]
        }));
    }
    vertices.push([0.0, 0.0, -1.0]);
    let at = |ring: u32, k: u32| match ring {
        0 => 0,
        ring if ring == rings => (rings - 1) * round + 1,
        ring => 1 + (ring - 1) * round + k % round,
    };
    let mut faces = Vec::new();
    for (ring, k) in (0..rings).flat_map(|ring| (0..round).map(move |k| (ring, k))) {
        let [a, b, c, d] = [
            at(ring, k),
            at(ring + 1, k),
            at(ring + 1, k + 1),
            at(ring, k + 1),
        ];
        if b != c {
            faces.push([a, b, c]);
        }
        if a != d {
            faces.push([a, c, d]);
        }
    }
    (vertices, faces)
}

fn mass() {
    let (count, size) = (2000, 50);
    let masses: Vec<f64> = numbers(count * size).iter().map(|x| 1.5 + x).collect();
    let positions = numbers(count * size * 3);
    let points: &[[f64; 3]] = positions.as_chunks().0;
    let row = |k: usize| Particles::new(&masses[k * size..][..size], &points[k * size..][..size]);
    time("particles_many", || {
        particle_stack(count, |_| size, row, &mut go_on)
    });
    let whole = |_| Particles::new(&masses, points);
    time("particles_one", || {
        particle_stack(1, |_| masses.len(), whole, &mut go_on)
    });

    let (vertices, faces) = ball(60);
    let amount = Amount::Density(1.0);
    time("mesh", || polyhedron(&vertices, &faces, amount, false));
    time("thick_shell", || {
        thick_shell(&vertices, &faces, 0.01, amount, &mut go_on)
    });
    let mut nodes = vertices.clone();
    nodes.push([0.0; 3]);
    let middle = nodes.len() - 1;
    let cells: Vec<[usize; 4]> = (faces.iter())
        .map(|face| {
            let [a, b, c] = face.map(|k| k as usize);
            [middle, a, b, c]
        })
        .collect();
    let densities: Vec<f64> = numbers(nodes.len()).iter().map(|x| 1.5 + x).collect();
    let density = CellDensity::PerNode(&densities);
    time("tetrahedra", || {
        tetrahedra(&nodes, &cells, density, &mut go_on)
    });
    let (spacing, origin) = ([0.1, 0.2, 0.3], [1.0, 2.0, 3.0]);
    let grid = Grid::of_boxes(&masses[..64_000], [40; 3], spacing, origin).expect("a grid");
    time("voxels", || voxels(&grid, &mut go_on));
    let region = Region::ball(1.0, &Vector3::zeros(), 0.0).expect("a region");
    time("density", || {
        let effort = Effort {
            rtol: 1e-6,
            max_evaluations: 10_000_000,
        };
        let density = |points: &[[f64; 3]], out: &mut [f64]| {
            for (out, &[x, y, z]) in out.iter_mut().zip(points) {
                *out = 1.0 + 0.5 * x * y + (3.0 * z).cos().powi(2);
            }
            Ok::<_, Error>(())
        };
        from_density(&region, density, effort)
    });
}

fn principal() {
    let tensors: Vec<[f64; 9]> = (numbers(300_000).as_chunks::<6>().0.iter())
        .map(|&[x, y, z, a, b, c]| {
            let tensor = |p: [f64; 3]| {
                let p = Vector3::from(p);
                Matrix3::from_diagonal_element(p.norm_squared()) - p * p.transpose()
            };
            let sum = tensor([x, y, z]) + tensor([a, b, c]) + tensor([b, x, -c]);
            let mut row = [0.0; 9];
            row.copy_from_slice(sum.as_slice());
            row
        })
        .collect();
    let (mut moments, mut axes) = (vec![[0.0; 3]; tensors.len()], vec![[0.0; 9]; tensors.len()]);
    time("principal_moments", || {
        principal_moments_many(&tensors, 1e-12, &mut moments, &mut go_on)
    });
    time("principal_axes", || {
        principal_axes_many(&tensors, 1e-12, &mut moments, &mut axes, &mut go_on)
    });
}

/// A body of these moments about the axes of its frame.
fn body(moments: [f64; 3], center: Vector3<f64>) -> RigidBody {
    RigidBody::from_principal(1.0, &moments, &Matrix3::identity(), &center, 0.0).expect("a body")
}

fn closed_forms() {
    let free = body([1.0, 2.0, 2.5], Vector3::zeros());
    let (omega, attitude) = (Vector3::new(0.3, 0.2, 1.1), UnitQuaternion::identity());
    let motion = FreeMotion::of(&free, &omega, &attitude).expect("a motion");
    let times: Vec<f64> = (0..50_000).map(|k| 0.37 * f64::from(k)).collect();
    let (mut attitudes, mut omegas) = (vec![[0.0; 4]; times.len()], vec![[0.0; 3]; times.len()]);
    time("free_states", || {
        motion.sample(&times, &mut attitudes, &mut omegas);
    });
    time("free_state", || {
        times[..5000]
            .iter()
            .map(|&t| motion.at(t).omega.x)
            .sum::<f64>()
    });
    time("free_setup", || {
        (0..1000)
            .filter(|&k| {
                FreeMotion::of(&free, &(omega * (1.0 + 1e-4 * f64::from(k))), &attitude).is_ok()
            })
            .count()
    });
    time("free_sensitivity", || {
        times[..1000]
            .iter()
            .map(|&t| motion.sensitivity(t).state[0])
            .sum::<f64>()
    });

    let gravity = Vector3::new(0.0, 0.0, -9.81);
    let heavy = body([2e-4, 2e-4, 3e-4], Vector3::new(0.0, 0.0, 4e-4));
    let top = PivotedTop::of(&heavy, 1e-9).expect("a top");
    let lean = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.6);
    let spin = Vector3::new(0.5, 0.0, 150.0);
    let made = || HeavyTop::of(&top, &spin, &lean, &gravity).expect("a motion");
    let motion = made();
    time("top_states", || {
        motion.sample(&times, &mut attitudes, &mut omegas);
    });
    time("top_setup", || {
        (0..200).map(|_| made().at(1.0).omega.x).sum::<f64>()
    });
}

/// The loads of the runs, by name.
fn loads(start: &Phase) -> [(&'static str, Vec<Term>); 7] {
    let matrix = Matrix3::from_diagonal(&Vector3::new(0.02, 0.01, 0.03));
    let torques = [0.1, -0.2, 0.3, 0.1].map(|x| Vector3::new(x, 0.05, -x));
    [
        ("free", vec![]),
        (
            "torque",
            vec![
                Term::constant_torque(&Vector3::new(0.1, 0.0, 0.05), Frame::Body).expect("finite"),
            ],
        ),
        (
            "damped",
            vec![Term::Damping(
                Damping::new(&matrix, &matrix).expect("finite"),
            )],
        ),
        (
            "gradient",
            vec![
                GravityGradient::new(1.0, &start.position, &start.velocity, None)
                    .expect("an orbit")
                    .into(),
            ],
        ),
        (
            "magnet",
            vec![Term::Magnetic(
                Magnetic::new(
                    &Vector3::new(0.3, -0.2, 0.5),
                    None,
                    MagneticField::uniform(&Vector3::new(0.3, 0.1, 0.9)).expect("finite"),
                )
                .expect("finite"),
            )],
        ),
        (
            "wheels",
            [Vector3::x(), Vector3::y(), Vector3::z()]
                .map(|axis| {
                    Wheel::new(
                        &axis,
                        0.1,
                        2.0,
                        0.01,
                        Drive::Torque(PiecewiseSignal::constant("torque", 0.0).expect("finite")),
                    )
                    .expect("a wheel")
                })
                .map(Term::from)
                .into(),
        ),
        (
            "sampled",
            vec![
                Sampled::new(&[0.0, 30.0, 70.0, 100.0], &torques, Frame::Space)
                    .expect("finite")
                    .into(),
            ],
        ),
    ]
}

fn runs() {
    let body = body([1.0, 2.0, 2.5], Vector3::new(0.0, 0.0, 0.3));
    let mut start = Phase::in_place(&State {
        attitude: UnitQuaternion::from_euler_angles(0.3, -0.5, 1.1),
        omega: Vector3::new(0.3, 0.2, 1.1),
    });
    start.position = Vector3::new(8.0, 0.0, 0.0);
    start.velocity = Vector3::new(0.0, 0.35, 0.0);
    let times: Vec<f64> = (0..=100).map(f64::from).collect();
    let loads = loads(&start);
    let task = |method, tolerance| {
        let tolerance = Tolerance::new(tolerance, 0.0).expect("a tolerance");
        Task::free(&body, start.clone(), &times, method, tolerance)
    };
    for (load, terms) in &loads {
        for (name, method, tolerance) in [
            ("taylor", Method::Taylor, 1e-12),
            ("dop853", Method::Dop853, 1e-10),
            ("radau", Method::Radau, 1e-8),
            ("twofold", Method::Taylor, 1e-20),
        ] {
            let task = task(method, tolerance);
            time(&format!("{name}_{load}"), || {
                simulate(
                    &task,
                    &mut Analytic::new(terms, task.body_at_point),
                    &mut NoEvents::new(),
                    &mut go_on,
                )
            });
        }
        let task = task(Method::Taylor, 1e-12);
        time(&format!("lanes_{load}"), || {
            let mut many: [Option<Run<Error>>; 16] = Default::default();
            solve_many(&|_| task.clone(), &|_| terms, &mut many, &|_| go_on(0.0));
            many
        });
    }
    let task = task(Method::Dop853, 1e-8);
    time("dop853_closure", || {
        let torque = |t: f64, phase: &Phase| Ok::<_, Error>(phase.omega * -0.01 * (1.0 + t.sin()));
        let mut load = Callback::torque(torque);
        simulate(&task, &mut load, &mut NoEvents::new(), &mut go_on)
    });
}

/// Calls of less than a microsecond each.
fn small() {
    let lengths = || (1..3000).map(f64::from);
    time("cuboid", || {
        lengths()
            .filter(|&x| solids::cuboid(&[1.0, 2.0, x], Amount::Mass(1.0)).is_ok())
            .count()
    });
    time("torus", || {
        lengths()
            .filter(|&x| solids::torus(1.0 + x, 1.0, Amount::Mass(1.0)).is_ok())
            .count()
    });
    let brick = solids::cuboid(&[1.0, 2.0, 3.0], Amount::Mass(1.0)).expect("a body");
    time("combined", || {
        let mut sum = brick;
        for x in lengths().take(500) {
            let moved = brick.translated(&Vector3::new(x, 0.5, -x)).expect("a body");
            sum = sum.combined(&moved).expect("a body");
        }
        sum
    });
    let attitude = UnitQuaternion::from_euler_angles(0.3, -0.5, 1.1);
    let sequence: Sequence = "ZXZ".parse().expect("a sequence");
    time("euler_angles", || {
        lengths()
            .filter_map(|x| sequence.to_quaternion(&[0.1 + x, 0.5, x]).ok())
            .filter_map(|q| sequence.from_quaternion(&(q * attitude)).ok())
            .map(|angles| angles[0])
            .sum::<f64>()
    });
    let mut out = vec![0.0; 20_000];
    time("random", || {
        Stream::new(7, 1).fill(0, 1, &mut out, &mut go_on, distributions::normal)
    });
}
