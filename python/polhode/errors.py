"""The exceptions of polhode.

Each of them is also a :class:`ValueError`, so that ``except ValueError`` catches bad input of every kind. The
message names the argument, the row of a stack, the bad number, the law that it breaks, and a remedy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable

    from polhode._core import RigidBody
    from polhode.motion.trajectory import Trajectory

__all__ = [
    "Argument",
    "FileFormatError",
    "IntegrationError",
    "InvalidInertiaError",
    "MeshError",
    "PolhodeError",
    "QuadratureError",
    "SingularAttitudeError",
]


class Argument(NamedTuple):
    """An argument in a message: the command line and the files of assemblies write it in their own way.

    Attributes
    ----------
    name : str
    value : object
        The value to pass; None names the argument alone.
    """

    name: str
    value: object = None

    def __str__(self) -> str:
        if self.value is None:
            return self.name
        return f'{self.name}="{self.value}"' if isinstance(self.value, str) else f"{self.name}={self.value}"


class PolhodeError(ValueError):
    """Base class of the errors that polhode raises about physics and data.

    Its `args` are the pieces of the message: texts, and an :class:`Argument` where an argument is named. They
    become words when the message is printed.

    Attributes
    ----------
    kind : str
        What is wrong, where the command line has a remedy of its own; else ``""``.
    way_out : str
        The remedy at the end of a message of the core; ``""`` where there is none.
    row : int or None
        Place in the flattened stack of the value at fault, where the message begins with it.
    """

    kind: str = ""
    way_out: str = ""
    row: int | None = None

    def __str__(self) -> str:
        return self.words()

    def words(self, name: Callable[[Argument], str] = str) -> str:
        """Return the message.

        Parameters
        ----------
        name : callable, optional
            A function that writes an argument; as Python does by default.
        """
        return "".join(name(part) if isinstance(part, Argument) else str(part) for part in self.args)

    @property
    def fault(self) -> str:
        """The message without the remedy, for a caller that has another one."""
        return str(self).removesuffix(self.way_out).rstrip("; :")


class InvalidInertiaError(PolhodeError):
    """Mass properties that no real body can have."""


class MeshError(PolhodeError):
    """A mesh from which no body can be computed.

    A mesh of a solid may be open, inconsistently wound, inverted or degenerate. A surface may be folded onto
    itself or have a bad face. A mesh of tetrahedra may have a bad cell or density.

    Attributes
    ----------
    law : str
        ``"closed"`` where the mesh is open; else ``""``.
    """

    law: str = ""


class FileFormatError(PolhodeError):
    """The content of a file does not fit its name or header, or is damaged."""


class IntegrationError(PolhodeError):
    """An integration could not go on; the message tells why.

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
