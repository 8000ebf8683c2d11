"""Type stubs of the compiled core; ``mypy.stubtest`` holds them against the built module."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, Literal, Self, TypeAlias, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import disjoint_base

from polhode._typing import SupportsQuaternion, SupportsSigma
from polhode.motion.free import Cones, ErrorBar, Periods, Poinsot, Sensitivity
from polhode.motion.gyrostat import Equilibria
from polhode.motion.rolling import RollingMotion
from polhode.motion.trajectory import Trajectory
from polhode.orbits import DipoleField, Orbit, SampledOrbit
from polhode.results import (
    AngularMomentum,
    ErrorBound,
    FreePrecession,
    KineticEnergy,
    MotionSensitivity,
    NutationDamping,
    Particles,
    PrincipalAxes,
    Provenance,
    Sigma,
    State,
)
from polhode.uncertainty.motion import FromPeriods, PeriodsSigma

__all__ = [
    "Contact",
    "FreeMotion",
    "Gyrostat",
    "GyrostatMotion",
    "HeavyTop",
    "Load",
    "MassAccumulator",
    "Region",
    "RigidBody",
    "RuledSurface",
    "Slabs",
    "Stepper",
    "Surface",
    "Uncertain",
    "VaryingBody",
    "Wheel",
    "__version__",
    "angular_velocity_from_euler_rates",
    "annulus",
    "arc",
    "attitudes",
    "box",
    "callback",
    "canonical_axes",
    "capsule",
    "classify_tops",
    "compiled",
    "cone",
    "constant_force",
    "constant_torque",
    "contact_history",
    "contact_invariants",
    "covariance_factor",
    "cube",
    "cylinder",
    "damping",
    "dipole_field",
    "disk",
    "ellipse",
    "ellipsoid",
    "euler_angles_from_quaternion",
    "euler_rates",
    "feedback",
    "fit_tumble",
    "free_precession",
    "from_log_cholesky",
    "from_parameters",
    "from_pseudo_inertia",
    "from_spatial_inertia",
    "frustum",
    "gravity_gradient",
    "hemisphere",
    "hollow_sphere",
    "impulses",
    "inertia_from_center_of_mass",
    "inertia_to_center_of_mass",
    "kepler_period",
    "kepler_states",
    "labelled_voxels",
    "least_spin",
    "local_frames",
    "machine",
    "magnetic",
    "motion_sensitivity",
    "nearest_valid",
    "nutation_damping",
    "oblate_states",
    "panels",
    "polygon",
    "principal_axes",
    "principal_derivative",
    "principal_gaps",
    "principal_moments",
    "prism",
    "pyramid",
    "quaternion_from_euler_angles",
    "quaternion_from_matrix",
    "random_numbers",
    "rates",
    "ray_kappa",
    "read_plates",
    "read_stl",
    "real_numbers",
    "rectangle",
    "region_ball",
    "region_box",
    "region_cylinder",
    "region_ellipsoid",
    "region_mesh",
    "ring",
    "rod",
    "rolling_critical_rate",
    "rolling_modes",
    "rolling_plane",
    "rolling_states",
    "rolling_steady",
    "rolling_tippe_top",
    "rotate",
    "rotor",
    "ruled_cone",
    "ruled_cylinder",
    "sampled",
    "sampled_states",
    "schedule",
    "slug",
    "sphere",
    "steady_precession",
    "stick",
    "stream_solid",
    "surface_area",
    "surface_disk",
    "surface_ellipsoid",
    "surface_paraboloid",
    "surface_sphere",
    "surface_torus",
    "tetrahedron",
    "thrusters",
    "to_log_cholesky",
    "to_parameters",
    "to_positive_products",
    "to_pseudo_inertia",
    "to_spatial_inertia",
    "torque_callback",
    "torus",
    "transport",
    "triangle",
    "tube",
    "tumble_information",
    "uniform_gravity",
    "wedge",
    "wheel",
    "wheels",
    "white_noise",
    "with_states",
    "within_box",
]

_Floats: TypeAlias = NDArray[np.float64]
_Reference: TypeAlias = Literal["center_of_mass", "com", "origin"]
_About: TypeAlias = _Reference | ArrayLike
_SpatialOrder: TypeAlias = Literal["angular-linear", "linear-angular"]
_Attitude: TypeAlias = ArrayLike | SupportsQuaternion
_WithStates: TypeAlias = Callable[[float, _Floats, _Floats, _Floats, _Floats, dict[str, _Floats]], Any]
_Number: TypeAlias = float | Uncertain | SupportsSigma
_Row: TypeAlias = ArrayLike | _Number | Sequence[_Number]
_Numbers: TypeAlias = ArrayLike | _Number | Sequence[_Row]

__version__: str

@final
class FreeMotion:
    @property
    def body(self) -> RigidBody: ...
    @property
    def omega(self) -> _Floats: ...
    @property
    def quaternion(self) -> _Floats: ...
    @property
    def uncertain_start(self) -> tuple[Uncertain | None, Uncertain | None]: ...
    @property
    def shape(self) -> tuple[int, ...]: ...
    def at(self, t: ArrayLike) -> Trajectory: ...
    def animate(self, path: str | PathLike[str], end: float, **options: Any) -> Path: ...
    def plot(self, end: float, ax: Any = None) -> Any: ...
    @property
    def mode(self) -> Any: ...
    def angular_momentum(self, frame: Literal["space", "body"] = "space") -> AngularMomentum: ...
    def kinetic_energy(self) -> KineticEnergy: ...
    @property
    def energy_ratio(self) -> Any: ...
    @property
    def modulus(self) -> Any: ...
    @property
    def complementary_modulus(self) -> Any: ...
    @property
    def periods(self) -> Periods: ...
    def _periods_sigma(self) -> PeriodsSigma | None: ...
    @property
    def _from_periods(self) -> FromPeriods | None: ...
    @property
    def nutation(self) -> _Floats: ...
    @property
    def cones(self) -> Cones: ...
    def stability(self) -> _Floats: ...
    def polhode(self, n: int = 181) -> _Floats: ...
    def herpolhode(self, t: ArrayLike) -> _Floats: ...
    def poinsot(self, t: ArrayLike) -> Poinsot: ...
    def sensitivity(self, t: ArrayLike) -> Sensitivity: ...
    def error_bar(self, t: ArrayLike, rtol: float = 2.220446049250313e-16) -> ErrorBar: ...
    @staticmethod
    def _from_start(
        body: RigidBody,
        omega: ArrayLike,
        quaternion: ArrayLike,
        uncertain_start: tuple[Uncertain | None, Uncertain | None],
        from_periods: FromPeriods | None = None,
    ) -> FreeMotion: ...
    def __copy__(self) -> FreeMotion: ...
    def __deepcopy__(self, memo: object, /) -> FreeMotion: ...

@final
class Gyrostat:
    @property
    def body(self) -> RigidBody: ...
    @property
    def momentum(self) -> _Floats: ...
    @property
    def wheels(self) -> tuple[Wheel, ...]: ...
    @property
    def shape(self) -> tuple[int, ...]: ...
    @property
    def inertia(self) -> _Floats: ...
    def free_motion(self, omega: ArrayLike, attitude: _Attitude | None = None) -> GyrostatMotion: ...
    def equilibria(self, momentum: float) -> Equilibria: ...
    def _rotor(self) -> tuple[_Floats, _Floats]: ...
    @staticmethod
    def _from_parts(body: RigidBody, momentum: ArrayLike, wheels: tuple[Wheel, ...]) -> Gyrostat: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __copy__(self) -> Gyrostat: ...
    def __deepcopy__(self, memo: object, /) -> Gyrostat: ...

@final
class GyrostatMotion:
    @property
    def gyrostat(self) -> Gyrostat: ...
    @property
    def body(self) -> RigidBody: ...
    @property
    def omega(self) -> _Floats: ...
    @property
    def quaternion(self) -> _Floats: ...
    @property
    def shape(self) -> tuple[int, ...]: ...
    @property
    def mode(self) -> Any: ...
    @property
    def periods(self) -> Periods: ...
    @property
    def mean_precession(self) -> Any: ...
    @property
    def rotor(self) -> _Floats: ...
    def angular_momentum(self, frame: Literal["space", "body"] = "space") -> AngularMomentum: ...
    def kinetic_energy(self) -> KineticEnergy: ...
    def equilibria(self) -> Equilibria: ...
    def at(self, t: ArrayLike) -> Trajectory: ...
    def animate(self, path: str | PathLike[str], end: float, **options: Any) -> Path: ...
    def plot(self, end: float, ax: Any = None) -> Any: ...
    @staticmethod
    def _from_start(gyrostat: Gyrostat, omega: ArrayLike, quaternion: ArrayLike) -> GyrostatMotion: ...
    def __copy__(self) -> GyrostatMotion: ...
    def __deepcopy__(self, memo: object, /) -> GyrostatMotion: ...

@final
class Uncertain:
    def __new__(
        cls,
        value: ArrayLike | SupportsQuaternion,
        sigma: ArrayLike | None = None,
        *,
        covariance: ArrayLike | None = None,
        source: str | None = None,
    ) -> Self: ...
    @property
    def value(self) -> Any: ...
    @property
    def sigma(self) -> Any: ...
    @property
    def covariance(self) -> _Floats: ...
    @property
    def source(self) -> str | None: ...
    def __float__(self) -> float: ...
    def __array__(self, *_args: object, **_options: object) -> Any: ...
    def _forms(self) -> list[list[tuple[tuple[int, int], float]]]: ...
    @staticmethod
    def _restored(
        value: Any,
        sigma: Any,
        covariance: Any,
        source: str | None,
        variables: list[list[tuple[tuple[int, int], float]]],
        by_sigma: bool,
    ) -> Uncertain: ...

@final
class RigidBody:
    __array_ufunc__: None
    def __new__(
        cls,
        mass: _Numbers,
        inertia: _Numbers | None = None,
        center_of_mass: _Numbers = (0.0, 0.0, 0.0),
        *,
        inertia_about_origin: _Numbers | None = None,
        rtol: float | None = None,
    ) -> Self: ...
    @staticmethod
    def from_principal(
        mass: _Numbers,
        moments: _Numbers,
        axes: _Attitude | None = None,
        center_of_mass: _Numbers = (0.0, 0.0, 0.0),
        *,
        rtol: float | None = None,
    ) -> RigidBody: ...
    def gyrostat(
        self, momentum: ArrayLike | None = None, *, wheels: Iterable[Wheel] | None = None
    ) -> Gyrostat: ...
    @staticmethod
    def from_positive_products(
        mass: _Numbers,
        moments: _Numbers,
        products: _Numbers,
        center_of_mass: _Numbers = (0.0, 0.0, 0.0),
        *,
        rtol: float | None = None,
    ) -> RigidBody: ...
    @staticmethod
    def from_tetrahedra(
        nodes: ArrayLike,
        cells: ArrayLike,
        *,
        density: ArrayLike,
        at: Literal["cells", "nodes"] | None = None,
    ) -> RigidBody: ...
    @staticmethod
    def from_density(
        density: Callable[[_Floats], ArrayLike],
        bounds: Region | ArrayLike,
        *,
        rtol: float = 1e-9,
        max_evaluations: int = 10_000_000,
    ) -> RigidBody: ...
    @staticmethod
    def from_radial_density(
        density: Callable[[_Floats], ArrayLike],
        radii: ArrayLike,
        *,
        rtol: float = 1e-9,
        max_evaluations: int = 1_000_000,
    ) -> RigidBody: ...
    @staticmethod
    def from_particles(masses: _Numbers, positions: _Numbers) -> RigidBody: ...
    @staticmethod
    @overload
    def from_labelled_particles(
        masses: ArrayLike, positions: ArrayLike, labels: ArrayLike, *, return_labels: Literal[False] = ...
    ) -> RigidBody: ...
    @staticmethod
    @overload
    def from_labelled_particles(
        masses: ArrayLike, positions: ArrayLike, labels: ArrayLike, *, return_labels: Literal[True]
    ) -> tuple[NDArray[np.int64], RigidBody]: ...
    @staticmethod
    def from_balls(
        centers: ArrayLike, radii: ArrayLike, *, density: _Number | None = None, mass: _Number | None = None
    ) -> RigidBody: ...
    @staticmethod
    def from_voxels(
        density: ArrayLike,
        spacing: ArrayLike | None = None,
        origin: ArrayLike = (0.0, 0.0, 0.0),
        *,
        affine: ArrayLike | None = None,
    ) -> RigidBody: ...
    @staticmethod
    def from_labelled_voxels(
        labels: ArrayLike | PathLike[str],
        density: ArrayLike | Mapping[int | str, float],
        *,
        spacing: ArrayLike | None = None,
        origin: ArrayLike = (0.0, 0.0, 0.0),
        affine: ArrayLike | None = None,
        length_unit: str | None = None,
    ) -> tuple[NDArray[np.int64], RigidBody]: ...
    @staticmethod
    def from_mesh(
        vertices: _Numbers,
        faces: ArrayLike,
        *,
        density: _Number | None = None,
        mass: _Number | None = None,
        closure: Literal["caps", "hull"] | None = None,
        orient: bool = False,
        check: bool = True,
    ) -> RigidBody: ...
    @staticmethod
    def from_surface(
        vertices: ArrayLike,
        faces: ArrayLike,
        *,
        areal_density: _Number | None = None,
        density: _Number | None = None,
        mass: _Number | None = None,
        thickness: float | None = None,
    ) -> RigidBody: ...
    @staticmethod
    def from_curve(
        points: ArrayLike, *, linear_density: _Number | None = None, mass: _Number | None = None
    ) -> RigidBody: ...
    @staticmethod
    def from_file(
        path: str | PathLike[str],
        *,
        density: _Number | Mapping[Any, _Number] | Callable[[NDArray[Any]], ArrayLike] | None = None,
        mass: _Number | None = None,
        length_unit: str | None = None,
        thickness: float | None = None,
        weld: float = 0.0,
        closure: Literal["caps", "hull"] | None = None,
        orient: bool = False,
        union: bool = False,
        repair: bool = False,
        index_base: Literal[0, 1] = 1,
        masses: Literal["most_common", "average"] = "most_common",
        progress: Callable[[float], object] | None = None,
    ) -> RigidBody: ...
    @staticmethod
    def from_mesh_object(
        mesh: Any, *, density: _Number | None = None, mass: _Number | None = None, **options: Any
    ) -> RigidBody: ...
    @staticmethod
    def from_atoms(
        atoms: Any, *, conformer: int | None = None, masses: Literal["most_common", "average"] = "most_common"
    ) -> RigidBody: ...
    @staticmethod
    def stack(bodies: Iterable[RigidBody]) -> RigidBody: ...
    @staticmethod
    def varying(t: ArrayLike, bodies: RigidBody, outlet: ArrayLike | None = None) -> VaryingBody: ...
    def save(self, path: str | PathLike[str]) -> None: ...
    def plot(self, ax: Any = None, **options: Any) -> Any: ...
    def view(self, plotter: Any = None, **options: Any) -> Any: ...
    def _repr_html_(self) -> str: ...
    @staticmethod
    def _from_numbers(
        numbers: ArrayLike, doubts: dict[str, Any] | None = None, figures: list[Any] | None = None
    ) -> RigidBody: ...
    def _figures(self) -> list[Any] | None: ...
    @staticmethod
    def _from_mesh(
        vertices: ArrayLike,
        faces: ArrayLike | None = None,
        *,
        density: _Number | None = None,
        mass: _Number | None = None,
        closure: Literal["caps", "hull"] | None = None,
        orient: bool = False,
        check: bool = True,
    ) -> tuple[RigidBody, float]: ...
    def _doubts(self) -> dict[str, Any] | None: ...
    def _probes(self) -> _Floats: ...
    def with_sigma(
        self,
        *,
        mass: ArrayLike | None = None,
        center_of_mass: ArrayLike | None = None,
        inertia: ArrayLike | None = None,
        source: str | None = None,
    ) -> RigidBody: ...
    def with_covariance(self, covariance: ArrayLike, source: str | None = None) -> RigidBody: ...
    def with_error_bound(self) -> RigidBody: ...
    @property
    def covariance(self) -> _Floats | None: ...
    def covariance_with(self, other: RigidBody) -> _Floats: ...
    @property
    def sigma(self) -> Sigma | None: ...
    def sigma_about(self, about: _About) -> Sigma | None: ...
    @property
    def mass(self) -> Any: ...
    @property
    def center_of_mass(self) -> _Floats: ...
    @property
    def inertia(self) -> _Floats: ...
    @property
    def principal_moments(self) -> _Floats: ...
    @property
    def principal(self) -> PrincipalAxes: ...
    @property
    def radii_of_gyration(self) -> _Floats: ...
    @property
    def provenance(self) -> Provenance: ...
    @property
    def error_bound(self) -> ErrorBound: ...
    def inertia_about(self, about: _About) -> _Floats: ...
    def moment_about(self, axis: ArrayLike, about: _About = "center_of_mass") -> Any: ...
    def principal_about(self, about: _About) -> PrincipalAxes: ...
    def translated(self, displacement: _Numbers) -> RigidBody: ...
    def rotated(self, rotation: _Attitude | Uncertain) -> RigidBody: ...
    def mirrored(self, normal: ArrayLike, point: ArrayLike = (0.0, 0.0, 0.0)) -> RigidBody: ...
    def cut(self, normal: ArrayLike, point: ArrayLike = (0.0, 0.0, 0.0)) -> RigidBody: ...
    def scaled(self, length: _Numbers = 1.0, mass: _Numbers = 1.0) -> RigidBody: ...
    def isclose(self, other: RigidBody, rtol: float = 1e-9, atol: float = 0.0) -> Any: ...
    def kinetic_energy(
        self, omega: ArrayLike, velocity: ArrayLike = (0.0, 0.0, 0.0), about: _About = "center_of_mass"
    ) -> KineticEnergy: ...
    def angular_momentum(
        self,
        omega: ArrayLike,
        velocity: ArrayLike = (0.0, 0.0, 0.0),
        position: ArrayLike = (0.0, 0.0, 0.0),
        about: _About = "center_of_mass",
    ) -> AngularMomentum: ...
    def angular_acceleration(
        self, omega: ArrayLike, torque: ArrayLike = (0.0, 0.0, 0.0), about: _About = "center_of_mass"
    ) -> _Floats: ...
    def torque(
        self,
        omega: ArrayLike,
        angular_acceleration: ArrayLike = (0.0, 0.0, 0.0),
        about: _About = "center_of_mass",
    ) -> _Floats: ...
    def point_velocity(
        self,
        point: _About,
        omega: ArrayLike,
        velocity: ArrayLike = (0.0, 0.0, 0.0),
        about: _About = "center_of_mass",
    ) -> _Floats: ...
    def point_acceleration(
        self,
        point: _About,
        omega: ArrayLike,
        angular_acceleration: ArrayLike = (0.0, 0.0, 0.0),
        acceleration: ArrayLike = (0.0, 0.0, 0.0),
        about: _About = "center_of_mass",
    ) -> _Floats: ...
    def pivot_reaction(
        self,
        omega: ArrayLike,
        angular_acceleration: ArrayLike = (0.0, 0.0, 0.0),
        attitude: _Attitude | None = None,
        gravity: ArrayLike = (0.0, 0.0, 0.0),
        force: ArrayLike = (0.0, 0.0, 0.0),
        about: _About = "origin",
    ) -> _Floats: ...
    def stability(self, rate: ArrayLike, about: _About = "center_of_mass") -> _Floats: ...
    def equimomental_particles(self) -> Particles: ...
    def free_motion(self, omega: _Numbers, attitude: _Attitude | Uncertain | None = None) -> FreeMotion: ...
    def free_motion_from_periods(
        self,
        rotation_period: ArrayLike | Uncertain,
        precession_period: ArrayLike | Uncertain,
        mode: Literal["long-axis", "short-axis"],
        sense: float = 1.0,
        phase: ArrayLike = 0.0,
        angular_momentum_direction: ArrayLike = (0.0, 0.0, 1.0),
    ) -> FreeMotion: ...
    def heavy_top(
        self,
        omega: _Numbers,
        attitude: _Attitude | Uncertain | None = None,
        gravity: ArrayLike | None = None,
        *,
        rtol: float = 1e-06,
    ) -> HeavyTop: ...
    def rolling_motion(
        self,
        surface: Surface | RuledSurface,
        omega: ArrayLike,
        attitude: _Attitude | None = None,
        gravity: ArrayLike = (0.0, 0.0, -9.81),
        turntable: float = 0.0,
    ) -> RollingMotion: ...
    def simulate(
        self,
        t: ArrayLike,
        omega: _Numbers,
        attitude: _Attitude | Uncertain | None = None,
        *,
        load: Load | None = None,
        contact: Contact | None = None,
        position: ArrayLike | None = None,
        velocity: ArrayLike | None = None,
        about: _Reference = "center_of_mass",
        method: Literal["auto", "exact", "taylor", "dop853", "radau", "splitting"] = "auto",
        rtol: float = 1e-10,
        atol: float | None = None,
        events: Callable[..., float] | Iterable[Callable[..., float]] | None = None,
        on_failure: Literal["raise", "keep"] = "raise",
        progress: Callable[[float], object] | None = None,
        states: dict[str, Any] | None = None,
        max_steps: int | None = None,
    ) -> Trajectory: ...
    def stepper(
        self,
        omega: _Numbers,
        attitude: _Attitude | Uncertain | None = None,
        *,
        load: Load | None = None,
        start: float = 0.0,
        position: ArrayLike | None = None,
        velocity: ArrayLike | None = None,
        about: _Reference = "center_of_mass",
        method: Literal["auto", "exact", "taylor", "dop853", "radau", "splitting"] = "auto",
        rtol: float = 1e-10,
        atol: float | None = None,
        events: Callable[..., float] | Iterable[Callable[..., float]] | None = None,
        states: dict[str, Any] | None = None,
        max_steps: int | None = None,
    ) -> Stepper: ...
    @property
    def shape(self) -> tuple[int, ...]: ...
    def _of_atoms(self, masses: Literal["most_common", "average", "own"], rounding: float) -> RigidBody: ...
    def _welded(self, corners: int) -> RigidBody: ...
    def __len__(self) -> int: ...
    def __getitem__(self, key: Any, /) -> RigidBody: ...
    def __bool__(self) -> Literal[True]: ...
    def __iter__(self) -> Iterator[RigidBody]: ...
    def __add__(self, other: RigidBody, /) -> RigidBody: ...
    def __radd__(self, other: int, /) -> RigidBody: ...
    def __sub__(self, other: RigidBody, /) -> RigidBody: ...
    def __rsub__(self, other: RigidBody, /) -> RigidBody: ...
    def combined(self, axis: int | tuple[int, ...] | None = None) -> RigidBody: ...
    def __copy__(self) -> RigidBody: ...
    def __deepcopy__(self, memo: object, /) -> RigidBody: ...
    def __hash__(self) -> int: ...

@final
class Stepper:
    @property
    def t(self) -> float: ...
    @property
    def status(self) -> Literal["complete", "event"]: ...
    def step(self, dt: float, load: Load | None = None) -> State: ...
    def state(self) -> State: ...
    def trajectory(self) -> Trajectory: ...

@final
class VaryingBody:
    @property
    def t(self) -> _Floats: ...
    @property
    def bodies(self) -> RigidBody: ...
    @property
    def outlet(self) -> _Floats | None: ...
    def at(self, t: ArrayLike) -> RigidBody: ...
    def simulate(
        self,
        t: ArrayLike,
        omega: ArrayLike,
        attitude: _Attitude | None = None,
        *,
        load: Load | None = None,
        position: ArrayLike | None = None,
        velocity: ArrayLike | None = None,
        about: _Reference = "center_of_mass",
        method: Literal["auto", "dop853", "radau"] = "auto",
        rtol: float = 1e-10,
        atol: float | None = None,
        events: Callable[..., float] | Iterable[Callable[..., float]] | None = None,
        on_failure: Literal["raise", "keep"] = "raise",
        progress: Callable[[float], object] | None = None,
        states: dict[str, Any] | None = None,
        max_steps: int | None = None,
    ) -> Trajectory: ...
    def torque_of_change(
        self, t: ArrayLike, omega: ArrayLike, about: _Reference = "center_of_mass"
    ) -> _Floats: ...
    def __reduce__(self) -> tuple[Any, ...]: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Region: ...

@final
class Surface:
    def contact(self, normal: ArrayLike) -> _Floats: ...
    def curvatures(self, normal: ArrayLike) -> _Floats: ...

@final
class RuledSurface:
    def line_of_contact(self, normal: ArrayLike) -> _Floats: ...

@final
class Contact:
    @property
    def surface(self) -> Surface: ...
    @property
    def normal(self) -> _Floats: ...
    @property
    def point(self) -> _Floats: ...
    @property
    def turntable(self) -> float: ...
    @property
    def lift(self) -> str: ...
    @property
    def law(self) -> str: ...
    @property
    def friction(self) -> float | None: ...
    @property
    def viscous(self) -> float | tuple[str, float] | None: ...
    @property
    def resistance(self) -> tuple[float, float, float] | None: ...

@final
class Slabs: ...

@final
class MassAccumulator:
    def __new__(cls) -> Self: ...
    def add(self, masses: ArrayLike, positions: ArrayLike, start: int | None = None) -> None: ...
    def merge(self, other: MassAccumulator) -> None: ...
    def finish(self) -> RigidBody: ...
    def moment_bounds(self) -> _Floats: ...
    @property
    def count(self) -> int: ...

@final
class HeavyTop:
    @property
    def body(self) -> RigidBody: ...
    @property
    def omega(self) -> _Floats: ...
    @property
    def quaternion(self) -> _Floats: ...
    @property
    def gravity(self) -> _Floats: ...
    @property
    def uncertain_start(self) -> tuple[Uncertain | None, Uncertain | None]: ...
    @property
    def shape(self) -> tuple[int, ...]: ...
    @property
    def mode(self) -> Any: ...
    @property
    def nutation_limits(self) -> _Floats: ...
    @property
    def nutation_period(self) -> Any: ...
    @property
    def mean_precession(self) -> Any: ...
    @property
    def mean_spin(self) -> Any: ...
    @property
    def axial_spin(self) -> Any: ...
    @property
    def sleeping_limit(self) -> Any: ...
    def effective_potential(self, inclination: ArrayLike, *, degrees: bool = False) -> _Floats: ...
    def at(self, t: ArrayLike) -> Trajectory: ...
    def animate(self, path: str | PathLike[str], end: float, **options: Any) -> Path: ...
    def plot(self, end: float, ax: Any = None) -> Any: ...
    def __copy__(self) -> HeavyTop: ...
    def __deepcopy__(self, memo: object, /) -> HeavyTop: ...

@disjoint_base
class Load:
    __array_ufunc__: None
    def torque(
        self,
        t: ArrayLike,
        omega: ArrayLike,
        quaternion: _Attitude,
        position: ArrayLike | None = None,
        velocity: ArrayLike | None = None,
        *,
        body: RigidBody | None = None,
        about: _Reference = "center_of_mass",
        start: float | None = None,
        states: dict[str, Any] | None = None,
    ) -> _Floats: ...
    def force(
        self,
        t: ArrayLike,
        omega: ArrayLike,
        quaternion: _Attitude,
        position: ArrayLike | None = None,
        velocity: ArrayLike | None = None,
        *,
        body: RigidBody | None = None,
        about: _Reference = "center_of_mass",
        start: float | None = None,
        states: dict[str, Any] | None = None,
    ) -> _Floats: ...
    def potential(
        self,
        body: RigidBody,
        quaternion: _Attitude,
        position: ArrayLike | None = None,
        about: _Reference = "center_of_mass",
    ) -> _Floats | None: ...
    def carried(
        self, t: ArrayLike, omega: ArrayLike, states: dict[str, Any] | None = None
    ) -> tuple[_Floats, _Floats]: ...
    @property
    def carries(self) -> bool: ...
    @property
    def states(self) -> dict[str, int]: ...
    def keeps_momentum(self, about: _Reference = "center_of_mass") -> Literal[True] | _Floats | None: ...
    def with_epoch(self, t: float) -> Load: ...
    @property
    def shape(self) -> tuple[int, ...]: ...
    def __getitem__(self, key: Any, /) -> Load: ...
    @staticmethod
    def _from_parts(parts: Iterable[Any]) -> Load: ...
    def __add__(self, other: Load, /) -> Load: ...
    def __radd__(self, other: int, /) -> Load: ...
    def __sub__(self, other: Load, /) -> Load: ...
    def __rsub__(self, other: Load, /) -> Load: ...
    def __neg__(self) -> Load: ...
    def __mul__(self, factor: float, /) -> Load: ...
    def __rmul__(self, factor: float, /) -> Load: ...
    def __copy__(self) -> Load: ...
    def __deepcopy__(self, memo: object, /) -> Load: ...

@final
class Wheel(Load):
    @property
    def axis(self) -> _Floats: ...
    @property
    def inertia(self) -> Any: ...
    @property
    def momentum(self) -> Any: ...
    @property
    def rate(self) -> Any: ...
    @property
    def mode(self) -> Literal["free", "held", "driven"]: ...
    @property
    def name(self) -> str: ...
    @property
    def motor(self) -> Any: ...
    @property
    def speed(self) -> Any: ...
    @property
    def times(self) -> Any: ...
    @property
    def friction(self) -> Any: ...
    @property
    def dry_friction(self) -> Any: ...
    @property
    def max_torque(self) -> Any: ...
    @property
    def max_momentum(self) -> Any: ...
    @property
    def max_rate(self) -> Any: ...
    @property
    def allocation(self) -> Any: ...
    @staticmethod
    def _of(
        axis: ArrayLike, inertia: ArrayLike, rate: ArrayLike, momentum: ArrayLike, mode: str, name: str
    ) -> Wheel: ...
    def __getitem__(self, key: Any, /) -> Wheel: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...
    def __copy__(self) -> Wheel: ...
    def __deepcopy__(self, memo: object, /) -> Wheel: ...

def machine() -> tuple[str, int]: ...
def principal_axes(inertia: ArrayLike, canonical: bool = False) -> PrincipalAxes: ...
def principal_moments(inertia: ArrayLike) -> _Floats: ...
def canonical_axes(moments: ArrayLike, axes: ArrayLike, rtol: float) -> _Floats: ...
def principal_derivative(
    moments: ArrayLike, axes: ArrayLike, tangent: ArrayLike, rtol: float
) -> tuple[_Floats, _Floats, NDArray[np.bool_]]: ...
def ray_kappa(moments: ArrayLike) -> Any: ...
def dipole_field(strength: ArrayLike, position: ArrayLike) -> _Floats: ...
def kepler_period(mu: ArrayLike, position: ArrayLike, velocity: ArrayLike) -> _Floats: ...
def kepler_states(
    mu: ArrayLike, position: ArrayLike, velocity: ArrayLike, elapsed: ArrayLike
) -> tuple[_Floats, _Floats]: ...
def oblate_states(
    mu: ArrayLike,
    position: ArrayLike,
    velocity: ArrayLike,
    j2: ArrayLike,
    radius: ArrayLike,
    pole: ArrayLike,
    elapsed: ArrayLike,
) -> tuple[_Floats, _Floats]: ...
def local_frames(orbit: object, t: ArrayLike) -> tuple[_Floats, _Floats]: ...
def sampled_states(
    times: ArrayLike, position: ArrayLike, t: ArrayLike, velocity: ArrayLike | None = None
) -> tuple[_Floats, _Floats]: ...

# loads: written by rust/python/declared.py
def feedback(
    K: ArrayLike,  # noqa: N803
    D: ArrayLike,  # noqa: N803
    target: _Attitude | Orbit | SampledOrbit | None = None,
    *,
    rate: ArrayLike | None = None,
    times: ArrayLike | None = None,
    epoch: float | None = None,
) -> Load: ...
def gravity_gradient(
    mu: ArrayLike | Orbit | SampledOrbit,
    position: ArrayLike | None = None,
    velocity: ArrayLike | None = None,
    epoch: float | None = None,
) -> Load: ...
def magnetic(
    dipole: ArrayLike | Load,
    field: ArrayLike | DipoleField,
    *,
    gain: ArrayLike | None = None,
    times: ArrayLike | None = None,
    dipole_times: ArrayLike | None = None,
    max_dipole: ArrayLike | None = None,
) -> Load: ...
def thrusters(
    positions: ArrayLike,
    directions: ArrayLike,
    forces: ArrayLike,
    *,
    command: ArrayLike | _WithStates,
    period: float,
    min_on: float | None = None,
    max_on: float | None = None,
    deadband: float | None = None,
    times: ArrayLike | None = None,
    name: str = "thrusters",
) -> Load: ...
def torque_callback(function: Callable[[float, _Floats, _Floats], ArrayLike]) -> Load: ...
def callback(
    function: Callable[[float, _Floats, _Floats, _Floats, _Floats], tuple[ArrayLike, ArrayLike]],
) -> Load: ...
def compiled(
    function: object,
    user_data: int | None = None,
    *,
    initial: ArrayLike | None = None,
    name: str = "states",
    scale: ArrayLike | None = None,
) -> Load: ...
def with_states(
    rates: _WithStates | None,
    initial: ArrayLike,
    wrench: _WithStates | None = None,
    name: str = "states",
    *,
    update: _WithStates | None = None,
    period: float | None = None,
    scale: ArrayLike | None = None,
) -> Load: ...
def constant_torque(vector: ArrayLike, frame: Literal["body", "space"] = "body") -> Load: ...
def constant_force(
    vector: ArrayLike, frame: Literal["body", "space"] = "body", point: ArrayLike | None = None
) -> Load: ...
def uniform_gravity(gravity: ArrayLike) -> Load: ...
def damping(matrix: ArrayLike, quadratic: ArrayLike | None = None) -> Load: ...
def sampled(t: ArrayLike, torque: ArrayLike, frame: Literal["body", "space"] = "body") -> Load: ...
def schedule(load: Load, windows: ArrayLike) -> Load: ...
def rotor(momentum: ArrayLike) -> Load: ...
def slug(inertia: ArrayLike, damping: ArrayLike, name: str = "slug") -> Load: ...
def panels(
    surface: object,
    law: Literal["solar", "drag"] = "solar",
    *,
    coefficients: ArrayLike,
    direction: ArrayLike | None = None,
    pressure: ArrayLike | None = None,
    density: ArrayLike | None = None,
    velocity: ArrayLike | None = None,
    times: ArrayLike | None = None,
) -> Load: ...
def wheel(
    axis: ArrayLike,
    inertia: ArrayLike,
    rate: ArrayLike | None = None,
    *,
    torque: ArrayLike | Load | None = None,
    speed: ArrayLike | None = None,
    times: ArrayLike | None = None,
    friction: ArrayLike | None = None,
    dry_friction: ArrayLike | None = None,
    max_torque: ArrayLike | None = None,
    max_momentum: ArrayLike | None = None,
    max_rate: ArrayLike | None = None,
    allocation: ArrayLike | None = None,
    name: str = "wheel",
) -> Wheel: ...
def wheels(
    axes: ArrayLike,
    inertias: ArrayLike,
    *,
    torque: Load,
    allocation: str | ArrayLike = "pseudo-inverse",
    rate: ArrayLike | None = None,
    friction: ArrayLike | None = None,
    dry_friction: ArrayLike | None = None,
    max_torque: ArrayLike | None = None,
    max_momentum: ArrayLike | None = None,
    max_rate: ArrayLike | None = None,
    name: str = "wheel",
) -> Load: ...

# end of loads
# solids: written by rust/python/declared.py
def box(size: _Numbers, *, mass: _Numbers | None = None, density: _Numbers | None = None) -> RigidBody: ...
def cube(side: _Numbers, *, mass: _Numbers | None = None, density: _Numbers | None = None) -> RigidBody: ...
def wedge(size: _Numbers, *, mass: _Numbers | None = None, density: _Numbers | None = None) -> RigidBody: ...
def prism(
    sides: ArrayLike,
    radius: _Numbers,
    height: _Numbers,
    *,
    mass: _Numbers | None = None,
    density: _Numbers | None = None,
) -> RigidBody: ...
def pyramid(
    size: _Numbers, *, mass: _Numbers | None = None, density: _Numbers | None = None
) -> RigidBody: ...
def tetrahedron(
    side: _Numbers, *, mass: _Numbers | None = None, density: _Numbers | None = None
) -> RigidBody: ...
def sphere(
    radius: _Numbers, *, mass: _Numbers | None = None, density: _Numbers | None = None
) -> RigidBody: ...
def ellipsoid(
    semi_axes: _Numbers, *, mass: _Numbers | None = None, density: _Numbers | None = None
) -> RigidBody: ...
def hollow_sphere(
    inner_radius: _Numbers,
    outer_radius: _Numbers,
    *,
    mass: _Numbers | None = None,
    density: _Numbers | None = None,
) -> RigidBody: ...
def hemisphere(
    radius: _Numbers, *, mass: _Numbers | None = None, density: _Numbers | None = None
) -> RigidBody: ...
def cylinder(
    radius: _Numbers, height: _Numbers, *, mass: _Numbers | None = None, density: _Numbers | None = None
) -> RigidBody: ...
def cone(
    radius: _Numbers, height: _Numbers, *, mass: _Numbers | None = None, density: _Numbers | None = None
) -> RigidBody: ...
def tube(
    inner_radius: _Numbers,
    outer_radius: _Numbers,
    height: _Numbers,
    *,
    mass: _Numbers | None = None,
    density: _Numbers | None = None,
) -> RigidBody: ...
def frustum(
    bottom_radius: _Numbers,
    top_radius: _Numbers,
    height: _Numbers,
    *,
    mass: _Numbers | None = None,
    density: _Numbers | None = None,
) -> RigidBody: ...
def capsule(
    radius: _Numbers, length: _Numbers, *, mass: _Numbers | None = None, density: _Numbers | None = None
) -> RigidBody: ...
def torus(
    major_radius: _Numbers,
    minor_radius: _Numbers,
    *,
    mass: _Numbers | None = None,
    density: _Numbers | None = None,
) -> RigidBody: ...

# end of solids
# laminae: written by rust/python/declared.py
def disk(radius: _Numbers, *, mass: _Numbers | None = None, density: _Numbers | None = None) -> RigidBody: ...
def annulus(
    inner_radius: _Numbers,
    outer_radius: _Numbers,
    *,
    mass: _Numbers | None = None,
    density: _Numbers | None = None,
) -> RigidBody: ...
def ellipse(
    semi_axes: _Numbers, *, mass: _Numbers | None = None, density: _Numbers | None = None
) -> RigidBody: ...
def rectangle(
    size: _Numbers, *, mass: _Numbers | None = None, density: _Numbers | None = None
) -> RigidBody: ...
def triangle(
    vertices: _Numbers, *, mass: _Numbers | None = None, density: _Numbers | None = None
) -> RigidBody: ...
def polygon(
    vertices: _Numbers, *, mass: _Numbers | None = None, density: _Numbers | None = None
) -> RigidBody: ...

# end of laminae
# rods: written by rust/python/declared.py
def rod(length: _Numbers, *, mass: _Numbers | None = None, density: _Numbers | None = None) -> RigidBody: ...
def ring(radius: _Numbers, *, mass: _Numbers | None = None, density: _Numbers | None = None) -> RigidBody: ...
def arc(
    radius: _Numbers,
    angle: _Numbers,
    *,
    mass: _Numbers | None = None,
    density: _Numbers | None = None,
    degrees: bool = False,
) -> RigidBody: ...

# end of rods
def region_box(low: ArrayLike, high: ArrayLike) -> Region: ...
def region_ball(
    radius: float, center: ArrayLike = (0.0, 0.0, 0.0), *, inner_radius: float = 0.0
) -> Region: ...
def region_ellipsoid(semi_axes: ArrayLike, center: ArrayLike = (0.0, 0.0, 0.0)) -> Region: ...
def region_cylinder(
    radius: float, height: float, center: ArrayLike = (0.0, 0.0, 0.0), *, inner_radius: float = 0.0
) -> Region: ...
def rolling_plane(
    surface: Surface,
    *,
    law: Literal["rolling", "sliding", "dry"] = "rolling",
    friction: float | None = None,
    viscous: float | tuple[Literal["normal"], float] | None = None,
    resistance: tuple[float, float, float] | None = None,
    normal: ArrayLike = (0.0, 0.0, 1.0),
    point: ArrayLike = (0.0, 0.0, 0.0),
    turntable: float = 0.0,
    lift: Literal["stop", "fly", "hold"] = "stop",
) -> Contact: ...
def surface_sphere(radius: float, center: ArrayLike = (0.0, 0.0, 0.0)) -> Surface: ...
def surface_ellipsoid(
    semi_axes: ArrayLike, center: ArrayLike = (0.0, 0.0, 0.0), axes: ArrayLike | None = None
) -> Surface: ...
def surface_disk(
    radius: float, axis: ArrayLike = (0.0, 0.0, 1.0), center: ArrayLike = (0.0, 0.0, 0.0)
) -> Surface: ...
def surface_torus(
    major_radius: float,
    minor_radius: float,
    axis: ArrayLike = (0.0, 0.0, 1.0),
    center: ArrayLike = (0.0, 0.0, 0.0),
) -> Surface: ...
def surface_paraboloid(radii: ArrayLike, apex: float, axes: ArrayLike | None = None) -> Surface: ...
def ruled_cylinder(
    radius: float,
    height: float,
    axis: ArrayLike = (0.0, 0.0, 1.0),
    center: ArrayLike = (0.0, 0.0, 0.0),
) -> RuledSurface: ...
def ruled_cone(
    radius: float,
    height: float,
    axis: ArrayLike = (0.0, 0.0, 1.0),
    center: ArrayLike = (0.0, 0.0, 0.0),
) -> RuledSurface: ...
def rolling_states(
    body: RigidBody,
    surface: Surface | RuledSurface,
    omega: ArrayLike,
    attitude: _Attitude | None,
    gravity: ArrayLike,
    turntable: float,
    t: ArrayLike,
) -> dict[str, Any]: ...
def rolling_steady(
    body: RigidBody,
    surface: Surface,
    inclination: float,
    gravity: ArrayLike,
    turn: float | None,
    spin: float | None,
) -> list[Any]: ...
def rolling_critical_rate(body: RigidBody, surface: Surface, gravity: ArrayLike, motion: str) -> float: ...
def rolling_tippe_top(
    body: RigidBody, surface: Surface, spin: float, gravity: ArrayLike
) -> tuple[float, float, float, float]: ...
def rolling_modes(
    body: RigidBody, surface: Surface, gravity: ArrayLike, rate: float
) -> list[list[float]]: ...
def contact_history(
    body: RigidBody,
    contact: Contact,
    load: Load | None,
    omega: ArrayLike,
    quaternion: ArrayLike,
    position: ArrayLike,
    velocity: ArrayLike,
    phases: ArrayLike,
) -> dict[str, _Floats]: ...
def contact_invariants(
    body: RigidBody,
    contact: Contact,
    load: Load | None,
    omega: ArrayLike,
    quaternion: ArrayLike,
    position: ArrayLike,
    velocity: ArrayLike,
) -> dict[str, Any]: ...
def region_mesh(vertices: ArrayLike, faces: ArrayLike) -> Region: ...
def to_positive_products(body: RigidBody) -> tuple[_Floats, _Floats]: ...
def to_pseudo_inertia(body: RigidBody) -> _Floats: ...
def from_pseudo_inertia(pseudo_inertia: ArrayLike, *, rtol: float | None = None) -> RigidBody: ...
def to_spatial_inertia(body: RigidBody, order: _SpatialOrder = "angular-linear") -> _Floats: ...
def from_spatial_inertia(
    spatial_inertia: ArrayLike, order: _SpatialOrder = "angular-linear", *, rtol: float | None = None
) -> RigidBody: ...
def to_parameters(body: RigidBody) -> _Floats: ...
def from_parameters(parameters: ArrayLike, *, rtol: float | None = None) -> RigidBody: ...
def to_log_cholesky(body: RigidBody) -> _Floats: ...
def from_log_cholesky(parameters: ArrayLike) -> RigidBody: ...
def nearest_valid(inertia: ArrayLike) -> tuple[_Floats, Any]: ...
def within_box(body: RigidBody, low: ArrayLike, high: ArrayLike) -> tuple[Any, _Floats]: ...
def quaternion_from_euler_angles(
    angles: ArrayLike, sequence: str = "ZXZ", *, degrees: bool = False
) -> _Floats: ...
def euler_angles_from_quaternion(
    quaternion: ArrayLike | SupportsQuaternion,
    sequence: str = "ZXZ",
    singular: Literal["raise", "nan"] = "raise",
    *,
    degrees: bool = False,
) -> _Floats: ...
def angular_velocity_from_euler_rates(
    angles: ArrayLike,
    rates: ArrayLike,
    sequence: str = "ZXZ",
    frame: Literal["body", "space"] = "body",
    *,
    degrees: bool = False,
) -> _Floats: ...
def euler_rates(
    angles: ArrayLike,
    omega: ArrayLike,
    sequence: str = "ZXZ",
    frame: Literal["body", "space"] = "body",
    singular: Literal["raise", "nan"] = "raise",
    *,
    degrees: bool = False,
) -> _Floats: ...
def transport(rate_in_frame: ArrayLike, vector: ArrayLike, frame_omega: ArrayLike) -> _Floats: ...
def motion_sensitivity(
    body: RigidBody,
    t: ArrayLike,
    omega: ArrayLike,
    quaternion: ArrayLike,
    load: Load | None,
    about: Literal["center_of_mass", "origin"],
    states: Mapping[str, ArrayLike] | None = None,
    given: Sequence[str] = ...,
) -> MotionSensitivity: ...
def inertia_from_center_of_mass(inertia: ArrayLike, mass: ArrayLike, displacement: ArrayLike) -> _Floats: ...
def inertia_to_center_of_mass(inertia: ArrayLike, mass: ArrayLike, displacement: ArrayLike) -> _Floats: ...
def stick(mass: ArrayLike, inertia: ArrayLike, a: ArrayLike, b: ArrayLike) -> Particles: ...
def free_precession(
    body: RigidBody, omega: ArrayLike, about: _About = "center_of_mass", *, rtol: float = 1e-6
) -> FreePrecession: ...
def least_spin(
    body: RigidBody,
    gravity: ArrayLike,
    inclination: ArrayLike = 0.0,
    *,
    rtol: float = 1e-6,
    degrees: bool = False,
) -> Any: ...
def nutation_damping(
    body: RigidBody,
    momentum: ArrayLike,
    *,
    inertia: ArrayLike,
    damping: ArrayLike,
    rtol: float = 1e-06,
) -> NutationDamping: ...
def steady_precession(
    body: RigidBody,
    spin: ArrayLike,
    inclination: ArrayLike,
    gravity: ArrayLike,
    *,
    rtol: float = 1e-6,
    degrees: bool = False,
) -> _Floats: ...
def quaternion_from_matrix(matrix: ArrayLike) -> _Floats: ...
def rotate(quaternion: ArrayLike, vector: ArrayLike, inverse: bool = False) -> _Floats: ...
def rates(
    t: ArrayLike, rows: ArrayLike, order: int | None = None, sigma: float | None = None
) -> tuple[_Floats, _Floats]: ...
def white_noise(t: ArrayLike, rows: ArrayLike) -> float: ...
def fit_tumble(
    t: ArrayLike,
    omega: ArrayLike,
    known: dict[str, Any],
    progress: Callable[[float], object] | None = None,
) -> list[dict[str, Any]]: ...
def tumble_information(
    t: ArrayLike,
    omega: Sequence[float],
    inertia: Sequence[float],
    place: Sequence[float],
    known: dict[str, Any],
) -> dict[str, Any] | None: ...
def attitudes(
    t: ArrayLike, omega: ArrayLike, attitude: _Attitude, frame: Literal["body", "space"], order: int
) -> tuple[_Floats, _Floats]: ...
def impulses(t: ArrayLike, quaternion: ArrayLike, torques: Sequence[ArrayLike]) -> list[_Floats]: ...
def principal_gaps(moments: ArrayLike) -> _Floats: ...
def classify_tops(moments: ArrayLike, rtol: ArrayLike) -> Any: ...
def real_numbers(values: ArrayLike, name: str) -> _Floats: ...
def read_stl(path: str) -> tuple[_Floats, NDArray[np.int64]]: ...
def read_plates(path: str, index_base: int = 1) -> tuple[_Floats, NDArray[np.int64]]: ...
def labelled_voxels(
    labels: NDArray[Any],
    spacing: ArrayLike | None,
    origin: ArrayLike | None,
    affine: ArrayLike | None,
    choose: Callable[[NDArray[np.int64], NDArray[np.uint64], NDArray[np.uint64]], ArrayLike | None],
) -> tuple[NDArray[np.int64], RigidBody] | None: ...
def surface_area(vertices: ArrayLike, faces: ArrayLike) -> float: ...
def stream_solid(
    path: str | PathLike[str],
    *,
    scale: float = 1.0,
    density: _Number | None = None,
    mass: _Number | None = None,
    orient: bool = False,
    progress: Callable[[float], object] | None = None,
) -> tuple[RigidBody, int, float, float]: ...
def covariance_factor(covariance: ArrayLike) -> _Floats: ...
def random_numbers(
    law: Literal["bits", "uniform", "normal", "rotation"],
    seed: int,
    stream: int,
    first: int,
    count: int,
    width: int,
) -> Any: ...
