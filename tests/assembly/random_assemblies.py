"""Random assemblies in files of a folder, with their sums in exact rational arithmetic."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from command_line import write_obj
from oracles.meshes import box as box_mesh

if TYPE_CHECKING:
    from polhode import RigidBody

__all__ = ["Random", "ours", "ten", "toml"]

F = Fraction
Body = tuple[Fraction, list[Fraction], list[list[Fraction]]]
"""Mass, centre, and second moment ∫ r rᵀ dm about the origin: sums of bodies are sums of these."""
QUATERNIONS = [
    (1, 2, 2, 4),
    (2, 4, 5, 6),
    (1, 1, 1, 1),
    (0, 3, 0, 4),
    (4, 4, 1, 4),
    (0, 0, 0, 1),
    (8, 4, 1, 0),
]
"""Whole numbers, and their lengths are whole too."""
SIZE = np.sqrt([np.dot(q, q) for q in QUATERNIONS])


def rotation(q: tuple[int, ...]) -> list[list[Fraction]]:
    x, y, z, w = (F(c) for c in q)
    n = x * x + y * y + z * z + w * w
    rows = [
        [w * w + x * x - y * y - z * z, 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), w * w - x * x + y * y - z * z, 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), w * w - x * x - y * y + z * z],
    ]
    return [[c / n for c in row] for row in rows]


def times(a: Any, b: Any) -> Any:
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def moved(body: Body, q: tuple[int, ...], d: list[Fraction]) -> Body:
    """r → R r + d."""
    m, s, Q = body
    R = rotation(q)
    Rs = [sum(R[i][k] * s[k] for k in range(3)) for i in range(3)]
    turned = times(times(R, Q), [list(column) for column in zip(*R, strict=True)])
    second = [
        [turned[i][j] + d[i] * Rs[j] + Rs[i] * d[j] + m * d[i] * d[j] for j in range(3)] for i in range(3)
    ]
    return m, [Rs[i] + m * d[i] for i in range(3)], second


def added(a: Body, b: Body) -> Body:
    return (
        a[0] + b[0],
        [x + y for x, y in zip(a[1], b[1], strict=True)],
        [[x + y for x, y in zip(p, q, strict=True)] for p, q in zip(a[2], b[2], strict=True)],
    )


def brick(size: list[Fraction], mass: Fraction) -> Body:
    zero = F(0)
    return (
        mass,
        [zero] * 3,
        [[mass * size[i] ** 2 / 12 if i == j else zero for j in range(3)] for i in range(3)],
    )


def ten(body: Body) -> np.ndarray[Any, Any]:
    """m, C and the elements xx yy zz xy xz yz of the tensor about C, rounded once."""
    m, s, Q = body
    c = [x / m for x in s]
    P = [[Q[i][j] - m * c[i] * c[j] for j in range(3)] for i in range(3)]
    trace = P[0][0] + P[1][1] + P[2][2]
    moments = [trace - P[i][i] for i in range(3)]
    return np.array([float(x) for x in (m, *c, *moments, -P[0][1], -P[0][2], -P[1][2])])


def ours(body: RigidBody) -> np.ndarray[Any, Any]:
    I = body.inertia
    return np.array([body.mass, *body.center_of_mass, *np.diag(I), I[0, 1], I[0, 2], I[1, 2]])


def toml(table: dict[str, Any]) -> str:
    """Write an assembly as a file: what this test needs of TOML."""

    def value(x: Any) -> str:
        if isinstance(x, dict):
            return "{ " + ", ".join(f"{k} = {value(v)}" for k, v in x.items()) + " }"
        return json.dumps(x)

    lines = [f"{k} = {value(v)}" for k, v in table.items() if k != "part"]
    for part in table["part"]:
        lines += ["[[part]]", *(f"{k} = {value(v)}" for k, v in part.items())]
    return "\n".join(lines)


class Random:
    """A random tree in files of a folder, with its exact sum."""

    def __init__(self, seed: int, folder: Path) -> None:
        self.rng, self.folder, self.files = np.random.default_rng(seed), folder, 0

    def dyadic(self, low: int, high: int, count: int = 3) -> list[Fraction]:
        return [F(int(k), 16) for k in self.rng.integers(16 * low, 16 * high, count)]

    def turned(self) -> tuple[tuple[int, ...], dict[str, Any]]:
        k = int(self.rng.integers(len(QUATERNIONS)))
        q = QUATERNIONS[k]
        if self.rng.random() < 0.5:
            return q, {"quaternion_xyzw": [c / SIZE[k] for c in q]}
        return q, {"matrix": [[float(c) for c in row] for row in rotation(q)]}

    def tree(self, depth: int) -> tuple[Path, Body]:
        unit, per = [("m", F(1)), ("mm", F(1, 1000)), ("in", F(254, 10000))][int(self.rng.integers(3))]
        parts: list[dict[str, Any]] = []
        total: Body | None = None
        for k in range(int(self.rng.integers(1, 4))):
            part: dict[str, Any] = {"name": f"p{k}"}
            kind = int(self.rng.integers(5 if depth else 4))
            size = [1 + abs(x) for x in self.dyadic(0, 4)]
            metres = [x * per for x in size]
            if kind == 0:
                density = F(int(self.rng.integers(1, 9)), 2)
                part |= {"solid": "box", "size": [float(x) for x in size], "density": float(density)}
                body = brick(metres, density * metres[0] * metres[1] * metres[2])
            elif kind == 1:
                part |= {"solid": "cube", "side": float(size[0]), "mass": "3.5 lbm"}
                body = brick([metres[0]] * 3, F("0.45359237") * F(7, 2))
            elif kind == 2:
                com = self.dyadic(-2, 2)
                inner = brick(metres, F(5, 2))
                q, _ = self.turned()
                body = moved(inner, q, [x * per for x in com])
                numbers = ten(body) / float(per) ** 2
                part["inertia"] = {
                    "mass": 2.5,
                    "com": [float(x) for x in com],
                    "tensor": [*numbers[4:7], *-numbers[7:]],
                    "products": "positive",
                }
            elif kind == 3:
                self.files += 1
                vertices, faces = box_mesh((float(size[0]), float(size[1]), float(size[2])))
                low = vertices.min(axis=0)
                part |= {
                    "file": write_obj(self.folder / f"m{self.files}.obj", vertices, faces).name,
                    "mass": 0.75,
                }
                middle = [F(float(low[i])) * per + metres[i] / 2 for i in range(3)]
                body = moved(brick(metres, F(3, 4)), (0, 0, 0, 1), middle)
            else:
                path, body = self.tree(depth - 1)
                part["assembly"] = path.name
            if self.rng.random() < 0.7:
                d, (q, form) = self.dyadic(-8, 8), self.turned()
                part |= {"position": [float(x) for x in d], "rotation": form}
                body = moved(body, q, [x * per for x in d])
            if self.rng.random() < 0.4:
                count, step = int(self.rng.integers(2, 5)), self.dyadic(-3, 3)
                q, form = self.turned()
                part |= {"count": count, "step": [float(x) for x in step], "turn": form}
                one = body
                for _ in range(count - 1):
                    one = moved(one, q, [x * per for x in step])
                    body = added(body, one)
            parts.append(part)
            total = body if total is None else added(total, body)
        assert total is not None
        self.files += 1
        path = self.folder / f"a{self.files}.toml"
        path.write_text(toml({"length_unit": unit, "part": parts}))
        return path, total
