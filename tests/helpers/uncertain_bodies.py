"""Trees of uncertain numbers (`oracles.matter_models`) as bodies of the package."""

from __future__ import annotations

from typing import Any

import numpy as np
import polhode
from oracles.matter_models import (
    PAIRS,
    Given,
    Mesh,
    Moved,
    Node,
    Particles,
    Principal,
    Quantity,
    Scaled,
    Solid,
    Sum,
    Tensor,
    Turned,
)
from oracles.textbook_shapes import SHAPES
from scipy.spatial.transform import Rotation

__all__ = ["Bodies", "RigidBody", "laminae", "rods", "solids", "symmetric"]

# What has a sigma is known where it is tested; the types do not know it.
RigidBody: Any = polhode.RigidBody
laminae: Any = polhode.laminae
rods: Any = polhode.rods
solids: Any = polhode.solids


def symmetric(six: Any) -> Any:
    """Symmetric matrix of xx yy zz xy xz yz."""
    matrix = np.empty((3, 3))
    for value, (i, j) in zip(six, PAIRS, strict=True):
        matrix[i, j] = matrix[j, i] = value
    return matrix


TWICE = np.array([symmetric(row).ravel() for row in np.eye(6)]).T
"""From six elements to the nine of a matrix."""


class Bodies:
    """One quantity becomes one `Uncertain`, one node one body: what is the same stays the same.

    `sigma` None: without any sigma; a number: each factor times this. With a `label` sources have names, so
    that the probes by which the body tells what is linear are the same in every run.
    """

    def __init__(self, sigma: float | None = 1.0, label: str | None = None) -> None:
        self.sigma = sigma
        self.label = label
        self.count = 0
        self.made: dict[int, Any] = {}
        self.kept: list[object] = []

    def _value(self, q: Quantity) -> Any:
        value = q.value.reshape(q.shape)
        return value if q.shape else float(value)

    def _uncertain(self, value: Any, factor: Any, source: str | None) -> Any:
        assert self.sigma is not None
        factor = factor * self.sigma
        if source is None and self.label is not None:
            self.count += 1
            source = f"{self.label}, {self.count}"
        square = factor.shape[0] == factor.shape[1]
        if square and not np.any(factor - np.diag(np.diag(factor))):
            sigma = np.abs(np.diag(factor))
            shape = np.shape(value) if not hasattr(value, "as_quat") else (3,)
            return polhode.Uncertain(value, sigma.reshape(shape) if shape else float(sigma[0]), source=source)
        return polhode.Uncertain(value, covariance=factor @ factor.T, source=source)

    def number(self, q: Quantity) -> Any:
        """Of any quantity but a tensor or a small rotation."""
        if q.factor is None or self.sigma is None:
            return self._value(q)
        if id(q) not in self.made:
            self.kept.append(q)
            self.made[id(q)] = self._uncertain(self._value(q), q.factor, q.source)
        return self.made[id(q)]

    def tensor(self, q: Quantity) -> Any:
        matrix = symmetric(q.value)
        if q.factor is None or self.sigma is None:
            return matrix
        factor = TWICE @ q.factor * self.sigma
        return polhode.Uncertain(matrix, covariance=factor @ factor.T, source=q.source)

    def rotation(self, attitude: Quantity, turn: Quantity) -> Any:
        rotation = Rotation.from_rotvec(turn.value) * Rotation.from_quat(attitude.value)
        if turn.factor is None or self.sigma is None:
            return rotation
        return self._uncertain(rotation, turn.factor, turn.source)

    def body(self, node: Node) -> Any:
        if id(node) not in self.made:
            self.kept.append(node)
            self.made[id(node)] = self._body(node)
        return self.made[id(node)]

    def _given(self, q: Quantity) -> Any:
        body = RigidBody(float(q.value[0]), symmetric(q.value[4:]), q.value[1:4])
        if q.factor is None or self.sigma is None:
            return body
        factor = q.factor * self.sigma
        if np.any(factor - np.diag(np.diag(factor))):
            return body.with_covariance(factor @ factor.T, source=q.source)
        sigma = np.abs(np.diag(factor))
        return body.with_sigma(
            mass=sigma[0], center_of_mass=sigma[1:4], inertia=symmetric(sigma[4:]), source=q.source
        )

    def _solid(self, node: Solid) -> Any:
        _, arguments, module = SHAPES[node.name]
        make = getattr(getattr(polhode, module), node.name)
        numbers: list[Any] = [v if isinstance(v, int) else self.number(v) for v in node.lengths.values()]
        assert len(numbers) == len(arguments)
        return make(*numbers, **{"density" if node.by_density else "mass": self.number(node.amount)})

    def _body(self, node: Node) -> Any:
        n = self.number
        match node:
            case Tensor():
                word = "inertia_about_origin" if node.about_origin else "inertia"
                return RigidBody(
                    n(node.mass), center_of_mass=n(node.center), **{word: self.tensor(node.inertia)}
                )
            case Given():
                return self._given(node.numbers)
            case Principal():
                axes = self.rotation(node.attitude, node.turn)
                if node.turn.factor is None:
                    return RigidBody.from_principal(n(node.mass), n(node.moments), axes, n(node.center))
                straight = RigidBody.from_principal(n(node.mass), n(node.moments))
                return straight.rotated(axes).translated(n(node.center))
            case Particles():
                return RigidBody.from_particles(n(node.masses), n(node.positions))
            case Solid():
                return self._solid(node)
            case Mesh():
                amount = {"density" if node.by_density else "mass": n(node.amount)}
                return RigidBody.from_mesh(n(node.vertices), node.faces, **amount)
            case Moved():
                return self.body(node.body).translated(n(node.displacement))
            case Turned():
                return self.body(node.body).rotated(self.rotation(node.attitude, node.turn))
            case Scaled():
                return self.body(node.body).scaled(length=n(node.length), mass=n(node.mass))
            case Sum():
                total: Any = None
                for part, sign in zip(node.parts, node.signs, strict=True):
                    one = self.body(part)
                    total = one if total is None else total + one if sign > 0 else total - one
                assert total is not None
                return total
        raise TypeError(f"no body of {type(node).__name__}")
