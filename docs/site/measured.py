"""Pages of measured numbers: tables of ``benchmarks/pages.json`` and ``benchmarks/ratios.json``."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from written import keep

if TYPE_CHECKING:
    from sphinx.application import Sphinx

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"


def setup(app: Sphinx) -> dict[str, bool]:
    """Write the pages before Sphinx looks for them."""
    app.connect("builder-inited", lambda app: keep(Path(app.srcdir) / "measured", pages()))
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def pages() -> dict[str, str]:
    """Give the names and the texts of the pages."""
    found = json.loads((BENCHMARKS / "pages.json").read_text("utf-8"))
    ratios = json.loads((BENCHMARKS / "ratios.json").read_text("utf-8"))
    return {
        "elsewhere.md": elsewhere(found),
        "validation.md": validation(found),
        "performance.md": performance(ratios),
    }


def where(found: dict[str, Any]) -> str:
    """Say when and on what the numbers were measured."""
    machine = found["machine"]
    return (
        f"Measured on {found['date']} with polhode {machine['polhode']}, Python {machine['python']}, "
        f"{machine['cpu']}, one thread. "
        "`python benchmarks/pages.py` measures anew."
    )


def elsewhere(found: dict[str, Any]) -> str:
    """Give the page of the same problems in other programs."""
    lines = [
        "# The same elsewhere\n",
        "Four problems, in polhode and in other programs: how many lines it takes, how long, and how far "
        "the answer is from the exact "
        "one. *First* is a call in a fresh interpreter with what it imports beside NumPy, *again* "
        "one after it. The "
        "other programs can do much that "
        "polhode does not; these four problems are those that polhode is made for.\n",
        where(found) + "\n",
    ]
    for problem, title, text in PROBLEMS:
        rows = sorted(found["elsewhere"][problem], key=lambda row: row["program"] != "polhode")
        lines += [
            f"## {title}\n",
            text,
            "",
            "| program | lines | first | again | error |",
            "|---|---|---|---|---|",
        ]
        lines += [
            f"| {row['program']} {row['version']} | {row['lines']} | {seconds(row['first'])} | "
            f"{seconds(row['again'])} "
            f"| {power(row['error'])} |"
            for row in rows
        ]
        for row in rows:
            lines += [
                f"\n### {row['program']}: {title[0].lower()}{title[1:]}\n",
                "```{literalinclude} ../../benchmarks/elsewhere.py",
                f":language: python\n:pyobject: {row['function']}\n```",
            ]
        lines.append("")
    return "\n".join(lines)


PROBLEMS = (
    (
        "motion",
        "A body that flips",
        "Angular velocity and attitude of a free body at 601 times of a minute. All find both; the error is "
        "that of the angular velocity, held against Jacobi's functions in 45 digits. SymPy's attitude is in "
        "Euler angles, the others' in quaternions. The integrators have "
        "tolerances of 1e-12, heyoka its own default, MuJoCo steps of a millisecond.",
    ),
    (
        "tensor",
        "The tensor of a mesh",
        "A torus of 20 000 triangles, held against rational numbers. polhode checks that the mesh is "
        "closed and wound one way "
        "and refuses it otherwise; trimesh reports this on request; the sum in NumPy does not check it.",
    ),
    (
        "axes",
        "Principal moments and axes of many bodies",
        "Right-handed axes and ascending moments of a thousand tensors. The error is that of the moments, "
        "held against mpmath in forty digits, relative to the largest of all.",
    ),
    (
        "particles",
        "The tensor of particles far from the origin",
        "A thousand particles, a hundred times as far from the origin as from each other, held against "
        "rational numbers. The sum by NumPy is about the centre of mass, as it has to be here.",
    ),
)


def validation(found: dict[str, Any]) -> str:
    """Give the page of what numbers are held against."""
    lines = [
        "# How it is checked\n",
        "Each formula is compared with something that is not polhode: a closed form, rational numbers, "
        "many digits, published figures or "
        "another engine. The tests do that at each change; here are some of the errors, relative to the "
        "largest number of the answer. "
        "The spacing of floating-point numbers is 2.2e-16.\n",
        where(found) + "\n",
        "| what | against | error |",
        "|---|---|---|",
        *(f"| {row['what']} | {row['against']} | {power(row['error'])} |" for row in found["validation"]),
        "\nThe oracles are in `tests/oracles`; `tests/claims.toml` names for each promise of these pages "
        "the test that keeps it.\n",
    ]
    return "\n".join(lines)


def performance(ratios: dict[str, Any]) -> str:
    """Give the page of times beside the peers."""
    lines = [
        "# How fast it is\n",
        "The ratio is the time of the other program for the same answer, divided by the time of polhode. "
        "Above 1, polhode is faster. In some rows polhode is compared with itself: the same work in another "
        "way, or for another body. Both ran in turn in one process, on one thread, in several rounds. The "
        "ratio is the median of the rounds. If the least and the largest ratio of a release were "
        "kept, the table shows them as the spread. "
        "`make bench` measures anew; `python benchmarks/run.py --keep RELEASE` keeps what "
        "this table shows, and `make docs` writes the page.\n",
    ]
    for release, found in ratios.items():
        machine = found["machine"]
        lines += [
            f"## Release {release}\n",
            f"Measured on {found['date']}: {machine['cpu']}, {machine['cores']} cores, "
            f"Python {machine['python']}.\n",
        ]
        has_spread = any(isinstance(kept, list) for kept in found["ratios"].values())
        lines += [
            "| what | beside | ratio |" + " spread |" * has_spread,
            "|---|---|---|" + "---|" * has_spread,
        ]
        for name, kept in found["ratios"].items():
            what, _, peer = name.partition(", beside ")
            ratio, *spread = kept if isinstance(kept, list) else [kept]
            row = f"| {what} | {peer} | {ratio:g} |".replace("Π(n; φ|m)", "Π(n; φ, m)")
            if has_spread:
                row += f" {spread[0]:g} to {spread[1]:g} |" if spread else " not kept |"
            lines.append(row)
    return "\n".join([*lines, ""])


def seconds(value: float) -> str:
    """Give a time with two digits and its unit."""
    for scale, unit in ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs")):
        if value >= scale:
            return f"{value / scale:.2g} {unit}" if value < 99.5 * scale else f"{value / scale:.0f} {unit}"
    return f"{value / 1e-9:.2g} ns"


def power(value: float) -> str:
    """Give a relative error; what is below half the spacing of numbers is rounding."""
    return "0" if value == 0.0 else f"{value:.0e}" if value >= 1e-16 else "below 1e-16"
