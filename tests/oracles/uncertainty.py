"""What the sigmas of a tree of uncertain numbers are: by draws, and by derivatives of fifty digits.

Draws come in pairs ±z. With y± = y₀ ± J z + r±, half the difference of a pair and half its sum do not
correlate, and of the first the linear part has the known variance J Jᵀ: what is estimated is only how the
variance differs from first order, and its error is smaller than that of a plain variance by the size of r.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import mpmath
import numpy as np
from numpy.typing import NDArray

from oracles.matter_models import PAIRS, Node, Quantity, quantities, ten_numbers
from oracles.textbook_shapes import FLOATS, Field, fifty_digits

Floats: TypeAlias = NDArray[np.float64]

__all__ = [
    "OUTPUTS",
    "Drawn",
    "Sources",
    "covariance",
    "draw_outputs",
    "drawn",
    "jacobian",
    "monte_carlo",
    "values",
]

OUTPUTS = (
    *("mass", "C_x", "C_y", "C_z", "I_xx", "I_yy", "I_zz", "I_xy", "I_xz", "I_yz"),
    *("I_1", "I_2", "I_3", "axis_1", "axis_2", "axis_3", "k_1", "k_2", "k_3"),
)
"""Ten numbers, principal moments, small rotations about the principal axes, radii of gyration."""


class Sources:
    """The standard normal numbers behind one or more trees: quantities of one name share theirs."""

    def __init__(self, *nodes: Node | Quantity) -> None:
        self.first: dict[object, int] = {}
        self.count = 0
        for node in nodes:
            for quantity in quantities(node):
                if quantity.factor is not None and quantity.key not in self.first:
                    self.first[quantity.key] = self.count
                    self.count += quantity.factor.shape[1]

    def draws(self, z: Floats) -> Callable[[Quantity], list[Any]]:
        """Values for draws z of shape (count, n)."""

        def of(quantity: Quantity) -> list[Any]:
            if quantity.factor is None:
                return list(quantity.value)
            start = self.first[quantity.key]
            own = z[start : start + quantity.factor.shape[1]]
            return list(quantity.value[:, None] + quantity.factor @ own)

        return of

    def own(self, z: Floats) -> Callable[[Quantity], Floats]:
        """The part of one draw z (count,) that belongs to a quantity."""

        def of(quantity: Quantity) -> Floats:
            assert quantity.factor is not None
            start = self.first[quantity.key]
            return z[start : start + quantity.factor.shape[1]]

        return of

    def step(self, which: int, h: Any) -> Callable[[Quantity], list[Any]]:
        """Values in numbers of mpmath with z zero but for one component h."""

        def of(quantity: Quantity) -> list[Any]:
            numbers = [mpmath.mpf(float(v)) for v in quantity.value]
            if quantity.factor is None:
                return numbers
            k = which - self.first[quantity.key]
            if 0 <= k < quantity.factor.shape[1]:
                column = quantity.factor[:, k].tolist()
                numbers = [v + mpmath.mpf(c) * h for v, c in zip(numbers, column, strict=True)]
            return numbers

        return of


def _tensors(ten: Floats) -> Floats:
    """Tensors (..., 3, 3) of the ten numbers (..., 10)."""
    tensors = np.empty((*ten.shape[:-1], 3, 3))
    for k, (i, j) in enumerate(PAIRS):
        tensors[..., i, j] = tensors[..., j, i] = ten[..., 4 + k]
    return tensors


def draw_outputs(node: Node, sources: Sources, z: Floats, nominal_axes: Floats) -> Floats:
    """All outputs for the draws z (count, n): shape (n, 19)."""
    numbers = ten_numbers(node.matter(sources.draws(z), FLOATS))
    ten = np.stack([np.broadcast_to(np.asarray(x, dtype=float), z.shape[1:]) for x in numbers], axis=-1)
    moments, axes = np.linalg.eigh(_tensors(ten))
    turn = nominal_axes.T @ axes
    signs = np.sign(np.einsum("...ii->...i", turn))
    turn = turn * np.where(signs == 0, 1, signs)[..., None, :]
    vee = np.stack([turn[..., 2, 1] - turn[..., 1, 2], turn[..., 0, 2] - turn[..., 2, 0]], axis=-1)
    vee = np.concatenate([vee, (turn[..., 1, 0] - turn[..., 0, 1])[..., None]], axis=-1) / 2
    sine = np.linalg.norm(vee, axis=-1, keepdims=True)
    cosine = (np.trace(turn, axis1=-2, axis2=-1)[..., None] - 1) / 2
    angles = vee * np.where(sine > 1e-12, np.arctan2(sine, cosine) / np.maximum(sine, 1e-300), 1.0)
    return np.concatenate([ten, moments, angles, np.sqrt(np.abs(moments) / ten[..., :1])], axis=-1)


def values(node: Node) -> tuple[Floats, Floats]:
    """The ten numbers and the principal axes where no number is off."""
    sources = Sources(node)
    ten = np.array(
        [
            float(np.asarray(x).flat[0])
            for x in ten_numbers(node.matter(sources.draws(np.zeros((sources.count, 1))), FLOATS))
        ]
    )
    axes = np.linalg.eigh(_tensors(ten))[1]
    if np.linalg.det(axes) < 0:
        axes[:, 2] *= -1
    return ten, axes


@dataclass(frozen=True)
class Drawn:
    """Sigmas by draws, their statistical errors, and the sigmas of first order: one for each output."""

    sigma: Floats
    error: Floats
    first_order: Floats

    @property
    def departure(self) -> Floats:
        """How far first order is off, relative to the sigma."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.abs(self.first_order / self.sigma - 1)


def drawn(f: Callable[[Floats], Floats], count: int, n: int, seed: int, chunk: int = 20_000) -> Drawn:
    """Sigmas of a function of draws z (count, m), with values (m, k), by n draws in pairs ±z."""
    h = 0.1  # of a sigma: any J serves as control, and steps that are too short have more rounding
    steps = h * np.eye(count)
    ends = f(np.hstack([steps, -steps, np.zeros((count, 1))]))
    nominal = ends[-1]
    J = ((ends[:count] - ends[count : 2 * count]) / (2 * h)).T
    first = np.einsum("ij,ij->i", J, J)
    rng = np.random.default_rng(seed)
    parts: list[Floats] = []
    evens: list[Floats] = []
    for start in range(0, n // 2, chunk):
        z = rng.standard_normal((count, min(chunk, n // 2 - start)))
        both = f(np.hstack([z, -z]))
        plus, minus = both[: z.shape[1]], both[z.shape[1] :]
        linear = (J @ z).T
        odd = (plus - minus) / 2 - linear
        parts.append(2 * linear * odd + odd * odd)
        evens.append((plus + minus) / 2 - nominal)
    part, even = np.concatenate(parts), np.concatenate(evens)
    part = part + (even - even.mean(axis=0)) ** 2
    variance = np.maximum(first + part.mean(axis=0), 0)
    sigma = np.sqrt(variance)
    with np.errstate(invalid="ignore", divide="ignore"):
        error = np.where(sigma > 0, part.std(axis=0) / np.sqrt(len(part)) / (2 * sigma), 0.0)
    return Drawn(sigma, error, np.sqrt(first))


def monte_carlo(node: Node, n: int = 400_000, seed: int = 0) -> Drawn:
    """Sigmas of all outputs of a tree."""
    sources, (_, axes) = Sources(node), values(node)
    return drawn(lambda z: draw_outputs(node, sources, z, axes), sources.count, n, seed)


def _outputs(numbers: list[Any], axes: Any) -> tuple[list[Any], Any]:
    """Outputs in fifty digits from the ten numbers; `axes` None: they are the nominal ones."""
    matrix = mpmath.matrix(3, 3)
    for k, (i, j) in enumerate(PAIRS):
        matrix[i, j] = matrix[j, i] = numbers[4 + k]
    moments, own = mpmath.eigsy(matrix)
    order = sorted(range(3), key=lambda k: moments[k])
    lengths = [moments[k] for k in order]
    own = mpmath.matrix([[own[i, k] for k in order] for i in range(3)])
    if axes is None:
        if mpmath.det(own) < 0:
            own = own * mpmath.diag([1, 1, -1])
        axes = own
    turn = axes.T * own
    signs = [1 if turn[i, i] > 0 else -1 for i in range(3)]
    angles = [(turn[j, i] * signs[i] - turn[i, j] * signs[j]) / 2 for i, j in ((1, 2), (2, 0), (0, 1))]
    radii = [mpmath.sqrt(abs(x) / numbers[0]) for x in lengths]
    return [*numbers, *lengths, *angles, *radii], axes


def jacobian(node: Node, sources: Sources | None = None, digits: int = 60) -> Any:
    """Derivatives of all outputs by z, (19, count), in numbers of mpmath: differences of steps of 1e-18.

    Their truncation is 1e-36 of the third derivatives, their rounding 1e-60/1e-18. The rows of moments and
    axes mean something where the moments differ.
    """
    sources = sources or Sources(node)
    with mpmath.workdps(digits):
        f: Field = fifty_digits()
        h = mpmath.mpf(10) ** -18

        def at(which: int, step: Any) -> list[Any]:
            return [mpmath.mpf(x) for x in ten_numbers(node.matter(sources.step(which, step), f))]

        _, axes = _outputs(at(-1, h), None)
        J = mpmath.matrix(len(OUTPUTS), sources.count)
        for k in range(sources.count):
            plus, minus = (_outputs(at(k, s), axes)[0] for s in (h, -h))
            for i, (p, m) in enumerate(zip(plus, minus, strict=True)):
                J[i, k] = (p - m) / (2 * h)
    return J


def covariance(left: Any, right: Any | None = None, digits: int = 60) -> Floats:
    """J Kᵀ rounded to float64, each with its derivatives by the same sources."""
    with mpmath.workdps(digits):
        product = left * (left if right is None else right).T
    return np.array([[float(product[i, j]) for j in range(product.cols)] for i in range(product.rows)])
