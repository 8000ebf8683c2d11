"""The exceptions of polhode.

Each of them is also a :class:`ValueError`, so that ``except ValueError`` catches bad input of every kind. The
message names the argument, the row of a stack, the bad number, the law that it breaks, and a remedy.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from polhode._format import Argument, in_words

if TYPE_CHECKING:
    from collections.abc import Callable

    from polhode._core import RigidBody
    from polhode.identify.results import Direction
    from polhode.motion.trajectory import Trajectory

__all__ = [
    "ContactError",
    "FileFormatError",
    "IdentificationError",
    "IntegrationError",
    "InvalidInertiaError",
    "MeshError",
    "PolhodeError",
    "QuadratureError",
    "SingularAttitudeError",
]


class PolhodeError(ValueError):
    """Base class of the errors that polhode raises about physics and data.

    Its `args` are the pieces of the message: texts, the path of a file, whole numbers for rows of arrays, and
    objects where an argument is named. They become words when the message is printed.

    Attributes
    ----------
    kind : str
        What is wrong, where the command line has a remedy of its own; else ``""``.
    way_out : str
        The remedy at the end of a message of the core; ``""`` where there is none.
    stack_row : int or None
        Row of the flattened stack that is at fault, where the first two pieces of the message name it.
    label : int or None
        Label of the particles at fault, where the second piece of the message is it.
    """

    kind: str = ""
    way_out: str = ""
    stack_row: int | None = None
    label: int | None = None

    def __str__(self) -> str:
        return self.words()

    def __repr__(self) -> str:
        return f"{type(self).__name__}({str(self)!r})"

    def words(self, name: Callable[[Argument], str] = str) -> str:
        """Return the message.

        Parameters
        ----------
        name : callable, optional
            A function that writes an argument; as Python does by default.
        """
        return in_words(self.args, name)

    def leave_row_out(self) -> None:
        """Take the row out of the message, for a caller to whom it is none of a stack's."""
        if self.stack_row is not None:
            self.args, self.stack_row = self.args[2:], None

    def shift_rows(self, by: int) -> None:
        """Add to the rows in the message, for a caller that passed a part of an array."""
        self.args = tuple(piece + by if isinstance(piece, int) else piece for piece in self.args)

    def rename_file(self, path: object, name: object) -> None:
        """Put another name for a file into the message, for a caller that passed a copy of the file."""
        self.args = tuple(name if str(piece) == str(path) else piece for piece in self.args)

    @property
    def fault(self) -> str:
        """The message without the remedy, for a caller that has another one."""
        return in_words(self.args[:-1] if self.way_out else self.args)


class InvalidInertiaError(PolhodeError):
    """Mass properties that no real body can have."""


class ContactError(PolhodeError):
    """A body that cannot touch a plane as it should.

    It hovers over the plane or sinks into it, lies flat, touches beyond the end of its surface, or is asked
    for what a contact cannot do.
    """


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
    _last: tuple[object, ...] = ()

    def end_with(self, *remedy: object) -> None:
        """Put a remedy, of pieces, in the place of the one at the end of the message."""
        before = self.args[: -len(self._last)] if self._last else (*self.args[:-1], "; ")
        self.args, self._last = (*before, *remedy), remedy
        self.way_out = "".join(map(str, remedy))

    def offer(self, *remedy: object) -> None:
        """Put another remedy, of pieces, into the message, before that at its end."""
        before = self.args[: len(self.args) - len(self._last)]
        self.args = (*before, *remedy, "; or ", *self._last) if self._last else (*before, " (", *remedy, ")")


class FileFormatError(PolhodeError):
    """The content of a file does not fit its name or header, or is damaged."""


class IdentificationError(PolhodeError):
    """Measurements from which no body can be identified.

    Attributes
    ----------
    kind : str
        ``"undetermined"``, ``"no fit"``, ``"contradiction"``, ``"clock"``, ``"units"`` or ``"saturated"``.
    observability : tuple of Direction
        The directions that the measurements leave undetermined.
    """

    observability: tuple[Direction, ...] = ()

    def __init__(self, *pieces: object, kind: str = "", observability: tuple[Direction, ...] = ()) -> None:
        super().__init__(*pieces)
        self.kind, self.observability = kind, observability


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
