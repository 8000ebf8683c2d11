"""Ledgers: published tables, exact sums, and covariances beside complex steps and Monte Carlo."""

from __future__ import annotations

import io
import json
import pickle
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import one_line, run
from matplotlib.figure import Figure
from numpy.typing import NDArray
from polhode import RigidBody, laminae, solids
from polhode._rounding import with_sigma
from polhode.errors import InvalidInertiaError
from polhode.uncertainty import Ledger, ledger

NUMBERS = ("mass", "Cx", "Cy", "Cz", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")
ELEMENTS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
SIGMAS = tuple(f"sigma_{name}" for name in NUMBERS)
Floats = NDArray[np.float64]

# SAWE paper 3360 (Zimmerman, Nakai: Are you sure?, 2005), its two-part example as tabulated in R massProps
# (jsjuni/massProps, data-raw/sawe_table.tsv and sawe_edges.tsv): the last row is what the paper prints.
SAWE = """id mass Cx Cy Cz Ixx Iyy Izz Ixy Ixz Iyz sigma_mass sigma_Cx sigma_Cy sigma_Cz sigma_Ixx sigma_Iyy sigma_Izz \
sigma_Ixy sigma_Ixz sigma_Iyz Ipoint POIconv
Widget 57.83 121.20 0.04 -0.16 7258.90 8607.02 10453.40 834.44 -1198.38 -1066.58 1.2416 0.2764 0.2085 0.0669 \
386.9233 171.4792 414.5547 1440.5402 344.6237 124.6860 FALSE +
2nd_Part 16.80 70.90 -0.95 0.46 65.07 1124.65 1078.82 76.01 202.83 13.62 1.7308 0.6234 0.5173 0.1405 12.4687 \
109.1324 108.5481 55.8879 212.1241 11.5408 FALSE +
Combined 74.63 109.8657 -0.1829 -0.0204 7341.73 42739.26 44547.27 1559.36 -1401.94 -1060.95 2.1301 0.9591
0.2000 \ 0.0618 387.4017 2794.5468 2820.5125 1488.1857 418.6320 125.3175 FALSE +
""".replace("\\\n", "").replace(" ", "\t")
SAWE_EDGES = "child\tparent\nWidget\tCombined\n2nd_Part\tCombined\n"
# What massProps prints of it (its vignette): values and sigmas, products positive.
SAWE_BY_R = (
    74.63,
    109.8769,
    -0.1828594,
    -0.02043146,
    7341.733,
    42673.75,
    44482.05,
    1558.714,
    -1401.534,
    -1060.951,
)
SAWE_SIGMAS_BY_R = (
    2.13008, 0.95821004, 0.19998470, 0.06178402, 387.4017, 2789.3133, 2815.3260, 1488.0948, 418.6048,
    125.3175,
)  # fmt: skip

# jsjuni/massProps, data-raw/test_table.tsv, and what its vignette prints of the assemblies.
TEST_TABLE = """id parent mass Cx Cy Cz Ixx Ixy Ixz Iyy Iyz Izz POIconv Ipoint
A.1  NA NA NA NA NA NA NA NA NA NA - FALSE
A.2 A.1 NA NA NA NA NA NA NA NA NA NA - FALSE
A.3 A.1 NA NA NA NA NA NA NA NA NA NA - FALSE
C.1 A.1 5 0 0 0 80 -4 -24 80 -24 75 - FALSE
P.1 A.2 2 1 1 1 4 -0.1 -0.1 4 0.1 4 - FALSE
P.2 A.2 2 1 1 -1 4 -0.1 -0.1 4 0.1 4 - FALSE
P.3 A.2 2 1 -1 1 4 -0.1 -0.1 4 0.1 4 - FALSE
P.4 A.2 2 1 -1 -1 4 -0.1 -0.1 4 0.1 4 - FALSE
P.5 A.3 2 -1 1 1 4 -0.1 -0.1 4 0.1 4 - FALSE
P.6 A.3 2 -1 1 -1 4 -0.1 -0.1 4 0.1 4 - FALSE
P.7 A.3 2 -1 -1 1 4 -0.1 -0.1 4 0.1 4 - FALSE
P.8 A.3 2 -1 -1 -1 4 -0.1 -0.1 4 0.1 4 - FALSE
""".replace(" ", "\t")
TEST_EDGES = '"parent"\t"child"\n' + "".join(
    f'"{parent}"\t"{child}"\n'
    for child, parent in [
        ("A.2", "A.1"), ("A.3", "A.1"), ("C.1", "A.1"),
        *((f"P.{k}", "A.2" if k < 5 else "A.3") for k in range(1, 9)),
    ]
)  # fmt: skip
TEST_BY_R = {
    "A.1": (21, 0, 0, 0, 144, 144, 139, -4.8, -24.8, -23.2),
    "A.2": (8, 1, 0, 0, 32, 24, 24, -0.4, -0.4, 0.4),
    "A.3": (8, -1, 0, 0, 32, 24, 24, -0.4, -0.4, 0.4),
}


def ten(mass: Any, center: Any, inertia: Any) -> Floats:
    """The ten numbers, last axis."""
    columns = [mass, *np.moveaxis(np.asarray(center), -1, 0), *(inertia[..., i, j] for i, j in ELEMENTS)]
    return np.stack([np.asarray(column) for column in columns], axis=-1)


def values(tree: Ledger) -> Floats:
    return ten(tree.mass, tree.center_of_mass, tree.inertia)


def sigmas(tree: Ledger) -> Floats:
    assert tree.sigma is not None
    return ten(*tree.sigma)


def covariances(tree: Ledger) -> Floats:
    assert tree.covariance is not None
    return tree.covariance


def combined(parts: Any) -> Any:
    """The textbook's sum of bodies, of numbers of any kind: parts (k, 10), or with draws before them."""
    mass, center = parts[..., 0], parts[..., 1:4]
    total = parts[..., :1].sum(axis=-2)
    mean = (mass[..., None] * center).sum(axis=-2) / total
    x, y, z = np.moveaxis(center - mean[..., None, :], -1, 0)
    own = np.stack([y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z], axis=-1)
    inertia = (parts[..., 4:] + mass[..., None] * own).sum(axis=-2)
    return np.concatenate([total, mean, inertia], axis=-1)


def random_tree(count: int, seed: int, fan: int = 3) -> tuple[dict[str, Any], dict[str, list[int]]]:
    """A table of a random tree, and the rows of the leaves below each id."""
    rng = np.random.default_rng(seed)
    above = [-1] + [
        int(rng.integers(max(0, (k - 1) // fan - 2), (k - 1) // fan + 1)) for k in range(1, count)
    ]
    is_leaf = np.ones(count, bool)
    is_leaf[above[1:]] = False
    arms = rng.normal(size=(count, 3, 4))
    second = arms @ arms.swapaxes(1, 2)
    inertia = np.trace(second, axis1=1, axis2=2)[:, None, None] * np.eye(3) - second
    numbers = ten(rng.uniform(1.0, 5.0, count), 3.0 * rng.normal(size=(count, 3)), inertia)
    spread = rng.uniform(0.002, 0.02, (count, 10)) * np.abs(numbers).mean(axis=0)
    columns = dict(zip(NUMBERS + SIGMAS, np.concatenate([numbers, spread], axis=1).T, strict=True))
    table: dict[str, Any] = {name: np.where(is_leaf, column, np.nan) for name, column in columns.items()}
    table["id"] = [f"n{k}" for k in range(count)]
    table["parent"] = ["" if k < 0 else f"n{k}" for k in above]
    table["POIconv"] = ["-"] * count
    below: dict[str, list[int]] = {name: [] for name in table["id"]}
    for k in np.flatnonzero(is_leaf).tolist():
        node = k
        while node >= 0:
            below[f"n{node}"].append(k)
            node = above[node]
    return table, below


def leaf_draws(table: dict[str, Any]) -> Floats:
    """The ten numbers of each row as stated, (n, 10)."""
    return np.stack([table[name] for name in NUMBERS], axis=1)


def by_complex_steps(
    table: dict[str, Any],
    rows: list[int],
    model: Callable[[Any, int], Any] = lambda numbers, _: numbers,
    source: list[str] | None = None,
) -> Floats:
    """The covariance of the sum of these rows: derivatives by complex steps, which lose no digits.

    `model` makes the ten numbers of a part from what is stated of it; rows with one word in `source` share
    draws.
    """
    stated = np.stack([table[name] for name in NUMBERS], axis=1)[rows]
    spread = np.stack([table[name] for name in SIGMAS], axis=1)[rows]
    groups: dict[Any, list[int]] = {}
    for k, row in enumerate(rows):
        groups.setdefault((source[row] if source else "") or row, []).append(k)
    columns = []
    step = 1e-30
    for members in groups.values():
        for j in range(10):
            moved = stated.astype(complex)
            moved[members, j] += 1j * step * spread[members, j]
            parts = np.stack([model(moved[k], row) for k, row in enumerate(rows)])
            columns.append(combined(parts).imag / step)
    draws = np.stack(columns, axis=1)
    return draws @ draws.T


def assert_close(ours: Floats, theirs: Floats, rtol: float) -> None:
    """Relative to the size that each element could have by its two sigmas; those below 1e-12 are rounding."""
    scale = np.sqrt(np.diagonal(theirs, axis1=-2, axis2=-1)).clip(1e-12)
    size = scale[..., :, None] * scale[..., None, :]
    assert np.all(np.abs(ours - theirs) <= rtol * size)


class TestPublished:
    @pytest.fixture
    def sawe(self, tmp_path: Path) -> Ledger:
        (tmp_path / "sawe_table.tsv").write_text(SAWE, "utf-8")
        (tmp_path / "sawe_edges.tsv").write_text(SAWE_EDGES, "utf-8")
        return ledger(tmp_path / "sawe_table.tsv", tmp_path / "sawe_edges.tsv", overwrite=True)

    def test_what_the_paper_prints(self, sawe: Ledger) -> None:
        """Within 0.3 %, which is its own rounding: first order gives 0.95821 for its 0.9591."""
        printed = [float(word) for word in SAWE.splitlines()[-1].split("\t")[1:21]]
        ours = values(sawe)[2] * ([1.0] * 7 + [-1.0] * 3)
        assert np.allclose(ours, printed[:10], rtol=3e-3, atol=0.0)
        assert np.allclose(sigmas(sawe)[2], printed[10:], rtol=3e-3, atol=0.0)

    def test_what_mass_props_prints(self, sawe: Ledger) -> None:
        ours = values(sawe)[2] * ([1.0] * 7 + [-1.0] * 3)
        assert np.allclose(ours, SAWE_BY_R, rtol=5e-7, atol=0.0)
        assert np.allclose(sigmas(sawe)[2], SAWE_SIGMAS_BY_R, rtol=5e-7, atol=0.0)

    def test_the_correlation_that_ten_sigmas_drop(self, sawe: Ledger) -> None:
        whole = sawe["Combined"]
        covariance = whole.covariance
        assert covariance is not None
        assert covariance[5, 6] / np.sqrt(covariance[5, 5] * covariance[6, 6]) == pytest.approx(
            0.986, abs=5e-4
        )
        axes = whole.body.principal.axes
        gradient = np.array(
            [[axes[i, k] * axes[j, k] * (2 - (i == j)) for i, j in ELEMENTS] for k in range(3)]
        )
        tensor = covariance[4:, 4:]
        kept = np.sqrt(np.diag(gradient @ tensor @ gradient.T))
        dropped = np.sqrt(np.diag(gradient @ np.diag(np.diag(tensor)) @ gradient.T))
        assert kept[1] == pytest.approx(2791.3, abs=0.05)
        assert dropped[1] == pytest.approx(2372.6, abs=0.05)

    def test_numpy_propagation(self, sawe: Ledger) -> None:
        rows = [line.split("\t") for line in SAWE.splitlines()[1:3]]
        numbers = np.array([[float(word) for word in row[1:21]] for row in rows])
        numbers[:, 7:10] *= -1.0
        table = dict(zip(NUMBERS + SIGMAS, numbers.T, strict=True))
        assert_close(covariances(sawe)[2], by_complex_steps(table, [0, 1]), 1e-13)

    def test_a_tree_of_mass_props(self, tmp_path: Path) -> None:
        (tmp_path / "test_table.tsv").write_text(TEST_TABLE, "utf-8")
        (tmp_path / "edges.tsv").write_text(TEST_EDGES, "utf-8")
        for tree in (None, tmp_path / "edges.tsv"):
            rolled = ledger(tmp_path / "test_table.tsv", tree)
            assert rolled.root == "A.1"
            assert rolled.covariance is None
            assert rolled.sigma is None
            for name, printed in TEST_BY_R.items():
                node = rolled[name]
                assert np.allclose(
                    ten(node.mass, node.center_of_mass, node.inertia), printed, rtol=0, atol=1e-13
                )

    def test_the_letter_of_older_tables(self, tmp_path: Path) -> None:
        (tmp_path / "old.tsv").write_text(SAWE.replace("sigma_", "σ_"), "utf-8")
        (tmp_path / "edges.tsv").write_text(SAWE_EDGES, "utf-8")
        old = ledger(tmp_path / "old.tsv", tmp_path / "edges.tsv", overwrite=True)
        assert np.allclose(sigmas(old)[2], SAWE_SIGMAS_BY_R, rtol=5e-7, atol=0.0)


class TestSums:
    @pytest.mark.parametrize("seed", range(5))
    def test_exact_rationals(self, seed: int) -> None:
        table, below = random_tree(40, seed)
        rolled = ledger(table)
        exact = np.vectorize(Fraction, otypes=[object])
        for name, rows in below.items():
            node = rolled[name]
            theirs = combined(exact(leaf_draws(table)[rows])).astype(float)
            ours = ten(node.mass, node.center_of_mass, node.inertia)
            scale = np.array([theirs[0], *[3.0] * 3, *[theirs[4:7].max()] * 6])
            assert np.all(np.abs(ours - theirs) <= 4e-15 * scale)

    def test_a_tree_far_from_the_origin(self) -> None:
        table, _ = random_tree(60, 7)
        far = dict(table)
        for name, by in (("Cx", 2.0**20), ("Cy", -(2.0**21)), ("Cz", 2.0**19)):
            far[name] = np.round(table[name] * 2.0**20) / 2.0**20
            table = table | {name: far[name]}
            far[name] = far[name] + by
        near, there = ledger(table), ledger(far)
        assert np.allclose(near.inertia, there.inertia, rtol=1e-8)
        assert_close(covariances(there), covariances(near), 1e-8)

    def test_bodies_and_growth(self) -> None:
        table, below = random_tree(30, 3)
        share = np.linspace(0.0, 0.3, 30)
        rolled = ledger(table | {"growth": np.where(np.isnan(table["mass"]), np.nan, share)})
        assert np.array_equal(rolled.bodies.mass, rolled.mass)
        assert np.array_equal(rolled.bodies.inertia, rolled.inertia)
        for name, rows in below.items():
            predicted = sum(table["mass"][rows] * (1.0 + share[rows]))
            assert rolled[name].predicted_mass == pytest.approx(predicted, rel=1e-14)
            row = rolled.ids.index(name)
            assert rolled.growth[row] == pytest.approx(predicted / table["mass"][rows].sum() - 1.0, abs=1e-14)

    def test_a_chain_a_bush_and_a_single_part(self) -> None:
        one = {"mass": 2.0, "Cx": 1.0, "Cy": 2.0, "Cz": 3.0, "Ipoint": True, "sigma_mass": 0.1}
        alone = ledger([{"id": "p", "parent": None} | one])
        assert alone["p"].with_sigma("mass") == (2.0, 0.1)
        deep = [{"id": f"n{k}", "parent": f"n{k - 1}" if k else ""} for k in range(2000)]
        chain = ledger([*deep, {"id": "p", "parent": "n1999"} | one])
        assert chain["n0"].with_sigma("mass") == (2.0, pytest.approx(0.1, rel=1e-14))
        assert chain.depth.max() == 2000
        wide = [{"id": f"p{k}", "parent": "all"} | one for k in range(10_000)]
        bush = ledger([{"id": "all"}, *wide])
        assert bush["all"].with_sigma("mass") == (20000.0, pytest.approx(10.0, rel=1e-12))
        assert bush["all"].with_sigma("Ixx")[0] == pytest.approx(0.0, abs=1e-9)


class TestCovariances:
    @pytest.mark.parametrize(
        ("count", "seed", "fan"), [(3, 0, 2), (20, 1, 2), (60, 2, 3), (60, 3, 12), (9, 4, 20)]
    )
    def test_complex_steps(self, count: int, seed: int, fan: int) -> None:
        table, below = random_tree(count, seed, fan)
        rolled = ledger(table)
        for name, rows in below.items():
            theirs = by_complex_steps(table, rows)
            covariance = rolled[name].covariance
            assert covariance is not None
            assert_close(covariance, theirs, 1e-12)
            spread = [rolled[name].with_sigma(number)[1] for number in NUMBERS]
            assert np.allclose(spread, np.sqrt(np.diag(theirs)), rtol=1e-12)

    @pytest.mark.parametrize("seed", range(4))
    def test_parts_that_share_a_source(self, seed: int) -> None:
        table, below = random_tree(40, seed)
        rng = np.random.default_rng(seed)
        source = [["", "", "wheel", "scale", f"own {k}"][int(rng.integers(5))] for k in range(40)]
        rolled = ledger(table | {"source": source})
        for name, rows in below.items():
            covariance = rolled[name].covariance
            assert covariance is not None
            assert_close(covariance, by_complex_steps(table, rows, source=source), 1e-12)

    @pytest.mark.parametrize("shared", [False, True])
    def test_tensors_about_the_origin_and_points(self, shared: bool) -> None:
        table, below = random_tree(30, 11)
        about = np.array(["origin" if k % 3 else "" for k in range(30)])
        is_point = np.array([k % 5 == 0 for k in range(30)])
        source = [["a", "b", ""][k % 3] if shared else "" for k in range(30)]
        x, y, z = (table[name] for name in ("Cx", "Cy", "Cz"))
        own = [y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z]
        stated = dict(table)
        for name, part in zip(NUMBERS[4:], own, strict=True):
            stated[name] = table[name] + np.where(about == "origin", table["mass"] * part, 0.0)

        def model(numbers: Any, row: int) -> Any:
            made = numbers.copy()
            if is_point[row]:
                made[4:] = 0.0
            elif about[row] == "origin":
                x, y, z = numbers[1:4]
                own = np.array([y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z])
                made[4:] = numbers[4:] - numbers[0] * own
            return made

        rolled = ledger(stated | {"about": about, "Ipoint": is_point, "source": source})
        for name, rows in below.items():
            theirs = by_complex_steps(stated, rows, model, source)
            covariance = rolled[name].covariance
            assert covariance is not None
            assert_close(covariance, theirs, 1e-11)
            node = rolled[name]
            numbers = np.stack([model(leaf_draws(stated)[row].astype(complex), row).real for row in rows])
            assert np.allclose(
                ten(node.mass, node.center_of_mass, node.inertia), combined(numbers), atol=1e-11
            )

    def test_monte_carlo(self) -> None:
        """2e5 draws of half of all sigmas: sigmas within 1 %, correlations within 0.02, five times their own sigma."""
        table, below = random_tree(12, 5)
        source = ["rig" if k % 3 == 0 else "" for k in range(12)]
        rolled = ledger(table | {"source": source})
        rng = np.random.default_rng(1)
        draws = rng.standard_normal((200_000, 12, 10))
        together = [k for k in range(12) if source[k]]
        draws[:, together] = draws[:, together[:1]]
        spread = np.stack([table[name] for name in SIGMAS], axis=1)
        for name in ("n0", "n1"):
            rows = below[name]
            sample = combined((leaf_draws(table) + 0.5 * draws * spread)[:, rows])
            theirs = np.cov(sample.T) / 0.25
            covariance = rolled[name].covariance
            assert covariance is not None
            assert np.allclose(np.diag(covariance), np.diag(theirs), rtol=0.02)
            assert_close(covariance, theirs, 0.02)

    def test_at_once_and_in_two_steps(self) -> None:
        table, below = random_tree(80, 6)
        nested = ledger(table)
        leaves = below["n0"]
        flat = {name: [column[row] for row in leaves] for name, column in table.items()}
        flat = {name: [np.nan, *cells] for name, cells in flat.items()}
        flat |= {"id": ["all", *(f"n{row}" for row in leaves)], "parent": ["", *["all"] * len(leaves)]}
        flat["POIconv"] = "-"
        at_once = ledger(flat)
        assert_close(covariances(nested)[0], covariances(at_once)[0], 1e-13)
        assert np.allclose(values(nested)[0], values(at_once)[0], rtol=1e-13, atol=1e-13)

    def test_the_order_of_rows_changes_nothing(self) -> None:
        table, _ = random_tree(120, 8)
        table["source"] = ["pair" if k % 7 == 0 else "" for k in range(120)]
        order = np.random.default_rng(2).permutation(120)
        one, other = (
            ledger(table),
            ledger({name: [column[k] for k in order] for name, column in table.items()}),
        )
        assert other.ids == tuple(one.ids[k] for k in order)
        assert np.allclose(values(other), values(one)[order], rtol=1e-14, atol=1e-14)
        assert_close(covariances(other), covariances(one)[order], 1e-14)

    def test_two_wheels_from_one_drawing(self) -> None:
        part = {"mass": 2.0, "Cy": 0.0, "Cz": 0.0, "Ipoint": True, "sigma_mass": 0.1}
        rows = [{"id": "car"}, *({"id": f"at {x}", "parent": "car", "Cx": x} | part for x in (-1.0, 1.0))]
        apart = ledger(rows)["car"]
        as_one = ledger([row | {"source": "drawing"} for row in rows])["car"]
        assert apart.with_sigma("mass")[1] == pytest.approx(0.1 * 2.0**0.5, rel=1e-15)
        assert as_one.with_sigma("mass")[1] == pytest.approx(0.2, rel=1e-15)
        assert as_one.with_sigma("Cx") == (0.0, 0.0)

    def test_what_is_exact_has_no_covariance(self) -> None:
        table, _ = random_tree(9, 1)
        table = {name: column for name, column in table.items() if not name.startswith("sigma")}
        exact = ledger(table)
        nothing = ledger(table | {"sigma_mass": 0.0})
        for tree in (exact, nothing):
            assert tree.covariance is None
            assert tree["n0"].covariance is None
            assert tree["n0"].sigma is None
        assert np.array_equal(values(exact), values(ledger(table | {"sigma_Cx": 0.25})))


class TestShapes:
    def test_solids_and_files(self, tmp_path: Path) -> None:
        (tmp_path / "box.obj").write_text(
            "v 0 0 0\nv 2 0 0\nv 0 3 0\nv 0 0 4\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", "utf-8"
        )
        (tmp_path / "parts.csv").write_text(
            "id,parent,solid,file,arguments,mass,density,sigma_mass,sigma_density,Cx,Cy,Cz,sigma_Cx\n"
            "all,,,,,,,,,,,,\n"
            "tank,all,cylinder,,radius=0.5 height=2,,3,,0.1,1,2,3,0.01\n"
            'slab,all,box,,"size=1,2,3",5,,0.2,,,,,\n'
            'plate,all,rectangle,,"size=1,2",5,,,,,,,\n'
            "rock,all,,box.obj,length_unit=m,,2.5,,0.05,,,,\n",
            "utf-8",
        )
        rolled = ledger(tmp_path / "parts.csv")
        rock = RigidBody.from_file(tmp_path / "box.obj", density=2.5, length_unit="m")
        bodies = {
            "tank": solids.cylinder(radius=0.5, height=2.0, density=3.0).translated((1.0, 2.0, 3.0)),
            "slab": solids.box((1.0, 2.0, 3.0), mass=5.0),
            "plate": laminae.rectangle((1.0, 2.0), mass=5.0),
            "rock": rock,
        }
        for name, body in bodies.items():
            assert bool(rolled[name].body.isclose(body, rtol=1e-14))
        assert bool(rolled["all"].body.isclose(sum(list(bodies.values())[1:], bodies["tank"]), rtol=1e-14))
        for name, share in (("tank", 0.1 / 3.0), ("slab", 0.2 / 5.0), ("rock", 0.05 / 2.5)):
            body, covariance = bodies[name], rolled[name].covariance
            assert covariance is not None
            draw = share * ten(body.mass, np.zeros(3), body.inertia)
            theirs = np.outer(draw, draw)
            theirs[1, 1] += 0.01**2 * (name == "tank")
            assert np.allclose(covariance, theirs, rtol=1e-13, atol=1e-16)
        assert rolled.unstated == 1

    def test_a_part_used_twice(self) -> None:
        rows = [
            {"id": "all"},
            *(
                {"id": f"w{x}", "parent": "all", "solid": "sphere", "arguments": "radius=0.5", "density": 2.0}
                | {"sigma_density": 0.1, "Cx": float(x), "source": "cast"}
                for x in (-3, 5)
            ),
        ]
        whole = ledger(rows)["all"]
        body = whole.body
        draw = 0.05 * ten(body.mass, np.zeros(3), body.inertia)
        assert whole.covariance is not None
        assert np.allclose(whole.covariance, np.outer(draw, draw), rtol=1e-13, atol=1e-15)


class TestShares:
    @pytest.mark.parametrize("number", NUMBERS)
    def test_a_share_is_what_the_variance_loses_without_it(self, number: str) -> None:
        table, below = random_tree(25, 9)
        table["source"] = ["rig" if k % 4 == 0 else "" for k in range(25)]
        table["about"] = ["origin" if k == below["n1"][0] else "" for k in range(25)]
        for k in (below["n1"][0],):  # a tensor about the origin has to be that of a body
            for name in NUMBERS[4:7]:
                table[name][k] += 1e3
        rolled = ledger(table)
        for at in ("n0", "n1"):
            shares = rolled.variance_shares(number, at)
            total = rolled[at].with_sigma(number)[1]
            assert total is not None
            assert shares.sigma == pytest.approx(total, rel=1e-12)
            assert shares.fraction.sum() == pytest.approx(1.0, rel=1e-12)
            assert np.allclose(shares.by_number.sum(axis=1), shares.fraction, rtol=1e-12)
            assert np.all(np.diff(shares.fraction) <= 0.0)
            assert len(shares) == len({table["source"][k] or k for k in below[at]})
            for k in range(3):
                name = shares.names[k]
                calm = {column: cells.copy() for column, cells in table.items()}
                rows = (
                    [row for row in below["n0"] if table["source"][row] == name]
                    if shares.is_source[k]
                    else [int(name[1:])]
                )
                for column in SIGMAS:
                    calm[column][rows] = 0.0
                left = ledger(calm)[at].with_sigma(number)[1]
                assert left is not None
                assert 1.0 - (left / total) ** 2 == pytest.approx(shares.fraction[k], abs=1e-9)

    def test_which_scale_has_to_become_better(self) -> None:
        shares = ledger(
            [
                {"id": "craft"},
                {
                    "id": "bus",
                    "parent": "craft",
                    "mass": 50,
                    "Cx": 0,
                    "Cy": 0,
                    "Cz": 0,
                    "Ipoint": "TRUE",
                    "sigma_mass": 0.3,
                },
                {
                    "id": "fin",
                    "parent": "craft",
                    "mass": 1,
                    "Cx": 0,
                    "Cy": 0,
                    "Cz": 0,
                    "Ipoint": "TRUE",
                    "sigma_mass": 0.4,
                },
            ]
        ).variance_shares("mass")
        assert shares.names == ("fin", "bus")
        assert shares.fraction == pytest.approx([0.64, 0.36])
        assert shares.largest(0) == "mass"
        assert (
            repr(shares) == "<Shares of the variance of mass of 'craft': fin 64.0% (mass), bus 36.0% (mass)>"
        )

    def test_what_has_no_variance_is_told(self) -> None:
        point = {"parent": "", "mass": 1, "Cx": 0, "Cy": 0, "Cz": 0, "Ipoint": True}
        with pytest.raises(ValueError, match="no part states a standard deviation"):
            ledger([{"id": "a"} | point]).variance_shares()
        uncertain = ledger([{"id": "a", "sigma_Cx": 0.1} | point])
        with pytest.raises(ValueError, match="mass of 'a' has no variance"):
            uncertain.variance_shares()
        with pytest.raises(ValueError, match="of: 'weight' is none of mass, Cx"):
            uncertain.variance_shares("weight")
        with pytest.raises(KeyError, match="no part has the id 'b'"):
            uncertain.variance_shares("Cx", "b")


HEAD = "id,parent,mass,Cx,Cy,Cz,Ixx,Iyy,Izz,Ixy,Ixz,Iyz,POIconv,sigma_mass"
GOOD = "a,,,,,,,,,,,,,\nb,a,1,0,0,0,1,1,1,0,0,0,-,0.1\n"
BAD_ROWS = {
    "c,a,-1,0,0,0,1,1,1,0,0,0,-,": (InvalidInertiaError, "line 4 ('c'): mass must be positive, got -1.0"),
    "c,a,1,0,0,0,1,1,3,0,0,0,-,": (
        InvalidInertiaError,
        "line 4 ('c'): principal moments 1.0, 1.0, 3.0 break the triangle",
    ),
    "c,a,1,0,0,0,1,1,1,0,0,0,-,-0.1": (ValueError, "line 4 ('c'): sigma_mass must not be negative, got -0.1"),
    "c,a,1,x,0,0,1,1,1,0,0,0,-,": (ValueError, "line 4: Cx is not a number: 'x'"),
    "c,a,1,nan,0,0,1,1,1,0,0,0,-,": (ValueError, "line 4: Cx is not a number: 'nan'"),
    "c,a,1,inf,0,0,1,1,1,0,0,0,-,": (ValueError, "line 4: Cx must be finite, got inf"),
    "c,a,1,,0,0,1,1,1,0,0,0,-,": (ValueError, "line 4 ('c'): has no children, and no Cx"),
    "c,a,1,0,0,0,,1,1,0,0,0,-,": (ValueError, "no Ixx; state it; Ipoint TRUE takes the part as a point"),
    "c,a,1,0,0,0,1,1,1,0.1,0,0,,": (ValueError, "line 4 ('c'): nothing says which sign Ixy = 0.1 has"),
    "c,a,1,0,0,0,1,1,1,0.1,0,0,?,": (ValueError, "line 4 ('c'): POIconv is '?'; write + or -"),
    "c,z,1,0,0,0,1,1,1,0,0,0,-,": (ValueError, "line 4 ('c'): an orphan: its parent 'z' has no row"),
    "c,,1,0,0,0,1,1,1,0,0,0,-,": (ValueError, "line 4 ('c'): a second root: 'a' and 'c' have no parent"),
    "b,a,1,0,0,0,1,1,1,0,0,0,-,": (ValueError, "line 4 ('b'): id 'b' is there twice, first at"),
    ",a,1,0,0,0,1,1,1,0,0,0,-,": (ValueError, "line 4 (''): id is empty"),
    "c,b,1,0,0,0,1,1,1,0,0,0,-,": (ValueError, "line 3 ('b'): has children, and mass = 1 of its own"),
    "c,a,,,,,,,,,,,,": (ValueError, "line 4 ('c'): has no children, and no mass"),
    "c,a,1,0,0": (ValueError, "line 4: 5 cells, but 14 columns"),
    "c,d,,,,,,,,,,,,\nd,e,,,,,,,,,,,,\ne,c,,,,,,,,,,,,": (
        ValueError,
        "line 4 ('c'): a cycle: 'c' in 'd' in 'e' in 'c'",
    ),
    "c,c,,,,,,,,,,,,": (ValueError, "line 4 ('c'): a cycle: 'c' in 'c'"),
}
BAD_TABLES: dict[str, tuple[dict[str, Any], str]] = {
    "unknown column": (
        {"sigma_mas": [0.1]},
        "table: nobody knows the column 'sigma_mas'; meant 'sigma_mass'",
    ),
    "far from any": ({"vendor": ["x"]}, "words for the reader may stand in 'name' and 'comment'"),
    "lengths": ({"name": ["x", "y"]}, "has 1 rows, but 'name' has 2"),
    "axes": ({"name": np.zeros((1, 2))}, "column 'name' has shape (1, 2)"),
    "truth": ({"Ipoint": ["maybe"]}, "row 0: Ipoint is 'maybe'; write TRUE or FALSE"),
    "about": ({"about": ["C"]}, "row 0 ('p'): about is 'C'; write center_of_mass or origin"),
    "growth": ({"growth": [15.0]}, "row 0 ('p'): growth must be a fraction of the basic mass from 0 to 1"),
    "growth below": ({"growth": [-0.1]}, "got -0.1"),
    "density": ({"density": [2.0]}, "row 0 ('p'): density and arguments are of a file or a solid"),
    "solid and tensor": ({"solid": ["cube"], "arguments": ["side=1"]}, "a tensor is stated beside the solid"),
}
SHAPES: dict[str, tuple[dict[str, Any], str]] = {
    "no such": (
        {"solid": "blob", "mass": 1},
        "row 0 ('p'): solid: there is no 'blob'; there are annulus, arc",
    ),
    "missing": (
        {"solid": "cube", "mass": 1},
        "arguments: cube: missing a required argument: 'side'; it takes side",
    ),
    "other": ({"solid": "cube", "arguments": "edge=1", "mass": 1}, "it takes side"),
    "word": ({"solid": "cube", "arguments": "side=long", "mass": 1}, "row 0 ('p'): "),
    "form": ({"solid": "cube", "arguments": "side", "mass": 1}, "arguments: 'side' is not name=value"),
    "twice": ({"solid": "cube", "arguments": "side=1 side=2", "mass": 1}, "arguments: 'side' is there twice"),
    "neither": ({"solid": "cube", "arguments": "side=1"}, "its mass or its density: one of each"),
    "both": ({"solid": "cube", "arguments": "side=1", "mass": 1, "density": 1}, "one of each"),
    "two": ({"solid": "cube", "file": "x.stl", "mass": 1}, "give a file or a solid"),
    "sigma of mass": (
        {"solid": "cube", "arguments": "side=1", "density": 1, "sigma_mass": 1},
        "state sigma_density",
    ),
    "sigma of density": (
        {"solid": "cube", "arguments": "side=1", "mass": 1, "sigma_density": 1},
        "state sigma_mass",
    ),
    "absent": ({"file": "nowhere.stl", "mass": 1}, "row 0 ('p'): [Errno 2]"),
    "negative": ({"solid": "cube", "arguments": "side=-1", "mass": 1}, "row 0 ('p'): side"),
}


class TestBadTables:
    @pytest.mark.parametrize("row", BAD_ROWS)
    def test_rows(self, row: str, tmp_path: Path) -> None:
        kind, words = BAD_ROWS[row]
        (tmp_path / "parts.csv").write_text(f"{HEAD}\n{GOOD}{row}\n", "utf-8")
        with pytest.raises(kind) as told:
            ledger(tmp_path / "parts.csv")
        assert f"{tmp_path / 'parts.csv'}: line " in str(told.value)
        assert words in str(told.value)

    @pytest.mark.parametrize("name", BAD_TABLES)
    def test_columns(self, name: str) -> None:
        columns, words = BAD_TABLES[name]
        good: dict[str, Any] = {"id": ["p"], "parent": [""], "POIconv": "-"}
        good |= {number: [1.0 if k < 7 else 0.0] for k, number in enumerate(NUMBERS)}
        ledger(good)
        with pytest.raises(ValueError, match=r"^(table|row 0)") as told:
            ledger(good | columns)
        assert words in str(told.value)

    @pytest.mark.parametrize("name", SHAPES)
    def test_shapes(self, name: str) -> None:
        row, words = SHAPES[name]
        with pytest.raises(ValueError, match="p") as told:
            ledger([{"id": "p", "parent": ""} | row])
        assert words in str(told.value)

    def test_the_first_of_many_bad_bodies_is_named(self) -> None:
        table, below = random_tree(20_000, 1)
        for row in below["n0"][7000::1000]:
            table["Izz"][row] = 1e4
        with pytest.raises(
            InvalidInertiaError, match=rf"^row {below['n0'][7000]} \('n{below['n0'][7000]}'\): principal"
        ):
            ledger(table)

    def test_texts_that_are_no_table(self, tmp_path: Path) -> None:
        file = tmp_path / "parts.csv"
        for text, words in (
            ("", "the file is empty"),
            ("id,parent\n", "there are no rows"),
            ("id,id\na,b\n", "line 1: column 'id' is there twice"),
            ("name\na\n", "there is no column 'id'"),
            ("id\na\n", "there is no column 'parent'"),
            ('id,parent\n"a,b\n', "line 2: not a table"),
        ):
            file.write_text(text, "utf-8")
            with pytest.raises(ValueError, match=words):
                ledger(file)
        file.write_bytes(b"id,parent\n\xff,\n")
        with pytest.raises(ValueError, match="not a text file, so not a table: byte 10 is not UTF-8"):
            ledger(file)
        with pytest.raises(TypeError, match="table: expected a path, columns by name or rows, got int"):
            ledger(3)
        with pytest.raises(TypeError, match="row 0: expected a mapping of columns to cells, got str"):
            ledger(["a"])

    def test_trees(self) -> None:
        point = {"mass": 1, "Cx": 0, "Cy": 0, "Cz": 0, "Ipoint": True}
        rows = [{"id": "a"}, {"id": "b"} | point, {"id": "c"} | point]
        good = [{"child": "b", "parent": "a"}, {"child": "c", "parent": "a"}]
        assert ledger(rows, good)["a"].mass == 2.0
        for edges, words in (
            ([*good, {"child": "d", "parent": "a"}], "row 2: the table has no row of 'd'"),
            ([*good, {"child": "c", "parent": "b"}], "row 2: 'c' has two parents, 'a' and 'b'"),
            ([{"child": "c", "above": "b"}], "tree: nobody knows the column 'above'"),
            ([{"parent": "b"}], "tree: a tree has the columns 'child' and 'parent'"),
        ):
            with pytest.raises(ValueError, match=words):
                ledger(rows, edges)
        with pytest.raises(ValueError, match=r"row 2 \('c'\): its parent is 'b' here, but 'a' in the tree"):
            ledger([*rows[:2], rows[2] | {"parent": "b"}], good)

    def test_columns_that_are_left_out(self) -> None:
        row = {"id": "p", "parent": "", "mass": 1, "Cx": 0, "Cy": 0, "Cz": 0, "Ipoint": True, "vendor": "x"}
        with pytest.raises(ValueError, match="pass ignore= with its name"):
            ledger([row])
        assert ledger([row], ignore=("vendor",))["p"].mass == 1.0

    def test_a_tensor_of_few_digits(self) -> None:
        row = {
            "id": "p",
            "mass": 1,
            "Cx": 0,
            "Cy": 0,
            "Cz": 0,
            "Ixx": 1,
            "Iyy": 1,
            "Izz": 2.001,
            "Ixy": 0,
            "Ixz": 0,
            "Iyz": 0,
        }
        with pytest.raises(InvalidInertiaError, match="pass rtol="):
            ledger([row | {"parent": ""}])
        assert ledger([row | {"parent": ""}], rtol=1e-3).bodies.mass == 1.0


class TestTables:
    def test_separators_quotes_blank_lines_and_marks(self, tmp_path: Path) -> None:
        file = tmp_path / "parts.csv"
        text = 'id,parent,name,mass,Cx,Cy,Cz,Ipoint,growth\n\n"a, b",,"two\nlines",NA,NA,,,,\nc,"a, b",x, 2
        ,1,0,0,yes,15%\n' for mark in ("", "\ufeff"):
            file.write_text(mark + text, "utf-8")
            made = ledger(file)
            assert made.ids == ("a, b", "c")
            assert made["c"].predicted_mass == pytest.approx(2.3)
        file.write_text(text.replace(" 2 ", "two"), "utf-8")
        with pytest.raises(ValueError, match="line 5: mass is not a number: 'two'"):
            ledger(file)
        file.write_text("id;parent;mass;Cx;Cy;Cz;Ipoint\na;;2;1;0;0;T\n", "utf-8")
        assert ledger(file)["a"].mass == 2.0

    def test_columns_rows_and_frames_alike(self) -> None:
        table, _ = random_tree(30, 4)
        rows = [{name: column[k] for name, column in table.items()} for k in range(30)]

        class Frame:
            def keys(self) -> list[str]:
                return list(table)

            def __getitem__(self, name: str) -> Any:
                return np.array(table[name], dtype=object if name == "parent" else None)

        one = ledger(table)
        for other in (ledger(rows), ledger(Frame()), ledger(iter(rows))):
            assert other.ids == one.ids
            assert np.array_equal(values(other), values(one))
            assert np.array_equal(covariances(other), covariances(one))

    def test_ids_that_are_numbers(self) -> None:
        rows = {"id": [1, 2, 3], "parent": [np.nan, 1.0, 1.0], "mass": [np.nan, 2.0, 3.0], "Ipoint": True}
        assert ledger(rows | {"Cx": 0.0, "Cy": 0.0, "Cz": 0.0}, overwrite=True)["1"].mass == 5.0

    def test_nothing_of_the_caller_s_is_changed(self) -> None:
        table, _ = random_tree(30, 4)
        table["POIconv"] = ["+"] * 30
        table |= {name: -table[name] for name in ("Ixy", "Ixz", "Iyz")}
        table["Ipoint"] = np.arange(30) % 2 == 0
        before = {name: np.array(column) for name, column in table.items()}
        made = ledger(table)
        assert all(
            np.array_equal(table[name], before[name], equal_nan=name not in ("id", "parent", "POIconv"))
            for name in table
        )
        for array in (made.mass, made.center_of_mass, made.inertia, made.covariance, made.depth):
            assert array is not None
            with pytest.raises(ValueError, match="read-only"):
                array[0] = 1.0
        with pytest.raises(AttributeError):
            made.mass = made.mass  # type: ignore[misc]


class TestOutputs:
    def test_a_table_that_is_read_back(self, tmp_path: Path) -> None:
        table, _ = random_tree(30, 4)
        table["name"] = [f"part, {k}" for k in range(30)]
        table["growth"] = np.where(np.isnan(table["mass"]), np.nan, 0.125)
        made = ledger(table)
        made.to_csv(tmp_path / "out.csv")
        again = ledger(tmp_path / "out.csv", overwrite=True)
        assert again.ids == made.ids
        assert again.parents == made.parents
        assert np.array_equal(values(again), values(made))
        assert np.array_equal(covariances(again), covariances(made))
        assert np.allclose(again.predicted_mass, made.predicted_mass, rtol=1e-15)
        again.to_csv(tmp_path / "again.csv")
        assert (tmp_path / "again.csv").read_text("utf-8") == (tmp_path / "out.csv").read_text("utf-8")

    def test_json(self, tmp_path: Path) -> None:
        table, _ = random_tree(12, 4)
        made = ledger(table)
        made.to_json(tmp_path / "out.json")
        told = json.loads((tmp_path / "out.json").read_text("utf-8"))
        assert told["format"] == "polhode.Ledger/1"
        assert told["id"] == list(made.ids)
        assert told["covariance_of"] == list(NUMBERS)
        assert np.array_equal(told["covariance"], covariances(made))
        assert np.array_equal(told["sigma"]["inertia"], made.sigma.inertia if made.sigma else None)
        made.to_json(tmp_path / "short.json", covariance=False)
        assert "covariance" not in json.loads((tmp_path / "short.json").read_text("utf-8"))
        table = {name: column for name, column in table.items() if not name.startswith("sigma")}
        ledger(table).to_json(tmp_path / "exact.json")
        assert json.loads((tmp_path / "exact.json").read_text("utf-8"))["covariance"] is None

    def test_what_is_printed(self) -> None:
        table, _ = random_tree(40, 4)
        made = ledger(table)
        leaves = int(made.is_part.sum())
        assert repr(made).startswith(f"<Ledger of 'n0': {leaves} parts, {made.depth.max() + 1} levels, mass ")
        assert str(made).count("\n") == 21
        assert str(made).endswith("  and 20 more")
        assert repr(made["n0"]).startswith("<Assembly 'n0': mass ")
        assert repr(made["n39"]).startswith("<Part 'n39': mass ")
        assert " ± " in repr(made["n39"])
        assert "without sigmas" in repr(
            ledger(
                table | {name: table[name] * np.where(np.arange(40) == 39, np.nan, 1.0) for name in SIGMAS}
            )
        )

    def test_nodes(self) -> None:
        table, _ = random_tree(40, 4)
        made = ledger(table)
        for node in made:
            assert all(child.parent is not None and child.parent.id == node.id for child in node.children)
            assert node.mass == pytest.approx(
                sum(child.mass for child in node.children) or node.mass, rel=1e-14
            )
            assert made[node.id].row == node.row
            assert node.id in made
        assert made["n0"].parent is None
        assert [node.id for node in made.walk()][0] == "n0"
        assert sorted(node.id for node in made.walk()) == sorted(made.ids)
        assert {node.depth for node in made.walk(1)} == {0, 1}
        assert "nobody" not in made
        again = pickle.loads(pickle.dumps(made))
        assert np.array_equal(covariances(again), covariances(made))

    @pytest.mark.parametrize(
        ("value", "sigma", "text"),
        [
            (57.834, 1.2416, "57.8 ± 1.2"),
            (57.834, 0.12, "57.83 ± 0.12"),
            (57.834, 0.0996, "57.83 ± 0.10"),
            (57.834, 0.0994, "57.834 ± 0.099"),
            (42673.7, 2789.3, "42700 ± 2800"),
            (0.0004, 12.5, "0 ± 12"),
            (-0.182859, 0.19998, "-0.18 ± 0.20"),
            (-3.2e-9, 4.56e-11, "(-3.200 ± 0.046)e-09"),
            (3.2e12, 4.56e10, "(3.200 ± 0.046)e+12"),
            (57.834, 0.0, "57.834"),
            (-0.0, None, "0"),
            (1.0, float("nan"), "1"),
            (1e301, 1e299, "1e+301 ± 1.0e+299"),
        ],
    )
    def test_two_digits_of_sigma(self, value: float, sigma: float | None, text: str) -> None:
        assert with_sigma(value, sigma) == text


class TestPictures:
    def test_a_sunburst_of_masses(self) -> None:
        table, _ = random_tree(40, 4)
        made = ledger(table)
        ax = made.plot(Figure().subplots(), of="mass")
        rings: dict[float, float] = {}
        for wedge in ax.patches:
            rings[wedge.r] = rings.get(wedge.r, 0.0) + wedge.theta2 - wedge.theta1
        assert rings[2.0] == pytest.approx(360.0)
        assert len(rings) == 3
        assert all(turn <= 360.0 + 1e-9 for turn in rings.values())
        first = {child.id: child.mass / made["n0"].mass for child in made["n0"].children}
        widths = sorted((wedge.theta2 - wedge.theta1) / 360.0 for wedge in ax.patches if wedge.r == 2.0)
        assert widths == pytest.approx(sorted(first.values()))

    def test_bars_of_variance(self) -> None:
        table, _ = random_tree(40, 4)
        made = ledger(table)
        shares = made.variance_shares("Iyy")
        ax = made.plot(Figure().subplots(), of="variance", number="Iyy")
        names = [label.get_text() for label in ax.get_yticklabels()]
        assert names == [*shares.names[:12], f"{len(shares) - 12} others"]
        widths = np.zeros(len(names))
        for bar in ax.patches:
            widths[round(bar.get_y() + bar.get_height() / 2)] += bar.get_width()
        assert widths.sum() == pytest.approx(100.0)
        assert widths[:12] == pytest.approx(100.0 * shares.fraction[:12])
        with pytest.raises(ValueError, match='of: expected "mass" or "variance"'):
            made.plot(of="weight")

    def test_many_small_parts_are_drawn_together(self) -> None:
        point = {"parent": "all", "mass": 1.0, "Cx": 0.0, "Cy": 0.0, "Cz": 0.0, "Ipoint": True}
        rows = [
            {"id": "all"},
            {"id": "big"} | point | {"mass": 1000.0},
            *({"id": f"p{k}"} | point for k in range(500)),
        ]
        ax = ledger(rows).plot(Figure().subplots())
        assert len(ax.patches) == 2
        assert [text.get_text() for text in ax.texts][:2] == ["big\n66.7 %", "others\n33.3 %"]


CRAFT = """id,parent,mass,Cx,Cy,Cz,Ixx,Iyy,Izz,Ixy,Ixz,Iyz,POIconv,sigma_mass,sigma_Cx,growth
craft,,,,,,,,,,,,,,,
bus,craft,22,0,0,0.1,3.1,3,2.2,0,0.02,0,-,0.1,0.002,5%
"wheel, x",craft,1.6,0.3,0,0,0.006,0.0032,0.0032,0,0,0,-,0.01,0.001,
"""


class TestCommand:
    @pytest.fixture
    def craft(self, tmp_path: Path) -> Path:
        (tmp_path / "craft.csv").write_text(CRAFT, "utf-8")
        return tmp_path / "craft.csv"

    def test_table(self, craft: Path) -> None:
        code, out, err = run("ledger", craft, "--of", "Cx")
        assert (code, err) == (0, "")
        for words in (
            "craft       23.60 ± 0.10",
            "4.66 %",
            "24.7",
            "    wheel, x",
            "variance of Cx of craft",
            "mostly by its",
        ):
            assert words in out
        assert "bus" not in run("ledger", craft, "--depth", "0")[1].partition("who contributes")[0]
        assert "  wheel, x" in run("ledger", craft, "--at", "wheel, x")[1]

    def test_json(self, craft: Path) -> None:
        code, out, _ = run("ledger", craft, "--format", "json")
        told = json.loads(out)
        made = ledger(craft)
        assert code == 0
        assert [node["id"] for node in told["nodes"]] == ["craft", "bus", "wheel, x"]
        assert told["nodes"][0]["mass"] == {
            "value": made.mass[0],
            "sigma": made.sigma.mass[0] if made.sigma else None,
        }
        assert np.array_equal(told["nodes"][0]["covariance"], covariances(made)[0])
        assert told["variance_shares"][0]["name"] == "bus"

    def test_files(self, craft: Path) -> None:
        folder = craft.parent
        assert run("ledger", craft, "--output", folder / "all.csv")[0] == 0
        assert np.array_equal(ledger(folder / "all.csv", overwrite=True).mass, ledger(craft).mass)
        assert run("ledger", craft, "--output", folder / "all.json", "--picture", folder / "all.png")[0] == 0
        assert json.loads((folder / "all.json").read_text("utf-8"))["parts"] == 2
        assert (folder / "all.png").read_bytes().startswith(b"\x89PNG")
        code, _, err = run("ledger", craft, "--output", craft)
        assert code == 2
        assert "write to another one" in err
        assert craft.read_text("utf-8") == CRAFT

    def test_standard_input(self, craft: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(CRAFT.encode())))
        assert run("ledger", "-")[1].replace("standard input", str(craft)) == run("ledger", craft)[1]

    def test_exact_tables_say_so(self, craft: Path) -> None:
        craft.write_text(CRAFT.replace(",0.1,0.002,", ",,,").replace(",0.01,0.001,", ",,,"), "utf-8")
        code, out, _ = run("ledger", craft, "--picture", craft.parent / "all.svg")
        assert code == 0
        assert "no part states a standard deviation" in out
        craft.write_text(CRAFT.replace(",0.1,0.002,", ",,,"), "utf-8")
        assert "1 of the parts state no standard deviation" in run("ledger", craft)[1]
        assert "Ixy of craft is exact" in run("ledger", craft, "--of", "Ixy")[1]

    @pytest.mark.parametrize(
        ("words", "told"),
        [
            (("--of", "weight"), "--of: 'weight' is none of mass"),
            (("--at", "x"), "--at: no part has the id 'x'"),
            (("--depth", "-1"), "--depth: a number of levels cannot be negative"),
            (("--tree", "none.csv"), "none.csv"),
            (("--output", "no/where.csv"), "create it first"),
        ],
    )
    def test_bad_words(self, craft: Path, words: tuple[str, ...], told: str) -> None:
        code, out, err = run("ledger", craft, *words)
        assert (code, out) == (2, "")
        assert one_line(err)
        assert told in err

    def test_ways_out_are_options(self, craft: Path) -> None:
        craft.write_text(CRAFT.replace("craft,,,", "craft,,5,"), "utf-8")
        err = run("ledger", craft)[2]
        assert "line 2 ('craft'): has children, and mass = 5 of its own" in err
        assert "pass --overwrite" in err
        assert run("ledger", craft, "--overwrite")[0] == 0
        craft.write_text(CRAFT.replace("growth", "cost"), "utf-8")
        assert "pass --ignore with its name" in run("ledger", craft)[2]
        assert run("ledger", craft, "--ignore", "cost")[0] == 0
