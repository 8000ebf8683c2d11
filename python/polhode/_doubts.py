"""What the uncertainty of body and start makes of a motion."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any, Final, Literal, NamedTuple

import numpy as np

from polhode import _core
from polhode._from_zero import runs_from_zero
from polhode._repr import short
from polhode._rows import rows_of
from polhode._variables import angles_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode.results import MotionSensitivity
    from polhode.trajectory import Trajectory
    from polhode.uncertainty.runs import StateLinear

    Floats = NDArray[np.float64]

__all__ = ["StateSigma", "covariance", "sigma", "spin_covariance"]

ELEMENTS: Final = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


class _StateSigma(NamedTuple):
    attitude: Any
    omega: Any


class StateSigma(_StateSigma):
    """Standard deviations of the states of a motion, to first order.

    Attributes
    ----------
    attitude : numpy.ndarray, shape (..., T, 3)
        Standard deviations of the small rotation δ from the attitude, ``R → R exp(δ×)``, components in the
        body frame, in radians.
    omega : numpy.ndarray, shape (..., T, 3)
    """

    _run: Trajectory | None = None
    """The motion they are of."""

    @cached_property
    def linear(self) -> StateLinear:
        """Whether the first order is enough, at every time.

        It is found when it is first asked for, by 256 runs of neighbours of the motion.

        Examples
        --------
        >>> from polhode import RigidBody, Uncertain
        >>> brick = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))
        >>> run = brick.simulate([0, 10, 1000], omega=Uncertain((0.3, 0.2, 1.1), sigma=0.001))
        >>> run.sigma.linear.attitude.all(axis=1)
        array([ True,  True, False])
        """
        if self._run is None:
            raise ValueError("linear: these sigmas are not of a motion; ask those of Trajectory.sigma")
        from polhode.uncertainty.runs import state_linear

        return state_linear(self._run)

    def __repr__(self) -> str:
        return short(self)


def covariance(self: Trajectory) -> Floats | None:
    """Give the covariance of (δ, ω) at every time, shape (..., T, 6, 6); None where nothing is uncertain.

    δ is a small rotation from the attitude, ``R → R exp(δ×)``, components in the body frame, in radians. It
    comes from the covariance of the body, and from `omega` and `attitude` at the start if they were given as
    `Uncertain`. It is computed to first order, by the derivatives of :meth:`sensitivity`, with all
    correlations.

    Examples
    --------
    >>> import numpy as np
    >>> from polhode import Uncertain, solids
    >>> brick = solids.box(Uncertain((1, 2, 3), sigma=0.001), mass=1.0)
    >>> run = brick.simulate([0, 10], omega=Uncertain((0.1, 0.2, 2.0), sigma=0.001))
    >>> run.covariance.shape, run.sigma.omega[0]
    ((2, 6, 6), array([0.001, 0.001, 0.001]))
    """
    forms, _ = _forms(self)
    if forms is None:
        return None
    found = _squares(forms[..., :6, :])
    found[np.isnan(self.omega).any(axis=-1)] = np.nan  # after the end of a run
    return found


def sigma(self: Trajectory) -> StateSigma | None:
    """Give standard deviations of attitude and angular velocity, shape (..., T, 3) each, or None."""
    found = self.covariance
    if found is None:
        return None
    deviations = np.sqrt(np.diagonal(found, axis1=-2, axis2=-1))
    both = StateSigma(deviations[..., :3], deviations[..., 3:])
    both._run = self
    return both


def spin_covariance(self: Trajectory, frame: Literal["space", "body"]) -> Floats | None:
    """Give the covariance of L = I_P ω at every time, shape (..., T, 3, 3), or None as of `covariance`.

    δL = δI ω + I δω in the body, and in space what the rotation δ of the body adds, R (δ × L).
    """
    if self.t.ndim != 1:
        raise ValueError("angular_momentum: its covariance is for times of shape (T,)")
    forms, columns = _forms(self)
    if forms is None:
        return None
    body = self.body
    tensor = body.inertia_about(self._about_word())[..., None, :, :]
    changes: Floats = tensor @ forms[..., 3:6, :]
    if self.states:
        by_omega, by_states = _of_carried(self)
        changes = changes + by_omega @ forms[..., 3:6, :] + by_states @ forms[..., 6:, :]
    doubts, stack = body._doubts(), self.omega.shape[:-2]
    if doubts is not None:
        by_numbers = _tensors(self).reshape(-1, 10, 3, 3)
        flat = changes.reshape(-1, *changes.shape[-3:])  # a view: the changes are new
        omega = self.omega.reshape(-1, *self.omega.shape[-2:])
        ends = np.cumsum(doubts["counts"]).tolist()
        for k, row in enumerate(rows_of(body.shape, stack)):
            for entry in range(ends[row] - int(doubts["counts"][row]), ends[row]):
                column = columns[tuple(doubts["variables"][entry].tolist())]
                change = np.tensordot(doubts["tangents"][entry], by_numbers[row], 1)
                flat[k, :, :, column] += omega[k] @ change
    if frame == "space":
        spin = (tensor @ self.omega[..., None])[..., 0]
        if self.carried is not None:
            spin = spin + self.carried[0]
        # Columns (δ × L) of the matrix that belongs to every change of the attitude.
        changes = changes + np.cross(forms[..., :3, :], spin[..., None], axis=-2)
        turned = _core.rotate(self.quaternion[..., None, :], np.swapaxes(changes, -1, -2))
        changes = np.swapaxes(turned, -1, -2)
    return _squares(changes)


def _of_carried(self: Trajectory) -> tuple[Floats, Floats]:
    """Give the derivatives of the momentum carried along by ω and by the states; it is linear in both."""
    load = self._acting("covariance")
    assert load is not None
    stack = self.omega.shape[:-2]
    over_time = self._over_time(load)
    own = {name: np.zeros((*stack, len(self.t), values.shape[-1])) for name, values in self.states.items()}

    def carried(omega: Floats) -> Floats:
        return over_time.carried(self.t, np.broadcast_to(omega, self.omega.shape), own)[0]

    columns = [carried(axis) for axis in np.eye(3)]
    for values in own.values():
        for k in range(values.shape[-1]):
            values[..., k] = 1.0
            columns.append(carried(np.zeros(3)))
            values[..., k] = 0.0
    still = carried(np.zeros(3))  # of rotors, and of wheels whose speed is given
    found = np.stack([column - still for column in columns], axis=-1)
    return found[..., :3], found[..., 3:]


def _squares(forms: Floats) -> Floats:
    """Give the covariance of numbers that depend on independent variables."""
    return np.asarray(np.einsum("...ik,...jk->...ij", forms, forms))


def _forms(self: Trajectory) -> tuple[Floats | None, dict[tuple[int, ...], int]]:
    """Give what each variable does to (δ, ω, states) per deviation, (..., T, 6 + n, k), and their columns."""
    if not isinstance(self.uncertain_start, tuple):
        return _forms_from_zero(self)
    omega, attitude = self.uncertain_start
    doubts = self.body._doubts()
    if doubts is None and omega is None and attitude is None:
        return None, {}
    slopes = self.sensitivity()
    count = slopes.state.shape[-1]  # of (δ, ω) and of the states of the load
    stack, times = self.omega.shape[:-2], self.omega.shape[-2]
    columns: dict[tuple[int, ...], int] = {}
    terms: list[tuple[int, int, Floats]] = []  # row of the stack, column, change at every time
    if doubts is not None:
        by_numbers = _by_numbers(self, slopes).reshape(-1, times, count, 10)
        ends = np.cumsum(doubts["counts"]).tolist()
        for k, row in enumerate(rows_of(self.body.shape, stack)):
            for entry in range(ends[row] - int(doubts["counts"][row]), ends[row]):
                column = columns.setdefault(tuple(doubts["variables"][entry].tolist()), len(columns))
                terms.append((k, column, by_numbers[k] @ doubts["tangents"][entry]))
    by_state = slopes.state.reshape(-1, times, count, count)
    # The states that begin with ω go with it.
    by_omega = by_state[..., 3:6]
    if count > 6:
        by_omega = by_omega + by_state[..., 6:] @ slopes.begins.reshape(-1, 1, count - 6, 3)
    if omega is not None:
        forms, shape = omega._forms(), np.shape(omega.value)
        for k, row in enumerate(rows_of(shape[:-1], stack)):
            for place, form in enumerate(forms[3 * row : 3 * row + 3]):
                for words, step in form:
                    column = columns.setdefault(tuple(words), len(columns))
                    terms.append((k, column, by_omega[k][:, :, place] * step))
    if attitude is not None:
        # Its small angles are about fixed axes; those of the derivatives about the body's.
        starts = self.quaternion[..., 0, :].reshape(-1, 4)
        for k, start in enumerate(starts):
            for axis, form in zip(np.eye(3), angles_of(attitude, stack, k), strict=True):
                local = by_state[k][:, :, :3] @ _core.rotate(start, axis, inverse=True)
                for words, step in form:
                    terms.append((k, columns.setdefault(tuple(words), len(columns)), local * step))
    out = np.zeros((int(np.prod(stack, dtype=int)), times, count, len(columns)))
    for k, column, term in terms:
        out[k, :, :, column] += term
    return out.reshape(*stack, times, count, len(columns)), columns


def _forms_from_zero(self: Trajectory) -> tuple[Floats | None, dict[tuple[int, ...], int]]:
    """Give it for a closed form at any times."""
    stack = self.omega.shape[: self.omega.ndim - 1 - self.t.ndim]
    flat = np.zeros(0)
    columns: dict[tuple[int, ...], int] = {}
    for run, which, places in runs_from_zero(self):
        forms, columns = _forms(run)
        if forms is None:
            return None, {}
        if not flat.size:
            flat = np.full((*stack, self.t.size, 6, len(columns)), np.nan)
        flat[..., which, :, :] = forms[..., places, :, :]
    return flat.reshape(*stack, *self.t.shape, 6, len(columns)), columns


def _by_numbers(self: Trajectory, slopes: MotionSensitivity) -> Floats:
    """Give the derivatives of (δ, ω, states) by the body's ten numbers, shape (..., T, 6 + n, 10).

    The sensitivities are by the tensor about the reference point P, in its principal axes:
    ``I_P = I_C + m (d² 1 − d dᵀ)``, d from P to C.
    """
    body, about = self.body, self._about_word()
    axes = body.principal_about(about).axes if self.pivoted else body.principal.axes
    tensors = _tensors(self)
    turned = np.swapaxes(axes, -1, -2)[..., None, :, :] @ tensors @ axes[..., None, :, :]
    # By moments, and by the elements 23, 31, 12.
    places = ((0, 0), (1, 1), (2, 2), (1, 2), (2, 0), (0, 1))
    changes = np.stack([turned[..., i, j] for i, j in places], axis=-2)
    by_tensor = np.concatenate([slopes.moments, slopes.products], axis=-1)
    found = by_tensor @ changes[..., None, :, :]
    found[..., 0] += slopes.mass
    found[..., 1:4] += slopes.center_of_mass
    return np.asarray(found)


def _tensors(self: Trajectory) -> Floats:
    """Give the derivatives of the tensor about P by the body's ten numbers, shape (..., 10, 3, 3)."""
    body = self.body
    d = body.center_of_mass if self.pivoted else np.zeros_like(body.center_of_mass)
    mass = np.asarray(body.mass)[..., None, None]
    one = np.eye(3)
    tensors = np.zeros((*body.shape, 10, 3, 3))
    tensors[..., 0, :, :] = (d**2).sum(axis=-1)[..., None, None] * one - d[..., :, None] * d[..., None, :]
    for k, axis in enumerate(one):
        if self.pivoted:
            cross = d[..., :, None] * axis + axis[:, None] * d[..., None, :]
            tensors[..., 1 + k, :, :] = mass * (2 * d[..., k, None, None] * one - cross)
    for k, (i, j) in enumerate(ELEMENTS):
        tensors[..., 4 + k, i, j] = tensors[..., 4 + k, j, i] = 1.0
    return tensors
