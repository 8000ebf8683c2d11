"""What MuJoCo's compiler does to the masses of bodies after it has read them or taken them from geoms.

``boundmass`` and ``boundinertia`` raise what is less, ``balanceinertia`` makes moments that no body has all
their mean, and ``settotalmass`` scales every body. What a file declares is judged as it stands there; what it
leaves to the simulator is told as the simulator has it in the end.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from polhode.robots.model import Compiler, numbers

if TYPE_CHECKING:
    from collections.abc import Sequence

    from polhode.files.xml_source import Element
    from polhode.robots.model import Link, Robot
    from polhode.robots.verdict import Verdict

__all__ = ["as_compiled", "compiler_of", "total_mass_of"]

# Below it MuJoCo refuses the mass and the moments of what moves.
_LEAST = 1e-15


def compiler_of(compilers: Sequence[Element]) -> Compiler:
    """Read what the ``<compiler>`` elements of a model say; the last word counts."""
    least = [_number(compilers, name) for name in ("boundmass", "boundinertia")]
    texts = [each.attributes.get("balanceinertia") for each in compilers]
    return Compiler(least[0], least[1], next((t for t in reversed(texts) if t), "false") == "true")


def total_mass_of(compilers: Sequence[Element]) -> float:
    """Give the mass that ``settotalmass`` sets for all bodies together; 0 where it does not."""
    return max(_number(compilers, "settotalmass"), 0.0)


def as_compiled(robot: Robot, verdicts: Sequence[Verdict]) -> list[Verdict]:
    """Put into the verdicts of inferred bodies what the compiler makes of them."""
    pairs = list(zip(robot.links, verdicts, strict=True))
    if not (robot.total_mass or any(link.compiler for link in robot.links)):
        return list(verdicts)
    found = [_bounded(link.compiler, verdict) if link.compiler else verdict for link, verdict in pairs]
    masses = [_mass(link, verdict) for link, verdict in zip(robot.links, found, strict=True)]
    total = sum(mass for mass in masses if mass is not None)
    if not (robot.total_mass and total > 0.0):
        return found
    if None in masses:
        unknown = robot.links[masses.index(None)].name
        return [_told(v, f"settotalmass would scale it: the mass of {unknown} is not known") for v in found]
    factor = robot.total_mass / total
    return [
        _told(v, f"times {factor:.4g} by settotalmass", v.mass * factor, np.asarray(v.moments) * factor)
        if v.mass is not None and v.moments is not None
        else v
        for v in found
    ]


def _number(compilers: Sequence[Element], name: str) -> float:
    value = 0.0
    for each in compilers:
        if name in each.attributes:
            value = float(numbers(each, each.attributes[name], 1, name)[0])
    return value


def _bounded(compiler: Compiler, verdict: Verdict) -> Verdict:
    """Raise what is less than the bounds, and balance moments that break the triangle inequality."""
    is_empty = verdict.verdict == "missing" and min(compiler.mass, compiler.moment) > _LEAST
    if not is_empty and (verdict.verdict != "inferred" or verdict.mass is None):
        return verdict
    before = np.zeros(3) if is_empty or verdict.moments is None else np.asarray(verdict.moments)
    mass = max(0.0 if is_empty else float(verdict.mass or 0.0), compiler.mass)
    moments = np.maximum(before, compiler.moment)
    is_balanced = compiler.is_balanced and 2.0 * moments.max() > moments.sum()
    moments = np.full(3, moments.mean()) if is_balanced else np.sort(moments)
    if not is_empty and mass == verdict.mass and np.array_equal(moments, before):
        return verdict
    if is_empty:
        verdict = verdict._replace(verdict="inferred", reason="", better=None)
    return _told(verdict, "by boundmass and boundinertia of the compiler", mass, moments)


def _mass(link: Link, verdict: Verdict) -> float | None:
    """Give the mass of a body as it is before ``settotalmass``; None where it is not known."""
    if verdict.mass is None and verdict.verdict in ("none", "missing"):
        return link.compiler.mass if link.compiler else 0.0
    if verdict.mass is None:
        return None
    return max(verdict.mass, link.compiler.mass) if link.compiler else verdict.mass


def _told(verdict: Verdict, words: str, mass: float | None = None, moments: Any = None) -> Verdict:
    """Add words, and numbers where they are given, to the verdict of an inferred body."""
    if verdict.verdict != "inferred":
        return verdict
    reason = ", ".join(part for part in (verdict.reason, words) if part)
    if mass is None:
        return verdict._replace(reason=reason)
    return verdict._replace(reason=reason, mass=mass, moments=moments)
