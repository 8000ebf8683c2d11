"""``polhode spin``: the motion of a body, in numbers, tables and pictures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from polhode import RigidBody
from polhode._extras import require
from polhode._files.trajectory import TRAJECTORY_SUFFIXES
from polhode.cli.layout import Field, Report
from polhode.cli.loading import LoadedBody, load_body
from polhode.cli.progress import progress
from polhode.cli.quantities import quantity, vector
from polhode.cli.source import shown
from polhode.errors import PolhodeError
from polhode.euler_angles import to_quaternion

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode import Trajectory
    from polhode.cli.options import BodyOptions, SpinOptions

    Floats = NDArray[np.float64]

__all__ = ["PICTURE_SUFFIXES", "spin_report"]

PICTURE_SUFFIXES = (".png", ".pdf", ".svg")
_LONG = 1e5
"""Radians of turning beyond which an integration is worth a bar."""


def spin_report(file: Path | None, spin: SpinOptions, options: BodyOptions) -> Report:
    """Let a body move, save its motion as asked for and report on it."""
    omega, until = _checked(file, spin)
    loaded = _body(file, spin, options)
    body = loaded.body
    axes = body.principal.axes if spin.axes == "principal" else np.eye(3)
    to_radians = np.pi / 180.0 if spin.degrees else 1.0
    trajectory = _moved(body, axes @ omega, until, spin)
    report = Report()
    report.section(
        "",
        Field("file", "file", "(moments)" if file is None else shown(file)),
        Field("axes", "components", _axes_text(spin)),
    )
    report.section(
        "body",
        Field("mass", "mass", body.mass, loaded.mass_unit),
        Field("principal_moments", "I1 I2 I3", body.principal_moments, loaded.moment_unit),
    )
    rates = trajectory.omega[[0, -1]] @ axes / to_radians
    angles = np.rad2deg(trajectory.euler_angles("ZXZ", singular="nan")[-1])
    rate_unit = "deg/s" if spin.degrees else "rad/s"
    report.section(
        "motion",
        Field("time", "end", until, "s"),
        Field("omega_start", "omega, start", rates[0], rate_unit),
        Field("omega_end", "omega, end", rates[1], rate_unit),
        Field("euler_angles_end", "Euler angles, end", angles, "deg", "ZXZ phi, theta, psi"),
    )
    report.section("conserved", *_conserved_fields(trajectory, loaded))
    report.notes += loaded.notes
    if np.isnan(angles).any():
        report.notes.append("at the end theta is 0 or 180 deg, where phi and psi are not defined one by one")
    if loaded.length == "unit":
        report.notes.append("unit unknown: mass and moments are in the file's own unit of length")
    if loaded.assumed:
        report.notes.append(
            "neither density nor mass was given: density 1 was used; the motion does not depend on it"
        )
    for path in spin.save:
        _save(trajectory, path, spin, title="" if file is None else Path(shown(file)).name)
        report.notes.append(f"saved {path}")
    return report


def _checked(file: Path | None, spin: SpinOptions) -> tuple[Floats, float]:
    """Everything that can be refused before the work is; the angular velocity and the time."""
    if (file is None) == (not spin.moments):
        missing = "give a file, or principal moments with --moments"
        both = "give one of the two, the file or --moments"
        raise PolhodeError(f"spin: {missing if file is None else both}")
    if not spin.omega:
        raise PolhodeError('--omega: state the angular velocity at the start, as in "10 20 30 deg/s"')
    words = spin.omega
    if spin.degrees and not any(c.isalpha() for word in words for c in word):
        words = (*words, "deg/s")
    omega = np.array(vector(words, "rad/s", "--omega"))
    if spin.until is None:
        raise PolhodeError('--until: state the time of the end, as in "20 s"')
    until = quantity(spin.until, "s", "--until")
    if until == 0.0:
        raise PolhodeError(f"--until: {until:g} is not a time other than 0")
    if spin.samples < 2:
        raise PolhodeError(f"--samples: {spin.samples} is less than 2, the start and the end")
    for path in spin.save:
        if path.suffix.lower() not in (*PICTURE_SUFFIXES, *TRAJECTORY_SUFFIXES):
            known = ", ".join((*PICTURE_SUFFIXES, *TRAJECTORY_SUFFIXES))
            raise PolhodeError(f"--save: {path} does not end in one of {known}")
        if not path.parent.is_dir():
            raise PolhodeError(f"--save: there is no directory {path.parent}; create it first")
    return omega, until


def _body(file: Path | None, spin: SpinOptions, options: BodyOptions) -> LoadedBody:
    """Read the body, or make the one of the moments that were typed."""
    if file is not None:
        if spin.center:
            raise PolhodeError("--center: the file tells where the centre of mass is; leave it out")
        return load_body(file, options)
    moments = vector(spin.moments, "kg m^2", "--moments")
    mass = quantity(options.mass, "kg", "--mass") if options.mass is not None else 1.0
    center = vector(spin.center, "m", "--center") if spin.center else (0.0, 0.0, 0.0)
    body = RigidBody.from_principal(mass, moments, center_of_mass=center)
    return LoadedBody(body=body, source=[], mass_unit="kg", length="m")


def _moved(body: RigidBody, omega: Floats, until: float, spin: SpinOptions) -> Trajectory:
    """Move the body: freely, or about its origin under gravity."""
    attitude = to_quaternion(vector(spin.attitude, "rad", "--attitude")) if spin.attitude else None
    times = np.linspace(0.0, until, spin.samples)
    with progress("moving", is_long=abs(until) * float(np.linalg.norm(omega)) > _LONG) as tell:
        return body.simulate(times, omega, attitude, rtol=spin.rtol, progress=tell)


def _conserved_fields(trajectory: Trajectory, loaded: LoadedBody) -> list[Field]:
    energy = trajectory.kinetic_energy().total
    momentum = trajectory.angular_momentum().total
    return [
        Field("kinetic_energy", "kinetic energy", energy[0], f"{loaded.moment_unit}/s^2"),
        Field("kinetic_energy_drift", "  drift", _drift(energy), hint="largest, relative"),
        Field("angular_momentum", "|L|", np.linalg.norm(momentum[0]), f"{loaded.moment_unit}/s"),
        Field(
            "angular_momentum_drift",
            "  drift of L",
            _drift(momentum),
            hint="largest, relative; the vector in space",
        ),
    ]


def _axes_text(spin: SpinOptions) -> str:
    return "along the principal axes e1 e2 e3" if spin.axes == "principal" else "along the file's axes x y z"


def _drift(values: Floats) -> float:
    """Largest distance from the value at the start, relative to that value."""
    distance = values - values[0]
    size = np.abs(values[0]) if values.ndim == 1 else np.linalg.norm(values[0])
    largest = np.max(np.abs(distance) if values.ndim == 1 else np.linalg.norm(distance, axis=-1))
    return float(largest / size) if size > 0.0 else 0.0


def _save(trajectory: Trajectory, path: Path, spin: SpinOptions, *, title: str) -> None:
    if path.suffix.lower() in TRAJECTORY_SUFFIXES:
        trajectory.save(path)
        return
    figure_module = require("matplotlib.figure", extra="plot", purpose=f"--save {path}:")
    from polhode.plot import angular_velocity

    # A figure of its own, outside pyplot: no window system is asked for.
    figure = figure_module.Figure(figsize=(8.0, 4.5), layout="constrained")
    frame: Literal["body", "principal"] = "principal" if spin.axes == "principal" else "body"
    ax = angular_velocity(trajectory, figure.add_subplot(), frame=frame, degrees=spin.degrees)
    ax.set_title(title, loc="left")
    figure.savefig(path, dpi=160)
