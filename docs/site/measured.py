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
        "Four problems are solved with polhode and with other programs. The tables compare the lines of "
        "code, the time and the error of the result. *First* is the time of the first call in a new "
        "interpreter, "
        "with all imports except NumPy. *Again* is the time of a second call. The other programs can do much "
        "that polhode cannot; polhode is made for problems like these four.\n",
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
        "Each program computes angular velocity and attitude of a free body at 601 times of one minute. The "
        "error is the error of the angular velocity, compared with Jacobi's functions in 45 digits. SymPy "
        "gives the attitude in Euler angles, the others give quaternions. The integrators have "
        "a tolerance of 1e-12; heyoka has its default tolerance, and MuJoCo has steps of a millisecond.",
    ),
    (
        "tensor",
        "The tensor of a mesh",
        "The mesh is a torus of 20 000 triangles. The result is compared with rational arithmetic. polhode "
        "checks that the mesh is closed and that all its faces have the same orientation, and refuses it "
        "otherwise. trimesh checks this on request. The sum in NumPy does not check it.",
    ),
    (
        "axes",
        "Principal moments and axes of many bodies",
        "Each program computes right-handed axes and ascending moments of a thousand tensors. The error is "
        "the error of the moments, compared with mpmath in forty digits, relative to the largest moment.",
    ),
    (
        "particles",
        "The tensor of particles far from the origin",
        "A thousand particles are a hundred times as far from the origin as from each other. The result is "
        "compared with rational arithmetic. The sum in NumPy is taken about the centre of mass; about the "
        "origin it would lose digits.",
    ),
)


def validation(found: dict[str, Any]) -> str:
    """Give the page of what numbers are held against."""
    lines = [
        "# How it is checked\n",
        "Each formula is compared with something that is not polhode: a closed form, rational numbers, "
        "many digits, published figures or "
        "another engine. The tests repeat this after each change of the code. The table shows some of the "
        "errors, relative to the largest number of the result. "
        "The spacing of floating-point numbers is 2.2e-16.\n",
        where(found) + "\n",
        "| what | compared with | error |",
        "|---|---|---|",
        *(f"| {row['what']} | {row['against']} | {power(row['error'])} |" for row in found["validation"]),
        "\nThe code of the reference solutions is in `tests/oracles`. For each promise on these pages, "
        "`tests/claims.toml` names the test that checks it.\n",
    ]
    return "\n".join(lines)


def performance(ratios: dict[str, Any]) -> str:
    """Give the page of times beside the peers."""
    lines = [
        "# How fast it is\n",
        "The ratio is the time of the other program for the same answer, divided by the time of polhode. "
        "Above 1, polhode is faster. In some rows polhode is compared with itself: the same work in another "
        "way, or for another body. The two ran alternately in one process, on one thread, in several rounds. "
        "The "
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
            "| what | compared with | ratio |" + " spread |" * has_spread,
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
