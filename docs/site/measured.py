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
    """Return the names and the texts of the pages."""
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
    """Return the page of the same problems in other programs."""
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
        "Each program computes angular velocity and attitude of a free body at 601 "
        "instants, evenly spaced over one minute. The "
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
    """Return the page of what numbers are held against."""
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
        "\nThe code of the reference solutions is in `tests/oracles`. For the numbers that users rely on, "
        "`tests/pages/claims.toml` names the tests.\n",
    ]
    return "\n".join(lines)


def performance(ratios: dict[str, Any]) -> str:
    """Return the page of times beside the peers."""
    runs = [(release, found) for release, one in ratios.items() for found in one.values()]
    has_spread = any(isinstance(kept, list) for _, found in runs for kept in found["ratios"].values())
    lines = [
        "# How fast it is\n",
        "Each row compares the times of two calculations. polhode does the first one, in the column *polhode "
        "does*. The second one, in the column *compared with*, is another way to the same result, or a part "
        "of the work that cannot be avoided, or a similar calculation of polhode itself.\n",
        "The ratio is the time of the second calculation divided by the time of the first. Above 1, the "
        "first is faster. If the second one was done for fewer bodies, the times for one body are compared. "
        "Both ran on one thread, unless the row says otherwise. They took turns in several rounds, and each "
        "round gave a ratio. The table shows the median of these ratios." + SPREAD * has_spread + "\n",
        "`make bench` measures anew. `python benchmarks/run.py --keep RELEASE` keeps the ratios, and "
        "`make docs` writes them into this page.\n",
    ]
    for release, found in runs:
        machine = found["machine"]
        lines += [
            f"## Release {release}, {machine['cpu']}\n",
            f"Measured on {found['date']}: {machine['cpu']} with {machine['level']}, "
            f"{machine['cores']} cores, Python {machine['python']}.\n",
        ]
        left = dict(found["ratios"])
        for section, words in ROWS.items():
            rows = {name: left.pop(name) for name in words if name in left}
            lines += table(section, rows, words)
        lines += table("Other rows", left, {})
    return "\n".join([*lines, ""])


SPREAD = " If the least and the largest of these ratios were kept, the column *least to largest* shows them."


def table(section: str, rows: dict[str, Any], words: dict[str, tuple[str, str]]) -> list[str]:
    """Return the table of some rows under a heading; nothing without rows."""
    if not rows:
        return []
    has_spread = any(isinstance(kept, list) for kept in rows.values())
    lines = [
        f"### {section}\n",
        "| polhode does | compared with | ratio |" + " least to largest |" * has_spread,
        "|---|---|---|" + "---|" * has_spread,
    ]
    for name, kept in rows.items():
        first, _, second = name.rpartition(", beside ")
        what, peer = words.get(name, (first, second))
        ratio, *spread = kept if isinstance(kept, list) else [kept]
        row = f"| {what} | {peer} | {ratio:g} |"
        if has_spread:
            row += f" {spread[0]:g} to {spread[1]:g} |" if spread else " not kept |"
        lines.append(row)
    return [*lines, ""]


_SCIPY = "SciPy: integration by DOP853 at 1e-12"
_STACKED = "NumPy: matrix products and `linalg.eigh`"
_WATERTIGHT = "trimesh: mass properties, and the test that the mesh is closed"
_ONE_THREAD = "the same on one thread"
ROWS: dict[str, dict[str, tuple[str, str]]] = {
    "Start": {
        "import in a fresh interpreter, beside import numpy": (
            "`from polhode import RigidBody` in a new interpreter",
            "`import numpy` in a new interpreter",
        ),
        "polhode --help, beside import cyclopts, rich": (
            "the command `polhode --help`",
            "only the imports of cyclopts and rich, which it needs",
        ),
        "polhode report, 10 000 triangles, beside the bare imports": (
            "the command `polhode report`, for an STL file of 10 000 triangles",
            "only the imports that it needs",
        ),
    },
    "Principal moments and axes": {
        "moments and axes, 1e6 tensors, beside numpy.linalg.eigh": (
            "moments and axes of a million tensors",
            "NumPy: `linalg.eigh`",
        ),
        "moments alone, 1e6 tensors, beside numpy.linalg.eigvalsh": (
            "moments of a million tensors, without axes",
            "NumPy: `linalg.eigvalsh`",
        ),
        "moments and axes, one tensor, beside numpy.linalg.eigh": (
            "moments and axes of one tensor",
            "NumPy: `linalg.eigh`",
        ),
    },
    "Bodies of particles and voxels": {
        "inertia of 1e7 particles, beside numpy: a plain sum": (
            "mass, centre and tensor of ten million particles",
            "NumPy: only `masses.sum()` and `positions.sum()` of the same arrays",
        ),
        "inertia of 1e7 particles, beside numpy: matrix products": (
            "mass, centre and tensor of ten million particles",
            "NumPy: the same by matrix products",
        ),
        "a thin body of 1e7 particles, beside polhode: an ordinary one": (
            "ten million particles of a body that is a thousand times as long as thick",
            "polhode: ten million particles of a body that is about as long as thick",
        ),
        "1e7 particles through a stream, beside polhode: at once": (
            "ten million particles in chunks, by `MassAccumulator`",
            "polhode: all particles in one call",
        ),
        "1e6 particles with 1e3 labels, beside numpy: sorted, body by body": (
            "a thousand bodies from a million particles with labels",
            "NumPy: the particles sorted by label, then one body after the other",
        ),
        "1e4 bodies x 20 particles, moments and axes, beside numpy: products, eigh": (
            "moments and axes of ten thousand bodies of 20 particles",
            _STACKED,
        ),
        "1e4 frames of 20 particles, moments and axes, beside numpy: products, eigh": (
            "moments and axes of 20 particles in ten thousand positions",
            _STACKED,
        ),
        "256^3 voxels, float32, beside numpy: separable sums": (
            "a body of 256 × 256 × 256 voxels, densities in 32 bits",
            "NumPy: sums over planes of voxels",
        ),
        "128 x 256^2 voxels, float64, beside numpy: separable sums": (
            "a body of 128 × 256 × 256 voxels, densities in 64 bits",
            "NumPy: sums over planes of voxels",
        ),
    },
    "Meshes": {
        "checked solid, 1e5 triangles, beside trimesh": (
            "a solid from a mesh of a hundred thousand triangles, with all checks",
            _WATERTIGHT,
        ),
        "checked solid, 2e6 triangles, beside trimesh": (
            "a solid from a mesh of two million triangles, with all checks",
            _WATERTIGHT,
        ),
        "binary STL of 5e6 triangles, checked, beside trimesh": (
            "a solid from a binary STL file of five million triangles, with all checks",
            _WATERTIGHT,
        ),
    },
    "Motion in closed form": {
        "many times of one body, 1e+05 states, beside one Π(n; φ|m) each, SciPy": (
            "a hundred thousand states of one free body",
            "SciPy: Jacobi's functions, and an elliptic integral of the third kind for each state",
        ),
        "1e+05 bodies at 10 rotations, beside SciPy DOP853, 10 rotations": (
            "a hundred thousand free bodies, the state of each after ten rotations",
            f"{_SCIPY}, over the same time",
        ),
        "1e+05 bodies at 1e6 rotations, beside SciPy DOP853, 10 rotations": (
            "a hundred thousand free bodies, the state of each after a million rotations",
            f"{_SCIPY}, over ten rotations only",
        ),
        "heavy top: 1000 states over 10 turns, beside scipy: DOP853 at 1e-12": (
            "a thousand states of a heavy top, over ten turns",
            _SCIPY,
        ),
        "heavy top: 1e4 states, beside one by one, beside polhode: a call for each": (
            "ten thousand states of a heavy top in one call",
            "polhode: one call for each state",
        ),
        "heavy top: 4 tops, one state at 10 turns, beside scipy: DOP853 at 1e-12": (
            "four heavy tops, the state of each after ten turns",
            _SCIPY,
        ),
    },
    "Simulation": {
        "free, asymmetric, a rotation, beside SciPy DOP853 at 1e-12": (
            "a free body with three different moments, by Taylor series",
            _SCIPY,
        ),
        "heavy symmetric top, a rotation, beside SciPy DOP853 at 1e-12": (
            "a heavy symmetric top, by Taylor series",
            _SCIPY,
        ),
        "heavy asymmetric top, a rotation, beside SciPy DOP853 at 1e-12": (
            "a heavy top with three different moments, by Taylor series",
            _SCIPY,
        ),
        "torque of a Python function, DOP853, beside bare loop of the calls": (
            "a motion under the torque of a Python function, by DOP853",
            "Python: only the calls of this function, in a loop",
        ),
        "force and torque of a Python function, DOP853, beside bare loop of the calls": (
            "a motion under force and torque of a Python function, by DOP853",
            "Python: only the calls of this function, in a loop",
        ),
        "torque of a compiled function, DOP853, beside the Python function": (
            "a motion under the torque of a compiled function, by DOP853",
            "polhode: the same torque as a Python function",
        ),
    },
    "Two threads": {
        "a plain sum over 1e7 particles, two threads, beside one thread": (
            "for comparison, NumPy: a sum over ten million particles on two threads",
            _ONE_THREAD,
        ),
        "inertia of 1e7 particles, two threads, beside one thread": (
            "mass, centre and tensor of ten million particles on two threads",
            _ONE_THREAD,
        ),
        "a thin body of 1e7 particles, two threads, beside one thread": (
            "ten million particles of a thin body on two threads",
            _ONE_THREAD,
        ),
        "1e7 particles through a stream, two threads, beside one thread": (
            "ten million particles by `MassAccumulator` on two threads",
            _ONE_THREAD,
        ),
        "1e5 bodies x 20 particles, two threads, beside one thread": (
            "a hundred thousand bodies of 20 particles on two threads",
            _ONE_THREAD,
        ),
        "256^3 voxels, float32, two threads, beside one thread": (
            "a body of 256 × 256 × 256 voxels on two threads",
            _ONE_THREAD,
        ),
        "checked solid, 1e6 triangles, two threads, beside one thread": (
            "a solid from a mesh of a million triangles on two threads",
            _ONE_THREAD,
        ),
    },
}
"""What the rows of ``benchmarks/ratios.json`` say in words, under the headings of the page."""


def seconds(value: float) -> str:
    """Return a time with two digits and its unit."""
    for scale, unit in ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs")):
        if value >= scale:
            return f"{value / scale:.2g} {unit}" if value < 99.5 * scale else f"{value / scale:.0f} {unit}"
    return f"{value / 1e-9:.2g} ns"


def power(value: float) -> str:
    """Return a relative error; what is below half the spacing of numbers is rounding."""
    return "0" if value == 0.0 else f"{value:.0e}" if value >= 1e-16 else "below 1e-16"
