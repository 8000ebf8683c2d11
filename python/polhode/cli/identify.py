"""``polhode identify``: the body that explains a log, and what the log does not tell of it."""

from __future__ import annotations

import csv
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import identify
from polhode._optional import require
from polhode.cli.files import as_file, check_suffixes, label
from polhode.cli.layout import Column, Field, Report, Table
from polhode.cli.terminal import progress
from polhode.errors import FileFormatError, IdentificationError, PolhodeError
from polhode.io.budget import read_text
from polhode.io.motion_tables import Log, read_log
from polhode.io.writing import save_picture
from polhode.units import amount, amounts, quantities, quantity

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from polhode.cli.options import IdentifyOptions
    from polhode.identify import Direction, Identified

    Floats = NDArray[np.float64]

__all__ = ["identify_report"]

_PICTURES: Final = (".png", ".pdf", ".svg")
_RATES: Final = {"rad/s": 1.0, "deg/s": np.pi / 180.0, "rpm": np.pi / 30.0}
_OWN: Final = {
    "tumble": ("rotor", "mass"),
    "wrench": ("force", "torque", "specific_force", "angular_acceleration"),
    "pendulum": ("gravity", "mass"),
}
"""Options that are for one kind or two."""
_OF_SENSORS: Final = ("time", "omega", "rate_unit", "omega_sigma", "bias")
_BAD: Final = ("undetermined", "no fit", "contradiction")
"""Kinds of errors that are a verdict on the measurements, not on the file."""
_DEVICES: Final[dict[str, tuple[str, ...]]] = {
    "compound": ("axis", "about", "period", "amplitude", "decrement"),
    "torsional": ("axis", "period", "stiffness", "fixture", "known", "decrement"),
    "bifilar": (
        "axis",
        "period",
        "length",
        "distance",
        "amplitude",
        "plate_mass",
        "plate_moment",
        "decrement",
    ),
    "trifilar": (
        "axis",
        "period",
        "length",
        "radius",
        "amplitude",
        "plate_mass",
        "plate_moment",
        "decrement",
    ),
}
_UNITS: Final = {
    "period": "s", "amplitude": "rad", "decrement": "", "stiffness": "N m/rad", "fixture": "kg m^2",
    "known": "kg m^2", "length": "m", "distance": "m", "radius": "m", "plate_mass": "kg",
    "plate_moment": "kg m^2",
}  # fmt: skip
_COLUMNS: Final = (
    Column("words", "hardly determined"),
    Column("relative", "sigma / size"),
    Column("remedy", "remedy"),
)
_JUMP: Final = 3.0
"""A step of the clock is a jump if it is longer than so many usual ones."""
_LIMIT: Final = 5
"""So many rows in a row at one extreme value are saturated."""


def identify_report(file: Path, options: IdentifyOptions) -> tuple[Report, bool]:
    """Report on the body that explains a log best; tell too whether the log is explained and tells enough."""
    check_suffixes(options.save, (*_PICTURES, ".json"))
    if options.kind is None:
        raise PolhodeError("--kind: state what was measured: --kind tumble, --kind wrench or --kind pendulum")
    allowed = {*_OWN[options.kind], *(() if options.kind == "pendulum" else _OF_SENSORS)}
    for name in sorted({*_OF_SENSORS, *(one for names in _OWN.values() for one in names)} - allowed):
        if getattr(options, name):
            option = "--" + name.replace("_", "-")
            raise PolhodeError(f"{option}: it is not for --kind {options.kind}; leave it out")
    report = Report()
    try:
        if options.kind == "pendulum":
            found, drawing = _pendulum(file, options, report)
        else:
            found, drawing = _sensors(file, options, report)
    except IdentificationError as error:
        if error.kind not in _BAD:
            raise
        report.section("verdict", Field("verdict", "verdict", f"no body: {error.kind}"))
        _directions(report, error.observability)
        report.notes.append(str(error))
        return report, False
    _tell(report, found, options.kind)
    for path in options.save:
        if path.suffix.lower() == ".json":
            found.body.save(path)
        else:
            _draw(found, drawing, path)
        report.notes.append(f"saved {path}")
    return report, True


def _sensors(file: Path, options: IdentifyOptions, report: Report) -> tuple[Identified, Any]:
    asked = {"time": [options.time] if options.time else [], "omega": _names(options.omega)}
    if options.kind == "wrench":
        asked |= {name: _names(getattr(options, name)) for name in _OWN["wrench"]}
    with as_file(file) as path:
        log = read_log(path, asked, ("angular_acceleration",), label(file))
    t, notes = _times(log)
    omega, rate = _rates(log, options, notes)
    log.values["omega"] = omega
    _look(log, t, notes)
    report.section(
        "",
        Field("file", "file", label(file)),
        Field("rows", "rows", len(t)),
        *(
            Field(f"columns.{name}", f"read as {name.replace('_', ' ')}", " ".join(names))
            for name, names in log.columns.items()
        ),
        Field("rate_unit", "angular velocity in", rate),
    )
    report.notes += notes
    sigma = None if options.omega_sigma is None else quantity(options.omega_sigma, "rad/s", "--omega-sigma")
    if options.kind == "tumble":
        rotor = quantities(options.rotor, 3, "kg m^2/s", "--rotor") if options.rotor else None
        mass = None if options.mass is None else quantity(options.mass, "kg", "--mass")
        with progress("starts of the fit") as shown:
            found = identify.from_tumble(
                t, omega, sigma=sigma, bias=options.bias, rotor=rotor, mass=mass, progress=shown
            )
        finite = np.isfinite(omega).all(axis=1) & np.isfinite(t)
        return found, (t[finite], omega[finite])
    rows: dict[str, Any] = {name: log.values[name] for name in _OWN["wrench"] if name in log.values}
    if "angular_acceleration" in rows:
        rows["angular_acceleration"] = rows["angular_acceleration"] * _RATES[rate]
    return identify.from_wrench(t, omega=omega, omega_sigma=sigma, bias=options.bias, **rows), None


def _names(words: tuple[str, ...]) -> list[str]:
    return [part for word in words for part in word.replace(",", " ").split()]


def _unit(name: str) -> str:
    """Return the unit in brackets in the name of a column."""
    found = re.search(r"[\[(]([^\])]*)[\])]", name)
    return found.group(1).strip().lower() if found else ""


def _times(log: Log) -> tuple[Floats, list[str]]:
    """Return the times in s."""
    name, t = log.columns["time"][0], log.values["time"][:, 0]
    unit = _unit(name) or ("ms" if name.lower().endswith("ms") else "")
    scale = {"ms": 1e-3, "us": 1e-6, "µs": 1e-6, "μs": 1e-6, "ns": 1e-9, "min": 60.0}.get(unit, 1.0)
    notes = [] if scale == 1.0 else [f"times in {unit}, as the name {name!r} says: divided by {1 / scale:g}"]
    return t * scale, notes


def _rates(log: Log, options: IdentifyOptions, notes: list[str]) -> tuple[Floats, str]:
    """Return the angular velocity in rad/s, and the unit that it was taken to be in."""
    unit = options.rate_unit
    if unit is None:
        told = {_unit(name) for name in log.columns["omega"]} - {""}
        unit = "rad/s"
        if len(told) == 1 and (own := next(iter(told))) not in ("rad/s", "rads", "rad s-1", "1/s"):
            if own in ("deg/s", "dps", "°/s", "degrees/s"):
                unit = "deg/s"
            elif own == "rpm":
                unit = "rpm"
            else:
                raise PolhodeError(
                    f"--rate-unit: the name {log.columns['omega'][0]!r} says {own!r}, which is not known; "
                    "state --rate-unit rad/s, --rate-unit deg/s or --rate-unit rpm"
                )
            notes.append(f"angular velocity in {unit}, as the names of its columns say")
    return log.values["omega"] * _RATES[unit], unit


def _look(log: Log, t: Floats, notes: list[str]) -> None:
    """Tell what is amiss with the rows, with counts."""
    values = np.hstack([t[:, None], *(rows for name, rows in log.values.items() if name != "time")])
    lost = int((~np.isfinite(values).all(axis=1)).sum())
    if lost:
        notes.append(f"{lost} of {len(t)} rows have a number that is missing: left out")
    steps = np.diff(t[np.isfinite(t)])
    jumps = int((steps > _JUMP * np.median(steps)).sum()) if len(steps) else 0
    if jumps:
        notes.append(
            f"jumps of the clock: {jumps}, longer than {_JUMP:g} usual steps of {np.median(steps):.4g} s; "
            f"the longest is {steps.max():.4g} s"
        )
    for name, rows in log.values.items():
        count = 0 if name == "time" else sum(_saturated(column) for column in rows.T)
        if count:
            notes.append(
                f"{count} values of {name.replace('_', ' ')} stay at their extreme: is the sensor saturated?"
            )


def _saturated(column: Floats) -> int:
    """Return the number of values in runs at the largest or at the least value of a column."""
    total = 0
    finite = column[np.isfinite(column)]
    if not len(finite) or finite.min() == finite.max():
        return 0
    for extreme in (finite.min(), finite.max()):
        at = np.concatenate([[0], (finite == extreme).astype(int), [0]])
        starts, ends = np.flatnonzero(np.diff(at) == 1), np.flatnonzero(np.diff(at) == -1)
        total += int(sum(n for n in ends - starts if n >= _LIMIT))
    return total


def _pendulum(file: Path, options: IdentifyOptions, report: Report) -> tuple[Identified, None]:
    if options.gravity is None:
        raise PolhodeError('--gravity: pendulums need it, as in --gravity 9.81 or --gravity "9.812 ± 0.001"')
    gravity = amount(options.gravity, "m/s^2", "--gravity")
    mass = None if options.mass is None else amount(options.mass, "kg", "--mass")
    with as_file(file) as path:
        text = read_text(path, "a table of pendulums")
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    table = csv.DictReader(lines, skipinitialspace=True)
    names = [name for name in table.fieldnames or [] if name is not None]
    known = {"device", *(name for fields in _DEVICES.values() for name in fields)}
    other, needed = sorted(set(names) - known), {"device", "axis", "period"}
    if other or not needed <= set(names):
        wrong = f"{other[0]!r} is no column of pendulums" if other else "a column is missing"
        raise FileFormatError(
            f"{label(file)}: {wrong}; needed are device, axis and period; there may be "
            f"{', '.join(sorted(known - needed))}"
        )
    rows = [_row(k, row, label(file)) for k, row in enumerate(table, 1)]
    if not rows:
        raise FileFormatError(f"{label(file)}: it holds no rows below the names of its columns")
    report.section(
        "",
        Field("file", "file", label(file)),
        Field("rows", "rows", len(rows)),
        Field("columns", "columns", " ".join(names)),
    )
    return identify.from_pendulum(rows, gravity=gravity, mass=mass), None


def _row(k: int, row: dict[str, Any], name: str) -> Any:
    """Return the pendulum of a row."""
    where = f"{name}: row {k}"
    device = (row.get("device") or "").strip()
    if device not in _DEVICES:
        raise FileFormatError(f"{where}: device is {device!r}; it is one of {', '.join(_DEVICES)}")
    given: dict[str, Any] = {}
    for column, text in row.items():
        if column in (None, "device") or not (isinstance(text, str) and text.strip()):
            continue
        if column not in _DEVICES[device]:
            raise FileFormatError(f"{where}: a {device} pendulum has no {column}; leave the cell empty")
        if column == "axis" and text.strip() in "xyz":
            given[column] = tuple(np.eye(3)["xyz".index(text.strip())])
        elif column in ("axis", "about"):
            given[column] = amounts([text], 3, "" if column == "axis" else "m", f"{where}: {column}")
        else:
            given[column] = amount(text, _UNITS[column], f"{where}: {column}")
    try:
        return getattr(identify, device)(**given)
    except TypeError:
        needed = [one for one in _DEVICES[device][:4] if one not in given]
        raise FileFormatError(f"{where}: a {device} pendulum needs {needed[0]}; fill the cell") from None


def _tell(report: Report, found: Identified, kind: str) -> None:
    body, sigma = found.body, found.body.sigma
    known = found.scale_known
    of_place = [
        Field("mass", "mass", body.mass, "kg", sigma=None if sigma is None else sigma.mass),
        Field(
            "center_of_mass", "centre of mass", body.center_of_mass, "m",
            sigma=None if sigma is None else sigma.center_of_mass,
        ),
    ]  # fmt: skip
    if kind == "tumble":  # which does not tell them
        of_place = []
    report.section(
        "body",
        *of_place,
        Field(
            "principal_moments", "I1 I2 I3", body.principal_moments, "kg m^2" if known else "",
            hint="" if known else "(of a trace of 1: the scale is not told)",
            sigma=None if sigma is None else sigma.principal_moments,
        ),
        Field(
            "inertia", "inertia", body.inertia, "kg m^2" if known else "",
            sigma=None if sigma is None else sigma.inertia,
        ),
    )  # fmt: skip
    more = []
    if found.bias is not None:
        more.append(Field("bias", "offsets", np.asarray(found.bias.value).tolist()))
    if found.noise is not None:
        more.append(Field("noise", "noise", np.asarray(found.noise.value).tolist()))
    if found.window is not None:
        more.append(Field("window", "window", found.window, "rows"))
    report.section(
        "fit",
        Field("chi2", "chi-square", found.chi2),
        Field("degrees_of_freedom", "degrees of freedom", found.degrees_of_freedom),
        *([] if np.isnan(found.p_value) else [Field("p_value", "p", found.p_value)]),
        Field("at_edge", "at the edge of the possible", "yes" if found.at_edge else "no"),
        *more,
    )
    _directions(report, found.observability)
    report.section("verdict", Field("verdict", "verdict", "the log is explained"))
    if found.alternatives:
        report.notes.append(f"other bodies that explain the log nearly as well: {len(found.alternatives)}")


def _directions(report: Report, directions: tuple[Direction, ...]) -> None:
    if directions:
        rows = [
            {
                "words": one.words,
                "relative": one.relative if np.isfinite(one.relative) else None,
                "remedy": one.remedy,
            }
            for one in directions
        ]
        report.section("hardly determined", Table("observability", _COLUMNS, rows))


def _draw(found: Identified, drawing: Any, path: Path) -> None:
    """Draw the fit, where there is a motion, and the residuals."""
    figure: Any = require("matplotlib.figure", extra="plot", purpose="drawing")
    drawn = figure.Figure(figsize=(8.0, 6.0 if drawing else 4.5), facecolor="white", layout="constrained")
    if drawing is None or found.motion is None:
        found.plot(drawn.subplots())
    else:
        from polhode.draw.plot.axes import tidy
        from polhode.draw.style import AXIS_COLORS

        t, omega = drawing
        top, bottom = drawn.subplots(2, sharex=True, height_ratios=(3, 2))
        fine = np.linspace(t[0], t[-1], 2000)
        line = found.motion.at(fine - t[0]).omega
        if found.bias is not None:
            line = line + np.asarray(found.bias.value)
        for k, name in enumerate("xyz"):
            top.plot(t, omega[:, k], ".", color=AXIS_COLORS[k], markersize=2.0, alpha=0.5)
            top.plot(fine, line[:, k], color=AXIS_COLORS[k], linewidth=1.2, label=name)
        top.set_ylabel("ω, rad/s")
        top.legend(loc="upper right", ncols=3)
        tidy(top)
        found.plot(bottom, t=t)
        bottom.set_xlabel("t, s")
    save_picture(drawn, path)
