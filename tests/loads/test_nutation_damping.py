"""What dissipation inside does to nutation: the energy-sink model against a slug that is simulated."""

from __future__ import annotations

import numpy as np
import pytest
from polhode import Event, RigidBody, loads, tops
from polhode.errors import PolhodeError

BODY = RigidBody.from_principal(1.0, (1.0, 2.0, 2.5))


class TestEnergySink:
    """A small slug against the energy-sink model, which is of first order in its moment."""

    @pytest.mark.parametrize(("axial", "start", "end"), [(0.5, 0.2, 1.2), (1.7, 1.2, 0.2)])
    def test_the_error_goes_with_the_moment(self, axial: float, start: float, end: float) -> None:
        body = RigidBody.from_principal(1.0, (1.0, 1.0, axial))
        found = []
        for inertia in (4e-3, 2e-3, 1e-3):
            fate = tops.nutation_damping(body, 1.0, inertia=inertia, damping=0.7 * inertia)
            expected = fate.time(start, end)
            omega = (np.sin(start), 0.0, np.cos(start) / axial)
            there = Event(
                lambda _t, w, *_: (
                    abs(w[2]) * axial - np.cos(end) * np.hypot(np.hypot(w[0], w[1]), w[2] * axial)
                ),
                terminal=True,
            )
            load = loads.slug(inertia, 0.7 * inertia)
            run = body.simulate(np.array([0.0, 2 * expected]), omega, load=load, events=there)
            found.append(run.events.t[0] / expected - 1)
            assert fate.angle(start, expected) == pytest.approx(end, abs=1e-12)
        assert abs(found[2]) < 0.01
        assert found[0] / found[1] == pytest.approx(2.0, abs=0.2)
        assert found[1] / found[2] == pytest.approx(2.0, abs=0.2)

    def test_the_major_axis_rule(self) -> None:
        moments = [(1.0, 1.0, 0.5), (1.0, 1.0, 1.0), (1.0, 1.0, 1.7)]
        bodies = RigidBody.stack([RigidBody.from_principal(1.0, m) for m in moments])
        fate = tops.nutation_damping(bodies, 1.0, inertia=1e-3, damping=1e-3)
        assert fate.verdict.tolist() == ["flat spin", "neutral", "damps"]
        assert fate.time_constant[1] == np.inf
        assert fate.angle(0.3, 1e9) == pytest.approx([np.pi / 2, 0.3, 0.0], abs=1e-15)
        one = tops.nutation_damping(bodies[0], 1.0, inertia=1e-3, damping=1e-3)
        assert one.verdict == "flat spin"
        assert one.angle(1e-300, [0.0, 2000.0 / one.rate]).tolist() == [1e-300, np.pi / 2]
        with pytest.raises(PolhodeError, match=r"no two of .* are equal|symmetric top"):
            tops.nutation_damping(BODY, 1.0, inertia=1e-3, damping=1e-3)
        with pytest.raises(PolhodeError, match="damping must be positive, got 0"):
            tops.nutation_damping(bodies[0], 1.0, inertia=1e-3, damping=0.0)
