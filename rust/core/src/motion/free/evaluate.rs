//! The states of a motion in closed form: at one time, and at many.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::motion::state::State;
use crate::numerics::dispatch::{Kernel, dispatch};
use crate::numerics::lane::Lane;
use crate::numerics::structure_of_arrays::{ROWS, StructureOfArrays};

/// A motion whose formula is chosen once for all times, so that loops over times have no branches.
pub(in crate::motion) trait Motion: Copy {
    /// Chooses the formula, and hands it on.
    fn choose<U: Use>(&self, then: U) -> U::Output;
}

/// A formula for the state.
pub(in crate::motion) trait Formula {
    /// (x, y, z, w) of the attitude and ω in B at the time t.
    fn state<L: Lane>(&self, t: L) -> [L; 7];
}

/// What is done with a formula.
pub(in crate::motion) trait Use {
    type Output;

    fn with(self, formula: &impl Formula) -> Self::Output;
}

/// The state at one time.
pub(in crate::motion) fn at(motion: &impl Motion, time: f64) -> State {
    dispatch(At { motion, time })
}

/// The states at many times, quaternions as (x, y, z, w): the bits of [`at`].
///
/// # Panics
/// If the lengths differ.
pub(in crate::motion) fn sample(
    motion: &impl Motion,
    times: &[f64],
    attitudes: &mut [[f64; 4]],
    omegas: &mut [[f64; 3]],
) {
    assert_eq!(times.len(), attitudes.len(), "an attitude for each time");
    assert_eq!(
        times.len(),
        omegas.len(),
        "an angular velocity for each time"
    );
    if times.len() < FEW {
        for ((&time, attitude), omega) in times.iter().zip(attitudes).zip(omegas) {
            let state = at(motion, time);
            *attitude = state.attitude.coords.into();
            *omega = state.omega.into();
        }
        return;
    }
    dispatch(Sample {
        motion,
        times,
        attitudes,
        omegas,
    });
}

/// Fewer times than this are done one by one.
const FEW: usize = 8;

struct At<'a, M> {
    motion: &'a M,
    time: f64,
}

impl<M: Motion> Kernel for At<'_, M> {
    // As the caller returns it: a copy would wait until it is written.
    type Output = State;

    #[inline(always)]
    fn run<L: Lane>(self) -> State {
        let [x, y, z, w, p, q, r] = self.motion.choose(Now(L::new(self.time))).map(L::get);
        State {
            attitude: UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z)),
            omega: Vector3::new(p, q, r),
        }
    }
}

struct Now<L>(L);

impl<L: Lane> Use for Now<L> {
    type Output = [L; 7];

    #[inline(always)]
    fn with(self, formula: &impl Formula) -> [L; 7] {
        formula.state(self.0)
    }
}

struct Sample<'a, M> {
    motion: &'a M,
    times: &'a [f64],
    attitudes: &'a mut [[f64; 4]],
    omegas: &'a mut [[f64; 3]],
}

impl<M: Motion> Kernel for Sample<'_, M> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lane>(self) {
        // A copy that nothing else points to stays in registers.
        let motion = *self.motion;
        motion.choose(All {
            times: self.times,
            attitudes: self.attitudes,
            omegas: self.omegas,
            lane: std::marker::PhantomData::<L>,
        });
    }
}

struct All<'a, L> {
    times: &'a [f64],
    attitudes: &'a mut [[f64; 4]],
    omegas: &'a mut [[f64; 3]],
    lane: std::marker::PhantomData<L>,
}

impl<L: Lane> Use for All<'_, L> {
    type Output = ();

    #[inline(always)]
    fn with(self, formula: &impl Formula) {
        let mut states = StructureOfArrays::<7>::ZERO;
        let mut times = StructureOfArrays::<1>::ZERO;
        let rows = (self.times.chunks(ROWS))
            .zip(self.attitudes.chunks_mut(ROWS))
            .zip(self.omegas.chunks_mut(ROWS));
        for ((batch, attitudes), omegas) in rows {
            for (row, &t) in batch.iter().enumerate() {
                times.set(row, [t]);
            }
            for row in 0..ROWS {
                let [t] = times.lanes::<L>(row);
                states.set_lanes(row, formula.state(t));
            }
            write(&states, attitudes, omegas);
        }
    }
}

/// From planes to rows; outside the kernel, where the compiler would scatter.
#[inline(never)]
fn write(states: &StructureOfArrays<7>, attitudes: &mut [[f64; 4]], omegas: &mut [[f64; 3]]) {
    for (row, (attitude, omega)) in attitudes.iter_mut().zip(omegas).enumerate().take(ROWS) {
        *attitude = states.get(row, 0);
        *omega = states.get(row, 4);
    }
}

/// Σ `numbers[k]` `columns[k]`.
#[inline(always)]
pub(in crate::motion) fn combine<L: Lane, const N: usize, const M: usize>(
    columns: &[[f64; N]; M],
    numbers: [L; M],
) -> [L; N] {
    let mut sums = [L::new(0.0); N];
    let mut i = 0;
    while i < N {
        let mut sum = L::new(columns[0][i]) * numbers[0];
        let mut k = 1;
        while k < M {
            sum = L::new(columns[k][i]).mul_add(numbers[k], sum);
            k += 1;
        }
        sums[i] = sum;
        i += 1;
    }
    sums
}
