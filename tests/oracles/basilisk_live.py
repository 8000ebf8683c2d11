"""A scenario of :mod:`oracles.basilisk_scenarios` by Basilisk, which needs the package ``bsk``.

Basilisk integrates by RK4 with equal steps. A command is read at the beginning of the step that follows it.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from oracles.basilisk_scenarios import Scenario

    Rows = NDArray[np.float64]
    Change = Callable[[float], object]

__all__ = ["run"]


class _Run:
    """A simulation under construction, and what changes a message at a time."""

    def __init__(self, scenario: Scenario, step: float) -> None:
        from Basilisk.architecture import messaging
        from Basilisk.simulation import spacecraft
        from Basilisk.utilities import SimulationBaseClass, macros

        self.scenario, self.messaging, self.nano = scenario, messaging, macros.sec2nano
        self.simulation = SimulationBaseClass.SimBaseClass()
        # The controllers run after the motion has come to their time.
        for process, task, period, priority in (
            ("motion", "steps", step, 10),
            ("flight", "control", scenario.control.period if scenario.control else step, 5),
        ):
            made = self.simulation.CreateNewProcess(process, priority)
            made.addTask(self.simulation.CreateNewTask(task, self.nano(period)))
        self.craft = spacecraft.Spacecraft()
        hub = self.craft.hub
        hub.mHub = scenario.mass
        hub.IHubPntBc_B = [list(row) for row in scenario.inertia]
        hub.r_BcB_B = _column(scenario.center)
        hub.omega_BN_BInit = _column(scenario.omega)
        hub.sigma_BNInit = _column(scenario.mrp)
        hub.r_CN_NInit = _column(scenario.position)
        hub.v_CN_NInit = _column(scenario.velocity)
        self.changes: list[Change] = []
        self.kept: list[object] = []
        self.speeds: Any = None

    def message(self, kind: str, field: str, table: Any) -> Any:
        """Return a message whose field follows a table."""
        message = getattr(self.messaging, f"{kind}Msg")()
        self.kept.append(message)

        def change(t: float) -> None:
            payload = getattr(self.messaging, f"{kind}MsgPayload")()
            setattr(payload, field, table.at(t))
            message.write(payload, self.nano(t))

        self.changes.append(change)
        return message

    def fixed(self, kind: str, **fields: Any) -> Any:
        payload = getattr(self.messaging, f"{kind}MsgPayload")()
        for name, value in fields.items():
            setattr(payload, name, value)
        message = getattr(self.messaging, f"{kind}Msg")().write(payload)
        self.kept.append(message)
        return message

    def add(self, effector: Any, task: str = "steps", priority: int = -1) -> Any:
        self.simulation.AddModelToTask(task, effector, None, priority)
        self.kept.append(effector)
        return effector

    def add_wheels(self) -> None:
        from Basilisk.simulation import reactionWheelStateEffector

        scenario, messaging = self.scenario, self.messaging
        effector = reactionWheelStateEffector.ReactionWheelStateEffector()
        for wheel in scenario.wheels:
            one = reactionWheelStateEffector.RWConfigPayload()
            one.RWModel = messaging.BalancedWheels
            one.gsHat_B = _column(wheel.axis)
            one.Js, one.Jt, one.Jg = wheel.inertia, 0.5 * wheel.inertia, 0.5 * wheel.inertia
            one.Omega, one.cViscous, one.fCoulomb = wheel.rate, wheel.friction, wheel.dry_friction
            one.u_max = -1.0 if wheel.max_torque is None else wheel.max_torque
            # The rate at the end of the step that ends at the limit differs from it by its rounding.
            one.Omega_max = -1.0 if wheel.max_rate is None else wheel.max_rate * (1.0 - 1e-13)
            one.u_min, one.P_max, one.betaStatic = 0.0, -1.0, -1.0
            one.omegaLimitCycle = 1e-13  # below this rate dry friction is made linear
            effector.addReactionWheel(one)
            self.kept.append(one)
        self.craft.addStateEffector(effector)
        self.add(effector)
        self.speeds = effector.rwSpeedOutMsg
        if scenario.motors:
            effector.rwMotorCmdInMsg.subscribeTo(
                self.message("ArrayMotorTorque", "motorTorque", scenario.motors)
            )
        else:
            request = (
                self.add_control()
                if scenario.control
                else self.message("CmdTorqueBody", "torqueRequestBody", scenario.request)
            )
            effector.rwMotorCmdInMsg.subscribeTo(self.add_allocation(request))

    def wheel_numbers(self) -> Any:
        wheels = self.scenario.wheels
        return self.fixed(
            "RWArrayConfig",
            numRW=len(wheels),
            GsMatrix_B=np.ravel([wheel.axis for wheel in wheels]).tolist(),
            JsList=[wheel.inertia for wheel in wheels],
            uMax=[1e9] * len(wheels),
        )

    def add_allocation(self, request: Any) -> Any:
        from Basilisk.fswAlgorithms import rwMotorTorque

        # A request from a table is there before the step, one of a controller at the end of the last step.
        task = ("control", -1) if self.scenario.control else ("steps", 100)
        module = self.add(rwMotorTorque.rwMotorTorque(), *task)
        module.controlAxes_B = np.eye(3).ravel().tolist()
        module.rwParamsInMsg.subscribeTo(self.wheel_numbers())
        module.vehControlInMsg.subscribeTo(request)
        return module.rwMotorTorqueOutMsg

    def add_control(self) -> Any:
        from Basilisk.fswAlgorithms import attTrackingError, inertial3D, mrpFeedback
        from Basilisk.simulation import simpleNav

        scenario, control = self.scenario, self.scenario.control
        assert control is not None
        sensed = self.add(simpleNav.SimpleNav(), "control")
        sensed.scStateInMsg.subscribeTo(self.craft.scStateOutMsg)
        target = self.add(inertial3D.inertial3D(), "control")
        target.sigma_R0N = list(control.target)
        error = self.add(attTrackingError.attTrackingError(), "control")
        error.attNavInMsg.subscribeTo(sensed.attOutMsg)
        error.attRefInMsg.subscribeTo(target.attRefOutMsg)
        law = self.add(mrpFeedback.mrpFeedback(), "control")
        law.K, law.P, law.Ki, law.integralLimit, law.controlLawType = (
            control.K,
            control.P,
            -1.0,
            1.0,
            control.kind,
        )
        law.guidInMsg.subscribeTo(error.attGuidOutMsg)
        law.vehConfigInMsg.subscribeTo(
            self.fixed("VehicleConfig", ISCPntB_B=scenario.without_wheels().ravel().tolist())
        )
        if scenario.wheels:
            law.rwParamsInMsg.subscribeTo(self.wheel_numbers())
            law.rwSpeedsInMsg.subscribeTo(self.speeds)
        return law.cmdTorqueOutMsg

    def add_coils(self) -> None:
        from Basilisk.simulation import MtbEffector

        coils = self.scenario.coils
        assert coils is not None
        effector = MtbEffector.MtbEffector()
        self.craft.addDynamicEffector(effector)
        self.add(effector)
        effector.mtbParamsInMsg.subscribeTo(
            self.fixed(
                "MTBArrayConfig",
                numMTB=len(coils.axes),
                GtMatrix_B=np.array(coils.axes, float).T.ravel().tolist(),
                maxMtbDipoles=list(coils.limits),
            )
        )
        effector.magInMsg.subscribeTo(self.message("MagneticField", "magField_N", coils.fields))
        effector.mtbCmdInMsg.subscribeTo(
            self.add_dipole_law() if coils.follows else self.message("MTBCmd", "mtbDipoleCmds", coils.dipoles)
        )

    def add_dipole_law(self) -> Any:
        """Return the command of a law that is asked after each step."""
        from Basilisk.architecture import sysModel
        from Basilisk.utilities import RigidBodyKinematics

        coils, craft, messaging = self.scenario.coils, self.craft, self.messaging
        assert coils is not None
        command = messaging.MTBCmdMsg()
        fields, gain, damping = coils.fields, coils.gain, coils.damping

        def update(_: object, now: int) -> None:
            state = craft.scStateOutMsg.read()
            omega = np.array(state.omega_BN_B)
            field = RigidBodyKinematics.MRP2C(np.array(state.sigma_BN)) @ np.array(fields.at(now * 1e-9))
            # The rate of the field in the body is -ω × B.
            dipole = gain * np.cross(omega, field)
            dipole -= np.cross(field, damping * omega) / (field @ field)
            payload = messaging.MTBCmdMsgPayload()
            payload.mtbDipoleCmds = dipole.tolist()
            command.write(payload, now)

        law = type("Law", (sysModel.SysModel,), {"UpdateState": update})
        self.add(law(), "control")
        self.kept.append(command)
        return command

    def add_thrusters(self) -> None:
        from Basilisk.simulation import thrusterDynamicEffector

        thrusters = self.scenario.thrusters
        assert thrusters is not None
        effector = thrusterDynamicEffector.ThrusterDynamicEffector()
        for place, along, force in zip(
            thrusters.positions, thrusters.directions, thrusters.forces, strict=True
        ):
            one = thrusterDynamicEffector.THRSimConfig()
            one.thrLoc_B = _column(place)
            one.thrDir_B = _column(np.array(along) / np.linalg.norm(along))
            one.MaxThrust, one.steadyIsp, one.MinOnTime = force, 200.0, thrusters.min_on
            effector.addThruster(one)
            self.kept.append(one)
        self.craft.addDynamicEffector(effector)
        self.add(effector)
        message = self.messaging.THRArrayOnTimeCmdMsg()
        effector.cmdsInMsg.subscribeTo(message)
        self.kept.append(message)

        def change(t: float) -> None:
            if t % thrusters.period == 0.0:
                payload = self.messaging.THRArrayOnTimeCmdMsgPayload()
                payload.OnTimeRequest = thrusters.pulses.at(t)
                message.write(payload, self.nano(t))

        self.changes.append(change)

    def add_external(self) -> None:
        from Basilisk.simulation import extForceTorque

        scenario = self.scenario
        effector = extForceTorque.ExtForceTorque()
        self.craft.addDynamicEffector(effector)
        self.add(effector)
        if scenario.force:
            effector.cmdForceBodyInMsg.subscribeTo(
                self.message("CmdForceBody", "forceRequestBody", scenario.force)
            )
        if scenario.force_in_space:
            effector.cmdForceInertialInMsg.subscribeTo(
                self.message("CmdForceInertial", "forceRequestInertial", scenario.force_in_space)
            )
        if scenario.torque:
            effector.cmdTorqueInMsg.subscribeTo(
                self.message("CmdTorqueBody", "torqueRequestBody", scenario.torque)
            )
        elif scenario.control:
            effector.cmdTorqueInMsg.subscribeTo(self.add_control())

    def add_gravity(self) -> None:
        from Basilisk.simulation import GravityGradientEffector
        from Basilisk.utilities import simIncludeGravBody

        factory = simIncludeGravBody.gravBodyFactory()
        attractor = factory.createCustomGravObject("attractor", self.scenario.mu)
        attractor.isCentralBody = True
        factory.addBodiesTo(self.craft)
        effector = GravityGradientEffector.GravityGradientEffector()
        effector.addPlanetName(attractor.planetName)
        self.craft.addDynamicEffector(effector)
        self.add(effector)
        self.kept.append(factory)

    def rows(self) -> Rows:
        scenario, found = self.scenario, []
        self.simulation.AddModelToTask("steps", self.craft)
        self.simulation.InitializeSimulation()
        times = scenario.times()
        for t, end in pairwise(times):
            for change in self.changes:
                change(t)
            self.simulation.ConfigureStopTime(self.nano(end))
            self.simulation.ExecuteSimulation()
            if end in scenario.t:
                state = self.craft.scStateOutMsg.read()
                rates = list(self.speeds.read().wheelSpeeds)[: len(scenario.wheels)] if self.speeds else []
                found.append([*state.omega_BN_B, *state.sigma_BN, *state.r_CN_N, *state.v_CN_N, *rates])
        return np.array(found)


def _column(vector: Any) -> list[list[float]]:
    rows: list[list[float]] = np.array(vector, float)[:, None].tolist()
    return rows


def run(scenario: Scenario, step: float) -> Rows:
    """Return ω, Rodrigues parameters, position and velocity of the centre, and rates of the wheels."""
    built = _Run(scenario, step)
    if scenario.wheels:
        built.add_wheels()
    if scenario.coils:
        built.add_coils()
    if scenario.thrusters:
        built.add_thrusters()
    if (
        scenario.force
        or scenario.force_in_space
        or scenario.torque
        or (scenario.control and not scenario.wheels)
    ):
        built.add_external()
    if scenario.mu:
        built.add_gravity()
    return built.rows()
