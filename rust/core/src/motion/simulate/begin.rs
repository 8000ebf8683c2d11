//! The one place where the methods of steps are told apart.

use super::closed_form_run::ClosedFormRun;
use super::equations::{FEW, MANY, MOVING, SOME, TURNING};
use super::runge_kutta_run::RungeKuttaRun;
use super::splitting_run::SplittingRun;
use super::stepper::{Span, Stepper};
use crate::error::{Error, MotionFault};
use crate::motion::integrate::{Dop853, Radau, RungeKutta};
use crate::motion::loads::Load;
use crate::motion::problem::{Method, Task};

/// A method of steps at the start of `span`.
///
/// A stepper more is an arm more here, and its row in [`Method`].
pub(super) fn begin<'a, L: Load>(
    method: Method,
    task: &Task<'_>,
    span: &Span,
    load: &'a mut L,
) -> Result<Box<dyn Stepper<Error = L::Error> + 'a>, L::Error>
where
    L::Error: 'a,
{
    let moves = !task.body_at_point.pivoted && load.exerts_force();
    let states = span.phase.internal_state.len();
    if states > 0 {
        return match method {
            Method::Radau | Method::Dop853 | Method::Auto | Method::Taylor
                if states > MANY - MOVING =>
            {
                Err(Error::Motion(MotionFault::MethodCannotServe {
                    method: method.name(),
                    needs: "a load with 51 states of its own at most",
                    instead: "taylor",
                })
                .into())
            }
            Method::Exact | Method::Splitting => {
                Err(Error::Motion(MotionFault::MethodCannotServe {
                    method: method.name(),
                    needs: "a load without states of its own",
                    instead: "dop853",
                })
                .into())
            }
            Method::Radau if states <= FEW - MOVING => {
                solved::<L, Radau<FEW>, FEW>(task, span, load)
            }
            Method::Radau if states <= SOME - MOVING => {
                solved::<L, Radau<SOME>, SOME>(task, span, load)
            }
            Method::Radau => solved::<L, Radau<MANY>, MANY>(task, span, load),
            _ if states <= FEW - MOVING => solved::<L, Dop853<FEW>, FEW>(task, span, load),
            _ if states <= SOME - MOVING => solved::<L, Dop853<SOME>, SOME>(task, span, load),
            _ => solved::<L, Dop853<MANY>, MANY>(task, span, load),
        };
    }
    match method {
        Method::Exact => Ok(Box::new(ClosedFormRun::<L::Error>::new(
            task,
            span,
            load.analytic(),
        )?)),
        Method::Radau if moves => solved::<L, Radau<MOVING>, MOVING>(task, span, load),
        Method::Radau => solved::<L, Radau<TURNING>, TURNING>(task, span, load),
        Method::Splitting => Ok(Box::new(SplittingRun::new(task, span, load)?)),
        // Auto was settled, and a series has a driver of its own.
        Method::Auto | Method::Taylor | Method::Dop853 if moves => {
            solved::<L, Dop853<MOVING>, MOVING>(task, span, load)
        }
        Method::Auto | Method::Taylor | Method::Dop853 => {
            solved::<L, Dop853<TURNING>, TURNING>(task, span, load)
        }
    }
}

/// Not inlined: a run of few numbers is not to take the stack that many take.
#[inline(never)]
fn solved<'a, L: Load, M: RungeKutta<N> + 'a, const N: usize>(
    task: &Task<'_>,
    span: &Span,
    load: &'a mut L,
) -> Result<Box<dyn Stepper<Error = L::Error> + 'a>, L::Error>
where
    L::Error: 'a,
{
    Ok(Box::new(RungeKuttaRun::<L, M, N>::new(task, span, load)?))
}
