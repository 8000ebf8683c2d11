"""A record of a motion beside the exact one: what does not agree, and which mistake explains it.

A record is the motion of a body when its attitudes turn with its angular velocity, and when its angular
momentum in space changes by the impulse of the load alone. A mistake of the writer breaks the first, one of
the program the second. Each is a change of the record, or a torque along it, and is judged by likelihood.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from polhode import _core
from polhode._format import one_line
from polhode._hints import check_kind
from polhode.errors import PolhodeError
from polhode.motion.rates import rates_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from polhode.motion.trajectory import Trajectory

    Floats = NDArray[np.float64]

__all__ = ["Audit", "Finding", "audit"]

_RTOL: Final = 1e-5
_LEAST: Final = 16
"""Rows without which nothing is judged."""
_GAIN: Final = 15.0
"""Least gain of log-likelihood for a finding: the alternative is e^15 times as likely."""
_FASTEST: Final = 1e5
"""The largest angle, in radians, by which a body may turn from row to row: it may be in degrees."""
_NOISIEST: Final = 0.3
"""Noise of attitudes, in radians, beyond which a record tells nothing."""
_OTHERWISE: Final = 0.25
"""Share of ω by which attitudes may turn otherwise where a mistake of the program is looked for."""
_OTHER_TENSORS: Final = ("diagonal tensor", "products of the other sign")
_NOISELESS: Final = 1e-9
"""Noise of attitudes, in radians, that is none."""
_EXPLAINED: Final = 0.05
"""Share of the squares that an alternative may leave unexplained."""
_CONJUGATE: Final = np.array([-1.0, -1.0, -1.0, 1.0])

KINDS: Final = {
    "scalar-first": (
        "the quaternions stand with the scalar first, (w, x, y, z)",
        "write them as (x, y, z, w): q[:, [1, 2, 3, 0]]",
    ),
    "inverse attitude": (
        "the attitudes lead from space to the body, R_BN",
        "invert them: R_NB is the transposed matrix, or the quaternion with -x, -y, -z",
    ),
    "space-axes omega": (
        "the components of the angular velocity refer to the axes of space",
        "turn them into the body: R^T omega",
    ),
    "degrees": ("the angular velocity is in degrees per unit of time", "multiply it by pi/180"),
    "clock": (
        "the times do not fit the turns from row to row",
        "write the time that the program has computed with, and each row once",
    ),
    "no gyroscopic term": (
        "the program computes I d(omega)/dt = N, without omega x I omega",
        "turn the gyroscopic term on, or keep I omega in space",
    ),
    "doubled gyroscopic term": (
        "the program has omega x I omega twice",
        "take it out of the torques that are applied",
    ),
    "diagonal tensor": (
        "the program has only the diagonal of the tensor",
        "give it the products of inertia, or principal axes with their moments",
    ),
    "products of the other sign": (
        "the program reads the products of inertia with the other sign",
        "negate Ixy, Ixz and Iyz: some take the elements of the tensor, some the positive products",
    ),
    "undeclared torque": (
        "a constant torque acts that is no part of the load",
        "find it, or declare it: load=",
    ),
    "undeclared damping": (
        "the angular velocity is damped",
        "set the angular damping of the program to zero, or declare it: loads.damping",
    ),
    "first-order step": (
        "the program takes steps of first order",
        "take smaller steps, or a method of higher order",
    ),
}
"""Kinds of findings: what is wrong, and what to do."""


@dataclass(frozen=True)
class Finding:
    """A mistake that explains what does not agree in a record.

    Attributes
    ----------
    kind : str
        One of ``"scalar-first"``, ``"inverse attitude"``, ``"space-axes omega"``, ``"degrees"``, ``"clock"``,
        ``"no gyroscopic term"``, ``"doubled gyroscopic term"``, ``"diagonal tensor"``, ``"products of the
        other sign"``, ``"undeclared torque"``, ``"undeclared damping"`` and ``"first-order step"``.
    evidence : dict of str and number
        ``before`` and ``after``: relative size of what does not agree in the record as it stands, and with
        this mistake taken into account. ``log_likelihood``: by how much the logarithm of the likelihood
        grows. Further numbers by the kind: ``torque`` with ``frame``, ``rate`` or ``coefficient`` of a
        damping, ``step``, ``rows`` and ``jumps`` of a clock, or its ``factor``.
    """

    kind: str
    evidence: dict[str, Any]

    @property
    def words(self) -> str:
        """What is wrong, and what to do."""
        fault, remedy = KINDS[self.kind]
        return f"{fault}; {remedy}"


@dataclass(frozen=True, eq=False, repr=False)
class Audit:
    """What an audit of a recorded motion has found.

    Attributes
    ----------
    t : numpy.ndarray, shape (T,)
        Times of the rows.
    energy_drift : numpy.ndarray, shape (T,)
        Energy minus that of the first row, relative to the latter. Where the load has no potential, the
        kinetic energy.
    angular_momentum_drift : numpy.ndarray, shape (T,)
        Length of the change of the angular momentum in space since the first row, less the impulse of the
        load, relative to the angular momentum of the first row.
    residual_torque : numpy.ndarray, shape (T, 3)
        ``I ω̇ + ω × I ω`` minus the torque of the load, about the point `about` of the trajectory, components
        in the body frame: the torque that would explain the record.
    angle_from_exact : numpy.ndarray, shape (T,)
        Angle in radians between the attitudes and those of the exact motion from the same start. Of a noisy
        record the noise of the first row grows in it.
    order : float or None
        Observed order of the method of the program, if a second record was given.
    findings : tuple of Finding
        Mistakes that explain what does not agree; none where the record agrees, or no mistake explains it.
    noise : dict of str and float
        Standard deviations of white noise: ``attitude`` in radians, and ``angular_momentum`` relative to it.
    agrees : bool
        Whether the record is the motion of this body: there are no findings, and neither the angular
        momentum nor the turns from row to row are off by more than the noise and `rtol`. False where the
        noise of the attitudes is more than 0.3 rad: they tell nothing then.
    """

    t: Floats
    energy_drift: Floats
    angular_momentum_drift: Floats
    residual_torque: Floats
    angle_from_exact: Floats
    order: float | None
    findings: tuple[Finding, ...]
    noise: dict[str, float]
    agrees: bool

    def __repr__(self) -> str:
        names = [finding.kind for finding in self.findings]
        return one_line(self, {"rows": len(self.t), "agrees": self.agrees, "findings": names})

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw drifts and the distance from the exact motion over time; needs matplotlib.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, optional
            Where to draw; a new figure by default.

        Returns
        -------
        matplotlib.axes.Axes
        """
        from polhode.draw.plot.audits import drifts

        return drifts(self, ax)


class _Record(NamedTuple):
    """Rows of a record: times, quaternions, angular velocities, and torques of the load in the body."""

    t: Floats
    quaternion: Floats
    omega: Floats
    torque: Floats

    def impulses(self, *torques: Floats) -> list[Floats]:
        """Integrate torques in the body along the attitudes, in space."""
        return _core.impulses(self.t, self.quaternion, list(torques))


def audit(
    trajectory: Trajectory,
    *,
    rtol: float | None = None,
    finer: Trajectory | None = None,
    ratio: float | None = None,
) -> Audit:
    """Compare a recorded motion with the exact one, and find the mistake that explains what does not agree.

    Parameters
    ----------
    trajectory : Trajectory
        The motion of one body, mostly from :meth:`polhode.Trajectory.from_samples`. Its load is what was
        declared to act.
    rtol : float, optional
        What is off by less, relative to the angular momentum and the angular velocity, counts as the error
        of the steps of the program; 1e-5 by default.
    finer : Trajectory, optional
        A second record from the same start to the same time with smaller steps; :attr:`Audit.order` is then
        the order of the method that both show.
    ratio : float, optional
        The steps of the first record divided by those of the finer one. By default that of the steps in time
        from row to row.

    Returns
    -------
    Audit

    Raises
    ------
    PolhodeError
        For fewer than 16 rows without NaN.

    Notes
    -----
    The noise of attitudes and angular momentum is estimated from what polynomials through neighbouring rows
    miss. A record is first read in other ways: quaternions with the scalar first, inverse attitudes, ω in the
    axes of space or in degrees, a clock that jumps. A reading is chosen if attitudes turn with ω only in it.
    Then the angular momentum in space is compared with that of each mistake of programs. A torque n along the
    record changes it by the integral of ``R n``: ``ω × I ω`` where the program leaves out the gyroscopic
    term, ``−c ω`` or ``−c I ω`` of a damping, the terms of second order in the step of Euler's method. A
    finding needs a likelihood at least e^15 times that of the record as it stands, and must explain all but
    5 percent of the squares, or all but the noise.

    Examples
    --------
    The program knows only the diagonal of the tensor:

    >>> import numpy as np
    >>> import polhode
    >>> from polhode import RigidBody, Trajectory
    >>> tensor = np.array([[2.0, 0.3, 0.1], [0.3, 3.0, -0.2], [0.1, -0.2, 4.0]])
    >>> t = np.linspace(0.0, 20.0, 1001)
    >>> made = RigidBody(1.0, np.diag(tensor.diagonal())).free_motion((0.3, 1.0, 0.2)).at(t)
    >>> record = Trajectory.from_samples(RigidBody(1.0, tensor), t, made.quaternion, made.omega)
    >>> found = polhode.audit(record)
    >>> [finding.kind for finding in found.findings], found.agrees
    (['diagonal tensor'], False)
    """
    check_kind(trajectory, "trajectory", "Trajectory")
    body = trajectory.body
    if body.shape:
        raise ValueError(
            f"trajectory: expected that of one body, got a stack of shape {body.shape}; take one"
        )
    trajectory._check_series("audit")
    trajectory._check_constant(
        "trajectory", "an audit knows the laws of a body that does not; compare momenta instead"
    )
    limit = _RTOL if rtol is None else float(_core.real_numbers(rtol, "rtol"))
    if not 0.0 < limit < 1.0:
        raise ValueError(f"rtol: expected a number between 0 and 1, got {rtol!r}")
    there = _known(trajectory)
    if there.sum() < _LEAST:
        raise PolhodeError(f"trajectory: needs at least {_LEAST} rows without NaN, got {int(there.sum())}")
    record = _record_of(trajectory, there)
    tensor = body.inertia_about(trajectory.about)
    units = _units(record, tensor)
    order = None if finer is None else _order(trajectory, finer, ratio)
    scaled = _Record(
        (record.t - record.t[0]) / units.time,
        record.quaternion,
        record.omega * units.time,
        record.torque * units.time**2 / units.inertia,
    )
    tensor = tensor / units.inertia
    reading = _Reading(scaled, tensor, limit, derived=trajectory._origin.derived)
    findings, agrees = reading.judge()
    momentum = reading.momentum_of(scaled)
    first = np.linalg.norm(momentum[0])
    drift = np.sqrt(_lengths(momentum - momentum[0]))
    noise = {"attitude": reading.noise, "angular_momentum": reading.noise_of_momentum}
    return Audit(
        t=trajectory.t,
        energy_drift=_energy_drift(trajectory, there),
        angular_momentum_drift=_whole(there, drift / first if first > 0.0 else drift),
        residual_torque=_whole(there, _residual(scaled, tensor) * units.inertia / units.time**2),
        angle_from_exact=_whole(there, _angles(trajectory, there)),
        order=order,
        findings=tuple(Finding(one.kind, _in_units(one.evidence, units)) for one in findings),
        noise=noise,
        agrees=agrees,
    )


class _Units(NamedTuple):
    """Units in which the numbers of a record are neither large nor small: powers of two."""

    time: float
    inertia: float


def _units(record: _Record, tensor: Floats) -> _Units:
    steps = np.diff(record.t)
    speed = float(np.abs(record.omega).max())
    if not speed * float(steps.max()) < _FASTEST:
        raise PolhodeError(
            f"trajectory: an angular velocity of {speed:.3g} turns the body by {speed * steps.max():.3g} rad "
            "from one row to the next; check its unit, or give more rows"
        )
    with np.errstate(divide="ignore"):
        time, inertia = (np.exp2(np.round(np.log2(x))) for x in (np.median(steps), np.abs(tensor).max()))
    if not 1e-140 < time < 1e140 or not 1e-140 < (inertia or 1.0) < 1e140:
        raise PolhodeError(
            f"trajectory: steps of {time:.3g} and moments of {inertia:.3g} are beyond what is computed; take "
            "units in which they are between 1e-140 and 1e140"
        )
    return _Units(float(time), float(inertia) or 1.0)


def _in_units(evidence: dict[str, Any], units: _Units) -> dict[str, Any]:
    """Return the numbers of a finding in the units of the record."""
    time, inertia = units
    sizes = {"torque": inertia / time**2, "coefficient": inertia / time, "rate": 1.0 / time}
    sizes |= {"step": time, "jumps": time}
    return {
        name: [size * one for one in value] if isinstance(value, list) else size * value
        for name, value in evidence.items()
        if (size := sizes.get(name)) is not None
    } | {name: value for name, value in evidence.items() if name not in sizes}


def _known(trajectory: Trajectory) -> NDArray[np.bool_]:
    """Return which rows have no NaN."""
    return np.asarray(np.isfinite(trajectory.quaternion).all(1) & np.isfinite(trajectory.omega).all(1))


def _whole(there: NDArray[np.bool_], values: Floats) -> Floats:
    if there.all():
        return values
    found = np.full((len(there), *values.shape[1:]), np.nan)
    found[there] = values
    return found


def _record_of(trajectory: Trajectory, there: NDArray[np.bool_]) -> _Record:
    """Return the rows without NaN."""
    rows = (trajectory.t, trajectory.quaternion, trajectory.omega, trajectory.torque())
    return _Record(*(rows if there.all() else (values[there] for values in rows)))


def _momentum(record: _Record, tensor: Floats) -> Floats:
    """Compute the angular momentum in space less the impulse of the load."""
    momentum = _core.rotate(record.quaternion, record.omega @ tensor)
    if record.torque.any():
        momentum -= record.impulses(record.torque)[0]
    return momentum


def _residual(record: _Record, tensor: Floats) -> Floats:
    """Compute the torque that the record needs besides the load, in the body."""
    noise = _core.white_noise(record.t, record.omega)
    sigma = noise if noise > _NOISELESS * float(np.abs(record.omega).max()) else None
    rate = rates_of(record.t, record.omega, 4 if sigma else None, sigma, turning=False)[0]
    return rate @ tensor + _cross(record.omega, record.omega @ tensor) - record.torque


def _energy_drift(trajectory: Trajectory, there: NDArray[np.bool_]) -> Floats:
    kinetic, potential = trajectory.kinetic_energy().total, trajectory._potential()
    energy = kinetic if potential is None else kinetic + potential
    first = energy[there.argmax()]
    size = abs(first) if potential is None else max(abs(first), float(kinetic[there].max()))
    drift: Floats = (energy - first) / size if size > 0.0 else energy - first
    return drift


def _angles(trajectory: Trajectory, there: NDArray[np.bool_]) -> Floats:
    """Compute the angles between the attitudes and those of the exact motion from the first row on."""
    t, quaternion, omega = (
        x if there.all() else x[there] for x in (trajectory.t, trajectory.quaternion, trajectory.omega)
    )
    about = trajectory._about_word()
    if trajectory.load is None and about == "center_of_mass":
        exact = trajectory.body.free_motion(omega[0], quaternion[0]).at(t - t[0]).quaternion
    else:
        place = {} if trajectory.pivoted else {"velocity": trajectory.velocity[there][0]}
        exact = trajectory.body.simulate(
            t,
            omega[0],
            quaternion[0],
            load=trajectory.load,
            about=about,
            position=trajectory.position[there][0],
            rtol=1e-12,
            **place,
        ).quaternion
    return _angle_between(exact, quaternion)


def _angle_between(a: Floats, b: Floats) -> Floats:
    sign = np.sign(np.einsum("ij,ij->i", a, b))[:, None]
    apart = np.sqrt(_lengths(a - sign * b))
    found: Floats = 4.0 * np.arcsin(np.minimum(0.5 * apart, 1.0))
    return found


def _order(trajectory: Trajectory, finer: Trajectory, ratio: float | None) -> float:
    """Compute the order of the method from how far two records are from the exact motion."""
    check_kind(finer, "finer", "Trajectory")
    steps = [float(np.median(np.diff(run.t))) for run in (trajectory, finer)]
    shrink = steps[0] / steps[1] if ratio is None else float(ratio)
    if not shrink > 1.0 + 1e-6:
        raise ValueError(
            f"finer: its rows are {1.0 / shrink:.6g} times as far apart in time as those of the first "
            "record; give ratio=, the steps of the program in the first record divided by those in the finer"
        )
    ends = []
    for run in (trajectory, finer):
        there = _known(run)
        ends.append((run.t[there][-1], _angles(run, there)[-1]))
    if abs(ends[0][0] - ends[1][0]) > 1e-9 * abs(ends[0][0]) + 1e-3 * steps[1]:
        raise ValueError(f"finer: it ends at t = {ends[1][0]}, and the first record at {ends[0][0]}; cut one")
    if not (ends[0][1] > 0.0 and ends[1][1] > 0.0):
        return float("nan")
    return float(np.log(ends[0][1] / ends[1][1]) / np.log(shrink))


# How the record is to be read -------------------------------------------------------------------------------


class _Reading:
    """The search for the mistake: first of the writer, then of the program."""

    def __init__(self, record: _Record, tensor: Floats, rtol: float, *, derived: bool) -> None:
        self.record, self.tensor, self.rtol = record, tensor, rtol
        self.noise = _core.white_noise(record.t, record.quaternion)
        self.noise_of_momentum = 0.0
        self._momentum: tuple[_Record, Floats] | None = None
        self.derived = derived
        self.rates, self.error = self._rates(record.t)

    def _rates(self, t: Floats) -> tuple[Floats, float]:
        """Compute the angular velocity of the attitudes, and the size of its error."""
        sigma = self.noise if self.noise > _NOISELESS else None
        rates, error = rates_of(t, self.record.quaternion, 4 if sigma else None, sigma, turning=True)
        return rates, float(np.median(error))

    def judge(self) -> tuple[list[Finding], bool]:
        """Return the findings, and whether the record is the motion of the body."""
        if not (self.record.omega.any() or self.rates.any()):
            return [], True
        if self.noise > _NOISIEST:
            return [], False
        findings = [*self._clock()]
        findings += self._readings()
        turns = self._misfit(self.record, self.rates)
        noise = self.error / max(_size(self.rates), 1e-300)
        agrees = turns < max(10.0 * self.rtol, 3.0 * noise) + 3.0 * self._noise_of_omega()
        if turns > _OTHERWISE + 3.0 * (noise + self._noise_of_omega()):
            return findings, False
        found, settled = self._mistakes()
        findings += found
        return findings, agrees and settled and not findings

    def momentum_of(self, record: _Record) -> Floats:
        """Compute the angular momentum of a record, once."""
        if self._momentum is None or self._momentum[0] is not record:
            self._momentum = record, _momentum(record, self.tensor)
        return self._momentum[1]

    def _noise_of_omega(self) -> float:
        size = _size(self.record.omega)
        noise = _core.white_noise(self.record.t, self.record.omega)
        return noise * 3.0**0.5 / size if size > 0.0 else 0.0

    def _misfit(self, record: _Record, rates: Floats) -> float:
        """Return how far attitudes turn otherwise than with ω, relative to both."""
        least = len(record.t) - max(len(record.t) // 10, 1)
        off = np.partition(_lengths(rates - record.omega), least)[:least]
        size = max(_size(rates), _size(record.omega))
        return float(np.sqrt(off.mean())) / size if size > 0.0 else 0.0

    def _clock(self) -> Iterator[Finding]:
        """Find rows at which the clock jumps, and set it right."""
        record = self.record
        widths = np.diff(record.t)
        turns = _angle_between(record.quaternion[:-1], record.quaternion[1:])
        speed = np.sqrt(_lengths(record.omega))
        expected = 0.5 * (speed[1:] + speed[:-1])
        if self.derived:
            expected = _running_median(turns / widths)
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.where(expected > 0.0, turns / (expected * widths), np.nan)
        if not (expected > 0.0).any() or not (usual := np.nanmedian(ratio)) > 0.0:
            return
        off = np.abs(ratio / usual - 1.0)
        spread = 1.4826 * np.nanmedian(off)
        far = off > max(10.0 * spread, 0.05)
        rows = np.flatnonzero(far)
        if not 0 < len(rows) <= max(len(widths) // 20, 1):
            return
        right = widths.copy()
        right[rows] = turns[rows] / (expected[rows] * usual)
        jumps = widths[rows] - right[rows]
        t = record.t[0] + np.concatenate(([0.0], np.cumsum(right)))
        if not (right > 0.0).all():
            return
        sigma = max(spread, 1e-12)
        evidence = {
            "rows": (rows + 1).tolist(),
            "jumps": jumps.tolist(),
            "before": float(off[rows].max()),
            "after": float(spread),
            "log_likelihood": float(0.5 * ((off[rows] / sigma) ** 2).sum()),
        }
        self.record = record._replace(t=t)
        self.rates, self.error = self._rates(t)
        if self.derived:
            self.record = self.record._replace(omega=self.rates)
        yield Finding("clock", evidence)

    def _readings(self) -> list[Finding]:
        """Find in which reading the attitudes turn with ω."""
        return self._by_momentum() if self.derived else self._by_turns()

    def _by_turns(self) -> list[Finding]:
        stated = self._misfit(self.record, self.rates)
        floor = max(self.rtol, 3.0 * self.error / max(_size(self.rates), 1e-300))
        if stated < floor:
            return []
        best: tuple[float, int, tuple[str, ...], _Record, Floats] | None = None
        for names, quaternion, rates in self._attitudes():
            for more, omega in self._omegas(quaternion):
                record = self.record._replace(quaternion=quaternion, omega=omega)
                kinds = names + more
                misfit = self._misfit(record, rates)
                if best is None or misfit < 0.8 * best[0]:
                    best = (misfit, len(kinds), kinds, record, rates)
        assert best is not None
        kinds = best[2]
        if not kinds or best[0] ** 2 > _EXPLAINED * stated**2:
            return self._scaled(stated)
        self.record, self.rates = best[3], best[4]
        gain = 1.5 * len(self.record.t) * np.log(stated / max(best[0], 1e-15))
        return [
            Finding(kind, {"before": stated, "after": best[0], "log_likelihood": float(gain)})
            for kind in kinds
        ]

    def _scaled(self, stated: float) -> list[Finding]:
        """Find a clock that is fast or slow all the time."""
        omega, rates = self.record.omega, self.rates
        size = (omega * omega).sum()
        factor = float((rates * omega).sum() / size) if size > 0.0 else 1.0
        left = self._misfit(self.record._replace(omega=factor * omega), rates)
        floor = max(100.0 * self.rtol, 3.0 * self.error / max(_size(rates), 1e-300))
        if not factor > 0.0 or stated < floor or left**2 > 0.2 * _EXPLAINED * stated**2:
            return []
        self.record = self.record._replace(t=self.record.t[0] + factor * (self.record.t - self.record.t[0]))
        self.rates = rates / factor
        gain = 1.5 * len(self.record.t) * np.log(stated / max(left, 1e-15))
        evidence = {"factor": factor, "before": stated, "after": left, "log_likelihood": float(gain)}
        return [Finding("clock", evidence)]

    def _attitudes(self) -> Iterator[tuple[tuple[str, ...], Floats, Floats]]:
        """Yield attitudes as they stand, inverted, and with the scalar first, with the rates of each."""
        q = self.record.quaternion
        yield (), q, self.rates
        yield ("inverse attitude",), q * _CONJUGATE, -_core.rotate(q, self.rates)
        other = q[:, [1, 2, 3, 0]]
        sigma = self.noise if self.noise > _NOISELESS else None
        rates = rates_of(self.record.t, other, 4 if sigma else None, sigma, turning=True)[0]
        yield ("scalar-first",), other, rates
        yield ("scalar-first", "inverse attitude"), other * _CONJUGATE, -_core.rotate(other, rates)

    def _omegas(self, quaternion: Floats) -> Iterator[tuple[tuple[str, ...], Floats]]:
        """Yield ω as it stands, in degrees, and in the axes of space."""
        omega = self.record.omega
        yield (), omega
        yield ("degrees",), np.deg2rad(omega)
        turned = _core.rotate(quaternion, omega, inverse=True)
        yield ("space-axes omega",), turned
        yield ("space-axes omega", "degrees"), np.deg2rad(turned)

    def _by_momentum(self) -> list[Finding]:
        """Find the reading of attitudes alone in which the angular momentum is kept."""
        found = []
        for names, quaternion, rates in self._attitudes():
            record = self.record._replace(quaternion=quaternion, omega=rates)
            momentum = _momentum(record, self.tensor)
            off = _size(_centred(momentum)) / max(_size(momentum), 1e-300)
            found.append((off, names, record))
        stated = found[0][0]
        best = min(found, key=lambda one: one[0] * 1.2 ** len(one[1]))
        self.record = self.record._replace(omega=self.rates)
        if not best[1] or stated < 10.0 * self.rtol or best[0] ** 2 > 0.1 * _EXPLAINED * stated**2:
            return []
        momentum = _momentum(self.record, self.tensor)
        left = min(one.squares for one in self._alternatives(momentum) if one.possible)
        if left < best[0] ** 2 * _size(momentum) ** 2 * len(self.record.t):  # a mistake of the program
            return []
        self.record, self.rates = best[2], best[2].omega
        gain = 1.5 * len(self.record.t) * np.log(stated / max(best[0], 1e-15))
        return [
            Finding(kind, {"before": stated, "after": best[0], "log_likelihood": float(gain)})
            for kind in best[1]
        ]

    # Mistakes of programs ---------------------------------------------------------------------------------

    def _mistakes(self) -> tuple[list[Finding], bool]:
        """Find the mistake that explains how the angular momentum changes; and whether it is kept."""
        record, momentum = self.record, self.momentum_of(self.record)
        length = max(_size(momentum), 1e-300)
        sigma = _core.white_noise(record.t, momentum)
        self.noise_of_momentum = sigma / length
        count = 3.0 * (len(record.t) - 1)
        stated = _squares(momentum)
        structure = np.sqrt(max(stated / count - sigma**2, 0.0) * 3.0) / length
        doubt = 3.0 * self.error / max(_size(self.rates), 1e-300) if self.derived else 0.0
        if structure < max(self.rtol, 0.1 * self.noise_of_momentum, doubt):
            return self._step_in_turns()
        tried = [*self._alternatives(momentum)]
        least = min(one.squares for one in tried)
        floor = max(sigma**2, least / count, (1e-3 * self.rtol * length) ** 2)
        best: _Alternative | None = None
        for one in tried:
            allowed = max(1.3 * sigma**2 * count, _EXPLAINED * stated)
            gain = 0.5 * (stated - one.squares) / floor - 0.5 * one.parameters * np.log(count)
            if one.squares > allowed or not one.possible or gain < _GAIN:
                continue
            if one.kind in _OTHER_TENSORS and stated < 1.5 * sigma**2 * count:
                continue  # the noise of another tensor is another one, and known to some percent only
            # The impulse of ω × I ω has noise of its own: within the noise, no fitted number is better.
            is_as_good = not one.parameters and one.squares < 1.3 * floor * count
            squares = min(one.squares, least) if is_as_good else one.squares
            score = 0.5 * squares / floor + 0.5 * one.parameters * np.log(count)
            if best is None or score < best.score:
                best = one._replace(score=score, gain=gain)
        if best is None:
            if structure < max(10.0 * self.rtol, 3.0 * self.noise_of_momentum, 3.0 * doubt):
                return self._step_in_turns()
            return [], False
        evidence = best.evidence | {
            "before": float(np.sqrt(3.0 * stated / count) / length),
            "after": float(np.sqrt(3.0 * best.squares / count) / length),
            "log_likelihood": float(best.gain),
        }
        return [Finding(best.kind, evidence)], False

    def _step_in_turns(self) -> tuple[list[Finding], bool]:
        """Find a program that keeps the angular momentum and turns the body by steps of first order."""
        if self.derived:
            return [], True
        rate = self._euler(self.record.omega)
        off = self.rates - self.record.omega
        if not _size(rate) > 0.0:
            return [], True
        parts = zip(np.array_split(off, 20), np.array_split(rate, 20), strict=True)
        each = np.array([np.vdot(a, b) / size for a, b in parts if (size := np.vdot(b, b)) > 0.0])
        late, spread = float(each.mean()), float(each.std(ddof=1) / np.sqrt(len(each)))
        shift = abs(late) * _size(rate)
        before, after = _size(off), _size(off - late * rate)
        small = max(
            self.rtol * _size(self.record.omega), 3.0 * self.error if self.noise < _NOISELESS else 0.0
        )
        explained = after**2 < 0.2 * before**2 or after < 2.0 * self.error
        step = 2.0 * abs(late)
        if shift < small or abs(late) < 6.0 * spread or not explained or step > 2.0 * self._width():
            return [], True
        gain = 1.5 * len(rate) * np.log(before / max(after, 1e-300))
        speed = _size(self.record.omega)
        evidence = {
            "step": step,
            "before": before / speed,
            "after": after / speed,
            "log_likelihood": float(gain),
        }
        return [Finding("first-order step", evidence)], False

    def _width(self) -> float:
        return float(np.median(np.diff(self.record.t)))

    def _euler(self, omega: Floats) -> Floats:
        """Compute ω̇ by Euler's equations."""
        right = self.record.torque - _cross(omega, omega @ self.tensor)
        found: Floats = right @ np.linalg.pinv(self.tensor)
        return found

    def _alternatives(self, momentum: Floats) -> Iterator[_Alternative]:
        """Yield every mistake with the squares that it leaves of the angular momentum."""
        record, tensor = self.record, self.tensor
        omega = record.omega
        spin = omega @ tensor
        rate = self._euler(omega)
        lag = _cross(rate, spin)
        along = [np.broadcast_to(axis, omega.shape) for axis in np.eye(3)]
        gyroscopic, *in_body, damped, by_omega, late, step = record.impulses(
            _cross(omega, spin), *along, -spin, -omega, lag, 0.5 * (lag + _cross(omega, rate @ tensor))
        )
        yield _Alternative("no gyroscopic term", _squares(momentum - gyroscopic))
        yield _Alternative("doubled gyroscopic term", _squares(momentum + gyroscopic))
        diagonal = np.diag(tensor.diagonal())
        if np.abs(tensor - diagonal).max() > 1e-9 * np.abs(tensor).max():
            sigma = _core.white_noise(record.t, momentum)
            for kind, other in (
                ("diagonal tensor", diagonal),
                ("products of the other sign", 2 * diagonal - tensor),
            ):
                kept = _momentum(record, other)  # noise of ω has another size in it
                own = _core.white_noise(record.t, kept)
                yield _Alternative(kind, _squares(kept) * ((sigma / own) ** 2 if own > 0.0 else 1.0))
        passed = (record.t - record.t[0])[:, None]
        for frame, impulses in (("body", in_body), ("space", [axis * passed for axis in np.eye(3)])):
            left, found = _fit(momentum, impulses)
            yield _Alternative(
                "undeclared torque", left, 3, evidence={"torque": found.tolist(), "frame": frame}
            )
        for name, impulse in (("rate", damped), ("coefficient", by_omega)):
            left, found = _fit(momentum, [impulse])
            yield _Alternative(
                "undeclared damping", left, 1, evidence={name: found[0]}, possible=found[0] > 0.0
            )
        # The lag of the attitudes behind ω, and the terms of second order of Euler's method.
        left, found = _fit(momentum, [late, step])
        size = max(abs(found[1]), 2.0 * abs(found[0]))
        yield _Alternative(
            "first-order step", left, 2, evidence={"step": size}, possible=size < 2.0 * self._width()
        )


class _Alternative(NamedTuple):
    """A mistake: the squares that it leaves, its fitted numbers, whether these are possible."""

    kind: str
    squares: float
    parameters: int = 0
    evidence: dict[str, Any] = {}  # noqa: RUF012  # never changed
    possible: bool = True
    score: float = np.inf
    gain: float = 0.0


def _cross(a: Floats, b: Floats) -> Floats:
    x, y, z = range(3)
    found = np.empty_like(a)
    for k, (i, j) in enumerate(((y, z), (z, x), (x, y))):
        np.subtract(a[:, i] * b[:, j], a[:, j] * b[:, i], out=found[:, k])
    return found


def _lengths(vectors: Floats) -> Floats:
    """Return the squares of the lengths."""
    found: Floats = np.einsum("ij,ij->i", vectors, vectors)
    return found


def _size(vectors: Floats) -> float:
    """Return the root of the mean square of the lengths."""
    return float(np.sqrt(np.vdot(vectors, vectors) / len(vectors)))


def _centred(vectors: Floats) -> Floats:
    found: Floats = vectors - vectors.mean(0)
    return found


def _squares(vectors: Floats) -> float:
    """Sum the squares of the distances from the mean."""
    off = _centred(vectors)
    return float(np.vdot(off, off))


def _fit(momentum: Floats, impulses: list[Floats]) -> tuple[float, Any]:
    """Fit multiples of impulses and a constant to the momentum: what is left, squared, and the multiples."""
    columns = np.stack([_centred(one).ravel() for one in (*impulses, momentum)], axis=1)
    factor: Any = np.linalg.qr(columns, mode="r")
    found = np.linalg.lstsq(factor[:-1, :-1], factor[:-1, -1], rcond=1e-12)[0]
    left = columns[:, -1] - columns[:, :-1] @ found
    return float(left @ left), found


def _running_median(values: Floats, half: int = 5) -> Floats:
    """Return the median of each value and its neighbours."""
    padded = np.pad(values, half, mode="reflect")
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * half + 1)
    return np.asarray(np.median(windows, axis=1))
