"""One word a meaning: the parameters of every public function and method, by the table of words below."""

from __future__ import annotations

import inspect
from dataclasses import is_dataclass
from typing import Any

import polhode
import pytest
from public_objects import OBJECTS

FOREIGN = {
    "r": "point",
    "com": "center_of_mass",
    "centre": "center",
    "tensor": "inertia",
    "moi": "inertia",
    "time": "t",
    "times_out": "t",
    "t_eval": "t",
    "t_end": "end",
    "until": "end",
    "last": "end",
    "members": "n",
    "clones": "n",
    "count": "n",
    "omega0": "omega",
    "orientation": "attitude",
    "rotation_matrix": "attitude",
    "output": "path",
    "filename": "path",
    "file": "path",
    "units": "length_unit",
    "unit": "length_unit",
}
"""Words that other libraries have, or that this one had, and the word here."""

ALLOWED = {
    ("polhode.units.metres_per", "unit"),  # of any length
}

MOTIONS = (polhode.Trajectory, polhode.FreeMotion, polhode.HeavyTop, polhode.GyrostatMotion)
"""The classes that hold a motion."""

TIMES = {"t", "end"}
"""What a closed form is asked for, and a trajectory has."""

OF_ONE_MOTION = {
    ("sensitivity", "method"),  # there is one way to derive a closed form
}
"""Parameters of one class of motion alone, by the name of the method."""


def parameters() -> list[tuple[str, str]]:
    """Every parameter of a public function, method or class that is no record, by the name of its owner."""
    found = []
    for name, value in OBJECTS.items():
        if inspect.isclass(value) and (issubclass(value, tuple) or is_dataclass(value)):
            continue
        try:
            signature = inspect.signature(value)
        except (TypeError, ValueError):  # no callable, or one without a signature
            continue
        found += [(name, parameter) for parameter in signature.parameters]
    return found


def test_parameters_have_the_words_of_the_vocabulary() -> None:
    known = parameters()
    assert len(known) > 500
    faults = [
        f"{owner}({name}): write {FOREIGN[name]}"
        for owner, name in known
        if name in FOREIGN and (owner, name) not in ALLOWED
    ]
    assert faults == []


@pytest.mark.parametrize("name", ["inertia_about", "moment_about", "principal_about", "sigma_about"])
def test_what_is_taken_about_a_point_says_about(name: str) -> None:
    assert "about" in inspect.signature(getattr(polhode.RigidBody, name)).parameters


@pytest.mark.parametrize(
    "method",
    [polhode.RigidBody.point_velocity, polhode.RigidBody.point_acceleration, polhode.Trajectory.point],
)
def test_a_point_that_is_asked_for_is_called_point(method: Any) -> None:
    assert list(inspect.signature(method).parameters)[1] == "point"


def test_no_parameter_of_a_picture_says_unit_without_converting() -> None:
    labels = [
        (owner, name)
        for owner, name in parameters()
        if owner.startswith(("polhode.plot", "polhode.view", "polhode.animation")) and name.endswith("_unit")
    ]
    assert labels == []


def words_of(kind: type, name: str) -> list[str] | None:
    """Parameters of a method, but for the times; None for an attribute."""
    if not callable(inspect.getattr_static(kind, name, None)):
        return None
    found = list(inspect.signature(getattr(kind, name)).parameters)[1:]
    return [one for one in found if one not in TIMES and (name, one) not in OF_ONE_MOTION]


def test_one_quantity_of_a_motion_is_one_method_or_one_attribute() -> None:
    public = {
        kind: {one for one in {*dir(kind), *getattr(kind, "__dataclass_fields__", ())} if one[0] != "_"}
        for kind in MOTIONS
    }
    shared = sorted(set().union(*public.values()))
    assert {"kinetic_energy", "angular_momentum", "mode", "periods"} <= set(shared)
    faults = []
    for name in shared:
        ways = {kind.__name__: words_of(kind, name) for kind in MOTIONS if name in public[kind]}
        if len({repr(words) for words in ways.values()}) > 1:
            faults.append((name, ways))
    assert faults == []


@pytest.mark.parametrize("kind", MOTIONS, ids=lambda kind: kind.__name__)
@pytest.mark.parametrize("name", ["kinetic_energy", "angular_momentum", "stability", "equilibria"])
def test_what_is_computed_of_a_motion_is_a_method(kind: type, name: str) -> None:
    assert not hasattr(kind, name) or callable(inspect.getattr_static(kind, name))
