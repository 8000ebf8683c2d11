"""The T-handle that flips over, as a moving picture that goes on without a break: ``docs/images/flip.gif``.

After two flips ω is where it was in the body, and the body has turned about L by some angle. The start is
chosen so that this angle is a whole number of turns: body and ω are then where they were.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from PIL import Image, ImageSequence
from polhode import FreeMotion, RigidBody, solids
from scipy.optimize import brentq

PICTURES, DURATION, SIZE, COLORS = 100, 5.0, (420, 340), 128
TURNS = 5
"""About L, until the picture comes again; more of them are for a start nearer to the axis."""


def handle() -> RigidBody:
    """Put the handle of the readme together, its stem along z."""
    bar = solids.box((0.100, 0.016, 0.016), density=7850).translated((0, 0, 0.008))
    stem = solids.box((0.016, 0.016, 0.050), density=7850).translated((0, 0, -0.025))
    return bar + stem


def spin(body: RigidBody, share: float) -> FreeMotion:
    """Spin a body about its intermediate axis, and by a share of that about its first one."""
    return body.free_motion(body.principal.axes @ np.array([share, 1.0, 0.0]))


def closed(body: RigidBody) -> tuple[FreeMotion, float]:
    """Find the start after which body and ω come back together, and the time that this takes."""

    def excess(share: float) -> float:
        periods = spin(body, share).periods
        return float(periods.rotation / periods.precession) - TURNS

    motion = spin(body, brentq(excess, 1e-4, 0.4))
    return motion, float(motion.periods.rotation)


def draw(path: Path) -> None:
    """Draw the motion twice and keep the second time, in which the path of ω is there from the start."""
    body = handle()
    motion, period = closed(body)
    times = period / PICTURES * np.arange(2 * PICTURES)
    with TemporaryDirectory() as scratch:
        film = body.simulate(times, motion.at(0.0).omega).animate(
            Path(scratch, "twice.gif"), frames=len(times), duration=2.0 * DURATION, size=SIZE, labels=False
        )
        with Image.open(film) as twice:
            pictures = [picture.convert("RGB") for picture in ImageSequence.Iterator(twice)][PICTURES:]
    some = Image.new("RGB", (SIZE[0], SIZE[1] * 10))  # whose colours all of them share
    for number, picture in enumerate(pictures[:: PICTURES // 10]):
        some.paste(picture, (0, SIZE[1] * number))
    palette = some.quantize(COLORS, Image.Quantize.MAXCOVERAGE)
    few = [picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    each = round(1000.0 * DURATION / PICTURES)
    few[0].save(path, save_all=True, append_images=few[1:], duration=each, loop=0, optimize=True)


if __name__ == "__main__":
    draw(Path(__file__).parents[1] / "images" / "flip.gif")
