"""``polhode audit``: a recorded motion beside the exact one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np

from polhode import RigidBody, Trajectory, loads
from polhode._optional import require
from polhode.cli.files import as_file, check_suffixes, label
from polhode.cli.layout import Column, Field, Report, Table
from polhode.cli.loading import LoadedBody
from polhode.cli.spin import momentum_inside
from polhode.cli.whole import any_body, check_moments_alone, check_weight, mass_and_center
from polhode.errors import PolhodeError
from polhode.io.motion_tables import read_motion_table
from polhode.io.writing import save_picture
from polhode.motion.auditing import Audit, audit
from polhode.units import amounts, quantity

if TYPE_CHECKING:
    from pathlib import Path

    from polhode.cli.options import AuditOptions, BodyOptions

__all__ = ["audit_report", "draw_audit"]

_PICTURES: Final = (".png", ".pdf", ".svg")
_COLUMNS: Final = (
    Column("kind", "finding"),
    Column("before", "off by"),
    Column("after", "explained to"),
    Column("log_likelihood", "log likelihood"),
    Column("numbers", "numbers"),
)


def audit_report(file: Path, options: AuditOptions, body: BodyOptions) -> tuple[Report, Audit]:
    """Report on the record in a file; give the audit too."""
    check_suffixes(options.save, _PICTURES)
    if options.ratio is not None and options.finer is None:
        raise PolhodeError("--ratio: it compares the steps of two records; give the second one with --finer")
    loaded = _body(options, body)
    load = _load(options, loaded)
    record, columns = _record(file, loaded.body, load, options)
    finer = None if options.finer is None else _record(options.finer, loaded.body, load, options)[0]
    found = audit(record, rtol=options.rtol, finer=finer, ratio=options.ratio)
    report = Report()
    report.section(
        "",
        Field("file", "file", label(file)),
        Field("rows", "rows", len(record)),
        *(Field(f"columns.{name}", f"read as {name}", " ".join(names)) for name, names in columns.items()),
        Field("principal_moments", "principal moments", loaded.body.principal_moments, loaded.moment_unit),
    )
    report.section(
        "beside the exact motion of the same start",
        Field("energy_drift", "energy drift", _largest(found.energy_drift)),
        Field("angular_momentum_drift", "|L| drift", _largest(found.angular_momentum_drift)),
        Field("angle_from_exact", "angle from exact", _largest(found.angle_from_exact), "rad"),
        Field("residual_torque", "residual torque", _middle(found.residual_torque), hint="(median)"),
        *([] if found.order is None else [Field("order", "observed order", found.order)]),
    )
    report.section(
        "noise",
        Field("noise.attitude", "of attitudes", found.noise["attitude"], "rad"),
        Field("noise.angular_momentum", "of L", found.noise["angular_momentum"], hint="(relative)"),
    )
    if found.findings:
        report.section("findings", Table("findings", _COLUMNS, [_row(one) for one in found.findings]))
    verdict = (
        "the record is the motion of this body" if found.agrees else "the record is no motion of this body"
    )
    report.section("verdict", Field("verdict", "verdict", verdict))
    report.notes += loaded.notes
    report.notes += [f"{one.kind}: {one.words}" for one in found.findings]
    if not found.agrees and not found.findings:
        report.notes.append(
            "no mistake that is known explains the record; --rtol allows for the errors of a program's steps"
        )
    if record.omega is not None and "omega" not in columns:
        report.notes.append("no columns of an angular velocity: it was computed from the attitudes")
    return report, found


def draw_audit(found: Audit, path: Path) -> None:
    """Draw drifts and the distance from the exact motion."""
    figure: Any = require("matplotlib.figure", extra="plot", purpose="drawing")
    drawn = figure.Figure(figsize=(8.0, 4.5), facecolor="white", layout="constrained")
    found.plot(drawn.subplots())
    save_picture(drawn, path)


def _body(options: AuditOptions, body: BodyOptions) -> LoadedBody:
    if not options.moments:
        if options.body is None and not body.inertia:
            raise PolhodeError(
                "audit: say which body it is: --body FILE, or principal moments along the axes of the record "
                "with --moments, or a tensor with --inertia"
            )
        return any_body(options.body, body)
    if options.body is not None or body.inertia:
        other = "--body" if options.body is not None else "--inertia"
        raise PolhodeError(f"--moments and {other}: both say what the body is; give one of the two")
    check_moments_alone(body, *(() if options.gravity is None else ("mass", "center_of_mass")))
    check_weight(options.gravity, body)
    mass, center = mass_and_center(body)
    moments = [
        float(getattr(one, "value", one)) for one in amounts(options.moments, 3, "kg m^2", "--moments")
    ]
    known = RigidBody(float(getattr(mass, "value", mass)), np.diag(moments), center_of_mass=center)
    return LoadedBody(known, [], "kg", "m")


def _load(options: AuditOptions, loaded: LoadedBody) -> dict[str, Any]:
    """Return what is declared to act, and about which point the body turns."""
    found: dict[str, Any] = {}
    if options.gravity is not None:
        g = quantity(options.gravity, "m/s^2", "--gravity")
        found = {"load": loads.uniform_gravity((0.0, 0.0, -g)), "about": "origin"}
    if options.wheel:
        rotor = loads.rotor(momentum_inside(options.wheel, np.eye(3), loaded))
        found["load"] = found["load"] + rotor if "load" in found else rotor
    return found


def _record(
    file: Path, body: RigidBody, load: dict[str, Any], options: AuditOptions
) -> tuple[Trajectory, dict[str, list[str]]]:
    with as_file(file) as path:
        table = read_motion_table(
            path,
            time=options.time,
            attitude=_names(options.attitude),
            omega=_names(options.omega),
            name=label(file),
        )
    if (table.attitude.shape[1:] == (3,)) != (options.sequence is not None):
        raise PolhodeError(
            "--sequence: it is for three Euler angles; leave it out"
            if options.sequence is not None
            else "--attitude: three columns are Euler angles; give their order with --sequence, such as ZYX"
        )
    record = Trajectory.from_samples(
        body, table.t, table.attitude, table.omega, sequence=options.sequence, **load
    )
    return record, table.columns


def _names(words: tuple[str, ...]) -> list[str]:
    return [part for word in words for part in word.replace(",", " ").split()]


def _largest(values: Any) -> float:
    return float(np.nanmax(np.abs(values)))


def _middle(vectors: Any) -> float:
    return float(np.nanmedian(np.linalg.norm(vectors, axis=1)))


def _row(finding: Any) -> dict[str, Any]:
    own = {name: value for name, value in finding.evidence.items() if name not in ("before", "after")}
    own.pop("log_likelihood")
    told = ", ".join(f"{name} {_short(value)}" for name, value in own.items())
    return {"kind": finding.kind, "words": finding.words, "numbers": told or None, **finding.evidence}


def _short(value: Any) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, list):
        return " ".join(f"{one:.6g}" for one in value[:6]) + (" ..." if len(value) > 6 else "")
    return f"{value:.6g}"
