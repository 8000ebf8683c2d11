"""``polhode validate``: published cases and closed interop, computed on this machine."""

from __future__ import annotations

import hashlib
import math
import platform
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from importlib.metadata import PackageNotFoundError, requires, version
from operator import add
from typing import Final, Literal

import numpy as np

from polhode import RigidBody, __version__, _core, interop, loads, orbits, solids
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


_CRAFT: Final = ((9.0, 0.4, -0.2), (0.4, 8.0, 0.3), (-0.2, 0.3, 10.0))
_CRAFT_RATE: Final = (0.05, -0.08, 0.1)


def _balanced_wheels() -> Numbers:
    """Three wheels of Honeywell HR16, whose torque is at most 0.2 N m; modified Rodrigues parameters."""
    rpm = math.pi / 30.0
    motors = zip(np.eye(3), (500.0, 200.0, -150.0), (0.2, 0.1, -0.5), strict=True)
    wheels: list[loads.Load] = [
        loads.wheel(
            axis, 100.0 / (6000.0 * rpm), rate * rpm, torque=[torque, 0.0], times=[0.0, 0.5], max_torque=0.2
        )
        for axis, rate, torque in motors
    ]
    body = RigidBody(750.0, np.diag((900.0, 800.0, 600.0)))
    quaternion = body.simulate(
        [0.0, 1.0], (0.08, 0.01, 0.0), load=reduce(add, wheels), rtol=1e-12
    ).quaternion[-1]
    return _to_floats(quaternion[:3] / (1.0 + quaternion[3]))


def _pyramid() -> Numbers:
    axes = ((1, 0, 1), (0, 1, 1), (-1, 0, 1), (0, -1, 1))
    torques = ((0.04, -0.03), (-0.02, 0.05), (0.03, 0.0), (0.01, 0.02))
    wheels: list[loads.Load] = [
        loads.wheel(axis, 0.03, rate, torque=torque, times=(0.0, 8.0), friction=2e-4, max_torque=0.035)
        for axis, rate, torque in zip(axes, (40.0, -30.0, 20.0, 60.0), torques, strict=True)
    ]
    motion = RigidBody(90.0, _CRAFT).simulate([0.0, 20.0], _CRAFT_RATE, load=reduce(add, wheels), rtol=1e-13)
    omega = motion.omega[-1]
    momenta = [momentum[-1, 0] for momentum in motion.states.values()]
    rates = [h / 0.03 - omega @ axis / math.sqrt(2.0) for h, axis in zip(momenta, axes, strict=True)]
    return _to_floats([*omega, *rates])


def _coils() -> Numbers:
    load = loads.magnetic((5e3, -2e4, 1.25e3), (1e-5, -3e-5, 2e-5), max_dipole=(4e3, 2.5e3, 1e4))
    start = np.array((0.2, 0.4, -0.6, 0.86)) / 1.14  # Rodrigues parameters 0.1, 0.2, -0.3
    return _to_floats(
        RigidBody(90.0, _CRAFT).simulate([0.0, 60.0], _CRAFT_RATE, start, load=load, rtol=1e-13).omega[-1]
    )


def _thrusters() -> Numbers:
    duties = np.array(((64, 128, 192, 0), (250, 26, 0, 77), (0, 154, 51, 250), (102, 0, 240, 13))) / 256.0
    load = loads.thrusters(
        ((1.0, 0.2, 0.0), (-1.0, 0.1, 0.3), (0.0, 1.0, -0.2), (0.1, -1.0, 0.0)),
        ((0.0, 1.0, 0.2), (0.1, 1.0, 0.0), (0.0, 0.3, 1.0), (0.2, 0.0, -1.0)),
        (0.2, 0.3, 0.25, 0.15),
        command=duties,
        times=(0.0, 2.0, 4.0, 6.0),
        period=2.0,
    )
    return _to_floats(
        RigidBody(90.0, _CRAFT).simulate([0.0, 8.0], _CRAFT_RATE, load=load, rtol=1e-13).omega[-1]
    )


def _tide() -> Numbers:
    """Compute ω on an ellipse, in degrees an hour."""
    body = RigidBody(90.0, ((60.0, 4.0, -2.0), (4.0, 80.0, 3.0), (-2.0, 3.0, 30.0)))
    load = loads.gravity_gradient(3.986004415e14, (7.2e6, 0.0, 0.0), (0.0, 8e3, 2e3))
    omega = body.simulate([0.0, 3000.0], (1e-3, -5e-4, 2e-3), load=load, rtol=1e-13).omega[-1]
    return _to_floats(np.rad2deg(omega) * 3600.0)


_PITCH: Final = math.radians(40.0)
_LIBRATING: Final = (2.0, 2.2, 0.5)


def _libration_period() -> float:
    """Compute the period of a pendulum: ``θ'' = -3/2 n² (I₁ - I₃)/I₂ sin 2θ`` for n = 1, from 40 degrees."""
    first, second, third = _LIBRATING
    return 2.0 * math.pi / (_mean(1.0, math.cos(_PITCH)) * math.sqrt(3.0 * (first - third) / second))


def _libration() -> Numbers:
    """Compute the pitch after a quarter, a half and a whole of its period."""
    orbit = orbits.kepler(1.0, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    t = np.array((0.0, 0.25, 0.5, 1.0)) * _libration_period()
    frame = orbit.frame(t)
    x, y, z, w = frame.quaternion[0]
    s, c = math.sin(0.5 * _PITCH), math.cos(0.5 * _PITCH)
    start = (c * x - s * z, c * y + s * w, c * z + s * x, c * w - s * y)
    motion = RigidBody.from_principal(1.0, _LIBRATING).simulate(
        t, frame.omega[0], start, load=loads.gravity_gradient(orbit), rtol=1e-13
    )
    # The axis of the pitch is that of the orbit, in the body and in the frame.
    long_axis = _core.rotate(motion.quaternion, (0.0, 0.0, 1.0))
    seen = _core.rotate(frame.quaternion, long_axis, inverse=True)
    return _to_floats(np.arctan2(seen[1:, 0], seen[1:, 2]))


_EARTH: Final = 398600.4418


def _kepler() -> Numbers:
    orbit = orbits.kepler(_EARTH, (1131.340, -2282.343, 6672.423), (-5.64305, 4.30333, 2.42879))
    return _to_floats(orbit.at(2400.0).position)


_J2: Final = 1.08263e-3
_EQUATOR: Final = 6378.137
_CIRCLE: Final = 7000.0
_CIRCLE_RATE: Final = math.sqrt(_EARTH / _CIRCLE**3 * (1.0 + 1.5 * _J2 * (_EQUATOR / _CIRCLE) ** 2))


def _oblate() -> Numbers:
    state = (_CIRCLE, 0.0, 0.0), (0.0, _CIRCLE_RATE * _CIRCLE, 0.0)
    return _to_floats(orbits.kepler(_EARTH, *state, j2=_J2, radius=_EQUATOR).at(86400.0).position)


def _node() -> Numbers:
    """Compute the drift of the node in degrees a day, over ten days."""
    orbit = orbits.from_elements(
        _EARTH,
        eccentricity=0.001,
        semi_major_axis=7178.0,
        inclination=98.6,
        degrees=True,
        j2=_J2,
        radius=_EQUATOR,
    )
    days = np.arange(11.0)
    place, velocity = orbit.at(86400.0 * days)
    normal = np.cross(place, velocity)
    node = np.unwrap(np.arctan2(normal[:, 0], -normal[:, 1]))
    return (float(np.degrees(np.polyfit(days, node, 1)[0])),)


def _node_drift() -> float:
    rate = math.sqrt(_EARTH / 7178.0**3)
    drift = -1.5 * _J2 * rate * (_EQUATOR / (7178.0 * (1.0 - 1e-6))) ** 2 * math.cos(math.radians(98.6))
    return math.degrees(drift) * 86400.0


_PERIAPSIS, _ECCENTRICITY = 38011.486, 4.253901873
_ANOMALY: Final = math.radians(100.0)


def _flyby() -> Numbers:
    """Compute the rate of a body that was at rest, per product of inertia, in seconds of arc a second.

    The product is so small that the body turns by less than a second of arc.
    """
    part = math.sqrt((_ECCENTRICITY - 1.0) / (_ECCENTRICITY + 1.0)) * math.tan(0.5 * _ANOMALY)
    hyperbolic = 2.0 * math.atanh(part)
    axis = _PERIAPSIS / (_ECCENTRICITY - 1.0)
    half = (_ECCENTRICITY * math.sinh(hyperbolic) - hyperbolic) * math.sqrt(axis**3 / _EARTH)
    orbit = orbits.from_elements(
        _EARTH, eccentricity=_ECCENTRICITY, periapsis=_PERIAPSIS, since_periapsis=-half
    )
    body = RigidBody(1.0, ((1.0, 1e-6, 0.0), (1e-6, 1.0, 0.0), (0.0, 0.0, 1.0)))
    load = loads.gravity_gradient(orbit)
    omega = body.simulate([0.0, 2.0 * half], (0.0, 0.0, 0.0), load=load, rtol=1e-13).omega[-1]
    return _to_floats(np.rad2deg(omega) * 3600.0 / 1e-6)


def _tidal_kick() -> float:
    """Compute ``3 mu/(p h) I₁₂ ∫ (1 + e cos f) cos 2f df``, from the true anomaly -100 to 100 degrees."""
    parameter = _PERIAPSIS * (1.0 + _ECCENTRICITY)
    angles = math.sin(2.0 * _ANOMALY) + _ECCENTRICITY * (math.sin(_ANOMALY) + math.sin(3.0 * _ANOMALY) / 3.0)
    return math.degrees(3.0 * math.sqrt(_EARTH / parameter**3) * angles) * 3600.0


_BASILISK: Final = "Basilisk 2.12.1"
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
        "spacecraft",
        "three balanced wheels, attitude at 1 s",
        "Basilisk, test_reactionWheelStateEffector_integrated.py",
        (1.99853994e-02, 2.45647716e-03, 8.45356279e-06),
        5.1e-11,
        _balanced_wheels,
    ),
    Case(
        "spacecraft",
        "four wheels with friction, rad/s at 20 s",
        f"{_BASILISK}, step 1/256 s, by 1/128 the same to 2e-13",
        (
            0.04371234003222547,
            -0.046906696287765726,
            0.1160976991196874,
            31.854809641761165,
            -17.629272515953595,
            24.680919110317305,
            62.60671922854026,
        ),
        1e-11,
        _pyramid,
    ),
    Case(
        "spacecraft",
        "three coils, two saturated, rad/s at 60 s",
        f"{_BASILISK}, step 1/100 s",
        (0.1378052392720095, -0.006130385611334306, -0.01163096737866266),
        1e-11,
        _coils,
    ),
    Case(
        "spacecraft",
        "four thrusters in pulses, rad/s at 8 s",
        f"{_BASILISK}, three steps, extrapolated",
        (0.19434437793307371, -0.08616809653658342, 0.0908939396065957),
        1e-11,
        _thrusters,
    ),
    Case(
        "spacecraft",
        "gravity gradient on an ellipse, deg/h at 3000 s",
        f"{_BASILISK}, step 1/4 s, by 1/2 the same to 3e-12",
        tuple(
            math.degrees(rate) * 3600.0
            for rate in (-0.0010570351184167601, 0.00027882140514733447, 0.0014159936629154274)
        ),
        1e-9,
        _tide,
    ),
    Case(
        "orbit",
        "libration of a satellite from 40 deg",
        "the pendulum: 0, -40 and 40 deg by its period",
        (0.0, -_PITCH, _PITCH),
        1e-11,
        _libration,
    ),
    Case(
        "orbit",
        "40 minutes on an ellipse, km",
        "Vallado, Fundamentals of Astrodynamics, example 2-4",
        (-4219.7527, 4363.0292, -3958.7666),
        6e-5,
        _kepler,
    ),
    Case(
        "orbit",
        "a day about the oblate Earth, km",
        "circle in the equator: cos, sin",
        (_CIRCLE * math.cos(86400.0 * _CIRCLE_RATE), _CIRCLE * math.sin(86400.0 * _CIRCLE_RATE), 0.0),
        1e-7,
        _oblate,
    ),
    Case(
        "orbit",
        "drift of the node of a sun-synchronous orbit, deg/d",
        "first order in J2: -3/2 J2 n (R/p)^2 cos i",
        (_node_drift(),),
        0.005,
        _node,
    ),
    Case(
        "flyby",
        "tide of the Earth on Apophis in 2029, arcsec/s",
        "closed form of the integral along the hyperbola",
        (0.0, 0.0, _tidal_kick()),
        2e-5,
        _flyby,
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
