"""``polhode demo``: a body from a file to its report, motion and picture, and a check against NASA."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from polhode import samples
from polhode.cli import brick
from polhode.cli.loading import load_body
from polhode.cli.options import BodyOptions
from polhode.cli.report import file_report
from polhode.cli.text import write
from polhode.errors import PolhodeError
from polhode.files.loaded import read_mesh
from polhode.files.writing import write_bytes
from polhode.units import metres_per

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray
    from rich.console import Console

    from polhode import Trajectory

__all__ = ["run"]

# One turn a second about the stem, and a breath of spin about the other two axes. Steel.
SPIN = (0.01, 2.0 * np.pi, 0.0)
DURATION = 20.0
SAMPLES = 2001
STEEL = "7850 kg/m^3"

GOOD, BAD = 0, 1


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
        raise PolhodeError(f"--output-dir: {directory} is a file; name a directory")
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

    _heading(console, "4. Now your own file, or one of those that ship with polhode")
    for command in (
        "polhode samples .",
        'polhode report bracket.ply --length-unit in --density "2.7 g/cm^3"',
        "polhode check robot.urdf --fix better.urdf",
        "polhode molecule water.xyz",
        f"polhode spin {mesh_file} --length-unit mm --axes principal --omega 0.01 6 0 --until 20 "
        "--save racket.html",
        "polhode --help",
    ):
        write(console, f"  {command}")
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
        from polhode.cli.picture import draw_flip

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
