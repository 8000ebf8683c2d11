"""``polhode demo``: a body from a file to its report, motion and picture, and a check against NASA."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from polhode import _core, plot, samples
from polhode._optional import require
from polhode.cli import brick
from polhode.cli.loading import load_body
from polhode.cli.options import BodyOptions
from polhode.cli.report import file_report
from polhode.cli.terminal import write
from polhode.draw.plot.axes import show_around
from polhode.errors import PolhodeError
from polhode.io.formats import read_mesh
from polhode.io.writing import save_picture, write_bytes
from polhode.units import metres_per

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray
    from rich.console import Console

    from polhode import Trajectory

    Floats = NDArray[np.float64]

__all__ = [
    "draw_flip",
    "run",
]

# One turn a second about the stem, and a breath of spin about the other two axes. Steel.
SPIN = (0.01, 2.0 * np.pi, 0.0)
DURATION = 20.0
SAMPLES = 2001
STEEL = "7850 kg/m^3"
GOOD, BAD = 0, 1
OWN = "polhode spin part.stl --length-unit mm --axes principal --omega 0.01 6 0 --end 20 --save part.html"
"""The line to try on a file of one's own."""


def run(directory: Path, console: Console) -> int:
    """Run the demo.

    Parameters
    ----------
    directory : pathlib.Path
        Where the mesh and the picture go; made if absent.
    console : rich.console.Console
        Where the text goes.

    Returns
    -------
    int
        0, or 1 if NASA's brick comes out wrong.
    """
    if directory.exists() and not directory.is_dir():
        raise PolhodeError(f"--save: {directory} is a file; name a folder")
    directory.mkdir(parents=True, exist_ok=True)
    mesh_file, picture = directory / "t-handle.stl", directory / "t-handle.png"

    _heading(console, "1. A body: a steel T-handle, written to a file and read back")
    write_bytes(mesh_file, samples.path("t-handle.stl").read_bytes())
    options = BodyOptions(density=STEEL, length_unit="mm")
    file_report(mesh_file, options).print(console)

    _heading(console, "2. Its motion: spun about the stem, the axis of the intermediate moment")
    loaded = load_body(mesh_file, options)
    axes = loaded.body.principal.axes
    trajectory = loaded.body.simulate(np.linspace(0.0, DURATION, SAMPLES), axes @ np.array(SPIN))
    flips = flip_times(trajectory)
    _print_motion(console, trajectory, flips)
    _draw(console, picture, mesh_file, trajectory, flips)

    _heading(console, "3. The same code against NASA: the tumbling brick of check case 2, rates after 30 s")
    comparisons = [brick.compare(rtol) for rtol in brick.BARS]
    _print_comparisons(console, comparisons)

    _heading(console, "4. Files that ship with polhode, and what else there is")
    for command in (
        "polhode samples .",
        'polhode report bracket.ply --length-unit in --density "2.7 g/cm^3"',
        "polhode check robot.urdf --fix better.urdf",
        "polhode molecule water.xyz",
        "polhode --help",
    ):
        write(console, f"  {command}")
    _heading(console, "5. Now your own file, in place of part.stl: watch it flip")
    write(console, f"  {OWN}")
    return GOOD if all(comparison.is_good for comparison in comparisons) else BAD


def flip_times(trajectory: Trajectory) -> NDArray[np.float64]:
    """Find the times at which the spin about the intermediate axis passes through zero."""
    spin = trajectory.omega @ trajectory.body.principal.axes[:, 1]
    before = np.flatnonzero(spin[:-1] * spin[1:] < 0.0)
    fraction = spin[before] / (spin[before] - spin[before + 1])
    times: NDArray[np.float64] = trajectory.t[before] + fraction * np.diff(trajectory.t)[before]
    return times


def _heading(console: Console, text: str) -> None:
    write(console)
    write(console, text, style="bold green")
    write(console)


def _print_motion(console: Console, trajectory: Trajectory, flips: NDArray[np.float64]) -> None:
    energy = trajectory.kinetic_energy().total
    momentum = trajectory.angular_momentum().total
    drift = np.linalg.norm(momentum - momentum[0], axis=-1).max() / np.linalg.norm(momentum[0])
    rows = (
        ("start", f"{SPIN[1]:.6f} rad/s about e2, {SPIN[0]} rad/s about e1"),
        ("flips", f"at {', '.join(f'{t:.3f}' for t in flips)} s"),
        ("energy", f"{energy[0]:.7g} J, kept to {np.ptp(energy) / energy[0]:.1e}"),
        (
            "angular momentum",
            f"{np.linalg.norm(momentum[0]):.7g} kg m^2/s, its vector in space kept to {drift:.1e}",
        ),
    )
    for label, text in rows:
        write(console, f"  {label:<20}{text}")


def _draw(
    console: Console, picture: Path, mesh_file: Path, trajectory: Trajectory, flips: NDArray[np.float64]
) -> None:
    try:
        mesh = read_mesh(mesh_file)
        draw_flip(picture, mesh.vertices * metres_per("mm"), mesh.faces, trajectory, flips)
    except ModuleNotFoundError as error:
        if error.name != "matplotlib":
            raise
        write(console, f"  no picture: {error}")  # the numbers stand without it
    else:
        write(console, f"  {'picture':<20}{picture}")


def _print_comparisons(console: Console, comparisons: list[brick.Comparison]) -> None:
    write(console, " " * 22 + "".join(name.rjust(21) for name in ("roll", "pitch", "yaw")))
    rows: list[tuple[str, tuple[float, ...], str]] = [
        ("NASA, simulator 01", brick.NASA_RATES, ".14f"),
        ("exact, 25 digits", brick.EXACT_RATES, ".14f"),
    ]
    for comparison in comparisons:
        rows += [
            (f"polhode, rtol {comparison.rtol:g}", comparison.rates, ".14f"),
            ("  minus exact", comparison.from_exact, ".1e"),
            ("  minus NASA", comparison.from_nasa, ".1e"),
        ]
    for label, values, style in rows:
        cells = "".join(format(value, style).rjust(21) for value in values)
        write(console, f"  {label:<20}{cells}  deg/s")
    verdict = "good" if all(comparison.is_good for comparison in comparisons) else "BAD"
    bars = ", ".join(f"{bar:g} deg/s at rtol {rtol:g}" for rtol, bar in brick.BARS.items())
    write(console, f"  verdict: {verdict} (may differ from the exact rates by {bars})", style="bold")


_SNAPSHOTS = 9
_VIEW = {"elev": 16.0, "azim": -62.0}


def draw_flip(
    path: Path, vertices: Floats, faces: NDArray[np.int64], trajectory: Trajectory, flips: Floats
) -> None:
    """Draw a body that flips over and save the picture.

    Parameters
    ----------
    path : pathlib.Path
        A file that matplotlib can write.
    vertices, faces : numpy.ndarray
        The body's mesh, in the unit of length of the trajectory.
    trajectory : Trajectory
        One body's motion, with its angular momentum along +z or nearly so.
    flips : numpy.ndarray
        Times of the flips, marked in the picture.
    """
    figure_module: Any = require("matplotlib.figure", extra="plot", purpose="drawing")
    figure = figure_module.Figure(figsize=(11.0, 5.4), facecolor="white")
    placed = vertices - trajectory.body.center_of_mass
    _draw_body(figure, placed, faces, trajectory)
    rates = _draw_rates(figure, trajectory, flips)
    _draw_snapshots(figure, rates, placed, faces, trajectory)
    save_picture(figure, path)


def _draw_body(figure: Any, vertices: Floats, faces: NDArray[np.int64], trajectory: Trajectory) -> None:
    ax = figure.add_axes((-0.01, 0.06, 0.35, 0.86), projection="3d", computed_zorder=False)
    ax.view_init(**_VIEW)
    reach = np.linalg.norm(vertices, axis=1).max()
    plot.body(vertices, faces, ax)
    plot.principal_axes(trajectory.body, ax, length=1.06 * reach, center=np.zeros(3))
    show_around(ax, np.zeros(3), 0.74 * reach)
    moments = trajectory.body.principal_moments
    ratios = " : ".join(f"{moment / moments[0]:.2f}" for moment in moments)
    figure.text(0.165, 0.075, f"$I_1 : I_2 : I_3$ = {ratios}", ha="center", va="center", fontsize=11)
    figure.text(0.165, 0.945, "Spin it about $e_2$ ...", ha="center", va="center", fontsize=14)


def _draw_rates(figure: Any, trajectory: Trajectory, flips: Floats) -> Any:
    ax = figure.add_axes((0.395, 0.115, 0.58, 0.45))
    plot.angular_velocity(trajectory, ax, frame="principal")
    curves = ax.get_lines()[:3]
    for curve in curves:
        curve.set_linewidth(1.8)
    for time in flips:
        ax.axvline(time, color="0.7", linewidth=0.8, linestyle=":", zorder=0)
    names = [r"$\omega_1$, least moment", r"$\omega_2$, intermediate", r"$\omega_3$, greatest"]
    place = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "borderaxespad": 0.2}
    ax.legend(curves, names, ncols=3, frameon=False, **place)
    return ax


def _draw_snapshots(
    figure: Any, rates: Any, vertices: Floats, faces: NDArray[np.int64], trajectory: Trajectory
) -> None:
    """Draw the body as seen from space, each view above the time it shows."""
    box = rates.get_position()
    width = box.width / _SNAPSHOTS
    reach = np.linalg.norm(vertices, axis=1).max()
    times = trajectory.t[0] + (np.arange(_SNAPSHOTS) + 0.5) * np.ptp(trajectory.t) / _SNAPSHOTS
    for number, row in enumerate(np.searchsorted(trajectory.t, times)):
        middle = box.x0 + (number + 0.5) * width
        place = (middle - 0.75 * width, 0.625, 1.5 * width, 0.30)
        ax = figure.add_axes(place, projection="3d", computed_zorder=False)
        ax.patch.set_alpha(0.0)
        ax.view_init(**_VIEW)
        plot.body(_core.rotate(trajectory.quaternion[row], vertices), faces, ax)
        show_around(ax, np.zeros(3), 0.93 * reach)
    middle = box.x0 + box.width / 2
    figure.text(
        middle, 0.945, "... and it flips over, again and again.", ha="center", va="center", fontsize=14
    )
