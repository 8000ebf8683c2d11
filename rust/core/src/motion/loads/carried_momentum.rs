//! What a load carries along in the body, with internal states: wheels, slugs.

use nalgebra::Vector3;

use super::body_at_point::BodyAtPoint;
use crate::motion::state::Phase;

/// What a law carries along in the body: an angular momentum beside I ω, and internal states that go on with the motion.
///
/// I is the tensor of the body with its wheels locked, ω that of B relative to N; all components in B. `state`: the states.
pub trait CarriedMomentum {
    /// How many states it has.
    fn count(&self) -> usize;

    /// What counts as large of a state, times |ω|.
    fn size(&self) -> f64;

    /// Its states where a motion starts at time `t` with `omega`, unless others are given.
    fn begin(&self, t: f64, omega: &Vector3<f64>) -> Vec<f64>;

    /// How these states depend on what they are made of: by ω (in B), and by the numbers of the law, for each state.
    fn beginning(&self, t: f64, omega: &Vector3<f64>) -> Vec<(Vector3<f64>, Vec<f64>)>;

    /// Whether its states follow from the law alone at any time, so that none can be given.
    fn is_known(&self) -> bool {
        false
    }

    /// Replace the states by those that are reported: those of a wheel are its momentum `h = J (Ω + a·ω)`.
    fn report_states(&self, states: &mut [f64], omega: &Vector3<f64>);

    /// Replace the states that are reported by those where a motion starts at time `t` with `omega`.
    fn resume_states(&self, states: &mut [f64], t: f64, omega: &Vector3<f64>);

    /// The axis (not of unit length) and the moment J of what turns freely in the body: the equations of motion have the tensor
    /// `I − J a aᵀ`.
    fn turning(&self) -> Option<(Vector3<f64>, f64)>;

    /// The unit axis, the moment J and the torque of dry friction of a wheel with such friction in its bearing. Its first state is the
    /// wheel's momentum; [`Self::torque`] leaves the friction out.
    fn bearing(&self) -> Option<(Vector3<f64>, f64, f64)> {
        None
    }

    /// The unit axis, the moment J and the largest |Ω| of a wheel with such a limit, whose first state is its momentum. At the limit its motor
    /// exerts what keeps it there, as long as it is asked for more.
    fn rate_limit(&self) -> Option<(Vector3<f64>, f64, f64)> {
        None
    }

    /// Whether its motor has a limit.
    fn has_limit(&self) -> bool {
        false
    }

    /// By how much more than its limit its motor is asked for: `(τ/limit)² − 1`; less than zero of one without.
    fn over_limit(&self, now: &LawContext<'_>) -> f64 {
        let _ = now;
        -1.0
    }

    /// The torque on the body, beside what stands in [`Self::torque`], of a motor at the start of a motion whose controller asks for `command`.
    fn answer(
        &self,
        body: &BodyAtPoint,
        t: f64,
        phase: &Phase,
        command: Vector3<f64>,
    ) -> Vector3<f64> {
        let state = self.begin(t, &phase.omega);
        let idle = LawContext::without_command(body, t, t, phase);
        self.torque(&LawContext { command, ..idle }, &state, None)
            - self.torque(&idle, &state, None)
    }

    /// The torque about the reference point that stands beside that tensor; the rates of its states into `rates`, where they are asked for.
    fn torque(
        &self,
        now: &LawContext<'_>,
        state: &[f64],
        rates: Option<&mut [f64]>,
    ) -> Vector3<f64>;

    /// Its momentum beside I ω.
    fn momentum(&self, state: &[f64], omega: &Vector3<f64>) -> Vector3<f64>;

    /// Its kinetic energy beside ½ ω·I ω; of a momentum that is constant nothing.
    fn energy(&self, state: &[f64], omega: &Vector3<f64>) -> f64;
}

/// When, on what and in which state a law acts within a run.
#[derive(Clone, Copy, Debug)]
pub struct LawContext<'a> {
    /// What it acts on.
    pub body: &'a BodyAtPoint,
    /// The time.
    pub t: f64,
    /// A time within the span under way, which has no breaks.
    pub middle: f64,
    /// The state.
    pub phase: &'a Phase,
    /// The sign that a law with one is taken for.
    pub side: f64,
    /// The torque on the body that the controller of a motor asks for.
    pub command: Vector3<f64>,
}

impl<'a> LawContext<'a> {
    /// That of a law that no controller asks for anything.
    pub(super) fn without_command(
        body: &'a BodyAtPoint,
        t: f64,
        middle: f64,
        phase: &'a Phase,
    ) -> Self {
        Self {
            body,
            t,
            middle,
            phase,
            side: 1.0,
            command: Vector3::zeros(),
        }
    }
}
