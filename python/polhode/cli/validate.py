"""``polhode validate``: published cases and closed interop, computed on this machine."""

from __future__ import annotations

import hashlib
import math
import platform
import sys
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, requires, version
from typing import Final, Literal

import numpy as np

from polhode import RigidBody, __version__, _core, interop, solids
from polhode.cli import brick
from polhode.cli.layout import Column, Field, Report, Table
from polhode.molecules import rotational_constants

__all__ = [
    "CASES",
    "Case",
    "Numbers",
    "as_text",
    "machine_fields",
    "validation",
]

Numbers = tuple[float, ...]


@dataclass(frozen=True)
class Case:
    """What is computed, and the numbers of others.

    Attributes
    ----------
    kind, name, source : str
    expected : tuple of float
        What the source says.
    allowed : float
        How far any number may be from it: what the source leaves open, or some units of rounding.
    compute : callable
        Gives ours.
    """

    kind: str
    name: str
    source: str
    expected: Numbers
    allowed: float
    compute: Callable[[], Numbers]


def _to_floats(values: object) -> Numbers:
    return tuple(float(value) for value in np.ravel(np.asarray(values)))


def _brick(method: Literal["exact", "taylor", "dop853"], rtol: float) -> Callable[[], Numbers]:
    def compute() -> Numbers:
        body = RigidBody(brick.MASS, np.diag(brick.MOMENTS))
        start = np.deg2rad(brick.START_RATES)
        return _to_floats(
            np.rad2deg(body.simulate([0.0, brick.DURATION], start, method=method, rtol=rtol).omega[-1])
        )

    return compute


def _apophis() -> Numbers:
    body = RigidBody.from_principal(1.0, (0.61, 0.965, 1.0))
    return (float(body.free_motion_from_periods(263.0, 27.38, mode="short-axis").energy_ratio),)


def _diatomic(masses: tuple[float, float], length: float) -> Callable[[], Numbers]:
    """Return the rotational constant of two atoms at a distance in angstroms, in 1/cm."""

    def compute() -> Numbers:
        body = RigidBody.from_particles(masses, [(0.0, 0.0, 0.0), (0.0, 0.0, length)])
        return (float(rotational_constants(body.principal_moments, "cm^-1")[2]),)

    return compute


def _printout() -> Numbers:
    center = (-0.45582142, 0.92780847, 0.0)
    products = (0.50358715, 0.17140362, 0.66303218, -0.05932693, 0.0, 0.0)
    return _to_floats(
        interop.from_printout(1.51653435, center, products, products="positive").principal_moments
    )


def _corner() -> Numbers:
    corners, faces = (
        [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
        [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)],
    )
    body = RigidBody.from_mesh(corners, faces, density=120.0)
    tensor = body.inertia_about("origin")
    return _to_floats([body.mass, tensor[0, 0], tensor[0, 1]])


def _cone() -> Numbers:
    return _to_floats(solids.cone(1.0, 4.0, mass=20.0).principal_moments)


def _symmetric() -> Numbers:
    body = RigidBody.from_principal(1.0, (2.0, 2.0, 3.0))
    return _to_floats(body.simulate([0.0, 10.0], (1.0, 0.0, 2.0), method="taylor", rtol=1e-13).omega[-1])


def _separatrix(method: Literal["exact", "dop853"]) -> Callable[[], Numbers]:
    def compute() -> Numbers:
        body = RigidBody.from_principal(1.0, (1.0, 2.0, 3.0))
        start = (math.sqrt(3.0), 0.0, 1.0)
        return _to_floats(body.simulate([0.0, 4.0], start, method=method, rtol=1e-13).omega[-1])

    return compute


def _period() -> Numbers:
    body = RigidBody.from_principal(1.0, (1.0, 2.0, 3.0))
    return (float(body.free_motion((0.2, 0.0, 1.0)).periods.rotation),)


def _mean(a: float, b: float) -> float:
    """Compute Gauss's mean of two numbers."""
    while abs(a - b) > 1e-15 * a:
        a, b = (a + b) / 2.0, math.sqrt(a * b)
    return a


_NASA: Final = "NASA/TM-2015-218675, check case 2"
_HERZBERG: Final = "Huber and Herzberg, Molecular Structure IV (1979)"
_T, _S3 = 4.0, math.sqrt(3.0)
_SECH, _TANH = 1.0 / math.cosh(_T), math.tanh(_T)
CASES: Final = (
    Case("NASA", "tumbling brick, deg/s at 30 s", _NASA, brick.NASA_RATES, 3e-10, _brick("exact", 1e-10)),
    Case("NASA", "the same, DOP853", f"{_NASA}, 25 digits", brick.EXACT_RATES, 1e-8, _brick("dop853", 1e-10)),
    Case(
        "NASA", "the same, Taylor", f"{_NASA}, 25 digits", brick.EXACT_RATES, 1e-11, _brick("taylor", 1e-13)
    ),
    Case(
        "asteroid",
        "Apophis: E/E0 from two periods",
        "Pravec et al., Icarus 233 (2014) 48: 1.024(13)",
        (1.024,),
        0.013,
        _apophis,
    ),
    Case(
        "molecule", "CO: B, 1/cm", _HERZBERG, (1.93128087,), 4e-6, _diatomic((12.0, 15.99491461957), 1.128323)
    ),
    Case("molecule", "N2: B, 1/cm", _HERZBERG, (1.998241,), 2e-5, _diatomic((14.0030740044,) * 2, 1.097685)),
    Case(
        "CAD",
        "a wing's principal moments, lb ft^2",
        "a printout of SolidWorks in 8 decimals",
        (0.16112601, 0.51386477, 0.66303218),
        4e-8,
        _printout,
    ),
    Case(
        "closed form", "corner of a cube, as a mesh", "by hand: 20, 4, -1", (20.0, 4.0, -1.0), 4e-15, _corner
    ),
    Case("closed form", "cone", "3/20 m (r^2 + h^2/4), 3/10 m r^2", (6.0, 15.0, 15.0), 1e-14, _cone),
    Case(
        "closed form",
        "symmetric top, rad/s at 10 s",
        "cos, sin",
        (math.cos(10.0), math.sin(10.0), 2.0),
        1e-11,
        _symmetric,
    ),
    Case(
        "closed form",
        "separatrix at 4 s, exact",
        "sech, tanh",
        (_S3 * _SECH, _S3 * _TANH, _SECH),
        1e-13,
        _separatrix("exact"),
    ),
    Case(
        "closed form",
        "separatrix at 4 s, DOP853",
        "sech, tanh",
        (_S3 * _SECH, _S3 * _TANH, _SECH),
        1e-10,
        _separatrix("dop853"),
    ),
    Case(
        "closed form",
        "period of a polhode, s",
        "2 pi over Gauss's mean",
        (2.0 * math.pi / _mean(1.0, math.sqrt(1.0 - 0.04 / 3.0)),),
        4e-15,
        _period,
    ),
)
"""All of them, in the order of the table."""


def validation(cases: tuple[Case, ...] = CASES) -> tuple[Report, bool]:
    """Compute every case; give the table, and whether all agree."""
    rows, bits = [], hashlib.sha256()
    for case in cases:
        found = case.compute()
        bits.update(np.array(found, "<f8").tobytes())
        off = max(abs(ours - theirs) for ours, theirs in zip(found, case.expected, strict=True))
        rows.append(
            {
                "kind": case.kind,
                "case": case.name,
                "difference": off,
                "allowed": case.allowed,
                # What is not a number is not within it either.
                "verdict": "good" if off <= case.allowed else "bad",
                "source": case.source,
                "expected": list(case.expected),
                "found": list(found),
                "bits": [value.hex() for value in found],
            }
        )
    columns = [
        Column("kind", "kind"),
        Column("case", "case"),
        Column("difference", "off by at most"),
        Column("allowed", "allowed"),
        Column("verdict", "verdict"),
        Column("source", "against"),
    ]
    report = Report()
    report.section("", *machine_fields())
    report.section("published cases and closed forms", Table("cases", columns, rows))
    bad = sum(row["verdict"] == "bad" for row in rows)
    report.notes.append(
        f"{bad} of {len(rows)} cases are bad" if bad else f"{len(rows)} cases agree with the published values"
    )
    report.notes.append(f"the bits of all numbers: {bits.hexdigest()[:16]}; --format json shows them")
    return report, not bad


#: Distributions of the extras, where their names are others than the modules'.
_NEEDED: Final = ("numpy",)


def machine_fields() -> list[Field]:
    """Return the versions of what is installed, and what long runs use."""
    level, threads = _core.machine()
    lock = "" if getattr(sys, "_is_gil_enabled", lambda: True)() else ", without the lock of the interpreter"
    libraries = ", ".join(f"{name} {found}" for name, found in _libraries().items())
    return [
        Field("polhode", "polhode", __version__),
        Field("python", "Python", f"{platform.python_implementation()} {platform.python_version()}{lock}"),
        Field("system", "system", platform.platform()),
        Field("processor", "processor", platform.machine()),
        Field("instruction_set", "instruction set", level),
        Field("threads", "threads", threads),
        Field("libraries", "libraries", libraries),
    ]


def as_text() -> str:
    """Return what ``polhode --version --verbose`` prints."""
    fields = machine_fields()
    return "\n".join(f"{field.label:<16} {field.value!s}" for field in fields)


def _libraries() -> dict[str, str]:
    """Return the versions of those libraries that polhode names and that are there."""
    try:
        needs = requires("polhode") or []
    except PackageNotFoundError:  # a source tree on the path
        needs = list(_NEEDED)
    names = sorted({_name(need) for need in needs} - {"polhode"})
    found = {}
    for name in names:
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            continue
    return found


def _name(need: str) -> str:
    """Return the distribution that a requirement names."""
    for stop in range(len(need)):
        if not (need[stop].isalnum() or need[stop] in "-_."):
            return need[:stop]
    return need
