"""Robots read here and by MuJoCo."""

from __future__ import annotations

import numpy as np
from polhode import robots, solids
from test_robots import fixed_axes, there


class TestMuJoCo:
    def read(self, geom: str, compiler: str = "") -> robots.Verdict:
        text = f"""<mujoco><compiler {compiler}/><worldbody><body name="b">
            <inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/>{geom}</body></worldbody></mujoco>"""
        (verdict,) = robots.check(robots.parse_robot(text.encode(), name="m", folder="."))
        return verdict

    def test_lengths_are_halves(self) -> None:
        np.testing.assert_allclose(
            there(self.read('<geom type="cylinder" size="0.5 1"/>').shape_moments),
            solids.cylinder(0.5, 2.0, mass=1.0).principal_moments,
            rtol=1e-14,
        )
        capsule = solids.capsule(0.5, 3.0, mass=1.0)
        for geom in (
            '<geom type="capsule" size="0.5 1.5"/>',
            '<geom type="capsule" size="0.5" fromto="0 1 0 0 4 0"/>',
            '<geom type="capsule" size="0.5" fromto="0 0 4 0 0 1"/>',
            '<geom type="capsule" size="0.5 1.5" zaxis="1 2 3"/>',
            '<geom type="capsule" size="0.5 1.5" axisangle="0 1 0 30"/>',
            '<geom type="capsule" size="0.5 1.5" xyaxes="0 1 0 1 1 0"/>',
            '<geom type="capsule" size="0.5 1.5" quat="2 1 0 0"/>',
        ):
            np.testing.assert_allclose(
                there(self.read(geom).shape_moments), capsule.principal_moments, rtol=1e-13
            )

    def test_masses_and_densities_weigh(self) -> None:
        two = '<geom size="0.1" mass="{}"/><geom size="0.2" pos="1 0 0" {}/>'
        light = 1000 * 4 / 3 * np.pi * 0.2**3
        for second, share in (('mass="3"', 3.0), ("", light), ('density="500"', light / 2)):
            verdict = self.read(two.format(1.0, second))
            total = 1.0 + share
            along = (0.4 * 0.01 * 1 + 0.4 * 0.04 * share) / total
            np.testing.assert_allclose(there(verdict.shape_moments)[0], along, rtol=1e-13)
            np.testing.assert_allclose(there(verdict.shape_moments)[2], along + share / total**2, rtol=1e-13)

    def test_default_angles_are_degrees_of_the_turning_frame(self) -> None:
        text = b"""<mujoco><worldbody><body name="b"><inertial mass="1" pos="0 0 0" euler="10 20 30"
            diaginertia="1 2 2.5"/></body></worldbody></mujoco>"""
        (link,) = robots.parse_robot(text, name="m", folder=".").links
        x, y, z = (fixed_axes(*row) for row in np.diag(np.deg2rad([10, 20, 30])))
        turn = x @ y @ z
        np.testing.assert_allclose(
            there(link.inertial).inertia, turn @ np.diag([1, 2, 2.5]) @ turn.T, rtol=0, atol=1e-14
        )

    def test_frames_and_classes(self) -> None:
        text = b"""<mujoco><default><default class="big"><geom size="0.5"/></default></default><worldbody>
            <frame><body name="b"><inertial mass="1" pos="0 0 0" diaginertia="1 2 2.5"/>
            <geom size="0.5"/><frame pos="0 0 1" euler="90 0 0" childclass="big"><geom pos="0 3 0"/></frame>
            </body></frame></worldbody></mujoco>"""
        robot = robots.parse_robot(text, name="m", folder=".")
        assert [shape.size for shape in robot.links[0].shapes] == [(0.5,), (0.5,)]
        np.testing.assert_allclose(robot.links[0].shapes[1].place.position, [0, 0, 4], atol=1e-15)
        (verdict,) = robots.check(robot)
        np.testing.assert_allclose(there(verdict.shape_moments), [0.1, 4.1, 4.1], rtol=1e-14)

    def test_nothing_declared_is_inferred(self) -> None:
        text = b'<mujoco><worldbody><body name="b"><geom size="1"/><body/></body></worldbody></mujoco>'
        verdicts = robots.check(robots.parse_robot(text, name="m", folder="."))
        assert [verdict.verdict for verdict in verdicts] == ["inferred", "none"]
        text = b"""<sdf><model><link name="a"><inertial auto="true"/>
            <collision><geometry><sphere><radius>1</radius></sphere></geometry></collision></link></model></sdf>"""
        (verdict,) = robots.check(robots.parse_robot(text, name="s", folder="."))
        assert verdict.verdict == "inferred"
