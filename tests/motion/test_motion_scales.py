"""A hundred thousand heavy tops, their moments from 1e-150 to 1e150: what is conserved stays."""

from __future__ import annotations

import numpy as np
import pytest
from polhode import RigidBody
from test_heavy_top_motion import invariants, random_tops

SEED = 20261121
CHUNKS, ROWS = 20, 5000
RADIANS = (0.3, 1e3, 1e9, 1e15)


@pytest.mark.long
@pytest.mark.timeout(1800)
def test_heavy_tops_keep_energy_and_momenta() -> None:
    rng = np.random.default_rng(SEED)
    for _ in range(CHUNKS):
        moments, centers, omega, quaternion, gravity = random_tops(rng, ROWS)
        # Powers of two, so that the states come back to unit size without rounding.
        length, rate = 2.0 ** rng.integers(-249, 250), 2.0 ** rng.integers(-240, 241)
        body = RigidBody.from_principal(1.0, moments * length**2, center_of_mass=centers * length)
        motion = body.heavy_top(omega * rate, quaternion, gravity * length * rate * rate)
        start, size = invariants(moments, centers, gravity, quaternion, omega)
        fastest = np.linalg.norm(omega, axis=-1).max()
        for angle in RADIANS:
            states = motion.at(angle / fastest / rate)
            assert np.isfinite(states.omega).all()
            assert np.abs(np.linalg.norm(states.quaternion, axis=-1) - 1).max() < 1e-15
            then, _ = invariants(moments, centers, gravity, states.quaternion, states.omega / rate)
            assert (np.abs(then - start) / np.where(size > 0, size, 1)).max() < 1e-14
