"""NASA's tumbling brick: published mass properties and rates against which the motion is held."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from polhode import RigidBody

__all__ = ["BARS", "EXACT_RATES", "NASA_RATES", "Comparison", "compare"]

# NASA Engineering and Safety Center, "Check-Cases for Verification of 6-Degree-of-Freedom Flight Vehicle
# Simulations", NASA/TM-2015-218675, atmospheric case 2 (dragless tumbling brick); mass properties from its
# brick_inertia.dml. Slugs and feet; products of inertia 0; rates in deg/s relative to inertial space.
MASS: Final = 0.155404754
MOMENTS: Final = (0.001894220, 0.006211019, 0.007194665)
START_RATES: Final = (10.0, 20.0, 30.0)
DURATION: Final = 30.0
NASA_RATES: Final = (12.61839077566776, -17.3974747618308, 31.11958888682995)
"""At 30 s in the published results of simulator 01."""
EXACT_RATES: Final = (12.61839077591422, -17.39747476161139, 31.11958888694434)
"""At 30 s by a Taylor series in 25-digit arithmetic."""
BARS: Final = {1e-10: 1e-8, 1e-13: 1e-11}
"""deg/s: how near the exact rates ours have to be at each relative tolerance, the default one first."""


@dataclass(frozen=True)
class Comparison:
    """Our rates at the end, at one tolerance, and how they compare.

    Attributes
    ----------
    rtol : float
        Relative tolerance of the integration.
    rates : tuple of float
        deg/s at 30 s.
    from_exact, from_nasa : tuple of float
        Ours minus theirs, deg/s.
    """

    rtol: float
    rates: tuple[float, ...]
    from_exact: tuple[float, ...]
    from_nasa: tuple[float, ...]

    @property
    def is_good(self) -> bool:
        """Whether ours are within the bar of the exact rates."""
        return max(abs(difference) for difference in self.from_exact) <= BARS[self.rtol]


def compare(rtol: float) -> Comparison:
    """Tumble the brick for 30 s.

    Parameters
    ----------
    rtol : float
        One of the tolerances of `BARS`.

    Returns
    -------
    Comparison
    """
    brick = RigidBody(MASS, np.diag(MOMENTS))
    trajectory = brick.simulate([0.0, DURATION], np.deg2rad(START_RATES), rtol=rtol)
    rates = np.rad2deg(trajectory.omega[-1])
    return Comparison(
        rtol=rtol,
        rates=tuple(map(float, rates)),
        from_exact=tuple(map(float, rates - EXACT_RATES)),
        from_nasa=tuple(map(float, rates - NASA_RATES)),
    )
