"""Records of one tumbling body from engines, each audited: the table of docs/engines.md.

``python benchmarks/engines.py`` runs every engine that is installed and prints the table. Each engine has a
function that returns times, quaternions (x, y, z, w) and angular velocities in the body; the functions are
the recipes of the page.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import numpy as np
import polhode
from polhode import RigidBody, Trajectory

TENSOR = np.array([[2.0, 0.3, 0.1], [0.3, 3.0, -0.2], [0.1, -0.2, 4.0]])
OMEGA = np.array([0.3, 1.0, 0.2])
STEP, END = 0.01, 40.0
MOMENTS, AXES = np.linalg.eigh(TENSOR)

Record = tuple[Any, Any, Any]


def mujoco(integrator: str, *, tensor: Any = TENSOR, scalar_last: bool = True) -> Record:
    """Run a free joint without gravity. ``qpos`` has the scalar first; ``qvel[3:]`` is ω in the body."""
    import mujoco

    xx, yy, zz = np.diag(tensor)
    full = f"{xx} {yy} {zz} {tensor[0, 1]} {tensor[0, 2]} {tensor[1, 2]}"
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler balanceinertia="false"/><option timestep="{STEP}" gravity="0 0 0" '
        f'integrator="{integrator}"/><worldbody><body><freejoint/>'
        f'<inertial pos="0 0 0" mass="1" fullinertia="{full}"/></body></worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    data.qvel[3:] = OMEGA
    rows = []
    for _ in range(round(END / STEP) + 1):
        rows.append((data.time, *data.qpos[3:], *data.qvel[3:]))
        mujoco.mj_step(model, data)
    t, q, omega = np.split(np.array(rows), [1, 5], axis=1)
    return t[:, 0], q[:, [1, 2, 3, 0]] if scalar_last else q, omega


def drake() -> Record:
    """Run one floating body of a MultibodyPlant, integrated with error control to 1e-8."""
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import SpatialInertia, UnitInertia
    from pydrake.systems.analysis import Simulator

    plant = MultibodyPlant(time_step=0.0)
    unit = UnitInertia(2.0, 3.0, 4.0, 0.3, 0.1, -0.2)
    body = plant.AddRigidBody("body", SpatialInertia(1.0, np.zeros(3), unit))
    plant.mutable_gravity_field().set_gravity_vector(np.zeros(3))
    plant.Finalize()
    simulator = Simulator(plant)
    simulator.get_mutable_integrator().set_target_accuracy(1e-8)
    context = simulator.get_mutable_context()
    velocities = np.concatenate((OMEGA, np.zeros(3)))  # in space, which is the body at the start
    plant.SetVelocities(context, velocities)
    rows = []
    for k in range(round(END / STEP) + 1):
        simulator.AdvanceTo(k * STEP)
        turn = plant.EvalBodyPoseInWorld(context, body).rotation()
        omega = turn.matrix().T @ plant.EvalBodySpatialVelocityInWorld(context, body).rotational()
        q = turn.ToQuaternion()
        rows.append((context.get_time(), q.x(), q.y(), q.z(), q.w(), *omega))
    t, quaternion, rates = np.split(np.array(rows), [1, 5], axis=1)
    return t[:, 0], quaternion, rates


def pinocchio() -> Record:
    """Run a free-flyer with aba and explicit steps of first order, as examples do."""
    import pinocchio as pin

    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "free")
    model.appendBodyToJoint(joint, pin.Inertia(1.0, np.zeros(3), TENSOR), pin.SE3.Identity())
    model.gravity.linear = np.zeros(3)
    data, q, v = model.createData(), pin.neutral(model), np.zeros(6)
    v[3:] = OMEGA
    rows = []
    for k in range(round(END / STEP) + 1):
        rows.append((k * STEP, *q[3:7], *v[3:]))
        a = pin.aba(model, data, q, v, np.zeros(6))
        v = v + STEP * a
        q = pin.integrate(model, q, STEP * v)
    t, quaternion, rates = np.split(np.array(rows), [1, 5], axis=1)
    return t[:, 0], quaternion, rates


def bullet(*, maximal: bool = False, in_body: bool = True) -> Record:
    """Run a free body along its principal axes. ``getBaseVelocity`` gives ω in space."""
    import pybullet as pb

    pb.connect(pb.DIRECT)
    pb.setPhysicsEngineParameter(fixedTimeStep=STEP)
    shape = pb.createCollisionShape(pb.GEOM_BOX, halfExtents=[0.1, 0.1, 0.1])
    body = pb.createMultiBody(baseMass=1.0, baseCollisionShapeIndex=shape, useMaximalCoordinates=maximal)
    pb.changeDynamics(body, -1, localInertiaDiagonal=MOMENTS.tolist(), linearDamping=0.0, angularDamping=0.0)
    pb.resetBaseVelocity(body, angularVelocity=(AXES.T @ OMEGA).tolist())
    rows = []
    for k in range(round(END / STEP) + 1):
        q = pb.getBasePositionAndOrientation(body)[1]
        omega = np.array(pb.getBaseVelocity(body)[1])
        if in_body:
            omega = np.array(pb.getMatrixFromQuaternion(q)).reshape(3, 3).T @ omega
        rows.append((k * STEP, *q, *omega))
        pb.stepSimulation()
    pb.disconnect()
    t, quaternion, rates = np.split(np.array(rows), [1, 5], axis=1)
    return t[:, 0], quaternion, rates


def basilisk() -> Record:
    """Run a spacecraft without gravity. ``sigma_BN`` are its modified Rodrigues parameters."""
    from Basilisk.simulation import spacecraft
    from Basilisk.utilities import SimulationBaseClass, macros
    from scipy.spatial.transform import Rotation

    simulation = SimulationBaseClass.SimBaseClass()
    simulation.CreateNewProcess("process").addTask(simulation.CreateNewTask("task", macros.sec2nano(STEP)))
    craft = spacecraft.Spacecraft()
    craft.hub.mHub = 1.0
    craft.hub.IHubPntBc_B = TENSOR.tolist()
    craft.hub.omega_BN_BInit = OMEGA[:, None].tolist()
    states = craft.scStateOutMsg.recorder()
    simulation.AddModelToTask("task", craft)
    simulation.AddModelToTask("task", states)
    simulation.InitializeSimulation()
    simulation.ConfigureStopTime(macros.sec2nano(END))
    simulation.ExecuteSimulation()
    attitude = Rotation.from_mrp(states.sigma_BN).as_quat()
    return 1e-9 * states.times(), attitude, np.array(states.omega_BN_B)


def newton(solver: str) -> Record:
    """Run one free body. ``body_qd`` has the velocity first, then ω in space; numbers have 32 bits."""
    import newton
    import warp
    from scipy.spatial.transform import Rotation

    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    builder.add_body(mass=1.0, inertia=warp.mat33(TENSOR), com=warp.vec3(0.0))
    model = builder.finalize(device="cpu")
    steps, state, after = getattr(newton.solvers, solver)(model), model.state(), model.state()
    start = np.array([0.0, 0.0, 0.0, *OMEGA], dtype=np.float32)
    state.body_qd.assign(start[None])
    state.joint_qd.assign(start)
    rows = []
    for k in range(round(END / STEP) + 1):
        q = state.body_q.numpy()[0, 3:].astype(np.float64)
        omega = Rotation.from_quat(q).inv().apply(state.body_qd.numpy()[0, 3:])
        rows.append((k * STEP, *q, *omega))
        state.clear_forces()
        steps.step(state, after, model.control(), None, STEP)
        state, after = after, state
    t, quaternion, rates = np.split(np.array(rows), [1, 5], axis=1)
    return t[:, 0], quaternion, rates


ENGINES: list[tuple[str, str, str, Callable[[], Record]]] = [
    ("MuJoCo", "mujoco", "RK4", lambda: mujoco("RK4")),
    ("MuJoCo", "mujoco", "implicit", lambda: mujoco("implicit")),
    ("MuJoCo", "mujoco", "implicitfast", lambda: mujoco("implicitfast")),
    ("MuJoCo", "mujoco", "Euler", lambda: mujoco("Euler")),
    ("MuJoCo", "mujoco", "RK4, `qpos` as it stands", lambda: mujoco("RK4", scalar_last=False)),
    (
        "MuJoCo",
        "mujoco",
        "RK4, diagonal of the tensor only",
        lambda: mujoco("RK4", tensor=np.diag(np.diag(TENSOR))),
    ),
    ("Drake", "drake", "error control, 1e-8", drake),
    ("Pinocchio", "pin", "`aba`, first-order steps", pinocchio),
    ("Basilisk", "bsk", "RK4", basilisk),
    ("Newton", "newton", "`SolverXPBD`", lambda: newton("SolverXPBD")),
    ("Newton", "newton", "`SolverSemiImplicit`, as it stands", lambda: newton("SolverSemiImplicit")),
    ("Bullet", "pybullet", "reduced coordinates", bullet),
    ("Bullet", "pybullet", "maximal coordinates", lambda: bullet(maximal=True)),
    (
        "Bullet",
        "pybullet",
        "maximal coordinates, ω as it stands",
        lambda: bullet(maximal=True, in_body=False),
    ),
]


def table() -> str:
    """Return the table of all engines that are installed."""
    lines = [
        "| engine | how | energy drift | drift of L | angle from exact, rad | findings |",
        "|---|---|---|---|---|---|",
    ]
    bodies = {"Bullet": RigidBody(1.0, np.diag(MOMENTS))}
    for name, package, how, run in ENGINES:
        try:
            told = version(package)
        except PackageNotFoundError:
            continue
        t, quaternion, omega = run()
        body = bodies.get(name, RigidBody(1.0, TENSOR))
        found = polhode.audit(Trajectory.from_samples(body, t, quaternion, omega))
        numbers = (
            np.abs(found.energy_drift).max(),
            found.angular_momentum_drift.max(),
            found.angle_from_exact.max(),
        )
        kinds = ", ".join(one.kind for one in found.findings) or (
            "none" if found.agrees else "none explains it"
        )
        lines.append(
            f"| {name} {told} | {how} | " + " | ".join(f"{x:.1e}" for x in numbers) + f" | {kinds} |"
        )
    return "\n".join(lines)


if __name__ == "__main__":
    print(table())
