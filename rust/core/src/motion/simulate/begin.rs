//! The one place where the methods of steps are told apart.

use super::equations::{MOVING, TURNING};
use super::exact::Exact;
use super::kicked::Kicked;
use super::solved::Solved;
use super::stepper::{Span, Stepper};
use crate::motion::integrate::{Dop853, Radau};
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
    let moves = !task.subject.pivoted && load.exerts_force();
    Ok(match method {
        Method::Exact => Box::new(Exact::<L::Error>::new(task, span, load.analytic())?),
        Method::Radau if moves => {
            Box::new(Solved::<L, Radau<MOVING>, MOVING>::new(task, span, load)?)
        }
        Method::Radau => Box::new(Solved::<L, Radau<TURNING>, TURNING>::new(task, span, load)?),
        Method::Splitting => Box::new(Kicked::new(task, span, load)?),
        // Auto was settled, and a series has a driver of its own.
        Method::Auto | Method::Taylor | Method::Dop853 if moves => {
            Box::new(Solved::<L, Dop853<MOVING>, MOVING>::new(task, span, load)?)
        }
        Method::Auto | Method::Taylor | Method::Dop853 => {
            Box::new(Solved::<L, Dop853<TURNING>, TURNING>::new(
                task, span, load,
            )?)
        }
    })
}
