"""Coils and thrusters by Basilisk: ``python -m oracles.basilisk_actuators`` in the folder ``tests``.

It needs the package ``bsk``, and writes ``tables/basilisk_actuators.json``. Basilisk integrates by RK4 with
equal steps. A thruster fires one sixth of a step too long, since the last stage of a step still sees it on.
So the case of the thrusters is run with three steps, and the numbers are extrapolated to steps of no length.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["COILS", "CRAFT", "TABLE", "THRUSTERS", "coils", "thrusters"]

TABLE = Path(__file__).parent / "tables" / "basilisk_actuators.json"

CRAFT: dict[str, Any] = {
    "mass": 90.0,
    "inertia": [[9.0, 0.4, -0.2], [0.4, 8.0, 0.3], [-0.2, 0.3, 10.0]],
    "omega": [0.05, -0.08, 0.1],
    "mrp": [0.1, 0.2, -0.3],
}
COILS: dict[str, Any] = {
    "dipole": [5e3, -2e4, 1.25e3],
    "max_dipole": [4e3, 2.5e3, 1e4],
    "field": [1e-5, -3e-5, 2e-5],
    "t": [20.0, 60.0],
}
"""Two of the coils saturate."""
THRUSTERS: dict[str, Any] = {
    "positions": [(1.0, 0.2, 0), (-1.0, 0.1, 0.3), (0, 1.0, -0.2), (0.1, -1.0, 0)],
    "directions": [(0, 1.0, 0.2), (0.1, 1.0, 0), (0, 0.3, 1.0), (0.2, 0, -1.0)],
    "forces": [0.2, 0.3, 0.25, 0.15],
    "duties": (
        np.array([(64, 128, 192, 0), (250, 26, 0, 77), (0, 154, 51, 250), (102, 0, 240, 13)]) / 256
    ).tolist(),
    "period": 2.0,
    "t": [2.0, 4.0, 6.0, 8.0],
}
"""Pulses are whole numbers of all steps."""


def _run(step: float, times: list[float], add: Callable[..., Callable[[int], object]]) -> list[list[float]]:
    """Return ω, the modified Rodrigues parameters, position and velocity at the times."""
    from Basilisk.simulation import spacecraft
    from Basilisk.utilities import SimulationBaseClass, macros

    simulation = SimulationBaseClass.SimBaseClass()
    simulation.CreateNewProcess("process").addTask(simulation.CreateNewTask("task", macros.sec2nano(step)))
    craft = spacecraft.Spacecraft()
    craft.hub.mHub = CRAFT["mass"]
    craft.hub.IHubPntBc_B = CRAFT["inertia"]
    craft.hub.omega_BN_BInit = np.array(CRAFT["omega"])[:, None].tolist()
    craft.hub.sigma_BNInit = np.array(CRAFT["mrp"])[:, None].tolist()
    change = add(simulation, craft)
    simulation.AddModelToTask("task", craft)
    simulation.InitializeSimulation()
    found = []
    for k, t in enumerate(times):
        change(k)
        simulation.ConfigureStopTime(macros.sec2nano(t))
        simulation.ExecuteSimulation()
        state = craft.scStateOutMsg.read()
        found.append([*state.omega_BN_B, *state.sigma_BN, *state.r_BN_N, *state.v_BN_N])
    return found


def coils() -> list[list[float]]:
    """Run three coils in a uniform field."""
    from Basilisk.architecture import messaging
    from Basilisk.simulation import MtbEffector

    def add(simulation: Any, craft: Any) -> Any:
        effector = MtbEffector.MtbEffector()
        craft.addDynamicEffector(effector)
        simulation.AddModelToTask("task", effector)
        bars, command, field = (
            messaging.MTBArrayConfigMsgPayload(),
            messaging.MTBCmdMsgPayload(),
            messaging.MagneticFieldMsgPayload(),
        )
        bars.numMTB, bars.GtMatrix_B, bars.maxMtbDipoles = 3, np.eye(3).ravel().tolist(), COILS["max_dipole"]
        command.mtbDipoleCmds, field.magField_N = COILS["dipole"], COILS["field"]
        kept = (
            messaging.MTBArrayConfigMsg().write(bars),
            messaging.MTBCmdMsg().write(command),
            messaging.MagneticFieldMsg().write(field),
        )
        effector.mtbParamsInMsg.subscribeTo(kept[0])
        effector.mtbCmdInMsg.subscribeTo(kept[1])
        effector.magInMsg.subscribeTo(kept[2])
        return lambda _k: kept

    return _run(0.01, COILS["t"], add)


def thrusters() -> list[list[float]]:
    """Run four thrusters with a table of duties, extrapolated to steps of no length."""
    from Basilisk.architecture import messaging
    from Basilisk.simulation import thrusterDynamicEffector
    from Basilisk.utilities import macros

    def add(simulation: Any, craft: Any) -> Any:
        effector = thrusterDynamicEffector.ThrusterDynamicEffector()
        for place, along, force in zip(
            THRUSTERS["positions"], THRUSTERS["directions"], THRUSTERS["forces"], strict=True
        ):
            one = thrusterDynamicEffector.THRSimConfig()
            one.thrLoc_B = np.array(place)[:, None].tolist()
            one.thrDir_B = (np.array(along) / np.linalg.norm(along))[:, None].tolist()
            one.MaxThrust, one.steadyIsp, one.MinOnTime = force, 200.0, 0.0
            effector.addThruster(one)
        craft.addDynamicEffector(effector)
        simulation.AddModelToTask("task", effector)
        message = messaging.THRArrayOnTimeCmdMsg()
        effector.cmdsInMsg.subscribeTo(message)
        kept = [effector, message]

        def change(k: int) -> object:
            payload = messaging.THRArrayOnTimeCmdMsgPayload()
            payload.OnTimeRequest = [duty * THRUSTERS["period"] for duty in THRUSTERS["duties"][k]]
            kept[1].write(payload, macros.sec2nano(k * THRUSTERS["period"]))
            return kept

        return change

    long, middle, short = (np.array(_run(2.0**-k, THRUSTERS["t"], add)) for k in (7, 8, 9))
    once = 2 * middle - long, 2 * short - middle
    found: list[list[float]] = ((4 * once[1] - once[0]) / 3).tolist()
    return found


if __name__ == "__main__":
    import Basilisk

    table = {"version": Basilisk.__version__, "coils": coils(), "thrusters": thrusters()}
    TABLE.write_text(json.dumps(table, indent=1) + "\n")
