"""``polhode roll``: the motion of a body that rolls on a plane."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import RigidBody, loads, rolling, solids
from polhode._optional import require
from polhode.animation import ANIMATION_SUFFIXES, animate_motion
from polhode.cli.files import check_suffixes, label
from polhode.cli.layout import Column, Field, Report, Table
from polhode.cli.loading import LoadedBody
from polhode.cli.spin import PICTURE_SUFFIXES
from polhode.cli.terminal import printable, progress
from polhode.cli.whole import any_body, check_moments_alone, mass_and_center
from polhode.draw.sampling import MOST, TURN
from polhode.errors import PolhodeError
from polhode.euler_angles import to_quaternion
from polhode.io.saved import TRAJECTORY_SUFFIXES
from polhode.io.writing import save_picture
from polhode.units import quantities, quantity, vector

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from polhode import Trajectory
    from polhode.cli.options import BodyOptions, RollOptions

    Floats = NDArray[np.float64]

__all__ = ["roll_report"]

_SUFFIXES: Final = (*PICTURE_SUFFIXES, *ANIMATION_SUFFIXES, *TRAJECTORY_SUFFIXES)
_SIZES: Final = {
    "sphere": ("radius",),
    "ellipsoid": ("semi_axes",),
    "disk": ("radius",),
    "torus": ("major_radius", "minor_radius"),
    "paraboloid": ("radii", "apex"),
}
"""The options that say how large each surface is."""
_COUNTS: Final = {"semi_axes": 3, "radii": 2}
_RUBBER: Final = 1.0
"""Few materials have a larger coefficient of friction."""
_NAMES: Final = {"sphere": "ball", "disk": "thin disk", "torus": "ring"}
_HOMOGENEOUS: Final[dict[str, Callable[..., RigidBody]]] = {
    "sphere": solids.sphere,
    "ellipsoid": solids.ellipsoid,
    "disk": lambda radius, mass: solids.cylinder(radius, 0.0, mass=mass),
    "torus": solids.torus,
}


def roll_report(file: Path | None, roll: RollOptions, options: BodyOptions) -> tuple[Report, bool]:
    """Compute the motion of a body that rolls, save it as asked for and report on it.

    Returned is, with the report, whether the body rolls to the end.
    """
    end = _check_options(roll)
    sizes = _sizes(roll)
    surface = _surface(roll, sizes)
    loaded = _body(file, roll, options, sizes)
    simulate, tilt = _start(loaded.body, surface, roll)
    motion = simulate(np.linspace(0.0, end, roll.times))
    assert motion.contact is not None
    known = np.asarray(np.isfinite(motion.omega).all(axis=-1))
    is_kept = bool(motion.status == "complete")
    last = end if is_kept else _time_of_loss(motion, known)
    report = Report()
    source = label(file) if file is not None else ""
    report.section(
        "",
        *([] if file is None else [Field("file", "file", source)]),
        Field("surface.kind", "surface", str(roll.surface)),
        *(Field(f"surface.{name}", name.replace("_", " "), size, "m") for name, size in sizes.items()),
    )
    report.section(
        "body",
        Field("mass", "mass", loaded.body.mass, loaded.mass_unit),
        Field("principal_moments", "I1 I2 I3", loaded.body.principal_moments, loaded.moment_unit),
        Field("center_of_mass", "centre of mass", loaded.body.center_of_mass, "m", scale=loaded.extent),
    )
    report.section(
        "motion",
        Field("omega_start", "omega, start", motion.omega[0], "rad/s"),
        Field("tilt_start", "tilt, start", tilt, "deg", "from the normal to the axis z of the body"),
        Field("status", "status", str(motion.status)),
        *_events(motion, end),
    )
    report.section("contact", *_contact(motion, known))
    report.section("conserved", *_conserved(motion, known, loaded))
    report.section("at the end" if is_kept else "when the contact is lost", *_last(motion, known, last))
    report.notes += loaded.notes
    report.notes += [str(error) for error in motion.failures]
    friction = float(motion.contact.largest_friction_needed.value)
    slips = bool((motion.contact.phase[known] == "sliding").any() or (motion.events.kind == "slip").any())
    if friction > _RUBBER and roll.friction is None:
        report.notes.append(
            f"rolling needs a coefficient of friction of {friction:.3g}: a body on a table slips before, and "
            "does not move like this"
        )
    _save(report, motion, simulate, last, roll, printable(Path(source).name) if source else "")
    return report, is_kept and not slips


def _check_options(roll: RollOptions) -> float:
    """Refuse wrong options before anything is computed; return the time of the end."""
    if roll.surface is None:
        raise PolhodeError("--surface: state what touches the plane, as in --surface disk --radius 5cm")
    if not roll.omega:
        raise PolhodeError('--omega: state the start, as in --omega "0 12 7"')
    if roll.end is None:
        raise PolhodeError('--end: state the last time, as in --end "3 s"')
    if roll.tilt is not None and roll.attitude:
        raise PolhodeError("--tilt and --attitude: both say how the body stands; give one of the two")
    if roll.times < 2:
        raise PolhodeError(f"--times: {roll.times} is less than 2, the start and the end; give 2 or more")
    check_suffixes(roll.save, _SUFFIXES)
    end = quantity(roll.end, "s", "--end")
    if not end > 0.0:
        raise PolhodeError(f"--end: expected a time greater than 0, got {end:g}")
    return end


def _sizes(roll: RollOptions) -> dict[str, Any]:
    """Read the lengths of the surface, in m, and refuse those of other surfaces."""
    kind = str(roll.surface)
    needed = _SIZES[kind]
    for name in sorted({name for names in _SIZES.values() for name in names}):
        option = _option(name)
        if name in needed and not getattr(roll, name):
            example = {"semi_axes": '"20 3 2 cm"', "radii": '"10 2 cm"'}.get(name, "5cm")
            raise PolhodeError(f"{option}: a {kind} needs it, as in {option} {example}")
        if name not in needed and getattr(roll, name):
            others = " and ".join(map(_option, needed))
            raise PolhodeError(f"{option}: a {kind} has none; leave it out, and give {others}")
    if roll.axis and kind not in ("disk", "torus"):
        raise PolhodeError(f"--axis: it is that of a disk or a torus, not of a {kind}; leave it out")
    if roll.middle and kind == "paraboloid":
        raise PolhodeError("--middle: a paraboloid has none; its rim is level with the origin of the body")
    found: dict[str, Any] = {}
    for name in needed:
        given = getattr(roll, name)
        count = _COUNTS.get(name)
        found[name] = (
            quantity(given, "m", _option(name))
            if count is None
            else quantities(given, count, "m", _option(name))
        )
        _positive(_option(name), "a length", found[name])
    return found


def _option(name: str) -> str:
    return f"--{name.replace('_', '-')}"


def _surface(roll: RollOptions, sizes: dict[str, Any]) -> rolling.Surface:
    """Make the surface at its place in the body."""
    places: dict[str, Any] = {}
    if roll.axis:
        places["axis"] = vector(roll.axis, "1", "--axis")
        if not np.any(places["axis"]):
            raise PolhodeError("--axis: the zero vector has no direction; give one, such as 0 1 0")
    if roll.middle:
        places["center"] = vector(roll.middle, "m", "--middle")
    surface: rolling.Surface = getattr(rolling, str(roll.surface))(**sizes, **places)
    return surface


def _positive(option: str, what: str, value: Any) -> None:
    """Refuse a number that is not greater than zero, or several of which one is not."""
    wrong = [each for each in np.ravel(value).tolist() if not each > 0.0]
    if wrong:
        raise PolhodeError(f"{option}: expected {what} greater than 0, got {wrong[0]:g}")


def _body(file: Path | None, roll: RollOptions, options: BodyOptions, sizes: dict[str, Any]) -> LoadedBody:
    """Read the body of a file or a printout, or make it from moments or from its surface."""
    if roll.moments and options.inertia:
        raise PolhodeError("--moments and --inertia: both say what the body is; give one of the two")
    if file is not None or options.inertia:
        if roll.moments:
            raise PolhodeError(f"--moments: the body is that of {label(file or Path())}; give one of the two")
        loaded = any_body(file, options)
        if loaded.length == "unit" and loaded.kind:
            notes = (*loaded.notes, f"the {loaded.kind} states no units: its numbers are taken in kg and m")
            return replace(loaded, mass_unit="kg", length="m", notes=notes)
        if loaded.length != "m":
            raise PolhodeError(
                f"{label(file or Path())}: its lengths have no unit that the surface and --gravity could be "
                "compared with; state --length-unit"
            )
        if loaded.assumed:
            raise PolhodeError("roll: the forces depend on the mass of the body; state --density or --mass")
        return loaded
    check_moments_alone(options, "mass", "center_of_mass")
    if options.mass is None:
        raise PolhodeError('--mass: state the mass of the body, as in --mass "200 g"')
    mass, center = (getattr(one, "value", one) for one in mass_and_center(options))
    _positive("--mass", "a mass", mass)
    if roll.moments:
        moments = vector(roll.moments, "kg m^2", "--moments")
        body = RigidBody(float(mass), np.diag(moments), center_of_mass=center)
        return LoadedBody(body=body, source=[], mass_unit="kg", length="m")
    words = f"a homogeneous {_NAMES.get(str(roll.surface), roll.surface)}"
    if roll.surface not in _HOMOGENEOUS:
        raise PolhodeError(
            f"--surface {roll.surface}: the body is not known from it; give a file, --moments or --inertia"
        )
    for name in ("center_of_mass", "axis", "middle"):
        if getattr(options if name == "center_of_mass" else roll, name):
            raise PolhodeError(
                f"{_option(name)}: {words} has its middle at the origin and its axis along z; leave it out, "
                "or give a file, --moments or --inertia"
            )
    body = _HOMOGENEOUS[str(roll.surface)](*sizes.values(), mass=float(mass))
    return LoadedBody(body=body, source=[], mass_unit="kg", length="m", notes=(f"the body is {words}",))


def _start(
    body: RigidBody, surface: rolling.Surface, roll: RollOptions
) -> tuple[Callable[[Floats], Trajectory], float]:
    """Return what computes the motion at times, and the angle from the normal to the axis z in degrees."""
    omega = vector(roll.omega, "rad/s", "--omega")
    if roll.attitude:
        attitude = to_quaternion(vector(roll.attitude, "rad", "--attitude"))
    else:
        attitude = to_quaternion(
            (0.0, 0.0 if roll.tilt is None else quantity(roll.tilt, "rad", "--tilt"), 0.0)
        )
    gravity = quantity(roll.gravity, "m/s^2", "--gravity")
    if not gravity >= 0.0:
        raise PolhodeError(f"--gravity: {gravity:g} is a magnitude less than 0; --slope leans the plane")
    slope = 0.0 if roll.slope is None else quantity(roll.slope, "rad", "--slope")
    if not abs(slope) < 0.5 * np.pi:
        raise PolhodeError(f"--slope: {np.rad2deg(slope):g} deg is not less than 90 deg, a wall")
    if not 0.0 < roll.rtol < 1.0:
        raise PolhodeError(f"--rtol: {roll.rtol:g} is not a tolerance between 0 and 1")
    turntable = 0.0 if roll.turntable is None else quantity(roll.turntable, "rad/s", "--turntable")
    if roll.friction is not None and not 0.0 <= roll.friction < np.inf:
        raise PolhodeError(f"--friction: expected a coefficient of 0 or more, got {roll.friction:g}")
    if roll.velocity and roll.friction is None:
        raise PolhodeError(
            "--velocity: a body that rolls has the velocity that rolling gives; give --friction"
        )
    velocity = vector(roll.velocity, "m/s", "--velocity") if roll.velocity else None
    contact = rolling.plane(
        surface,
        law="rolling" if roll.friction is None else "dry",
        friction=roll.friction,
        turntable=turntable,
        lift=roll.lift,
    )
    load = loads.uniform_gravity((gravity * np.sin(slope), 0.0, -gravity * np.cos(slope)))

    def simulate(t: Floats) -> Trajectory:
        return body.simulate(
            t,
            omega,
            attitude,
            load=load,
            contact=contact,
            velocity=velocity,
            rtol=roll.rtol,
            on_failure="keep",
        )

    return simulate, _tilts(np.asarray(attitude))


def _tilts(quaternion: Floats) -> Any:
    """Return the angles from the normal of the plane, z of space, to the axis z of the body, in degrees."""
    x, y, z, w = np.moveaxis(quaternion, -1, 0)
    return np.rad2deg(2.0 * np.arctan2(np.hypot(x, y), np.hypot(z, w)))


def _time_of_loss(motion: Trajectory, known: NDArray[np.bool_]) -> float:
    """Return when the contact is lost; where the run fails, the last time that is known."""
    if motion.status in ("lift-off", "landing"):
        return float(motion.events.t[-1])
    return float(motion.t[known][-1])


def _events(motion: Trajectory, end: float) -> list[Field | Table]:
    """List the events; with --lift hold a lift-off is a time from which the plane would have to pull."""
    if not len(motion.events.t):
        ended = motion.status == "failed"
        return [] if ended else [Field("events", "events", [], cells=[f"none up to {end:g} s"])]
    events = zip(motion.events.kind, motion.events.t, strict=True)
    rows: list[dict[str, Any]] = [{"kind": str(kind), "t": float(t)} for kind, t in events]
    return [Table("events", [Column("kind", "event"), Column("t", "time", "s")], rows)]


def _contact(motion: Trajectory, known: NDArray[np.bool_]) -> list[Field]:
    contact = motion.contact
    assert contact is not None
    most, least = contact.largest_friction_needed, contact.smallest_normal_force
    off = float(np.abs(contact.residual[known]).max())
    return [
        Field(
            "largest_friction_needed",
            "friction needed",
            float(most.value),
            hint=f"largest, at {float(most.t):.6g} s",
        ),
        Field("largest_friction_needed_time", "", float(most.t), "s", "when"),
        Field("smallest_normal_force", "normal force", float(least.value), "N", "smallest"),
        Field("smallest_normal_force_time", "", float(least.t), "s", "when"),
        Field("residual", "height and slip", off, hint="largest, relative: rounding errors of zero"),
    ]


def _conserved(motion: Trajectory, known: NDArray[np.bool_], loaded: LoadedBody) -> list[Field]:
    kept, unit = motion.invariants(), f"{loaded.moment_unit}/s"
    contact = motion._contact
    assert contact is not None
    is_plain = contact.law == "rolling" and not contact.turntable
    rows = (
        (
            "energy",
            "energy" if is_plain else "energy less the work of the plane",
            f"{loaded.moment_unit}/s^2",
        ),
        ("jellett", "Jellett's constant", f"{loaded.moment_unit} m/s"),
        ("routh", "Routh's constant", f"{loaded.moment_unit}/s"),
        ("chaplygin", "Chaplygin's vector", unit),
    )
    fields = []
    for name, words, of in rows:
        values = getattr(kept, name)
        if values is None:
            continue
        size = float(np.abs(values[known]).max())
        fields += [
            Field(name, words, values[0], of, scale=size),
            Field(f"{name}_drift", "", float(getattr(kept, f"{name}_drift")), hint="largest drift, relative"),
        ]
    return fields


def _last(motion: Trajectory, known: NDArray[np.bool_], last: float) -> list[Field]:
    """Describe the last state that is known."""
    contact = motion.contact
    assert contact is not None
    k = int(np.flatnonzero(known)[-1])
    omega, quaternion, place = motion.omega[k], motion.quaternion[k], contact.point[k]
    if motion.status in ("lift-off", "landing"):  # between two of the times
        omega, quaternion = motion.events.omega[-1], motion.events.quaternion[-1]
        place = None
    return [
        Field("time", "time", last, "s"),
        Field("omega_end", "omega", omega, "rad/s"),
        Field("tilt_end", "tilt", float(_tilts(quaternion)), "deg"),
        *([] if place is None else [Field("point_end", "point of contact", place, "m", "in space")]),
    ]


def _save(
    report: Report,
    motion: Trajectory,
    simulate: Callable[[Floats], Trajectory],
    last: float,
    roll: RollOptions,
    title: str,
) -> None:
    """Write the files of --save; pictures have as many times as they need, while the contact lasts."""
    known = np.isfinite(motion.omega).all(axis=-1)
    fastest = float(np.linalg.norm(motion.omega[known], axis=-1).max())

    def followed(least: int) -> Trajectory:
        """Compute as many times as the turns need; up to lift-off, whose last digits may be beyond it."""
        count = int(min(max(np.ceil(1.2 * last * fastest / TURN), least), MOST))
        return simulate(np.linspace(0.0, last * (1.0 - 1e-9), count))

    for path in roll.save:
        suffix = path.suffix.lower()
        if suffix in TRAJECTORY_SUFFIXES:
            motion.save(path)
        elif suffix in ANIMATION_SUFFIXES:
            is_page = suffix == ".html"
            with progress(f"drawing {path.name}", is_long=not is_page) as tell:
                notes = animate_motion(
                    followed(361 if is_page else 101),
                    None,
                    path,
                    title=title or f"A {roll.surface} that rolls",
                    progress=tell,
                )
            report.notes += [f"{path.name}: {note}" for note in notes]
        else:
            _draw(followed(361), path, title)
        report.notes.append(f"saved {path}")


def _draw(motion: Trajectory, path: Path, title: str) -> None:
    """Draw the body on the plane, and the trace of the contact from above."""
    figure: Any = require("matplotlib.figure", extra="plot", purpose=f"--save {path}:").Figure(
        figsize=(11.0, 5.0), layout="constrained"
    )
    from polhode.plot import contact
    from polhode.plot import rolling as on_plane

    on_plane(motion, figure.add_subplot(1, 2, 1, projection="3d", computed_zorder=False))
    contact(motion, figure.add_subplot(1, 2, 2))
    if title:
        figure.suptitle(title, parse_math=False)
    save_picture(figure, path)
