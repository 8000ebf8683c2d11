"""Mistakes that many make in Python: each is refused with what to write instead."""

from __future__ import annotations

import importlib
import inspect
import re
import subprocess
import sys
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
import polhode
import pytest
from mesh_files import obj
from oracles.meshes import cube
from polhode import RigidBody, _hints, interop, laminae, loads, rods, solids
from polhode.cli.app import app
from polhode.cli.running import COMMANDS, OTHER_OPTIONS

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

BODY: Any = solids.box((3.0, 2.0, 1.0), mass=1.0)
TOP: Any = RigidBody.from_principal(1.0, (2.0, 2.0, 3.0), center_of_mass=(0.0, 0.0, 0.1))
MADE: Any = RigidBody
LOADS: Any = loads
SOLIDS: Any = solids
LAMINAE: Any = laminae
RODS: Any = rods
POLHODE: Any = polhode
TRAJECTORY: Any = polhode.Trajectory
SPUN = ([0.0, 1.0], (0.0, 0.0, 1.0))

MISTAKES: list[tuple[str, Callable[[], object], type[Exception], str]] = [
    (
        "three moments for a tensor",
        lambda: MADE(1.0, (1, 2, 3)),
        ValueError,
        "inertia: expected shape (..., 3, 3), got (3,); RigidBody.from_principal takes",
    ),
    (
        "a center",
        lambda: MADE(1.0, np.eye(3), center=(0, 0, 1)),
        TypeError,
        "RigidBody() got an unexpected keyword argument 'center'; did you mean center_of_mass=?",
    ),
    (
        "a centre of mass",
        lambda: MADE(1.0, np.eye(3), centre_of_mass=(0, 0, 1)),
        TypeError,
        "'centre_of_mass'; did you mean center_of_mass=?",
    ),
    (
        "the moments of a body",
        lambda: MADE(1.0, inertia_about_orign=np.eye(3)),
        TypeError,
        "did you mean inertia_about_origin=?",
    ),
    (
        "something else",
        lambda: MADE(1.0, np.eye(3), colour="red"),
        TypeError,
        "'colour'; it takes mass, inertia, center_of_mass, inertia_about_origin, rtol",
    ),
    (
        "a com of moments",
        lambda: MADE.from_principal(1.0, (1, 1, 1), com=(0, 0, 1)),
        TypeError,
        "RigidBody.from_principal() got an unexpected keyword argument 'com'; did you mean center_of_mass=?",
    ),
    (
        "a unit with omega",
        lambda: BODY.simulate([0, 1], omega="30 deg/s"),
        TypeError,
        "omega: expected real numbers, got dtype <U8; convert units first: numpy.deg2rad(30) is 30 deg/s",
    ),
    (
        "a rate for omega",
        lambda: BODY.simulate([0, 1], 3.0),
        ValueError,
        "got (); a rate about z is (0, 0, rate)",
    ),
    (
        "one time",
        lambda: BODY.simulate(10, (1, 0, 0)),
        ValueError,
        "t: expected shape (T,), got (); the first time is the start: [0, 10]",
    ),
    (
        "three angles",
        lambda: BODY.simulate(*SPUN, attitude=(0, 0, 1)),
        ValueError,
        "got (3,); euler_angles.to_quaternion takes three angles",
    ),
    (
        "a strength of gravity",
        lambda: TOP.heavy_top((0, 0, 1), None, gravity=9.81),
        ValueError,
        "gravity: expected shape (..., 3), got (); a strength g that pulls along -z is (0, 0, -g)",
    ),
    ("a weight's strength", lambda: LOADS.uniform_gravity(9.81), ValueError, "is (0, 0, -g)"),
    (
        "a vector for a load",
        lambda: TOP.simulate(*SPUN, load=(0, 0, -9.81), about="origin"),
        TypeError,
        "<class 'tuple'>; a weight is loads.uniform_gravity((0, 0, -9.81))",
    ),
    (
        "a function for a load",
        lambda: BODY.simulate(*SPUN, load=lambda _t, w, _q: w),
        TypeError,
        "<class 'function'>; wrap a function in loads.torque_callback",
    ),
    (
        "gravity of a run",
        lambda: BODY.simulate(*SPUN, gravity=(0, 0, -9.81)),
        TypeError,
        "'gravity'; it is a load: load=loads.uniform_gravity((0, 0, -9.81))",
    ),
    (
        "a torque of a run",
        lambda: BODY.simulate(*SPUN, torque=(0, 0, 1)),
        TypeError,
        "'torque'; did you mean load=?",
    ),
    (
        "a picture's name",
        lambda: BODY.simulate(*SPUN).plot("m.png"),
        TypeError,
        "got 'm.png'; draw first and save the figure: .figure.savefig('m.png') of what this returns",
    ),
    ("a body's picture", lambda: BODY.plot("b.png"), TypeError, ".figure.savefig('b.png')"),
    (
        "three lengths of a box",
        lambda: SOLIDS.box(2, 3, 4, mass=1.0),
        TypeError,
        "box() takes its numbers as one argument: box((2, 3, 4), ...); 3 arguments were given without a name",
    ),
    (
        "the length of a cylinder",
        lambda: SOLIDS.cylinder(radius=1.0, length=2.0, mass=1.0),
        TypeError,
        "cylinder() got an unexpected keyword argument 'length'; did you mean height=?",
    ),
    (
        "the diameter of a ball",
        lambda: SOLIDS.sphere(diameter=1.0, mass=1.0),
        TypeError,
        "'diameter'; half of it is the radius",
    ),
    (
        "a mass without its name",
        lambda: SOLIDS.cylinder(1.0, 2.0, 3.0),
        TypeError,
        "cylinder() takes radius, height, then by name mass=, density=; 3 arguments were given",
    ),
    ("no height", lambda: SOLIDS.cylinder(1.0, mass=1.0), TypeError, "cylinder() needs height="),
    (
        "a radius given twice",
        lambda: SOLIDS.sphere(1.0, radius=1.0, mass=1.0),
        TypeError,
        "sphere() got radius twice: by its place and by its name",
    ),
    ("g", lambda: LOADS.uniform_gravity(g=9.81), TypeError, "'g'; did you mean gravity=?"),
    ("a coefficient", lambda: LOADS.damping(coefficient=1.0), TypeError, "did you mean matrix=?"),
    (
        "corners of a polygon",
        lambda: LAMINAE.polygon(points=[(0, 0), (1, 0), (0, 1)], mass=1.0),
        TypeError,
        "'points'; did you mean vertices=?",
    ),
    ("a rod of a mass", lambda: RODS.rod(2.0, 1.0), TypeError, "rod() takes length, then by name mass="),
    (
        "the name of an axis",
        lambda: BODY.moment_about("z"),
        TypeError,
        "axis: expected real numbers, got dtype <U1; the axis z is (0, 0, 1)",
    ),
    (
        "a number beyond floats",
        lambda: MADE(1.0, np.eye(3), rtol=10**400),
        TypeError,
        "expected a number that a float can be, at most 1.8e308 in size",
    ),
    (
        "a mass beyond floats",
        lambda: MADE.from_curve([[0, 0, 0], [1, 0, 0]], mass=10**400),
        TypeError,
        "expected a number that a float can be, at most 1.8e308 in size",
    ),
    (
        "a whole number beyond all",
        lambda: BODY.simulate(*SPUN, max_steps=10**400),
        TypeError,
        "expected a whole number of at most 38 digits",
    ),
    (
        "half of a letter",
        lambda: BODY.simulate(*SPUN, method="\ud800"),
        TypeError,
        "expected a word, got a string with half of a surrogate pair in it",
    ),
    (
        "a file for a robot",
        lambda: POLHODE.robots.check("robot.urdf"),
        TypeError,
        'robot: expected Robot, got str; robots.read_robot("robot.urdf") reads one',
    ),
    (
        "a word for a point",
        lambda: POLHODE.symbolic.shape("cone").inertia_about("apex"),
        ValueError,
        "point: expected three expressions or numbers, got 'apex'; the axes are those of center_of_mass",
    ),
    (
        "a density with a unit",
        lambda: MADE.from_file("part.stl", density="2.7 g/cm^3"),
        TypeError,
        "units are read on the command line: polhode report part.stl --density \"2.7 g/cm^3\"",
    ),
]  # fmt: skip


@pytest.mark.parametrize(
    ("make", "error", "says"), [row[1:] for row in MISTAKES], ids=[r[0] for r in MISTAKES]
)
def test_the_way_out_is_named(make: Callable[[], object], error: type[Exception], says: str) -> None:
    with pytest.raises(error, match=re.escape(says)):
        make()


def test_a_file_is_closed_and_welded_on_request(tmp_path: Path) -> None:
    vertices, faces = cube(2.0)
    whole = tmp_path / "open.obj"
    whole.write_bytes(obj(vertices, faces[1:]))
    for closure in ("caps", "hull"):
        body = RigidBody.from_file(whole, density=1.0, closure=closure)
        assert body.mass == pytest.approx(8.0, rel=1e-14)
        assert body.provenance.closure == closure
    # A corner of one triangle strays by a hundred-millionth: the edges beside it are open.
    strayed = np.vstack([vertices, vertices[faces[0, 0]] + 1e-8])
    frayed = tmp_path / "frayed.obj"
    frayed.write_bytes(obj(strayed, np.vstack([[len(vertices), *faces[0, 1:]], faces[1:]])))
    with pytest.raises(
        ValueError, match="1 corner lies within 1e-07 of another, weld=1e-07 joins it; or close the mesh"
    ):
        RigidBody.from_file(frayed, density=1.0)
    body = RigidBody.from_file(frayed, density=1.0, weld=1e-7, length_unit="mm")
    assert body.mass == pytest.approx(8e-9, rel=1e-7)
    assert body.provenance.welded == 1
    turned = tmp_path / "turned.obj"
    turned.write_bytes(obj(vertices, faces[:, ::-1]))
    assert RigidBody.from_file(turned, density=1.0, orient=True).mass == pytest.approx(8.0, rel=1e-14)


@pytest.mark.parametrize("option", [{"weld": 0.1}, {"closure": "hull"}, {"orient": True}, {"index_base": 0}])
def test_a_molecule_is_no_mesh(tmp_path: Path, option: dict[str, Any]) -> None:
    neon = tmp_path / "neon.xyz"
    neon.write_text("1\n\nNe 0 0 0\n")
    with pytest.raises(ValueError, match=f"{next(iter(option))}: .* is a molecule, not a mesh; leave it out"):
        RigidBody.from_file(neon, **option)


@pytest.mark.parametrize(
    ("ask", "says"),
    [
        (lambda: BODY.energy, "no attribute 'energy'; kinetic_energy(omega) gives it"),
        (lambda: BODY.com, "'com'; use center_of_mass"),
        (lambda: BODY.moments, "'moments'; use principal_moments"),
        (lambda: BODY.axes, "'axes'; use principal.axes"),
        (lambda: BODY.moment_of_inertia, "inertia_about(point) that about another"),
        (lambda: BODY.simulate(*SPUN).energy, "'energy'; kinetic_energy() gives it"),
        (lambda: BODY.simulate(*SPUN).to_dataframe(), "'to_dataframe'; to_pandas() gives a DataFrame"),
        (lambda: BODY.simulate(*SPUN).times, "'times'; use t"),
        (lambda: SOLIDS.cuboid, "module 'polhode.solids' has no attribute 'cuboid'; box((x, y, z)) is one"),
        (lambda: SOLIDS.ball, "'ball'; sphere(radius) is one"),
        (lambda: SOLIDS.disk, "'disk'; cylinder(radius, height) is one, laminae.disk(radius)"),
        (lambda: SOLIDS.cylindre, "'cylindre'; did you mean cylinder?"),
        (lambda: LAMINAE.disc, "module 'polhode.laminae' has no attribute 'disc'; disk(radius) is one"),
        (lambda: RODS.hoop, "module 'polhode.rods' has no attribute 'hoop'; ring(radius) is one"),
        (lambda: POLHODE.Body, "module 'polhode' has no attribute 'Body'; RigidBody is the class"),
        (lambda: POLHODE.solid, "'solid'; did you mean solids?"),
        (
            lambda: BODY.inertia_at((0, 0, 1)),
            "'inertia_at'; inertia_about(point) is the tensor about a point",
        ),
        (lambda: BODY.translate((0, 0, 1)), "'translate'; translated(displacement) is the moved body"),
        (lambda: BODY.rotate((0, 0, 0, 1)), "'rotate'; rotated(rotation) makes the turned body"),
        (lambda: BODY.principal_momnts, "'principal_momnts'; did you mean principal_moments?"),
        (
            lambda: BODY.free_motion((0, 0, 1)).omega_at(3),
            "'FreeMotion' object has no attribute 'omega_at'; use at(t)",
        ),
        (lambda: BODY.free_motion((0, 0, 1)).modde, "'modde'; did you mean mode?"),
        (
            lambda: TOP.heavy_top((0, 0, 1), gravity=(0, 0, -1)).energy,
            "'energy'; at(t).kinetic_energy() gives it",
        ),
        (lambda: TOP.heavy_top((0, 0, 1), gravity=(0, 0, -1)).path, "'path'; use mode"),
        (lambda: TOP.heavy_top((0, 0, 1), gravity=(0, 0, -1)).modde, "'modde'; did you mean mode?"),
        (lambda: BODY.free_motion((0, 0, 1)).energy, "'energy'; kinetic_energy() gives it, and its .total"),
        (
            lambda: BODY.gyrostat((0, 0, 1)).free_motion((0, 1, 1)).period,
            "'period'; use periods.rotation",
        ),
        (lambda: BODY.gyrostat((0, 0, 1)).equilibra, "'equilibra'; did you mean equilibria?"),
        (
            lambda: TRAJECTORY.load("m.npz"),
            "'Trajectory' has no attribute 'load'; Trajectory.from_file(path)",
        ),
        (lambda: BODY.simulate(*SPUN).periods, "'periods'; body.free_motion(omega).periods has them"),
        (lambda: LOADS.torque, "module 'polhode.loads' has no attribute 'torque'; constant_torque("),
        (lambda: LOADS.gravity, "'gravity'; uniform_gravity((0, 0, -9.81)) is one"),
        (lambda: POLHODE.orbits.circular, "'circular'; from_elements("),
        (lambda: POLHODE.robots.load, "'load'; read_robot("),
        (lambda: POLHODE.symbolic.cone, "'cone'; shape(name) makes one"),
        (lambda: POLHODE.plot.trajectory, "'trajectory'; angular_velocity(trajectory) draws one"),
        (lambda: POLHODE.euler_angles.from_matrix, "from_quaternion takes a quaternion"),
        (lambda: POLHODE.kinematics.velocity, "use RigidBody.point_velocity(point, omega)"),
    ],
)
def test_other_names_lead_to_those_here(ask: Callable[[], object], says: str) -> None:
    with pytest.raises(AttributeError, match=re.escape(says)):
        ask()


def test_what_nobody_means_has_no_hint() -> None:
    for owner in (BODY, BODY.simulate(*SPUN), SOLIDS, POLHODE):
        assert not hasattr(owner, "_q")
        with pytest.raises(AttributeError, match=r"has no attribute 'qqqqqq'$"):
            owner.qqqqqq  # noqa: B018 (asks for it)


def test_other_options_lead_to_options_that_a_command_has() -> None:
    options = {
        name
        for command in COMMANDS
        for one in app[command].assemble_argument_collection()
        for name in one.names
    }
    for meant, others in OTHER_OPTIONS:
        assert meant.split()[0] in options, meant
        assert meant.split()[0] not in others.split(), meant


def test_hints_name_what_there_is() -> None:
    """The first word of each hint is a public name of the module, or of one that it names."""
    for module, hints in _hints._OF_MODULES.items():
        known = importlib.import_module(module)
        for name, way_out in hints.items():
            assert not hasattr(known, name)
            found = re.findall(r"\b([A-Za-z_]+(?:\.[a-z_]+)?)\(", way_out)
            for word in found or [way_out.partition(" ")[0].rstrip(",")]:
                owner, _, inner = word.rpartition(".")
                home = getattr(polhode, owner) if owner else known
                assert hasattr(home, inner) or inner == "simulate", word


def test_principal_axes_unpack() -> None:
    moments, axes = BODY.principal
    assert moments is BODY.principal.moments or np.array_equal(moments, BODY.principal_moments)
    np.testing.assert_array_equal(axes @ np.diag(moments) @ axes.T, BODY.inertia)
    stack = solids.box([[1.0, 2.0, 3.0], [2.0, 2.0, 5.0]], mass=1.0)
    moments, axes = stack.principal
    assert (moments.shape, axes.shape) == ((2, 3), (2, 3, 3))
    moments, axes = polhode.principal_axes(np.diag([3.0, 1.0, 2.0]))
    assert moments.tolist() == [1.0, 2.0, 3.0]


def test_plot_is_there_without_its_import() -> None:
    code = """
import sys
import polhode
assert not {"matplotlib", "scipy", "sympy", "pandas", "trimesh"} & set(sys.modules)
assert "polhode.plot" not in sys.modules
polhode.plot.body, polhode.samples.names, polhode.io, polhode.units, polhode.robots, polhode.animation
assert "matplotlib" not in sys.modules
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


class TestCom:
    """``"com"`` is the centre of mass wherever a point is asked for."""

    OFF: Any = solids.box((3.0, 2.0, 1.0), mass=2.0).translated((0.3, -0.2, 0.5))
    CALLS: ClassVar[list[Callable[[Any, str], object]]] = [
        lambda b, at: b.inertia_about(at),
        lambda b, at: b.moment_about((1, 2, 3), at),
        lambda b, at: b.principal_about(at).moments,
        lambda b, at: b.kinetic_energy((1, 2, 3), (3, 2, 1), about=at).mixed,
        lambda b, at: b.angular_momentum((1, 2, 3), (3, 2, 1), about=at).mixed,
        lambda b, at: b.angular_acceleration((1, 2, 3), (3, 2, 1), about=at),
        lambda b, at: b.torque((1, 2, 3), (3, 2, 1), about=at),
        lambda b, at: b.point_velocity(at, (1, 2, 3)),
        lambda b, at: b.point_acceleration((1, 0, 0), (1, 2, 3), about=at),
        lambda b, at: b.pivot_reaction((1, 2, 3), about=at),
        lambda b, at: b.stability(1.0, about=at),
        lambda b, at: b.simulate(*SPUN, about=at).omega,
        lambda b, at: b.simulate(*SPUN).point(at),
        lambda b, at: LOADS.uniform_gravity((0, 0, -1)).torque(
            0.0, (0, 0, 1), (0, 0, 0, 1), (0, 0, 0), (0, 0, 0), body=b, about=at
        ),
        lambda b, at: LOADS.uniform_gravity((0, 0, -1)).potential(b, (0, 0, 0, 1), about=at),
        lambda _, at: LOADS.uniform_gravity((0, 0, -1)).keeps_momentum(at),
        lambda _, at: (
            polhode.tops.free_precession(solids.cylinder(1.0, 3.0, mass=1.0), (0.1, 0, 1), about=at).body_rate
        ),
        lambda _, at: (
            interop.from_printout(
                1.0, (0, 0, 1), [1, 2, 2.5, 0.1, 0, 0], products="positive", about=at
            ).inertia
        ),
        lambda b, at: POLHODE.ensemble(b, *SPUN, n=2, seed=1, about=at).compute().omega,
    ]

    @pytest.mark.parametrize("call", CALLS)
    def test_it_is_center_of_mass(self, call: Callable[[Any, str], object]) -> None:
        np.testing.assert_array_equal(call(self.OFF, "com"), call(self.OFF, "center_of_mass"))
        with pytest.raises(ValueError, match="center_of_mass"):
            call(self.OFF, "comm")


def test_a_top_starts_upright() -> None:
    gravity = (0.0, 0.0, -9.81)
    top = TOP.heavy_top((0, 0.1, 9), gravity=gravity)
    assert np.array_equal(top.quaternion, (0, 0, 0, 1))
    assert np.array_equal(top.at(1.0).omega, TOP.heavy_top((0, 0.1, 9), None, gravity).at(1.0).omega)
    with pytest.raises(TypeError, match=re.escape("gravity: a heavy top needs it, as gravity=(0, 0, -9.81)")):
        TOP.heavy_top((0, 0.1, 9))


KINDS: dict[str, Any] = {
    "a word": "robot.urdf",
    "half a letter": "\ud800",
    "bytes": b"x",
    "None": None,
    "a number": 3.0,
    "a number beyond floats": 10**400,
    "a list": [1, 2, 3],
    "a dictionary": {"a": 1},
    "an object": object(),
    "a body": BODY,
    "a run": BODY.simulate(*SPUN),
    "a motion": BODY.free_motion((0.1, 0.0, 1.0)),
}


@pytest.mark.parametrize(
    "module",
    [
        *("plot", "robots", "symbolic", "molecules", "flybys", "tops", "orbits", "equimomental", "validity"),
        *("kinematics", "parallel_axis", "reductions", "distributions", "uncertainty", "euler_angles"),
        *("solids", "laminae", "rods", "regions", "interop", "samples", "io", "units"),
        *("assembly", "loads"),
    ],
)
def test_functions_refuse_objects_of_other_kinds_in_words(
    module: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every required argument is one thing of another kind; the error is none of Python's own accidents."""
    plt = pytest.importorskip("matplotlib.pyplot")
    monkeypatch.chdir(tmp_path)
    home = importlib.import_module(f"polhode.{module}")
    wrong = []
    for name in home.__all__:
        function = getattr(home, name)
        if not callable(function) or name == "compiled":  # which takes a machine address
            continue
        needed = [one for one in inspect.signature(function).parameters.values() if one.default is one.empty]
        placed = [one for one in needed if one.kind in (one.POSITIONAL_ONLY, one.POSITIONAL_OR_KEYWORD)]
        named = [one.name for one in needed if one.kind is one.KEYWORD_ONLY]
        for kind, value in KINDS.items():
            plt.close("all")
            try:
                function(*[value] * len(placed), **dict.fromkeys(named, value))
            except (TypeError, ValueError, OSError, IndexError, ModuleNotFoundError, MemoryError) as error:
                if isinstance(error, UnicodeError) or not str(error):
                    wrong.append(f"{name} of {kind}: {error!r}")
            except Exception as error:
                wrong.append(f"{name} of {kind}: {error!r}")
    plt.close("all")
    assert not wrong
