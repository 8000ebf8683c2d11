"""Names and arguments of other libraries. Each is refused with the name to write here.

Names of modules, attributes of classes and arguments of functions have one table each, here alone; the
extension asks it too. A message is not a second spelling: only what it names works.
"""

from __future__ import annotations

import inspect
import sys
from difflib import get_close_matches
from functools import wraps
from types import ModuleType
from typing import TYPE_CHECKING, Any, Final, ParamSpec, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

__all__ = [
    "ClassWithHints",
    "check_kind",
    "check_no_tensor",
    "explain_calls",
    "explain_module_call",
    "no_attribute",
    "no_keyword",
    "no_name",
    "with_hints",
]

_Takes = ParamSpec("_Takes")
_Returns = TypeVar("_Returns")

_OF_MODULES: Final = {
    "polhode": {
        "Body": "RigidBody is the class of bodies",
        "Inertia": "RigidBody is the class of bodies",
        "load": "RigidBody.from_file reads a file",
        "read": "RigidBody.from_file reads a file",
        "from_file": "RigidBody.from_file reads a file",
        "simulate": "simulate is a method of a body",
        "labelled": "RigidBody.from_labelled_particles(…, return_labels=True) takes labels with gaps",
        "torques": "loads is the module of torques and forces",
        "bodies": "solids, laminae and rods are the modules of shapes",
        "shapes": "solids, laminae and rods are the modules of shapes",
        **dict.fromkeys(
            ("check_inertia", "validate_inertia", "is_valid"),
            "RigidBody(mass, inertia) refuses a tensor that no body has, "
            "validity.nearest_valid(inertia) finds the nearest possible one",
        ),
        **dict.fromkeys(
            ("uncertain", "ufloat", "measurement"), "Uncertain(value, sigma) is a number with its sigma"
        ),
    },
    "polhode.io": {
        "load_body": "RigidBody.from_file(path) reads one",
        "load_trajectory": "Trajectory.from_file(path) reads one",
        "save_body": "RigidBody.save(path) writes one",
        "save_trajectory_json": "Trajectory.save(path) writes one",
        "save_trajectory_npz": "Trajectory.save(path) writes one",
        "body_from_file": "RigidBody.from_file(path) reads one",
    },
    "polhode.loads": {
        "torque": 'constant_torque((0, 0, 1), "body") is one, torque_callback(f) takes a function',
        "force": 'constant_force((0, 0, 1), "body") is one, callback(f) takes a function',
        "gravity": "uniform_gravity((0, 0, -9.81)) is one",
        "weight": "uniform_gravity((0, 0, -9.81)) is one",
        "drag": "damping(matrix, quadratic=...) is one",
        "friction": "damping(matrix) is one; a wheel has friction=",
        "control": "feedback(K, D, target=...) is one",
        "pid": "feedback(K, D, target=...) has no integral term; with_states(...) takes any controller",
        "reaction_wheel": "wheel(axis, inertia) is one",
        "flywheel": "wheel(axis, inertia) is one",
        "magnetorquer": "magnetic(dipole, field) is one",
        "table": "sampled(t, torque) takes one",
        "function": "torque_callback(f) takes one",
    },
    "polhode.orbits": {
        "circular": "from_elements(mu, semi_major_axis=..., eccentricity=0.0) makes one",
        "elements": "from_elements(mu, ...) takes them",
        "from_state": "kepler(mu, position, velocity) takes one",
        "from_samples": "sampled(mu, t, position) takes them",
    },
    "polhode.euler_angles": {
        "from_matrix": "from_quaternion takes a quaternion, which SciPy's Rotation computes of a matrix",
        "to_matrix": "to_quaternion(angles) is a quaternion, of which SciPy's Rotation computes a matrix",
        "omega": "use angular_velocity(angles, rates)",
    },
    "polhode.kinematics": {
        "point_velocity": "use RigidBody.point_velocity(point, omega)",
        "velocity": "use RigidBody.point_velocity(point, omega)",
    },
    "polhode.robots": {
        "load": 'read_robot("robot.urdf") reads a file',
        "read": 'read_robot("robot.urdf") reads a file',
        "from_file": 'read_robot("robot.urdf") reads a file',
        "fixed": "fix(robot, verdicts) makes the bytes of a better file",
        "validate": "use check(robot)",
    },
    "polhode.plot": {
        "trajectory": "angular_velocity(trajectory) draws one, Trajectory.animate(path) moves it",
        "omega": "angular_velocity(trajectory) draws it",
        "energy": "invariants(trajectory) draws it",
        "inertia_ellipsoid": "ellipsoid(body) draws it",
    },
    "polhode.symbolic": {
        **dict.fromkeys(
            ("box", "cone", "cube", "cylinder", "ellipsoid", "sphere", "disk", "rod", "ring"),
            'shape(name) makes one, as shape("cone"); names() lists them',
        ),
        "inertia": 'shape("cone").inertia is the tensor of a cone',
        "euler_equations": "use torque(inertia, omega, angular_acceleration)",
    },
    "polhode.solids": {
        "cuboid": "box((x, y, z)) is one",
        "block": "box((x, y, z)) is one",
        "brick": "box((x, y, z)) is one",
        "parallelepiped": "box((x, y, z)) is one",
        "ball": "sphere(radius) is one",
        "shell": "hollow_sphere(inner_radius, outer_radius) is one; equal radii make a thin shell",
        "spherical_shell": "hollow_sphere(inner_radius, outer_radius) is one; equal radii make a thin shell",
        "thick_shell": "hollow_sphere(inner_radius, outer_radius) is one",
        "half_sphere": "hemisphere(radius) is one",
        "dome": "hemisphere(radius) is one",
        "spheroid": "ellipsoid((a, b, c)) with two equal semi-axes is one",
        "hollow_cylinder": "tube(inner_radius, outer_radius, height) is one",
        "pipe": "tube(inner_radius, outer_radius, height) is one",
        "disk": "cylinder(radius, height) is one, laminae.disk(radius) one without thickness",
        "disc": "cylinder(radius, height) is one, laminae.disk(radius) one without thickness",
        "plate": "box((x, y, z)) is one, laminae.rectangle((x, y)) one without thickness",
        "rod": "cylinder(radius, height) is one, rods.rod(length) one without thickness",
        "ring": "torus(major_radius, minor_radius) is one, rods.ring(radius) one without thickness",
        "donut": "torus(major_radius, minor_radius) is one",
        "doughnut": "torus(major_radius, minor_radius) is one",
        "truncated_cone": "frustum(bottom_radius, top_radius, height) is one",
        "pill": "capsule(radius, length) is one",
        "spherocylinder": "capsule(radius, length) is one",
        "simplex": "tetrahedron(side) is a regular one, RigidBody.from_tetrahedra takes any",
        "octahedron": "RigidBody.from_mesh takes its corners and faces",
        "mesh": "RigidBody.from_mesh takes corners and faces",
    },
    "polhode.laminae": {
        "disc": "disk(radius) is one",
        "circle": "disk(radius) is one, rods.ring(radius) its edge alone",
        "washer": "annulus(inner_radius, outer_radius) is one",
        "ring": "annulus(inner_radius, outer_radius) is one, rods.ring(radius) one without width",
        "plate": "rectangle((x, y)) is one",
        "square": "rectangle((x, x)) is one",
        "sheet": "rectangle((x, y)) is one",
    },
    "polhode.rods": {
        "stick": "rod(length) is one",
        "bar": "rod(length) is one, solids.box((x, y, z)) one with thickness",
        "line": "rod(length) is one",
        "wire": "rod(length) is a straight one, RigidBody.from_curve takes any",
        "hoop": "ring(radius) is one",
        "circle": "ring(radius) is one, laminae.disk(radius) the sheet in it",
        "curve": "RigidBody.from_curve takes points",
        "polyline": "RigidBody.from_curve takes points",
    },
}
"""Names that people look for in a module, with the text that names the right one."""

_OF_CLASSES: Final = {
    "Trajectory": {
        "energy": "kinetic_energy() gives it, and its .total the sum; invariants().energy adds the potential",
        "to_dataframe": "to_pandas() gives a DataFrame",
        "to_df": "to_pandas() gives a DataFrame",
        "to_csv": 'save("motion.csv") writes it',
        "to_dict": 'vars() of it are its arrays; save("motion.json") writes them',
        "to_dataset": "to_xarray() gives a Dataset",
        "times": "use t",
        "time": "use t",
        "attitude": "use quaternion, rotation is SciPy's, euler_angles(sequence) the angles",
        "quaternions": "use quaternion",
        "angular_velocity": "use omega",
        "omegas": "use omega",
        "y": "omega and quaternion are the states",
        "load_file": "Trajectory.from_file(path) reads what save wrote",
        "load": "Trajectory.from_file(path) reads what save wrote",
        "read": "Trajectory.from_file(path) reads what save wrote",
        "periods": "body.free_motion(omega).periods has them, of a body without a load",
        "mode": "use body.free_motion(omega).mode, of a body without a load",
        **dict.fromkeys(
            ("at", "interpolate", "sample"),
            "simulate(t, omega) gives the states at every t asked for, state(index) is one of them, and "
            "body.free_motion(omega).at(t) is the closed form, without a load",
        ),
        **dict.fromkeys(
            ("zero_crossings", "crossings", "find_events"),
            "simulate(t, omega, events=lambda t, omega, *_: omega[2]) finds them, and events.t has the times",
        ),
        "plot_polhode": "polhode.plot.polhode(body.free_motion(omega)) draws it",
    },
    "FreeMotion": {
        "omega_at": "use at(t).omega",
        "attitude_at": "use at(t).quaternion",
        "evaluate": "at(t) is the motion at these times",
        "simulate": "at(t) is the motion at these times",
        "period": "periods has them",
        "energy": "kinetic_energy() gives it, and its .total the sum",
        "t": "at(t) is the motion at these times; the start is 0",
    },
    "GyrostatMotion": {
        "period": "use periods.rotation",
    },
    "HeavyTop": {
        "path": "use mode",
        "period": "use nutation_period",
        "periods": "nutation_period, mean_precession and mean_spin are its rhythms",
        **dict.fromkeys(
            ("energy", "kinetic_energy"),
            "at(t).kinetic_energy() gives it, at(t).invariants().energy adds the potential",
        ),
        "angular_momentum": "at(t).angular_momentum() gives it",
    },
    "RigidBody": {
        "load": "RigidBody.from_file(path) reads every file that holds a body",
        "energy": "kinetic_energy(omega) gives it, and its .total the sum",
        **dict.fromkeys(("com", "center", "centre_of_mass", "centroid", "cog"), "use center_of_mass"),
        "moments": "use principal_moments",
        **dict.fromkeys(("axes", "principal_axes"), "use principal.axes"),
        **dict.fromkeys(
            ("moment_of_inertia", "inertia_tensor", "tensor", "I"),
            "inertia is the tensor about the centre of mass, inertia_about(point) that about another",
        ),
        "inertia_at": "inertia_about(point) is the tensor about a point",
        "moment": "moment_about(axis) is that about an axis",
        "moment_about_axis": "use moment_about(axis, about)",
        **dict.fromkeys(
            ("products_of_inertia", "products", "product_of_inertia"),
            "inertia[0, 1] is minus the product Ixy, interop.to_positive_products(body) has all products",
        ),
        **dict.fromkeys(
            ("translate", "move", "moved", "shift", "shifted"),
            "translated(displacement) is the moved body",
        ),
        **dict.fromkeys(("rotate", "turn", "turned"), "rotated(rotation) makes the turned body"),
        **dict.fromkeys(("scale", "resize"), "scaled(length=..., mass=...) makes the scaled body"),
        **dict.fromkeys(
            ("spin", "motion"),
            "free_motion(omega) is the motion in closed form, simulate(t, omega) that with loads",
        ),
        "m": "use mass",
        "volume": "a body has mass and moments alone: io.solid_from_file(path, density=1.0).volume is one",
        **dict.fromkeys(
            ("summary", "describe", "info", "report"),
            'print(body) shows its numbers; after save("body.json"), polhode report body.json prints all',
        ),
        "flip_period": "use free_motion(omega).periods.flip",
        **dict.fromkeys(("period", "periods"), "free_motion(omega).periods has them"),
        **dict.fromkeys(
            ("clones", "perturbed", "sample", "monte_carlo"),
            'uncertainty.propagate(f, body, "monte-carlo", n=1000, seed=1) draws bodies with a sigma, '
            "ensemble(body, t, omega, n=1000, seed=1) draws motions",
        ),
        "density": "a body keeps mass and moments alone",
        "gyration": "use radii_of_gyration",
        "radius_of_gyration": "use radii_of_gyration",
        **dict.fromkeys(("load", "read"), "RigidBody.from_file(path) reads a file"),
    },
}
"""Names that people look for in an object, with the text of the right one; FreeMotion: all closed forms."""

_OTHER_ARGUMENTS: Final = {
    "center_of_mass": ("center", "centre", "centre_of_mass", "com", "cog", "center_of_gravity"),
    "mass": ("m", "weight"),
    "density": ("rho", "material"),
    "inertia": ("I", "J", "tensor", "inertia_tensor"),
    "moments": ("inertia", "principal_moments"),
    "length_unit": ("unit", "units", "lunit", "length_units"),
    "omega": ("w", "angular_velocity", "rate", "rates", "omega0", "w0", "initial_omega"),
    "attitude": ("q", "quaternion", "orientation", "rotation"),
    "load": ("loads", "torque", "force"),
    "height": ("h", "length"),
    "length": ("height", "l", "L"),
    "radius": ("r", "R", "a"),
    "inner_radius": ("r", "r1", "inner"),
    "outer_radius": ("R", "r2", "outer", "radius"),
    "size": ("sizes", "dimensions", "lengths", "sides", "edges", "shape", "extents"),
    "side": ("a", "edge", "size", "length"),
    "semi_axes": ("radii", "axes", "size"),
    "vertices": ("points", "corners"),
    "points": ("vertices", "corners"),
    "gravity": ("g", "acceleration"),
    "matrix": ("coefficient", "c", "D", "damping"),
    "vector": ("torque", "force"),
    "axis": ("direction",),
    "position": ("r",),
    "velocity": ("v",),
    "t": ("time", "times", "t_eval", "t_span"),
}
"""Other names of an argument, by the argument."""

_INSTEAD: Final = {
    "diameter": "half of it is the radius",
    "gravity": "it is a load: load=loads.uniform_gravity((0, 0, -9.81))",
}
"""Arguments that no other argument replaces as it is."""

_OF_FUNCTIONS: Final = {
    ("gravity_gradient", "radius"): (
        "give an orbit: gravity_gradient(orbits.from_elements(mu, semi_major_axis=radius, eccentricity=0))"
    ),
    **dict.fromkeys(
        (("RigidBody.simulate", name) for name in ("t_end", "end", "duration", "t_max", "tmax", "until")),
        "the times are t=[0, end], or t=numpy.linspace(0, end, 1001)",
    ),
}
"""Arguments that no other argument of one function replaces."""

_OF_SHAPES: Final = {
    **dict.fromkeys(
        ("center", "centre", "center_of_mass", "com", "position", "origin"),
        ".translated(displacement) of what this returns moves the body",
    ),
    **dict.fromkeys(
        ("axis", "direction", "rotation", "attitude", "orientation"),
        ".rotated(rotation) of what this returns turns the body",
    ),
}
"""Arguments that place a shape."""

_LABELS: Final = {
    "time_unit": "time_label",
    "rate_unit": "rate_label",
    "energy_unit": "energy_label",
    "length_unit": "length_label",
    "unit": "momentum_label",
}
"""Words at axes, by the names of units, as which they would have to convert numbers."""

_MADE_BY: Final = {
    ("FreeMotion", "Trajectory"): "trajectory.body.free_motion(trajectory.omega[0]) is one, without a load",
    ("FreeMotion", "RigidBody"): "body.free_motion(omega) is one",
    ("Trajectory", "FreeMotion"): "motion.at(t) is one",
    ("Trajectory", "GyrostatMotion"): "motion.at(t) is one",
    ("Trajectory", "HeavyTop"): "motion.at(t) is one",
    ("Trajectory", "RigidBody"): "body.simulate(t, omega) is one",
    ("Gyrostat", "RigidBody"): "body.gyrostat(momentum) is one",
    ("Robot", "str"): 'robots.read_robot("robot.urdf") reads one',
    ("Robot", "path"): "robots.read_robot(path) reads one",
    ("RigidBody", "str"): "RigidBody.from_file(path) reads one",
    ("RigidBody", "path"): "RigidBody.from_file(path) reads one",
    ("RigidBody", "Trajectory"): "trajectory.body is its body",
    ("RigidBody", "FreeMotion"): "motion.body is its body",
}
"""Conversions: by the expected and the given class."""


class ClassWithHints(type):
    """A class whose missing attributes are refused with what to write instead."""

    if not TYPE_CHECKING:

        def __getattr__(cls, name: str) -> Any:
            """Refuse a name of others."""
            raise no_attribute(cls.__name__, name, dir(cls), f"type object {cls.__name__!r}")


def _or_nearest(way_out: str | None, name: str, known: Iterable[str]) -> str:
    if way_out is None and not name.startswith("_"):
        near = get_close_matches(name, [one for one in known if not one.startswith("_")], 1)
        way_out = f"did you mean {near[0]}?" if near else None
    return f"; {way_out}" if way_out else ""


def no_name(module: str, name: str, known: Iterable[str]) -> AttributeError:
    """Make the error for a name that a module does not have; the error proposes the right name."""
    way_out = _or_nearest(_OF_MODULES.get(module, {}).get(name), name, known)
    return AttributeError(f"module {module!r} has no attribute {name!r}{way_out}", name=name)


def no_attribute(kind: str, name: str, known: Iterable[str], what: str | None = None) -> AttributeError:
    """Make the error for an attribute that a class does not have; the error proposes the right name."""
    table = _OF_CLASSES.get(kind, {})
    if kind in ("HeavyTop", "GyrostatMotion"):
        table = _OF_CLASSES["FreeMotion"] | table
    way_out = _or_nearest(table.get(name), name, known)
    return AttributeError(f"{what or f'{kind!r} object'} has no attribute {name!r}{way_out}", name=name)


def no_keyword(function: str, given: str, known: Iterable[str]) -> TypeError:
    """Make the error for an unknown keyword of a function; the error proposes the right one."""
    known = [name for name in known if name != given]
    meant = [name for name, others in _OTHER_ARGUMENTS.items() if name in known and given in others]
    meant = meant or get_close_matches(given, known, 1)
    instead = _OF_FUNCTIONS.get((function, given), _INSTEAD.get(given))
    if "." not in function and {"mass", "density"}.issubset(known):
        instead = instead or _OF_SHAPES.get(given)
    if _LABELS.get(given) in known:
        way_out = f"write {_LABELS[given]}=, which is a word in the picture and converts no number"
    elif instead:
        way_out = instead
    else:
        way_out = f"did you mean {meant[0]}=?" if meant else f"it takes {', '.join(known)}"
    return TypeError(f"{function}() got an unexpected keyword argument {given!r}; {way_out}")


def check_no_tensor(values: object) -> None:
    """Refuse the elements of a tensor by their names, with how the tensor is written."""
    if isinstance(values, dict) and any(str(name).lower() == "ixx" for name in values):
        rows = "[[ixx, ixy, ixz], [ixy, iyy, iyz], [ixz, iyz, izz]]"
        raise TypeError(f"expected numbers, got a dict of a tensor's elements; write {rows}")


def check_kind(value: object, argument: str, *kinds: str) -> None:
    """Refuse an argument of a wrong class; the error says how to convert it."""
    if not {kind.__name__ for kind in type(value).__mro__}.isdisjoint(kinds):
        return
    got = "path" if hasattr(value, "__fspath__") else type(value).__name__
    ways_out = [_MADE_BY[kind, got] for kind in kinds if (kind, got) in _MADE_BY]
    raise TypeError(
        f"{argument}: expected {' or '.join(kinds)}, got {type(value).__name__}"
        f"{f'; {ways_out[0]}' if ways_out else ''}"
    )


def explain_calls(names: dict[str, Any], public: Iterable[str]) -> None:
    """Make the functions of a module propose the right name for an unknown argument.

    Parameters
    ----------
    names : dict
        The names of the module; its functions are replaced.
    public : iterable of str
        The names of the functions.
    """
    for name in public:
        if inspect.isroutine(names[name]):
            explained = with_hints(names[name], name)
            explained.__name__ = explained.__qualname__ = name
            explained.__module__ = names["__name__"]
            names[name] = explained


def explain_module_call(module: str, way_out: str) -> None:
    """Let a module that is called like a function say what to write instead."""

    class ModuleWithHint(ModuleType):
        """A module whose call is refused."""

        def __call__(self, *_args: object, **_options: object) -> None:
            """Refuse the call."""
            raise TypeError(f"{module} is a module; {way_out}")

    sys.modules[module].__class__ = ModuleWithHint


def with_hints(function: Callable[_Takes, _Returns], name: str | None = None) -> Callable[_Takes, _Returns]:
    """Make a function propose the right name for an unknown argument."""

    @wraps(function)
    def call(*args: _Takes.args, **kwargs: _Takes.kwargs) -> _Returns:
        try:
            return function(*args, **kwargs)
        except TypeError:
            error = _wrong_arguments(function, name or function.__name__, args, kwargs)
            if error is None:
                raise
        raise error

    return call


def _wrong_arguments(
    function: Callable[..., Any], name: str, args: tuple[Any, ...], kwargs: Mapping[str, Any]
) -> TypeError | None:
    """Make the error for arguments that do not fit the signature; None where they fit."""
    every = inspect.signature(function).parameters
    parameters = {
        key: one for key, one in every.items() if one.kind not in (one.VAR_POSITIONAL, one.VAR_KEYWORD)
    }
    unknown = [key for key in kwargs if key not in parameters]
    if any(one.kind is one.VAR_KEYWORD for one in every.values()):  # another function takes the rest
        unknown = [key for key in unknown if key in _LABELS]
    if unknown:
        return no_keyword(name, unknown[0], [*parameters, _LABELS.get(unknown[0], unknown[0])])
    places = [one.name for one in parameters.values() if one.kind is not one.KEYWORD_ONLY]
    if len(args) > len(places) and not any(one.kind is one.VAR_POSITIONAL for one in every.values()):
        by_name = [f"{key}=" for key in parameters if key not in places]
        takes = f"takes {', '.join(places)}" + (f", then by name {', '.join(by_name)}" if by_name else "")
        if places in (["size"], ["semi_axes"], ["gravity"]):
            takes = f"takes its numbers as one argument: {name}(({', '.join(map(repr, args))}), ...)"
        return TypeError(f"{name}() {takes}; {len(args)} arguments were given without a name")
    twice = [key for key in places[: len(args)] if key in kwargs]
    if twice:
        return TypeError(f"{name}() got {twice[0]} twice: by its place and by its name; leave one out")
    needed = [
        one.name
        for one in parameters.values()
        if one.default is one.empty and one.name not in kwargs and one.name not in places[: len(args)]
    ]
    if needed:
        return TypeError(f"{name}() needs {', '.join(f'{each}=' for each in needed)} too; give it")
    return None
