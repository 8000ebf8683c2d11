"""The exceptions of polhode.

Each of them is also a :class:`ValueError`, so that ``except ValueError`` catches bad input of every kind. The
message names the argument, the row of a stack, the bad number, the law that it breaks, and a remedy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from polhode._core import RigidBody
    from polhode.motion.trajectory import Trajectory

__all__ = [
    "FileFormatError",
    "IntegrationError",
    "InvalidInertiaError",
    "MeshError",
    "PolhodeError",
    "QuadratureError",
    "SingularAttitudeError",
]


class PolhodeError(ValueError):
    """Base class of the errors that polhode raises about physics and data."""


class InvalidInertiaError(PolhodeError):
    """Mass properties that no real body can have.

    Attributes
    ----------
    way_out : str
        The remedy at the end of the message; ``""`` where there is none.
    """

    way_out: str = ""

    @property
    def fault(self) -> str:
        """The message without the remedy, for a caller that has another one."""
        return str(self).removesuffix(self.way_out).rstrip("; :")


class MeshError(PolhodeError):
    """A mesh from which no body can be computed.

    A mesh of a solid may be open, inconsistently wound, inverted or degenerate. A surface may be folded onto
    itself or have a bad face. A mesh of tetrahedra may have a bad cell or density.

    Attributes
    ----------
    law : str
        ``"closed"`` where the mesh is open; else ``""``.
    way_out : str
        The remedy at the end of the message; ``""`` if `law` is ``""``.
    """

    law: str = ""
    way_out: str = ""

    def offer(self, way_out: str) -> None:
        """Insert another remedy into the message, before the present one."""
        fault = str(self).removesuffix(self.way_out)
        self.args = (f"{fault}{way_out}; or {self.way_out}" if self.way_out else f"{fault} ({way_out})",)


class FileFormatError(PolhodeError):
    """The content of a file does not fit its name or header, or is damaged."""


class IntegrationError(PolhodeError):
    """An integration could not go on; the message says why.

    Attributes
    ----------
    row : int
        Index of the body in the flattened stack.
    time : float
        The time that was reached.
    state : tuple of numpy.ndarray
        ``(quaternion, omega)`` at that time.
    partial : Trajectory
        The trajectory so far; states after ``time`` are NaN.
    """

    row: int
    time: float
    state: tuple[object, object]
    partial: Trajectory | None


class QuadratureError(PolhodeError):
    """An integral over a density did not reach its tolerance.

    Attributes
    ----------
    estimate : RigidBody
        Best estimate of the body.
    error : float
        Its estimated relative error.
    evaluations : int
        Number of points at which the density was evaluated.
    """

    estimate: RigidBody
    error: float
    evaluations: int


class SingularAttitudeError(PolhodeError):
    """An attitude at which the Euler angles or rates asked for are not defined."""
