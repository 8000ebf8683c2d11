"""``polhode flyby``: clones of a tumbling body past a planet, in numbers and pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import RigidBody, orbits, plot
from polhode._optional import require
from polhode.cli.ensemble import client_at
from polhode.cli.files import check_suffixes, label
from polhode.cli.layout import Cell, Column, Field, Report, Table
from polhode.cli.options import MODES
from polhode.cli.whole import any_body, check_moments_alone
from polhode.errors import PolhodeError
from polhode.flybys import Flyby, Forecast, flyby
from polhode.io.writing import save_picture
from polhode.units import amount, amounts, quantity, vector

if TYPE_CHECKING:
    from pathlib import Path

    from polhode.cli.options import BodyOptions, FlybyOptions

__all__ = ["draw_flyby", "flyby_report"]

EARTH: Final = 3.986004418e14
EARTH_RADIUS: Final = 6.371e6
HOUR: Final = 3600.0
SHARES: Final = (0.05, 0.5, 0.95)
PICTURES: Final = (".png", ".pdf", ".svg")
FORECAST: Final = (
    Column("name", "number"),
    Column("value", "value"),
    Column("sigma", "sigma"),
    Column("unit", "unit"),
)


def flyby_report(file: Path | None, options: FlybyOptions, body: BodyOptions) -> tuple[Report, Flyby]:
    """Run the clones and report on them; give them too."""
    found, orbit, notes = _run_flyby(file, options, body)
    report = Report()
    elements = orbit.elements
    report.section(
        "",
        Field("file", "file", "(moments)" if file is None else label(file)),
        Field("clones", "clones", len(found.failed)),
        Field("seed", "seed", options.seed),
    )
    report.section(
        "orbit",
        Field("eccentricity", "eccentricity", float(elements.eccentricity)),
        Field("periapsis", "least distance", float(elements.periapsis) / 1e3, "km"),
        Field("span", "span", quantity(options.span, "s", "--span") / HOUR, "h"),
        Field("speed", "speed at the start", float(np.linalg.norm(orbit.velocity)) / 1e3, "km/s"),
    )
    report.section(
        "before",
        Field("before.mode", "mode", str(found.before.mode[0])),
        *_before("rotation_period", "P_psi", found.before.rotation_period / HOUR),
        *_before("precession_period", "P_phi", found.before.precession_period / HOUR),
    )
    columns = (
        Column("name", "number"),
        Column("low", "5 %"),
        Column("median", "median"),
        Column("high", "95 %"),
        Column("unit", "unit"),
    )
    rows = [
        _row("P_psi", found.after.rotation_period / HOUR, "h"),
        _row("P_phi", found.after.precession_period / HOUR, "h"),
        _row("spin rate, ratio", found.spin_ratio, ""),
        _row("pole shift", np.degrees(found.pole_shift), "deg"),
    ]
    report.section("after", Table("after", columns, rows))
    shares = [
        {"mode": name, "share": Cell(f"{100.0 * share:.3g} %", share)}
        for name, share in found.modes().items()
    ]
    if found.forecast is not None:
        report.section("forecast", Table("forecast", FORECAST, _forecast(found.forecast)))
        if not found.forecast.linear:
            report.notes.append(
                "forecast: where no sigma stands, the first order is not enough; the table of quantiles says "
                "how wide the distribution is"
            )
    report.section("modes after", Table("modes", (Column("mode", "mode"), Column("share", "clones")), shares))
    if found.failed.any():
        report.notes.append(f"{int(found.failed.sum())} clones failed, and are left out of these numbers")
    report.notes += notes
    report.notes.append("spin rate: 2 E/|L|; pole shift: the angle between L before and after")
    return report, found


def draw_flyby(found: Flyby, path: Path) -> None:
    """Draw the spread of four numbers."""
    figure_module: Any = require("matplotlib.figure", extra="plot", purpose="drawing")
    figure = figure_module.Figure(figsize=(11.0, 7.4), facecolor="white", layout="constrained")
    axes = figure.subplots(2, 2).ravel()
    plot.flyby(found, "rotation_period", axes[0], time_label="h", time_scale=HOUR)
    plot.flyby(found, "precession_period", axes[1], time_label="h", time_scale=HOUR)
    plot.flyby(found, "spin_ratio", axes[2])
    plot.flyby(found, "pole_shift", axes[3])
    save_picture(figure, path)


def _run_flyby(
    file: Path | None, options: FlybyOptions, body: BodyOptions
) -> tuple[Flyby, orbits.Orbit, tuple[str, ...]]:
    if (file is None) == (not options.moments):
        raise PolhodeError("flyby: give a file, or principal moments with --moments")
    check_suffixes(options.save, PICTURES)
    if options.n < 1:
        raise PolhodeError(f"--n: expected a positive number, got {options.n}")
    if not options.periods:
        raise PolhodeError('--periods: state the two periods, as in "264.178 h, 27.38547 h"')
    if options.mode is None:
        raise PolhodeError(f"--mode: {MODES}")
    notes: tuple[str, ...]
    if file is not None:
        loaded = any_body(file, body)
        asteroid, notes = loaded.body, tuple(loaded.notes)
    else:
        check_moments_alone(body)
        notes = ()
        asteroid = RigidBody.from_principal(1.0, amounts(options.moments, 3, "kg m^2", "--moments"))
    rotation, precession = amounts(options.periods, 2, "s", "--periods")
    span = quantity(options.span, "s", "--span")
    if not span > 0.0:
        raise PolhodeError(f"--span: expected a positive time, got {span:g}")
    if not options.eccentricity >= 0.0:
        raise PolhodeError(f"--eccentricity: expected 1 or more, got {options.eccentricity:g}")
    if options.eccentricity < 1.0:
        raise PolhodeError(
            f"--eccentricity: {options.eccentricity:g} is that of an ellipse, on which the body goes round "
            "the planet; state 1 or more, as in --eccentricity 4.25, or for an ellipse call polhode.ensemble "
            "in Python, with load=loads.gravity_gradient(orbit)"
        )
    mu = quantity(options.mu, "m^3/s^2", "--mu")
    periapsis = quantity(options.periapsis, "m", "--periapsis")
    radius = EARTH_RADIUS if abs(mu / EARTH - 1.0) < 1e-3 else None
    if options.radius is not None:
        radius = quantity(options.radius, "m", "--radius")
    if radius is None:
        notes = (
            *notes,
            "the radius of this planet is unknown here: with --radius an orbit through it is refused",
        )
    elif not periapsis > radius:
        raise PolhodeError(
            f"--periapsis: {periapsis / 1e3:.6g} km from the centre is within the planet, whose radius is "
            f'{radius / 1e3:.6g} km; state a larger distance, as in --periapsis "38011.486 km", or another '
            "--radius"
        )
    pole_sigma = quantity(options.pole_sigma, "rad", "--pole-sigma")
    if not pole_sigma >= 0.0:
        raise PolhodeError(f"--pole-sigma: expected zero or more, got {options.pole_sigma!r}")
    if not options.pole:
        for name, is_given in (
            ("--pole-sigma", pole_sigma > 0.0),
            ("--azimuth", options.azimuth is not None),
        ):
            if is_given:
                raise PolhodeError(f"{name}: the direction is missing; state it, as in --pole 0 0 1")
    orbit = orbits.from_elements(
        mu,
        eccentricity=options.eccentricity,
        periapsis=periapsis,
        inclination=quantity(options.inclination, "rad", "--inclination"),
        node=quantity(options.node, "rad", "--node"),
        argument=quantity(options.argument, "rad", "--argument"),
        since_periapsis=-0.5 * span,
    )
    with client_at(options.client) as client:
        found = flyby(
            asteroid,
            orbit,
            span,
            rotation_period=rotation,
            precession_period=precession,
            mode=options.mode,
            pole=vector(options.pole, "", "--pole") if options.pole else None,
            pole_sigma=pole_sigma,
            phase=None if options.phase is None else amount(options.phase, "", "--phase"),
            azimuth=None if options.azimuth is None else amount(options.azimuth, "rad", "--azimuth"),
            radius=radius,
            n=options.n,
            seed=options.seed,
            rtol=options.rtol,
            client=client,
        )
    return found, orbit, notes


def _before(name: str, label: str, hours: Any) -> list[Field]:
    """Return a period before the flyby: the same for all clones, or the median and the spread of theirs."""
    low, median, high = (float(x) for x in np.nanquantile(hours, SHARES))
    is_same = high - low <= 1e-9 * median
    hint = "" if is_same else f"median; 5 % to 95 %: {low:.6g} to {high:.6g}"
    return [Field(f"before.{name}", label, median, "h", hint)]


def _forecast(found: Forecast) -> list[dict[str, Any]]:
    """Return each figure with its sigma, where the first order is enough for one."""
    figures = (
        ("P_psi", found.rotation_period, 1.0 / HOUR, "h"),
        ("P_phi", found.precession_period, 1.0 / HOUR, "h"),
        ("spin rate, ratio", found.spin_ratio, 1.0, ""),
        ("pole shift", found.pole_shift, np.degrees(1.0), "deg"),
    )
    return [
        {
            "name": name,
            "value": float(one.value) * factor,
            "sigma": float(one.sigma) * factor if one.linear else None,
            "unit": unit,
        }
        for name, one, factor, unit in figures
    ]


def _row(name: str, values: Any, unit: str) -> dict[str, Any]:
    low, median, high = (float(x) for x in np.nanquantile(values, SHARES))
    return {"name": name, "low": low, "median": median, "high": high, "unit": unit}
