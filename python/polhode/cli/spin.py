"""``polhode spin``: the motion of a free body, a body with wheels or a heavy top."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal, TypeAlias

import numpy as np

from polhode import RigidBody, Uncertain, _core
from polhode._format import at_most
from polhode._optional import require
from polhode.animation import ANIMATION_SUFFIXES, animate_motion
from polhode.cli.files import STDIN, check_suffixes, label
from polhode.cli.layout import Cell, Column, Field, Report, Table
from polhode.cli.loading import LoadedBody
from polhode.cli.options import MODES
from polhode.cli.tables import note_linear, sigmas_of, top_fields
from polhode.cli.terminal import printable, progress
from polhode.cli.whole import (
    any_body,
    check_moments_alone,
    check_source,
    check_weight,
    mass_and_center,
    source_of,
)
from polhode.draw.pivot import path_of
from polhode.draw.sampling import TURN, fastest, motion_times, turns
from polhode.draw.triangles import cluster_vertices
from polhode.errors import PolhodeError
from polhode.euler_angles import to_quaternion
from polhode.io.saved import TRAJECTORY_SUFFIXES
from polhode.io.writing import save_picture
from polhode.motion.invariants import drift, lengths
from polhode.uncertainty.motion import each_motion
from polhode.units import amounts, has_unit, quantity, vector

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from polhode import FreeMotion, GyrostatMotion, HeavyTop, Trajectory
    from polhode.cli.options import BodyOptions, SpinOptions
    from polhode.cli.tables import Sigmas

    Floats = NDArray[np.float64]
    Part: TypeAlias = tuple[NDArray[np.float64], NDArray[np.int64]]

__all__ = [
    "DRAWN",
    "FreeKind",
    "GyrostatKind",
    "TopKind",
    "attitude_field",
    "drawable",
    "momentum_inside",
    "of_end",
    "of_shape",
    "of_start",
    "period_fields",
    "save",
    "spin_report",
]


def spin_report(file: Path | None, spin: SpinOptions, options: BodyOptions) -> Report:
    """Compute the motion of a body, save it as asked for and report on it."""
    end = _check_options(file, spin, options)
    loaded = _body(file, spin, options)
    body = loaded.body
    axes = body.principal.axes if spin.axes == "principal" else np.eye(3)
    motion: FreeMotion | HeavyTop | GyrostatMotion
    kind: FreeKind | TopKind | GyrostatKind
    if spin.wheel:
        motion = _gyrostat_motion(loaded, axes, spin)
        kind = GyrostatKind(motion, axes)
    elif spin.gravity is None:
        motion = _free_motion(body, axes, spin)
        kind = FreeKind(motion)
    else:
        motion = _heavy_top(body, axes, spin)
        kind = TopKind(motion)
    report = Report()
    report.section(
        "",
        Field("file", "file", source_of(file, spin.moments)),
        Field("axes", "components", _axes_text(spin)),
    )
    rate, rate_unit = (180.0 / np.pi, "deg/s") if spin.degrees else (1.0, "rad/s")
    report.section(
        "body",
        Field("mass", "mass", body.mass, loaded.mass_unit, **sigmas_of(body, "mass")),
        Field(
            "principal_moments",
            "I1 I2 I3",
            body.principal_moments,
            loaded.moment_unit,
            **sigmas_of(body, "principal_moments"),
        ),
        *top_fields(loaded),
    )
    report.section(
        "motion",
        Field(
            "omega_start",
            "omega, start",
            motion.omega @ axes * rate,
            rate_unit,
            **of_start(motion, axes, rate),
        ),
        *kind.fields(rate, rate_unit),
    )
    if isinstance(kind, FreeKind):
        curve = kind.light_curve()
        if curve:
            is_tumbling = len(curve) > 1
            words = "short-axis convention and frequencies" if is_tumbling else "frequencies"
            report.section(f"light curve, {words}", *curve)
        else:
            report.notes.append("no frequencies of a light curve: the motion never repeats")
    report.section("conserved", *kind.constants(loaded.moment_unit))
    report.section("stability", *kind.stability())
    report.notes += _notes(loaded)
    note_linear(report)
    if end is None:
        return report
    _check_end(motion, end)
    trajectory = motion.at(np.linspace(0.0, end, spin.times))
    angles = np.rad2deg(trajectory.euler_angles("ZXZ", singular="nan")[-1])
    report.section(
        "at the end",
        Field("time", "end", end, "s"),
        Field(
            "omega_end",
            "omega, end",
            trajectory.omega[-1] @ axes * rate,
            rate_unit,
            **of_end(motion, end, axes, rate),
        ),
        *attitude_field(motion, end),
        Field("euler_angles_end", "Euler angles, end", angles, "deg", "ZXZ phi, theta, psi"),
        *kind.drifts(trajectory),
    )
    if np.isnan(angles).any():
        report.notes.append("at the end theta is 0 or 180 deg, where phi and psi are not defined one by one")
    if not spin.save:
        return report
    part, note = drawable(loaded, options)
    report.notes += [note] if note else []
    title = "" if file is None else printable(Path(label(file)).name)
    for path in spin.save:
        saved = save(motion, trajectory, path, spin, title=title, part=part)
        report.notes.append(f"saved {path}")
        report.notes += [f"{path.name}: {note}" for note in saved]
    return report


def _check_options(file: Path | None, spin: SpinOptions, options: BodyOptions) -> float | None:
    """Refuse wrong options before anything is computed; give the time of the end."""
    check_source("spin", file, spin.moments, options)
    if file is not None and file != STDIN:
        file.stat()  # a wrong path is told before a start that is missing
    if bool(spin.omega) == bool(spin.periods):
        both = "give one of the two" if spin.omega else 'state the start, as in --omega "10 20 30 deg/s"'
        raise PolhodeError(f"--omega and --periods: {both}")
    if spin.periods and spin.attitude:
        raise PolhodeError("--attitude: --periods starts with the angular momentum along z; leave it out")
    if spin.periods and spin.gravity is not None:
        raise PolhodeError("--gravity: --periods are those of a free body; start a top with --omega")
    if spin.wheel and spin.periods:
        raise PolhodeError(
            "--wheel: --periods are those of a body without wheels; state the start by --omega"
        )
    if spin.wheel and spin.gravity is not None:
        raise PolhodeError(
            "--wheel: the motion of a top with a wheel is not known in closed form; leave out --gravity, or "
            "integrate with RigidBody.simulate and loads.rotor in Python"
        )
    if spin.periods and spin.mode is None:
        raise PolhodeError(f"--mode: {MODES}")
    if spin.mode is not None and not spin.periods:
        raise PolhodeError("--mode: it is for --periods alone; leave it out")
    if spin.save and spin.end is None:
        raise PolhodeError('--save: state the time of the end with --end, as in "20 s"')
    if spin.times < 2:
        raise PolhodeError(f"--times: {spin.times} is less than 2, the start and the end; give 2 or more")
    check_suffixes(spin.save, _SUFFIXES)
    if spin.end is None:
        return None
    end = quantity(spin.end, "s", "--end")
    if end == 0.0:
        raise PolhodeError(f"--end: expected a time other than 0, got {end:g}")
    return end


def _check_end(motion: FreeMotion | HeavyTop | GyrostatMotion, end: float) -> None:
    """Refuse a time after so many turns that the last digit of the angular velocity is a turn or more."""
    rate = fastest(motion)
    digit = rate * np.finfo(float).eps
    if not digit * abs(end) < 1.0:
        raise PolhodeError(
            f"--end: after {end:g} s at {rate:.4g} rad/s the last digit of the angular velocity turns "
            f"the body by {digit * abs(end):.2g} rad, and its attitude is not known; end before "
            f"{at_most(1.0 / digit, 2)} s"
        )


def _body(file: Path | None, spin: SpinOptions, options: BodyOptions) -> LoadedBody:
    """Read the body, or make it from the moments that were typed."""
    if not spin.moments:
        return any_body(file, options, with_shape=any(path.suffix.lower() in DRAWN for path in spin.save))
    check_moments_alone(options, "mass", "center_of_mass")
    check_weight(spin.gravity, options)
    moments = amounts(spin.moments, 3, "kg m^2", "--moments")
    mass, center = mass_and_center(options)
    body = RigidBody.from_principal(mass, moments, center_of_mass=center)
    return LoadedBody(body=body, source=[], mass_unit="kg", length="m")


def _omega(axes: Floats, spin: SpinOptions) -> Floats | Uncertain:
    """Read the angular velocity at the start; its components are known independently of one another."""
    is_bare = not any(c.isalpha() for word in spin.omega for c in word)
    unit = "deg/s" if spin.degrees and is_bare else "rad/s"
    given = amounts(spin.omega, 3, unit, "--omega")
    both = [(part.value, part.sigma) if isinstance(part, Uncertain) else (part, 0.0) for part in given]
    values, sigma = np.array(both).T
    omega: Floats = axes @ values
    if unit == "deg/s":
        omega, sigma = np.radians(omega), np.radians(sigma)
    if not sigma.any():
        return omega
    covariance = (axes * sigma**2) @ axes.T
    return Uncertain(omega, covariance=0.5 * (covariance + covariance.T))


def _attitude(spin: SpinOptions) -> Floats | None:
    return to_quaternion(vector(spin.attitude, "rad", "--attitude")) if spin.attitude else None


def _free_motion(body: RigidBody, axes: Floats, spin: SpinOptions) -> FreeMotion:
    if not spin.periods:
        return body.free_motion(_omega(axes, spin), _attitude(spin))
    rotation, precession = amounts(spin.periods, 2, "s", "--periods")
    assert spin.mode is not None
    return body.free_motion_from_periods(rotation, precession, mode=spin.mode)


def _gyrostat_motion(loaded: LoadedBody, axes: Floats, spin: SpinOptions) -> GyrostatMotion:
    inside = momentum_inside(spin.wheel, axes, loaded)
    omega = _omega(axes, spin)
    if isinstance(omega, Uncertain):
        raise PolhodeError(
            "--omega: its sigma is not followed through the motion of a body with wheels; write the numbers "
            "alone, or leave out --wheel"
        )
    least = float(loaded.body.principal_moments[0])
    if not least > 0.0:
        raise PolhodeError(
            f"--wheel: all principal moments must be positive, got {least:g}: the momentum inside would turn "
            "the body infinitely fast; leave out --wheel"
        )
    return loaded.body.gyrostat(inside).free_motion(omega, _attitude(spin))


def _heavy_top(body: RigidBody, axes: Floats, spin: SpinOptions) -> HeavyTop:
    g = quantity(spin.gravity or "", "m/s^2", "--gravity")
    return body.heavy_top(_omega(axes, spin), _attitude(spin), (0.0, 0.0, -g))


def _axes_text(spin: SpinOptions) -> str:
    if spin.moments or spin.axes == "principal":
        return "along the principal axes e1 e2 e3"
    return "along the file's axes x y z"


def _notes(loaded: LoadedBody) -> list[str]:
    notes = list(loaded.notes)
    if loaded.length == "unit":
        notes.append("unit unknown: mass and moments are in the file's own unit of length")
    if loaded.assumed:
        notes.append(
            "neither density nor mass was given: density 1 was used; the motion does not depend on it"
        )
    return notes


ROUNDING: Final = 1e-12
"""Of the largest component of omega: less is what rounding of the axes leaves."""


class FreeKind:
    """A body on which nothing acts."""

    def __init__(self, motion: FreeMotion) -> None:
        self._motion = motion

    def fields(self, rate: float, rate_unit: str) -> list[Field]:
        """Return the mode, the periods and the angles from L."""
        motion = self._motion
        angles, periods = np.rad2deg(motion.nutation), motion.periods
        of_angles = of_shape(motion)
        return [
            Field("mode", "mode", str(motion.mode)),
            *self._periods(),
            Field(
                "mean_precession",
                "mean precession",
                periods.rates * rate,
                rate_unit,
                "of e1 e2 e3 about L",
                **self._sigmas("rates", rate),
            ),
            *(
                Field(
                    f"angle_from_L.e{k + 1}",
                    f"e{k + 1} from L",
                    angles[k],
                    "deg",
                    "least, greatest",
                    **of_angles(f"nutation {k}"),
                )
                for k in range(3)
            ),
            Field(
                "energy_ratio",
                "E / E_min",
                motion.energy_ratio,
                hint="1 for a spin about e3",
                **of_angles("energy_ratio"),
            ),
            Field("modulus", "elliptic modulus", motion.modulus, **of_angles("modulus")),
        ]

    def _sigmas(self, name: str, factor: float = 1.0) -> Sigmas:
        found = self._motion.periods.sigma
        if found is None:
            return {}
        return {"sigma": factor * getattr(found, name), "linear": getattr(found.linear, name)}

    def _periods(self) -> list[Field]:
        """Return the periods that this mode has, by the words of the glossary."""
        motion, periods, told = self._motion, self._motion.periods, self._sigmas
        mode = str(motion.mode)
        if not np.isnan(periods.turn):
            along = np.abs(motion.omega @ motion.body.principal.axes)
            is_along = mode != "spherical" and np.count_nonzero(along > ROUNDING * along.max()) == 1
            axis = f"e{int(np.argmax(along)) + 1}" if is_along else "an axis at rest in the body"
            if not np.isfinite(periods.turn):
                return [Field("turn_period", "one turn", periods.turn, "s", "the body is at rest")]
            return [
                *period_fields("turn_period", "one turn", periods.turn, f"about {axis}", told("turn")),
                *self._wobble(),
            ]
        if mode == "symmetric":
            axis = f"e{int(motion.cones.axis) + 1}"
            return [
                *period_fields(
                    "spin_period",
                    "spin period",
                    periods.spin,
                    f"about {axis}, relative to the plane of {axis} and L",
                    told("spin"),
                ),
                *period_fields(
                    "precession_period",
                    "precession period",
                    periods.precession,
                    f"of {axis} about L",
                    told("precession"),
                ),
            ]
        hints = {
            "long-axis": "P_psi, of the rotation about e1",
            "short-axis": "P_psi, of the swing of e1 to and fro",
            "separatrix": "P_psi: omega never returns",
        }
        flips = "the intermediate axis turns over" + (", once" if mode == "separatrix" else "")
        return [
            *period_fields(
                "rotation_period", "rotation period", periods.rotation, hints[mode], told("rotation")
            ),
            *period_fields(
                "precession_period",
                "precession period",
                periods.precession,
                "P_phi, mean, of e1 about L",
                told("precession"),
            ),
            *(
                []
                if np.isnan(periods.flip)
                else period_fields("flip_period", "flips every", periods.flip, flips, told("flip"))
            ),
        ]

    def _wobble(self) -> list[Field]:
        motion, wobble = self._motion, self._motion.periods.wobble
        hint = "of small oscillations of omega in the body"
        if not np.isnan(wobble):
            return period_fields("wobble_period", "wobble", wobble, hint, self._sigmas("wobble"))
        is_unstable = str(motion.mode) == "steady"
        why = "the spin is unstable" if is_unstable else "omega rests wherever it is put in the body"
        return [Field("wobble_period", "wobble", None, hint=why, cells=["none"])]

    def light_curve(self) -> list[Field | Table]:
        """Return the frequencies of the light curve, and periods of a tumbling body in the other convention.

        Returns
        -------
        list of Field and Table
            Empty for a motion that never repeats.
        """
        periods = self._motion.periods
        found = periods.light_curve()
        is_known = found.frequency > 0.0
        if not is_known.any():
            return []
        # Spins of a laboratory in seconds, those of asteroids in hours; the JSON has hours.
        is_slow = float(found.frequency[is_known].min()) < 1.0 / 3600.0
        columns = [
            Column("frequency", "frequency", "1/d", shown="" if is_slow else "1/s"),
            Column("period", "period", "h", shown="" if is_slow else "s"),
        ]
        per = (86400.0, 3600.0) if is_slow else (1.0, 1.0)
        order = np.argsort(found.frequency)
        rows = []
        for k, f in zip(order.tolist(), found.frequency[order].tolist(), strict=True):
            if f > 0.0:
                numbers = {
                    "frequency": (86400.0 * f, per[0] * f),
                    "period": (1.0 / (3600.0 * f), 1.0 / (per[1] * f)),
                }
                cells = {name: Cell(f"{shown:.4g}", value) for name, (value, shown) in numbers.items()}
                rows.append({"j": int(found.j[k]), "m": int(found.m[k]), **cells})
        if not np.isnan(periods.turn):
            return [Table("light_curve", [Column("j", "j / turn"), *columns], rows)]
        if not np.isnan(periods.spin):
            of_spin = [Column("j", "j / precession"), Column("m", "+ m / spin"), *columns]
            return [Table("light_curve", of_spin, rows)]
        swings = "swinging" if self._motion.mode == "long-axis" else "rotation"
        return [
            *period_fields(
                "short_axis.rotation_period", "P_psi, short axis", periods.rotation, f"{swings}, about e3", {}
            ),
            *period_fields(
                "short_axis.precession_period",
                "P_phi, short axis",
                periods.precession_short_axis,
                "mean, of e3 about L",
                {},
            ),
            Table("light_curve", [Column("j", "j f_phi"), Column("m", "+ m f_psi"), *columns], rows),
        ]

    def constants(self, moment_unit: str) -> list[Field]:
        """Return what is conserved: the energy and the angular momentum."""
        motion, unit = self._motion, f"{moment_unit}/s"
        momentum = motion.angular_momentum().spin
        size = float(lengths(momentum))
        energy = motion.kinetic_energy().rotational
        return [
            Field("kinetic_energy", "kinetic energy", energy, f"{moment_unit}/s^2"),
            Field("angular_momentum", "|L|", size, unit),
            Field("angular_momentum_vector", "L, in space", momentum, unit, scale=size),
        ]

    def stability(self) -> list[Field]:
        """Return whether steady spins with this angular momentum are stable."""
        squares = self._motion.stability()
        words = ["stable" if x > 0 else "unstable" if x < 0 else "neutral" for x in squares]
        words = ["undefined" if np.isnan(x) else word for x, word in zip(squares, words, strict=True)]
        return [
            Field("stability", "spin about e1 e2 e3", ", ".join(words)),
            Field(
                "stability_frequency_squared", "frequency^2", squares, "1/s^2", "of oscillations in the body"
            ),
        ]

    def drifts(self, trajectory: Trajectory) -> list[Field]:
        """Describe how well the trajectory keeps what is conserved."""
        energy = trajectory.kinetic_energy().total
        momentum = trajectory.angular_momentum().total
        hint = "largest, relative; the vector in space"
        return [
            Field(
                "kinetic_energy_drift",
                "drift of energy",
                drift(energy, np.abs(energy)),
                hint="largest, relative",
            ),
            Field("angular_momentum_drift", "drift of L", drift(momentum, lengths(momentum)), hint=hint),
        ]


class TopKind:
    """A symmetric top under gravity, its origin fixed."""

    def __init__(self, motion: HeavyTop) -> None:
        self._motion = motion

    def fields(self, rate: float, rate_unit: str) -> list[Field]:
        """Describe how the axis nods and goes round."""
        motion = self._motion
        limits = np.rad2deg(motion.nutation_limits)
        return [
            Field("path", "path of the axis", path_of(motion)),
            Field("nutation_limits", "axis from vertical", limits, "deg", "least, greatest"),
            *self._periods(),
            Field(
                "mean_precession", "mean precession", motion.mean_precession * rate, rate_unit, "mean of phi'"
            ),
            Field("mean_spin", "mean spin", motion.mean_spin * rate, rate_unit, "mean of psi'"),
            Field("axial_spin", "omega along axis", motion.axial_spin * rate, rate_unit),
            Field(
                "sleeping_limit", "sleeping limit", motion.sleeping_limit * rate, rate_unit, "least, upright"
            ),
        ]

    def _periods(self) -> list[Field]:
        """Return the periods that this path has, by the words of the glossary."""
        motion = self._motion
        period, why = motion.nutation_period, "the inclination of the axis is constant"
        if not np.isnan(period):
            hint = "" if np.isfinite(period) else "the axis never returns"
            return period_fields("nutation_period", "nutation period", period, hint, {})
        fields = [Field("nutation_period", "nutation period", None, hint=why, cells=["none"])]
        speed = float(lengths(motion.omega))
        if str(motion.mode) != "steady" or speed == 0.0:
            return fields
        return [*period_fields("turn_period", "one turn", 2.0 * np.pi / speed, "about the axis", {}), *fields]

    def constants(self, moment_unit: str) -> list[Field]:
        """Return what is conserved: the energy and the angular momentum about the vertical."""
        start = self._motion.at([0.0])
        kinetic, potential = self._energies(start)
        upright = start.angular_momentum().total[0, 2]
        hint = "kinetic and of its weight, from the pivot"
        return [
            Field("energy", "energy", (kinetic + potential)[0], f"{moment_unit}/s^2", hint),
            Field("angular_momentum_vertical", "L, vertical", upright, f"{moment_unit}/s"),
        ]

    def stability(self) -> list[Field]:
        """Return whether the top would sleep upright with this spin about its axis."""
        is_stable = abs(self._motion.axial_spin) >= self._motion.sleeping_limit
        return [Field("stability", "upright", "stable" if is_stable else "unstable")]

    def drifts(self, trajectory: Trajectory) -> list[Field]:
        """Describe how well the trajectory keeps what is conserved."""
        kinetic, potential = self._energies(trajectory)
        momentum = trajectory.angular_momentum().total
        energy = drift(kinetic + potential, kinetic + np.abs(potential))
        upright = drift(momentum[:, 2], lengths(momentum))
        return [
            Field("energy_drift", "drift of energy", energy, hint="largest, relative"),
            Field("angular_momentum_drift", "drift of L vertical", upright, hint="largest, relative to L"),
        ]

    def _energies(self, trajectory: Trajectory) -> tuple[Floats, Floats]:
        """Compute the kinetic energy, and that of the weight, zero at the height of the pivot."""
        height = -(trajectory.point("center_of_mass") @ self._motion.gravity)
        return trajectory.kinetic_energy().total, float(trajectory.body.mass) * height


def period_fields(key: str, label: str, seconds: float, hint: str, told: Sigmas) -> list[Field]:
    """Return a period in seconds, and a long one in days too."""
    fields = [Field(key, label, seconds, "s", hint, **told)]
    if np.isfinite(seconds) and seconds >= 3600.0:
        if "sigma" in told:
            told = {**told, "sigma": np.asarray(told["sigma"]) / 86400.0}
        fields.append(Field(f"in_days.{key}", "", seconds / 86400.0, "d", **told))
    return fields


_WAY_OUT: Final = 'write "z, 2.5 kg m^2/s" or "0, 0, 1, 2.5 kg m^2/s"'
_MODES: Final = {
    "steady": "L rests in the body",
    "circular": "L goes round in the body as sines and cosines do",
    "separatrix": "L departs from an unstable steady rotation, and comes back to one, once",
    "paired": "L goes round on one of the two curves in the body with this energy",
    "single": "L goes round on the only curve in the body with this energy",
}
_KINDS: Final = {
    "minimum": "stable, of least energy",
    "maximum": "stable, of most energy",
    "saddle": "unstable",
    "degenerate": "neutral: some meet here",
}


def momentum_inside(texts: Sequence[str], axes: Floats, loaded: LoadedBody) -> Floats:
    """Read the wheels and sum up their momenta.

    Parameters
    ----------
    texts : sequence of str
        ``"z, 2.5 kg m^2/s"``, ``"0, 0, 1, 2.5 kg m^2/s"``.
    axes : numpy.ndarray, shape (3, 3)
        Those of the components, as columns in the body frame.
    loaded : LoadedBody
        In whose units a bare number is.

    Returns
    -------
    numpy.ndarray, shape (3,)
        In the body frame.
    """
    if loaded.assumed:
        raise PolhodeError("--wheel: what it does depends on the mass of the body; state --density or --mass")
    if loaded.body.covariance is not None:
        raise PolhodeError(
            "--wheel: sigmas are not followed through the motion of a body with wheels; write the numbers of "
            "the body alone"
        )
    total = np.zeros(3)
    for text in texts:
        *parts, momentum = (part.strip() for part in text.split(","))
        axis = _axis(parts, text, axes, loaded)
        total += _momentum(momentum, loaded) * axis
    return total


def _momentum(text: str, loaded: LoadedBody) -> float:
    unit = f"{loaded.moment_unit}/s"
    if loaded.length != "unit":
        return quantity(text, unit, "--wheel")
    if has_unit(text):
        raise PolhodeError(
            f"--wheel: {text!r} has a unit, but the file's coordinates have none; state --length-unit too"
        )
    return quantity(text, "kg m^2/s", "--wheel")


def _axis(parts: list[str], text: str, axes: Floats, loaded: LoadedBody) -> Floats:
    """Read the direction of an axis: a name, or three numbers."""
    words = parts[0].split() if len(parts) == 1 else parts
    if words in (["x"], ["y"], ["z"]):
        return np.asarray(axes[:, "xyz".index(words[0])])
    if words in (["e1"], ["e2"], ["e3"]):
        return np.asarray(loaded.body.principal.axes[:, int(words[0][1]) - 1])
    try:
        along = np.array([float(word) for word in words])
    except ValueError:
        along = np.zeros(0)
    if along.shape != (3,):
        raise PolhodeError(
            f"--wheel: {text!r} is not an axis (x, y, z, e1, e2, e3 or three numbers), a comma and a "
            f"momentum; {_WAY_OUT}"
        )
    size = math.hypot(*along)
    if not 0.0 < size < math.inf:
        raise PolhodeError(f"--wheel: the axis of {text!r} has no direction; {_WAY_OUT}")
    return np.asarray(axes @ (along / size))


class GyrostatKind:
    """A body in which wheels keep their momentum, and on which nothing acts."""

    def __init__(self, motion: GyrostatMotion, axes: Floats) -> None:
        self._motion = motion
        self._axes = axes
        self._rate, self._rate_unit = 1.0, "rad/s"

    def fields(self, rate: float, rate_unit: str) -> list[Field]:
        """Describe how L moves in the body, and the body about L."""
        self._rate, self._rate_unit = rate, rate_unit
        motion = self._motion
        mode = str(motion.mode)
        hint = "of the body about L, but for whole turns in a period"
        return [
            Field("mode", "mode", mode, hint=_MODES[mode]),
            *self._periods(),
            Field("mean_precession", "mean precession", motion.mean_precession * rate, rate_unit, hint),
        ]

    def _periods(self) -> list[Field]:
        """Return the periods that this mode has, by the words of the glossary."""
        motion, periods = self._motion, self._motion.periods
        if not np.isnan(periods.rotation):
            hint = "" if np.isfinite(periods.rotation) else "omega never returns"
            return period_fields("period", "period in the body", periods.rotation, hint, {})
        if not np.isfinite(periods.turn):
            return [Field("turn_period", "one turn", math.inf, "s", "the body is at rest")]
        turn = period_fields("turn_period", "one turn", periods.turn, "about an axis at rest in the body", {})
        if not np.isnan(periods.wobble):
            hint = "of small oscillations of omega in the body"
            return [*turn, *period_fields("wobble_period", "wobble", periods.wobble, hint, {})]
        found = motion.equilibria()
        nearest = int(np.argmax(found.direction @ motion.angular_momentum("body").spin))
        why = "the spin is unstable" if found.squared_rate[nearest] < 0.0 else "the spin is neutral"
        return [*turn, Field("wobble_period", "wobble", None, hint=why, cells=["none"])]

    def constants(self, moment_unit: str) -> list[Field]:
        """Return what is conserved: the energy, the angular momentum, and what of it is inside."""
        motion, unit = self._motion, f"{moment_unit}/s"
        momentum, inside = motion.angular_momentum().spin, motion.rotor
        energy = motion.kinetic_energy().rotational
        size, held = float(lengths(momentum)), float(lengths(inside))
        hint = "half of omega.I omega: without the wheels' own"
        return [
            Field("kinetic_energy", "kinetic energy", energy, f"{moment_unit}/s^2", hint),
            Field("angular_momentum", "|L|", size, unit, "with the wheels"),
            Field("angular_momentum_vector", "L, in space", momentum, unit, scale=max(size, held)),
            Field(
                "momentum_inside", "h, in the body", inside @ self._axes, unit, "of the wheels", scale=held
            ),
        ]

    def stability(self) -> list[Field | Table]:
        """Return the steady rotations with this length of L."""
        motion = self._motion
        if not float(lengths(motion.angular_momentum().spin)) > 0.0:
            return [Field("stability", "steady rotations", "none with an axis of its own: L is zero")]
        found = motion.equilibria()
        rows: list[dict[str, Any]] = []
        for k, kind in enumerate(found.kind.tolist()):
            circle = _clean(found.circle[k] @ self._axes) if found.circle[k].any() else None
            words = _KINDS[kind]
            if circle is not None:
                words += f", one of a circle about ({' '.join(f'{x:.4g}' for x in circle)})"
            rows.append(
                {
                    "direction": _cell(found.direction[k] @ self._axes, "9.5f"),
                    "omega": _cell(found.omega[k] @ self._axes * self._rate, "10.4g"),
                    "kind": Cell(words, kind),
                    "circle": circle,
                    "kinetic_energy": float(found.kinetic_energy[k]),
                    "squared_rate": float(found.squared_rate[k]),
                }
            )
        return [
            Table(
                "equilibria",
                [
                    Column("direction", "L / |L|"),
                    Column("omega", "omega", self._rate_unit),
                    Column("kind", "steady rotation"),
                ],
                rows,
            )
        ]

    def drifts(self, trajectory: Trajectory) -> list[Field]:
        """Describe how well the trajectory keeps what is conserved."""
        energy = trajectory.kinetic_energy().total
        momentum = trajectory.angular_momentum().total
        held = float(lengths(self._motion.rotor))
        size = np.maximum(lengths(momentum), held)  # L may be zero where neither part of it is
        return [
            Field(
                "kinetic_energy_drift",
                "drift of energy",
                drift(energy, np.abs(energy)),
                hint="largest, relative",
            ),
            Field(
                "angular_momentum_drift",
                "drift of L",
                drift(momentum, size),
                hint="largest, relative to L or h; the vector in space",
            ),
        ]


def _cell(vector: Floats, form: str) -> Cell:
    """Return a vector, and how a table shows it."""
    numbers = _clean(vector)
    return Cell(" ".join(f"{x:{form}}" for x in numbers), numbers)


def _clean(vector: Floats) -> list[float]:
    """Put zero for what is rounding beside the largest component."""
    size = float(np.abs(vector).max())
    return [float(x) if abs(x) > 1e-15 * size else 0.0 for x in vector]


def of_start(motion: FreeMotion | HeavyTop | GyrostatMotion, axes: Floats, rate: float) -> Sigmas:
    """Compute the sigma of the angular velocity at the start, along these axes; `rate` units are 1 rad/s."""
    omega = None if isinstance(motion, _core.GyrostatMotion) else motion.uncertain_start[0]
    if omega is None:
        return {}
    if isinstance(motion, _core.FreeMotion) and motion._from_periods is not None:
        found = each_motion(motion, lambda _body, omega: rate * omega @ axes, (3,))
        return {"sigma": found.sigma, "linear": found.linear}
    return {"sigma": rate * _along(axes, omega.covariance), "linear": np.ones(3, dtype=bool)}


def of_shape(motion: FreeMotion) -> Callable[[str], Sigmas]:
    """Compute sigmas of energy ratio, modulus and angles from L; give what looks them up, nothing if none.

    The angles of axis k, ``"nutation k"``, are in degrees.
    """
    if motion.body.covariance is None and motion.uncertain_start[0] is None:
        return lambda _name: {}

    def numbers(body: RigidBody, omega: Any) -> Floats:
        near = body.free_motion(omega)
        return np.array([near.energy_ratio, near.modulus, *np.rad2deg(near.nutation).ravel()])

    found = each_motion(motion, numbers, (8,))
    places: dict[str, int | slice] = {"energy_ratio": 0, "modulus": 1}
    places |= {f"nutation {k}": slice(2 * k + 2, 2 * k + 4) for k in range(3)}
    return lambda name: {"sigma": found.sigma[places[name]], "linear": found.linear[places[name]]}


def of_end(motion: FreeMotion | HeavyTop | GyrostatMotion, end: float, axes: Floats, rate: float) -> Sigmas:
    """Return the uncertain numbers at the end."""
    found = _end(motion, end)
    if found is None:
        return {}
    covariance, linear = found
    is_linear = bool(linear[3:].all())
    return {"sigma": rate * _along(axes, covariance[3:, 3:]), "linear": np.full(3, is_linear)}


def attitude_field(motion: FreeMotion | HeavyTop | GyrostatMotion, end: float) -> list[Field]:
    """Compute the sigmas of the small angles by which the body may be turned at the end."""
    found = _end(motion, end)
    if found is None:
        return []
    covariance, linear = found
    sigma = np.degrees(np.sqrt(np.diagonal(covariance)[:3]))
    hint = "sigma of its rotation about its x y z"
    cells = [
        f"{angle:.2g}{'' if is_linear else '*'}" for angle, is_linear in zip(sigma, linear[:3], strict=True)
    ]
    return [
        Field(
            "attitude_end", "turned by, end", None, "deg", hint, sigma=sigma, linear=linear[:3], cells=cells
        )
    ]


def _end(motion: FreeMotion | HeavyTop | GyrostatMotion, end: float) -> tuple[Floats, Any] | None:
    """Return the covariance of attitude and angular velocity at the end, and what of it is linear."""
    run = motion.at([0.0, end])
    if run.covariance is None or run.sigma is None:
        return None
    linear = run.sigma.linear
    return run.covariance[-1], np.concatenate([linear.attitude[-1], linear.omega[-1]])


def _along(axes: Floats, covariance: Floats) -> Floats:
    """Return the standard deviations of components along axes, the columns."""
    return np.sqrt(np.maximum(np.diagonal(axes.T @ covariance @ axes), 0.0))


PICTURE_SUFFIXES: Final = (".png", ".pdf", ".svg")
_SUFFIXES: Final = (*PICTURE_SUFFIXES, *ANIMATION_SUFFIXES, *TRAJECTORY_SUFFIXES)
DRAWN: Final = (*PICTURE_SUFFIXES, *ANIMATION_SUFFIXES)
"""Of files that show the body itself."""
_MOST: Final = 10_000
"""Triangles that are drawn of a mesh."""


def drawable(loaded: LoadedBody, options: BodyOptions) -> tuple[Part | None, str]:
    """Return the mesh as it is drawn, if there is one, and a note where it is coarser."""
    if loaded.shape is None:
        return None, ""
    vertices, faces, side = cluster_vertices(loaded.shape.vertices, loaded.shape.faces, _MOST)
    note = ""
    if side > 0.0:
        note = (
            f"drawn coarser: {len(faces)} triangles for {len(loaded.shape.faces)}, corners within cells of "
            f"{side:.3g} {loaded.length} joined; the numbers are those of the whole mesh"
        )
    if options.orient or options.closure is not None:  # a triangle is seen from its outside alone
        faces = np.concatenate([faces, faces[:, ::-1]])
    return (vertices, faces), note


def save(
    motion: FreeMotion | HeavyTop | GyrostatMotion,
    samples: Trajectory,
    path: Path,
    spin: SpinOptions,
    *,
    title: str,
    part: Part | None,
) -> tuple[str, ...]:
    """Write a motion in the form that the name asks for, the body drawn as `part` or as a box.

    Numbers are those of the samples; what is drawn follows the motion. Returned is what the file does not
    show of it.
    """
    suffix, end = path.suffix.lower(), float(samples.t[-1])
    if suffix in TRAJECTORY_SUFFIXES:
        samples.save(path)
        return _between(samples)
    if suffix in ANIMATION_SUFFIXES:
        with progress(f"drawing {path.name}", is_long=suffix != ".html") as tell:
            return animate_motion(
                motion, end, path, title=title or "Motion of a rigid body", shape=part, progress=tell
            )
    span = motion_times(motion, np.array([0.0, end]))
    _draw(motion.at(span.t), path, spin, title, part)
    if span.is_whole:
        return ()
    return (
        f"shown is the beginning, to {span.t[-1]:.6g} of {end:.6g} s: {len(span.t)} points follow the motion "
        "no further; an earlier --end shows all of it",
    )


def _between(samples: Trajectory) -> tuple[str, ...]:
    """Return a note where the body turns so far between two times that the numbers do not show how."""
    widest = float(turns(samples.t, samples.omega).max())
    if widest < np.pi:
        return ()
    needed = np.ceil(len(samples) * widest / TURN)
    return (
        f"between two of its times the body turns by up to {np.rad2deg(widest):.4g} deg, so that the numbers "
        f"do not show how; --times {needed:.7g} follows it",
    )


def _draw(trajectory: Trajectory, path: Path, spin: SpinOptions, title: str, part: Part | None) -> None:
    figure_module = require("matplotlib.figure", extra="plot", purpose=f"--save {path}:")
    from polhode.draw.plot.axes import show_around
    from polhode.plot import angular_velocity, body, principal_axes

    # A figure of its own, outside pyplot: no window system is asked for.
    figure = figure_module.Figure(figsize=(8.0 if part is None else 12.0, 4.5), layout="constrained")
    place = figure.add_subplot() if part is None else figure.add_subplot(1, 3, (2, 3))
    if part is not None:
        vertices = part[0] - trajectory.body.center_of_mass
        picture = figure.add_subplot(1, 3, 1, projection="3d", computed_zorder=False)
        body(vertices, part[1], picture)
        length = 1.06 * float(np.linalg.norm(vertices[part[1]], axis=-1).max())
        principal_axes(trajectory.body, picture, length=length, center=np.zeros(3))
        show_around(picture, np.zeros(3), 0.9 * length)
    frame: Literal["body", "principal"] = "principal" if spin.axes == "principal" else "body"
    ax = angular_velocity(trajectory, place, frame=frame, degrees=spin.degrees)
    ax.set_title(title, loc="left", parse_math=False)
    save_picture(figure, path)
