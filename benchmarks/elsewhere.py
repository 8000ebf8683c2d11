"""The same problem in other programs: what it takes to write, to wait for, and how good the answer is.

``python benchmarks/pages.py`` runs these and keeps the numbers for the pages. Each function is shown
as it stands.
"""

from __future__ import annotations

from typing import Any

import numpy as np

MOMENTS = (0.8, 1.3, 1.9)  # kg m²
SPIN = (0.05, 3.0, 0.02)  # rad/s, nearly about the middle axis
TIMES = np.linspace(0.0, 60.0, 601)


def motion_polhode() -> Any:
    from polhode import RigidBody

    body = RigidBody.from_principal(1.0, MOMENTS)
    states = body.free_motion(SPIN).at(TIMES)
    return states.omega, states.quaternion


def motion_scipy() -> Any:
    from scipy.integrate import solve_ivp

    inertia = np.array(MOMENTS)

    def rates(_t: float, state: Any) -> Any:
        omega, (x, y, z, w) = state[:3], state[3:]
        p, q, r = omega
        turn = 0.5 * np.array(
            [w * p + y * r - z * q, w * q + z * p - x * r, w * r + x * q - y * p, -x * p - y * q - z * r]
        )
        return np.concatenate([-np.cross(omega, inertia * omega) / inertia, turn])

    found = solve_ivp(
        rates, (0.0, TIMES[-1]), [*SPIN, 0, 0, 0, 1], method="DOP853", t_eval=TIMES, rtol=1e-12, atol=1e-12
    )
    return found.y[:3].T, found.y[3:].T


def motion_sympy() -> Any:
    import sympy as sp
    import sympy.physics.mechanics as me
    from scipy.integrate import solve_ivp

    q = me.dynamicsymbols("q1:4")
    u = me.dynamicsymbols("u1:4")
    space, frame, point = me.ReferenceFrame("N"), me.ReferenceFrame("B"), me.Point("C")
    frame.orient_body_fixed(space, q, "XYZ")
    kinematic = [ui - wi for ui, wi in zip(u, frame.ang_vel_in(space).to_matrix(frame), strict=True)]
    frame.set_ang_vel(space, u[0] * frame.x + u[1] * frame.y + u[2] * frame.z)
    point.set_vel(space, 0)
    body = me.RigidBody("body", point, frame, 1, (me.inertia(frame, *MOMENTS), point))
    method = me.KanesMethod(space, q_ind=q, u_ind=u, kd_eqs=kinematic)
    method.kanes_equations([body], [])
    rates = sp.lambdify([(*q, *u)], [sp.simplify(e) for e in method.rhs()], "numpy", cse=True)
    found = solve_ivp(
        lambda _t, state: rates(state),
        (0.0, TIMES[-1]),
        [0, 0.1, 0, *SPIN],  # these angles are singular where the second is a right angle
        method="DOP853",
        t_eval=TIMES,
        rtol=1e-12,
        atol=1e-12,
    )
    return found.y[3:].T, found.y[:3].T


def motion_mujoco() -> Any:
    import mujoco

    a, b, c = MOMENTS
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco><option gravity="0 0 0" timestep="0.001" integrator="RK4"/><worldbody><body>
        <freejoint/><inertial pos="0 0 0" mass="1" diaginertia="{a} {b} {c}"/></body></worldbody></mujoco>"""
    )
    data = mujoco.MjData(model)
    data.qvel[3:] = SPIN
    rates, attitude = [], []
    for time in TIMES:
        while data.time < time - 0.0005:
            mujoco.mj_step(model, data)
        rates.append(data.qvel[3:].copy())
        attitude.append(data.qpos[3:].copy())
    return np.array(rates), np.array(attitude)


def motion_heyoka() -> Any:
    import heyoka as hy

    p, q, r, x, y, z, w = hy.make_vars("p", "q", "r", "x", "y", "z", "w")
    a, b, c = MOMENTS
    system = [
        (p, (b - c) / a * q * r),
        (q, (c - a) / b * r * p),
        (r, (a - b) / c * p * q),
        (x, 0.5 * (w * p + y * r - z * q)),
        (y, 0.5 * (w * q + z * p - x * r)),
        (z, 0.5 * (w * r + x * q - y * p)),
        (w, -0.5 * (x * p + y * q + z * r)),
    ]
    integrator = hy.taylor_adaptive(system, [*SPIN, 0.0, 0.0, 0.0, 1.0])
    found = integrator.propagate_grid(TIMES)[5]
    return found[:, :3], found[:, 3:]


def axes_polhode(tensors: Any) -> Any:
    from polhode import principal_axes

    found = principal_axes(tensors)
    return found.moments, found.axes


def axes_numpy(tensors: Any) -> Any:
    moments, axes = np.linalg.eigh(tensors)
    axes[np.linalg.det(axes) < 0, :, 2] *= -1  # right-handed
    return moments, axes


def axes_scipy(tensors: Any) -> Any:
    from scipy.linalg import eigh

    found = [eigh(tensor) for tensor in tensors]
    moments, axes = np.array([w for w, _ in found]), np.array([v for _, v in found])
    axes[np.linalg.det(axes) < 0, :, 2] *= -1  # right-handed
    return moments, axes


def tensors() -> Any:
    """A thousand bodies of eight particles each: their inertia tensors."""
    r = np.random.default_rng(7).normal(size=(1000, 8, 3))
    second = np.einsum("nki,nkj->nij", r, r)
    return np.trace(second, axis1=1, axis2=2)[:, None, None] * np.eye(3) - second


def particles_polhode(masses: Any, positions: Any) -> Any:
    from polhode import RigidBody

    return RigidBody.from_particles(masses, positions).inertia


def particles_numpy(masses: Any, positions: Any) -> Any:
    arms = positions - masses @ positions / masses.sum()
    second = arms.T @ (masses[:, None] * arms)
    return np.trace(second) * np.eye(3) - second


def cloud() -> tuple[Any, Any]:
    """A thousand particles, a hundred sizes away from the origin: masses and positions."""
    rng = np.random.default_rng(11)
    return rng.uniform(0.5, 1.5, 1000), rng.normal(size=(1000, 3)) + 100.0


def tensor_numpy(vertices: Any, faces: Any) -> Any:
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    six_volumes = np.einsum("ni,ni->n", a, np.cross(b, c))  # of tetrahedra with the origin
    total = a + b + c
    mass = 1000.0 * six_volumes.sum() / 6
    center = 1000.0 * six_volumes @ total / 24 / mass
    corners = sum(np.einsum("n,ni,nj->ij", six_volumes, x, x) for x in (a, b, c, total))
    second = 1000.0 * corners / 120 - mass * np.outer(center, center)
    return np.trace(second) * np.eye(3) - second


def mesh() -> tuple[Any, Any]:
    """A torus of 20 000 triangles: vertices and faces."""
    n, k = 200, 50
    u, v = np.meshgrid(np.arange(n) * 2 * np.pi / n, np.arange(k) * 2 * np.pi / k, indexing="ij")
    ring = 1.0 + 0.3 * np.cos(v)
    vertices = np.stack([ring * np.cos(u), ring * np.sin(u), 0.3 * np.sin(v)], axis=-1).reshape(-1, 3)
    i, j = (x.ravel() for x in np.meshgrid(np.arange(n), np.arange(k), indexing="ij"))
    a, b = i * k + j, (i + 1) % n * k + j
    c, d = (i + 1) % n * k + (j + 1) % k, i * k + (j + 1) % k
    return vertices, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def tensor_polhode(vertices: Any, faces: Any) -> Any:
    from polhode import RigidBody

    return RigidBody.from_mesh(vertices, faces, density=1000.0).inertia


def tensor_trimesh(vertices: Any, faces: Any) -> Any:
    import trimesh

    solid = trimesh.Trimesh(vertices, faces, process=False)
    assert solid.is_watertight  # not looked at unless asked
    assert solid.is_winding_consistent
    solid.density = 1000.0
    return solid.moment_inertia
