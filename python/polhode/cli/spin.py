"""``polhode spin``: the motion of a body, in numbers, tables and pictures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from polhode import RigidBody
from polhode.cli.layout import Field, Report
from polhode.cli.loading import LoadedBody, load_body
from polhode.cli.quantities import quantities, quantity, vector
from polhode.cli.source import shown
from polhode.cli.spin_output import check_paths, save
from polhode.errors import PolhodeError
from polhode.euler_angles import to_quaternion

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode import FreeMotion, Trajectory
    from polhode.cli.options import BodyOptions, SpinOptions

    Floats = NDArray[np.float64]

__all__ = ["spin_report"]


def spin_report(file: Path | None, spin: SpinOptions, options: BodyOptions) -> Report:
    """Let a body move, save its motion as asked for and report on it."""
    until = _checked(file, spin)
    loaded = _body(file, spin, options)
    body = loaded.body
    axes = body.principal.axes if spin.axes == "principal" else np.eye(3)
    motion = _motion(loaded, axes, spin)
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
        Field("top", "top", str(body.principal.top)),
    )
    report.section("motion", *_kind_fields(motion, axes, spin))
    report.section("conserved", *_constant_fields(motion, loaded))
    report.section("steady spins with this momentum", *_stability_fields(motion))
    report.notes += _notes(loaded)
    if until is None:
        return report
    trajectory = motion.at(np.linspace(0.0, until, spin.samples))
    end = _end_fields(trajectory, axes, until, spin)
    report.section("at the end", *end, *_drift_fields(trajectory))
    if np.isnan(np.asarray(end[-1].value)).any():
        report.notes.append("at the end theta is 0 or 180 deg, where phi and psi are not defined one by one")
    for path in spin.save:
        save(trajectory, path, spin, title="" if file is None else Path(shown(file)).name)
        report.notes.append(f"saved {path}")
    return report


def _checked(file: Path | None, spin: SpinOptions) -> float | None:
    """Refuse what can be refused before the work is; give the time of the end."""
    if file is None and not spin.moments:
        raise PolhodeError("spin: give a file, or principal moments with --moments")
    if file is not None and spin.moments:
        raise PolhodeError(f"--moments: the body is that of {shown(file)}; give one of the two")
    if bool(spin.omega) == bool(spin.periods):
        both = "give one of the two" if spin.omega else 'state the start, as in --omega "10 20 30 deg/s"'
        raise PolhodeError(f"--omega and --periods: {both}")
    if spin.periods and spin.attitude:
        raise PolhodeError("--attitude: --periods starts with the angular momentum along z; leave it out")
    if spin.save and spin.until is None:
        raise PolhodeError('--save: state the time of the end with --until, as in "20 s"')
    if spin.samples < 2:
        raise PolhodeError(f"--samples: {spin.samples} is less than 2, the start and the end")
    check_paths(spin.save)
    if spin.until is None:
        return None
    until = quantity(spin.until, "s", "--until")
    if until == 0.0:
        raise PolhodeError(f"--until: {until:g} is not a time other than 0")
    return until


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


def _motion(loaded: LoadedBody, axes: Floats, spin: SpinOptions) -> FreeMotion:
    """Start the body as it was told."""
    body = loaded.body
    if spin.periods:
        rotation, precession = quantities(spin.periods, 2, "s", "--periods")
        return body.free_motion_from_periods(rotation, precession, mode=spin.mode)
    words = spin.omega
    if spin.degrees and not any(c.isalpha() for word in words for c in word):
        words = (*words, "deg/s")
    omega = axes @ np.array(vector(words, "rad/s", "--omega"))
    attitude = to_quaternion(vector(spin.attitude, "rad", "--attitude")) if spin.attitude else None
    return body.free_motion(omega, attitude)


def _kind_fields(motion: FreeMotion, axes: Floats, spin: SpinOptions) -> list[Field]:
    """Tell what kind of motion it is, its periods and angles."""
    rate, rate_unit = _rate(spin)
    angles = np.rad2deg(motion.nutation)
    periods = motion.periods
    return [
        Field("mode", "mode", str(motion.mode)),
        Field("omega_start", "omega, start", motion.omega @ axes * rate, rate_unit),
        *_period_fields("rotation_period", "rotation period", periods.rotation, "P_psi, about the long axis"),
        *_period_fields(
            "precession_period", "precession period", periods.precession, "P_phi, of the long axis"
        ),
        *_period_fields("flip_period", "flips every", periods.flip, "the intermediate axis"),
        *(
            Field(f"angle_from_L.e{k + 1}", f"e{k + 1} from L", angles[k], "deg", "least, greatest")
            for k in range(3)
        ),
        Field("energy_ratio", "E / E_min", motion.energy_ratio, hint="1 for a spin about e3"),
        Field("modulus", "elliptic modulus", motion.modulus),
    ]


def _period_fields(key: str, label: str, seconds: float, hint: str) -> list[Field]:
    """Give a period in seconds, and a long one in the days or hours of an astronomer too."""
    fields = [Field(key, label, seconds, "s", hint)]
    if np.isfinite(seconds) and seconds >= 3600.0:
        fields.append(Field(f"in_days.{key}", "", seconds / 86400.0, "d"))
    return fields


def _constant_fields(motion: FreeMotion, loaded: LoadedBody) -> list[Field]:
    momentum = motion.angular_momentum
    scale = float(np.linalg.norm(momentum))
    unit = f"{loaded.moment_unit}/s"
    return [
        Field("kinetic_energy", "kinetic energy", motion.kinetic_energy, f"{loaded.moment_unit}/s^2"),
        Field("angular_momentum", "|L|", scale, unit),
        Field("angular_momentum_vector", "L, in space", momentum, unit, scale=scale),
    ]


def _stability_fields(motion: FreeMotion) -> list[Field]:
    """Tell whether spins about each principal axis would stay."""
    squares = motion.stability
    words = [
        "undefined" if np.isnan(x) else "stable" if x > 0 else "unstable" if x < 0 else "neutral"
        for x in squares
    ]
    return [
        Field("stability", "about e1 e2 e3", ", ".join(words)),
        Field(
            "stability_frequency_squared",
            "frequency^2",
            squares,
            "1/s^2",
            "of small oscillations in the body",
        ),
    ]


def _end_fields(trajectory: Trajectory, axes: Floats, until: float, spin: SpinOptions) -> list[Field]:
    rate, rate_unit = _rate(spin)
    angles = np.rad2deg(trajectory.euler_angles("ZXZ", singular="nan")[-1])
    return [
        Field("time", "end", until, "s"),
        Field("omega_end", "omega, end", trajectory.omega[-1] @ axes * rate, rate_unit),
        Field("euler_angles_end", "Euler angles, end", angles, "deg", "ZXZ phi, theta, psi"),
    ]


def _drift_fields(trajectory: Trajectory) -> list[Field]:
    """Tell how well the trajectory keeps what is constant."""
    energy = _drift(trajectory.kinetic_energy().total)
    momentum = _drift(trajectory.angular_momentum().total)
    return [
        Field("kinetic_energy_drift", "drift of energy", energy, hint="largest, relative"),
        Field(
            "angular_momentum_drift", "drift of L", momentum, hint="largest, relative; the vector in space"
        ),
    ]


def _rate(spin: SpinOptions) -> tuple[float, str]:
    return (180.0 / np.pi, "deg/s") if spin.degrees else (1.0, "rad/s")


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


def _drift(values: Floats) -> float:
    """Largest distance from the value at the start, relative to that value."""
    distance = values - values[0]
    size = np.abs(values[0]) if values.ndim == 1 else np.linalg.norm(values[0])
    largest = np.max(np.abs(distance) if values.ndim == 1 else np.linalg.norm(distance, axis=-1))
    return float(largest / size) if size > 0.0 else 0.0
