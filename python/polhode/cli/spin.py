"""``polhode spin``: the motion of a body, in numbers, tables and pictures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from polhode import RigidBody, Uncertain
from polhode._quantities import amount, amounts, quantity, vector
from polhode._rounding import at_most
from polhode._scene.sampling import fastest
from polhode.cli.layout import Field, Report
from polhode.cli.loading import LoadedBody
from polhode.cli.motion_options import MODES
from polhode.cli.sigmas import note_linear, told
from polhode.cli.source import STDIN, shown
from polhode.cli.spin_gyrostat import GyrostatKind, momentum_inside
from polhode.cli.spin_kinds import FreeKind, TopKind
from polhode.cli.spin_output import DRAWN, check_paths, drawable, save
from polhode.cli.spin_sigmas import attitude_field, of_end, of_start
from polhode.cli.tables import top_fields
from polhode.cli.text import printable
from polhode.cli.whole import any_body, check_moments_alone
from polhode.errors import PolhodeError
from polhode.euler_angles import to_quaternion

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode import FreeMotion, GyrostatMotion, HeavyTop
    from polhode.cli.motion_options import SpinOptions
    from polhode.cli.options import BodyOptions

    Floats = NDArray[np.float64]

__all__ = ["spin_report"]


def spin_report(file: Path | None, spin: SpinOptions, options: BodyOptions) -> Report:
    """Compute the motion of a body, save it as asked for and report on it."""
    until = _checked(file, spin, options)
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
        Field("file", "file", _source(file, spin)),
        Field("axes", "components", _axes_text(spin)),
    )
    rate, rate_unit = (180.0 / np.pi, "deg/s") if spin.degrees else (1.0, "rad/s")
    report.section(
        "body",
        Field("mass", "mass", body.mass, loaded.mass_unit, **told(body, "mass")),
        Field(
            "principal_moments",
            "I1 I2 I3",
            body.principal_moments,
            loaded.moment_unit,
            **told(body, "principal_moments"),
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
    if until is None:
        return report
    _check_end(motion, until)
    trajectory = motion.at(np.linspace(0.0, until, spin.samples))
    angles = np.rad2deg(trajectory.euler_angles("ZXZ", singular="nan")[-1])
    report.section(
        "at the end",
        Field("time", "end", until, "s"),
        Field(
            "omega_end",
            "omega, end",
            trajectory.omega[-1] @ axes * rate,
            rate_unit,
            **of_end(motion, until, axes, rate),
        ),
        *attitude_field(motion, until),
        Field("euler_angles_end", "Euler angles, end", angles, "deg", "ZXZ phi, theta, psi"),
        *kind.drifts(trajectory),
    )
    if np.isnan(angles).any():
        report.notes.append("at the end theta is 0 or 180 deg, where phi and psi are not defined one by one")
    if not spin.save:
        return report
    part, note = drawable(loaded, options)
    report.notes += [note] if note else []
    title = "" if file is None else printable(Path(shown(file)).name)
    for path in spin.save:
        saved = save(motion, trajectory, path, spin, title=title, part=part)
        report.notes.append(f"saved {path}")
        report.notes += [f"{path.name}: {note}" for note in saved]
    return report


def _checked(file: Path | None, spin: SpinOptions, options: BodyOptions) -> float | None:
    """Refuse wrong options before anything is computed; give the time of the end."""
    if file is None and not (spin.moments or options.inertia):
        raise PolhodeError(
            "spin: give a file, or principal moments with --moments, or a tensor with --inertia"
        )
    if spin.moments and options.inertia:
        raise PolhodeError("--moments and --inertia: both say what the body is; give one of the two")
    if file is not None and spin.moments:
        raise PolhodeError(f"--moments: the body is that of {shown(file)}; give one of the two")
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
        raise PolhodeError("--mode: it says which motion has the periods of --periods; leave it out")
    if spin.save and spin.until is None:
        raise PolhodeError('--save: state the time of the end with --until, as in "20 s"')
    if spin.samples < 2:
        raise PolhodeError(f"--samples: {spin.samples} is less than 2, the start and the end; give 2 or more")
    check_paths(spin.save)
    if spin.until is None:
        return None
    until = quantity(spin.until, "s", "--until")
    if until == 0.0:
        raise PolhodeError(f"--until: expected a time other than 0, got {until:g}")
    return until


def _check_end(motion: FreeMotion | HeavyTop | GyrostatMotion, until: float) -> None:
    """Refuse a time after so many turns that the last digit of the angular velocity is a turn or more."""
    rate = fastest(motion)
    digit = rate * np.finfo(float).eps
    if not digit * abs(until) < 1.0:
        raise PolhodeError(
            f"--until: after {until:g} s at {rate:.4g} rad/s the last digit of the angular velocity turns "
            f"the body by {digit * abs(until):.2g} rad, and its attitude is not known; end before "
            f"{at_most(1.0 / digit, 2)} s"
        )


def _body(file: Path | None, spin: SpinOptions, options: BodyOptions) -> LoadedBody:
    """Read the body, or make it from the moments that were typed."""
    if not spin.moments:
        return any_body(file, options, with_shape=any(path.suffix.lower() in DRAWN for path in spin.save))
    for option, is_given in (("--bond-sigma", options.bond_sigma), ("--mass-sigmas", options.mass_sigmas)):
        if is_given:
            raise PolhodeError(f"{option}: --moments are of no molecule; leave it out")
    check_moments_alone(options, "mass", "com")
    if spin.gravity is not None and (options.mass is None or not options.com):
        raise PolhodeError("--gravity: the weight acts at the centre of mass; state --mass and --center too")
    moments = amounts(spin.moments, 3, "kg m^2", "--moments")
    mass = amount(options.mass, "kg", "--mass") if options.mass is not None else 1.0
    center = vector(options.com, "m", "--center") if options.com else (0.0, 0.0, 0.0)
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
    return loaded.body.gyrostat(inside).free_motion(omega, _attitude(spin))


def _heavy_top(body: RigidBody, axes: Floats, spin: SpinOptions) -> HeavyTop:
    g = quantity(spin.gravity or "", "m/s^2", "--gravity")
    return body.heavy_top(_omega(axes, spin), _attitude(spin), (0.0, 0.0, -g))


def _source(file: Path | None, spin: SpinOptions) -> str:
    if file is not None:
        return shown(file)
    return "(moments)" if spin.moments else "(inertia)"


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
