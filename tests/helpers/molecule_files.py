"""Eight molecules as XYZ, from their published bond lengths (angstrom) and angles."""

from __future__ import annotations

from pathlib import Path

import numpy as np

__all__ = ["XYZ", "write_molecules"]

Atoms = list[tuple[str, float, float, float]]


def water(length: float, angle: float) -> Atoms:
    """Bent, with the oxygen at the origin."""
    half = np.deg2rad(angle) / 2
    x, z = length * np.sin(half), length * np.cos(half)
    return [("O", 0, 0, 0), ("H", x, 0, z), ("H", -x, 0, z)]


def ammonia(length: float, angle: float) -> Atoms:
    """A pyramid; the hydrogens are as far from each other as the angle says."""
    across = 2 * length * np.sin(np.deg2rad(angle) / 2) / np.sqrt(3)
    z = -np.sqrt(length**2 - across**2)
    turns = np.deg2rad([0.0, 120.0, 240.0])
    return [("N", 0, 0, 0), *(("H", across * np.cos(t), across * np.sin(t), z) for t in turns)]


def tetrahedral(middle: str, outer: str, length: float) -> Atoms:
    """At the corners of a cube, every other one."""
    c = length / np.sqrt(3)
    return [(middle, 0, 0, 0), (outer, c, c, c), (outer, -c, -c, c), (outer, -c, c, -c), (outer, c, -c, -c)]


def octahedral(middle: str, outer: str, length: float) -> Atoms:
    """On the coordinate axes."""
    ends = [sign * length * axis for axis in np.eye(3) for sign in (1, -1)]
    return [(middle, 0, 0, 0), *((outer, float(x), float(y), float(z)) for x, y, z in ends)]


def benzene(carbons: float, hydrogens: float) -> Atoms:
    """Two hexagons in a plane."""
    turns = np.deg2rad(60.0 * np.arange(6))
    rings = (("C", carbons), ("H", carbons + hydrogens))
    return [(name, r * np.cos(t), r * np.sin(t), 0) for name, r in rings for t in turns]


def _written(atoms: Atoms, title: str) -> str:
    rows = [f"{name} {x + 0.0:.9f} {y + 0.0:.9f} {z + 0.0:.9f}" for name, x, y, z in atoms]
    return "\n".join([str(len(atoms)), title, *rows, ""])


XYZ = {
    "h2o": _written(water(0.9578, 104.4776), "water, re: Hoy and Bunker 1979"),
    "nh3": _written(ammonia(1.0124, 106.67), "ammonia: Herzberg 1966"),
    "h2co": _written(
        [("O", 0, 0, 1.205), ("C", 0, 0, 0), ("H", 0, 0.9429, -0.5876), ("H", 0, -0.9429, -0.5876)],
        "formaldehyde: r(CO) 1.205, r(CH) 1.111, HCH 116.133 deg",
    ),
    "ch4": _written(tetrahedral("C", "H", 1.094), "methane, r0"),
    "sf6": _written(octahedral("S", "F", 1.561), "sulfur hexafluoride, r0"),
    "c6h6_re": _written(benzene(1.3914, 1.0802), "benzene, re: J Phys Chem A 104 (2000) 2865"),
    "c6h6_r0": _written(benzene(1.397, 1.084), "benzene, r0"),
    "co2": _written([("C", 0, 0, 0), ("O", 0, 0, 1.16), ("O", 0, 0, -1.16)], "carbon dioxide, re"),
}


def write_molecules(folder: Path) -> Path:
    """Write all of them."""
    for name, text in XYZ.items():
        (folder / f"{name}.xyz").write_text(text, "utf-8")
    return folder
