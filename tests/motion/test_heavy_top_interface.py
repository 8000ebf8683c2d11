"""The interface of heavy tops: stacks, copies, errors."""

from __future__ import annotations

import copy
import pickle

import numpy as np
import polhode
import pytest
from polhode import euler_angles, loads, solids
from polhode._core import rotate
from polhode.errors import PolhodeError
from test_heavy_top_motion import CASES, G


class TestInterface:
    def test_stacks_broadcast_and_rows_have_their_own_bits(self) -> None:
        stack = solids.cone([0.5, 1.0, 1.5], 3.0, mass=1.0).translated((0.0, 0.0, 2.25))
        omega = np.array([[[0.1, 0.2, 30.0]], [[1.0, 0.0, 3.0]]])
        times = np.linspace(-2, 5, 40).reshape(4, 10)
        top = stack.heavy_top(omega, euler_angles.to_quaternion((0, 0.4, 0)), G)
        assert top.shape == (2, 3)
        motion = top.at(times)
        assert motion.omega.shape == (2, 3, 4, 10, 3)
        assert motion.quaternion.shape == (2, 3, 4, 10, 4)
        alone = stack[1].heavy_top(omega[1, 0], euler_angles.to_quaternion((0, 0.4, 0)), G).at(times[2, 3])
        assert np.array_equal(motion.quaternion[1, 1, 2, 3], alone.quaternion)
        assert np.array_equal(motion.omega[1, 1, 2, 3], alone.omega)
        assert top.path.shape == (2, 3)
        assert top.nutation_limits.shape == (2, 3, 2)
        assert top.at(0.0).quaternion.shape == (2, 3, 4)
        assert top.at([]).omega.shape == (2, 3, 0, 3)

    def test_a_trajectory_about_the_pivot(self) -> None:
        case = CASES["loop"]
        motion = case.body.heavy_top(case.omega, case.attitude, G).at([0.0, 1.0, 2.0])
        assert not motion.position.any()
        assert not motion.about.any()
        energy = motion.kinetic_energy().total + 9.81 * motion.point("center_of_mass")[:, 2]
        assert np.ptp(energy) < 1e-13 * np.abs(energy).max()
        assert motion.pivoted
        downward = motion.pivot_reaction()[..., 2]
        assert (np.abs(downward - 9.81) < 0.7 * 50).all()
        load = loads.torque_callback(
            lambda _t, _omega, q: np.cross(case.body.center_of_mass, rotate(q, np.array(G), inverse=True))
        )
        run = case.body.simulate(
            [0.0, 1.0, 2.0], case.omega, case.attitude, load=load, about="origin", rtol=1e-13
        )
        assert np.abs(run.omega - motion.omega).max() < 1e-8

    def test_values_copy_pickle_and_print(self) -> None:
        case = CASES["loop"]
        top = case.body.heavy_top(case.omega, case.attitude, G)
        assert copy.copy(top) is top
        assert copy.deepcopy(top) is top
        again = pickle.loads(pickle.dumps(top))
        assert np.array_equal(again.at(3.0).quaternion, top.at(3.0).quaternion)
        assert again.body == case.body
        assert repr(top) == "<HeavyTop: loop, omega=[1.5, -2.0, 20.0]>"
        assert isinstance(top, polhode.HeavyTop)
        many = case.body.heavy_top([case.omega] * 2, case.attitude, G)
        assert repr(many) == "<HeavyTop stack of shape (2,): 2 motions>"

    def test_times_that_are_not_finite(self) -> None:
        for case in CASES.values():
            top = case.body.heavy_top(case.omega, case.attitude, (0, 0, -case.gravity))
            motion = top.at([0.0, np.nan, np.inf, 1.0])
            assert np.isfinite(motion.quaternion[[0, 3]]).all()
            assert np.isnan(motion.quaternion[1]).all()
            assert np.isnan(motion.omega[1, :2]).all()

    def test_what_is_refused(self) -> None:
        with pytest.raises(PolhodeError, match=r"no symmetric top.*simulate"):
            solids.box((1.0, 2.0, 3.0), mass=1.0).heavy_top((0, 0, 1), None, G)
        cone = solids.cone(1.0, 3.0, mass=1.0)
        with pytest.raises(PolhodeError, match=r"pivot.*symmetry axis.*0\.01.*translated"):
            cone.translated((0.01, 0.0, 1.0)).heavy_top((0, 0, 1), None, G)
        with pytest.raises(PolhodeError, match=r"row 1.*omega.*NaN"):
            cone.heavy_top([(0, 0, 1), (0, np.nan, 1)], None, G)
        with pytest.raises(PolhodeError, match=r"gravity.*inf"):
            cone.heavy_top((0, 0, 1), None, (0, 0, np.inf))
        with pytest.raises(ValueError, match="gravity: expected shape"):
            cone.heavy_top((0, 0, 1), None, 9.81)
        with pytest.raises(ValueError, match="do not broadcast"):
            cone.heavy_top(np.zeros((2, 3)), np.tile([0.0, 0.0, 0.0, 1.0], (3, 1)), G)
