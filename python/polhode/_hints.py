"""Other names of what the package has: each is refused with the name here."""

from __future__ import annotations

from difflib import get_close_matches
from functools import wraps
from typing import TYPE_CHECKING, Final, ParamSpec, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

__all__ = ["no_attribute", "no_name", "with_labels"]

_Takes = ParamSpec("_Takes")
_Returns = TypeVar("_Returns")

_OF_MODULES: Final = {
    "polhode": {
        "Body": "RigidBody is the class of bodies",
        "Inertia": "RigidBody is the class of bodies",
        "load": "RigidBody.from_file reads a file, RigidBody.load what save wrote",
        "read": "RigidBody.from_file reads a file",
        "from_file": "RigidBody.from_file reads a file",
        "simulate": "simulate is a method of a body",
        "torques": "loads is the module of torques and forces",
        "bodies": "solids, laminae and rods are the modules of shapes",
        "shapes": "solids, laminae and rods are the modules of shapes",
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
"""What people look for in a module, and what they find instead."""

_OF_MOTIONS: Final = {
    "energy": "kinetic_energy() gives it, and its .total the sum; invariants().energy adds the potential",
    "to_dataframe": "to_pandas() gives a DataFrame",
    "to_df": "to_pandas() gives a DataFrame",
    "to_csv": 'save("motion.csv") writes it',
    "to_dict": 'vars() of it are its arrays; save("motion.json") writes them',
    "to_dataset": "to_xarray() gives a Dataset",
    "times": "t is it",
    "time": "t is it",
    "attitude": "quaternion is it, or rotation as SciPy's",
    "quaternions": "quaternion is it",
    "angular_velocity": "omega is it",
    "omegas": "omega is it",
    "y": "omega and quaternion are the states",
}
"""What people look for in a motion."""


def no_name(module: str, name: str, known: Iterable[str]) -> AttributeError:
    """Give the error for a name that a module does not have, with what is meant by it."""
    way_out = _OF_MODULES[module].get(name)
    if way_out is None and not name.startswith("_"):
        near = get_close_matches(name, list(known), 1)
        way_out = f"did you mean {near[0]}?" if near else None
    return AttributeError(
        f"module {module!r} has no attribute {name!r}{f'; {way_out}' if way_out else ''}", name=name
    )


def no_attribute(name: str) -> AttributeError:
    """Give the error for an attribute that a motion does not have."""
    way_out = _OF_MOTIONS.get(name)
    return AttributeError(
        f"'Trajectory' object has no attribute {name!r}{f'; {way_out}' if way_out else ''}", name=name
    )


_LABELS: Final = {
    "time_unit": "time_label",
    "rate_unit": "rate_label",
    "energy_unit": "energy_label",
    "length_unit": "length_label",
    "unit": "momentum_label",
}
"""Words at axes, by the names of units, as which they would have to convert numbers."""


def with_labels(function: Callable[_Takes, _Returns]) -> Callable[_Takes, _Returns]:
    """Refuse the name of a unit where a function only takes words for its axes."""

    @wraps(function)
    def checked(*args: _Takes.args, **kwargs: _Takes.kwargs) -> _Returns:
        for name in kwargs:
            if name in _LABELS:
                raise TypeError(
                    f"{function.__name__}() got an unexpected keyword argument {name!r}; write "
                    f"{_LABELS[name]}=, which is a word in the picture and converts no number"
                )
        return function(*args, **kwargs)

    return checked
