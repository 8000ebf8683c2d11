//! Motions in closed form: their states at one time, and at many.

use std::convert::Infallible;
use std::ops::ControlFlow;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use super::state::State;
use crate::error::{Error, MotionFault};
use crate::numerics::dispatch::{Kernel, dispatch};
use crate::numerics::lane::Lane;
use crate::numerics::structure_of_arrays::{ROWS, StructureOfArrays};
use crate::numerics::threads::{Halt, fill_blocks};

/// A motion in closed form: its state at any time costs the same.
///
/// # Examples
///
/// ```
/// use std::ops::ControlFlow;
/// use polhode::mass::{Amount, solids};
/// use polhode::motion::free::FreeMotion;
/// use polhode::motion::closed_form::{ClosedForm, sample_many};
/// use polhode::nalgebra::{UnitQuaternion, Vector3};
///
/// // A box thrown with a hundred different spins, each at two times, on all cores.
/// let body = solids::cuboid(&[0.3, 0.2, 0.1], Amount::Mass(1.0))?;
/// let thrown = |k: i32| FreeMotion::of(&body, &Vector3::new(f64::from(k), 5.0, 0.0), &UnitQuaternion::identity());
/// let motions = (0..100).map(thrown).collect::<Result<Vec<_>, _>>()?;
/// let times = [0.0, 1.5];
/// let (mut attitudes, mut omegas) = (vec![[0.0; 4]; 200], vec![[0.0; 3]; 200]);
/// let go_on = &mut |_| ControlFlow::Continue(());
/// sample_many(&motions, &times, &mut attitudes, &mut omegas, go_on).unwrap();
/// assert_eq!(omegas[2 * 7 + 1], <[f64; 3]>::from(motions[7].at(1.5).omega));
/// assert!(motions[7].reach() > 1e20);
/// # Ok::<(), polhode::Error>(())
/// ```
pub trait ClosedForm: Sync {
    /// The largest |t| at which the state is known: what multiplies the time is, to 2⁻⁹⁰ of itself. Beyond, states are NaN.
    fn reach(&self) -> f64;

    /// That |t| is within [`reach`](Self::reach), or not finite, which has no state.
    ///
    /// # Errors
    /// [`MotionFault::BeyondReach`].
    #[inline]
    fn reaches(&self, t: f64) -> Result<(), Error> {
        let reach = self.reach();
        if t.is_finite() && t.abs() > reach {
            return Err(MotionFault::BeyondReach { t, reach }.into());
        }
        Ok(())
    }

    /// Attitudes as (x, y, z, w) and ω at many times, on the calling thread; one of each for every time.
    fn sample(&self, times: &[f64], attitudes: &mut [[f64; 4]], omegas: &mut [[f64; 3]]);
}

/// The states of many motions at many times, all times of the first motion first, on several threads when there are many;
/// quaternions as (x, y, z, w). Each state has the bits of [`ClosedForm::sample`].
///
/// About every 20 ms `watch` gets the fraction done; [`ControlFlow::Break`] ends the job.
///
/// # Errors
/// [`Halt::Stopped`] if `watch` said so; the states are then unspecified.
///
/// # Panics
/// If the number of attitudes or of angular velocities is not that of motions times that of times.
pub fn sample_many<M: ClosedForm>(
    motions: &[M],
    times: &[f64],
    attitudes: &mut [[f64; 4]],
    omegas: &mut [[f64; 3]],
    watch: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<(), Halt<Infallible>> {
    let count = motions.len() * times.len();
    assert_eq!(
        attitudes.len(),
        count,
        "an attitude for each motion and time"
    );
    assert_eq!(
        omegas.len(),
        count,
        "an angular velocity for each motion and time"
    );
    let mut blocks: Vec<_> = attitudes
        .chunks_mut(BLOCK)
        .zip(omegas.chunks_mut(BLOCK))
        .collect();
    fill_blocks(&mut blocks, 1, watch, |block, states| {
        for (attitudes, omegas) in states {
            let (mut at, mut done) = (block * BLOCK, 0);
            while done < attitudes.len() {
                let (row, first) = (at / times.len(), at % times.len());
                let span = (times.len() - first).min(attitudes.len() - done);
                motions[row].sample(
                    &times[first..first + span],
                    &mut attitudes[done..done + span],
                    &mut omegas[done..done + span],
                );
                at += span;
                done += span;
            }
        }
        Ok(())
    })
}

/// States that one thread computes at a time.
const BLOCK: usize = 4096;

/// A motion whose formula is chosen once for all times, so that loops over times have no branches.
pub(in crate::motion) trait ChooseFormula: Copy {
    /// Chooses the formula, and hands it on.
    fn choose<U: UseFormula>(&self, then: U) -> U::Output;
}

/// A formula for the state.
pub(in crate::motion) trait StateFormula {
    /// (x, y, z, w) of the attitude and ω in B at the time t.
    fn state<L: Lane>(&self, t: L) -> [L; 7];
}

/// What is done with a formula.
pub(in crate::motion) trait UseFormula {
    type Output;

    fn with(self, formula: &impl StateFormula) -> Self::Output;
}

/// The state at one time.
pub(in crate::motion) fn at(motion: &impl ChooseFormula, time: f64) -> State {
    dispatch(At { motion, time })
}

/// The states at many times, quaternions as (x, y, z, w): the bits of [`at`].
///
/// # Panics
/// If the lengths differ.
pub(in crate::motion) fn sample(
    motion: &impl ChooseFormula,
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

impl<M: ChooseFormula> Kernel for At<'_, M> {
    // As the caller returns it: a copy would wait until it is written.
    type Output = State;

    const IS_WIDE: bool = false;

    #[inline(always)]
    fn run<L: Lane>(self) -> State {
        let [x, y, z, w, p, q, r] = self.motion.choose(AtTime(L::new(self.time))).map(L::get);
        State {
            attitude: UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z)),
            omega: Vector3::new(p, q, r),
        }
    }
}

struct AtTime<L>(L);

impl<L: Lane> UseFormula for AtTime<L> {
    type Output = [L; 7];

    #[inline(always)]
    fn with(self, formula: &impl StateFormula) -> [L; 7] {
        formula.state(self.0)
    }
}

struct Sample<'a, M> {
    motion: &'a M,
    times: &'a [f64],
    attitudes: &'a mut [[f64; 4]],
    omegas: &'a mut [[f64; 3]],
}

impl<M: ChooseFormula> Kernel for Sample<'_, M> {
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

impl<L: Lane> UseFormula for All<'_, L> {
    type Output = ();

    #[inline(always)]
    fn with(self, formula: &impl StateFormula) {
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
