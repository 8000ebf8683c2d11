"""Nuclides: the meaning of a label, its mass and the sigma of the mass."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Final, Literal, NamedTuple, TypeAlias

import numpy as np

from polhode import _core
from polhode._optional import require
from polhode.errors import PolhodeError
from polhode.uncertainty.variables import of_forms

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["SYMBOLS", "Isotope", "Masses", "isotopes", "names_of", "shifted_mass_number", "uncertain_masses"]

Masses: TypeAlias = Literal["most_common", "average"]

SYMBOLS: Final = tuple(
    """
    H He Li Be B C N O F Ne Na Mg Al Si P S Cl Ar K Ca Sc Ti V Cr Mn Fe Co Ni Cu Zn Ga Ge As Se Br Kr Rb Sr Y
    Zr Nb Mo Tc Ru Rh Pd Ag Cd In Sn Sb Te I Xe Cs Ba La Ce Pr Nd Pm Sm Eu Gd Tb Dy Ho Er Tm Yb Lu Hf Ta W Re
    Os Ir Pt Au Hg Tl Pb Bi Po At Rn Fr Ra Ac Th Pa U Np Pu Am Cm Bk Cf Es Fm Md No Lr Rf Db Sg Bh Hs Mt Ds Rg
    Cn Nh Fl Mc Lv Ts Og
    """.split()  # noqa: SIM905
)
"""Symbols of all elements, by atomic number from 1; used to read files without periodictable."""

_LABEL: Final = re.compile(r"(?P<mass_number>[0-9]{1,9})?(?P<symbol>[A-Za-z]{1,2})|(?P<number>[0-9]{1,9})")
_HYDROGEN: Final = {"D": 2, "T": 3}


class Isotope(NamedTuple):
    """A nuclide: its name as ``"16O"``, or ``"O"`` for the average of an element, and its mass in u.

    Attributes
    ----------
    name : str
    mass : float
    sigma : float or None
        Standard deviation of the mass in u; None where none is on record.
    """

    name: str
    mass: float
    sigma: float | None = None


def isotopes(labels: Sequence[str], masses: Masses = "most_common") -> list[Isotope]:
    """Find the nuclide of each label.

    Parameters
    ----------
    labels : sequence of str
        Element symbols (``"O"``) or atomic numbers (``"8"``) stand for the most abundant isotope, as in
        spectroscopy. ``"18O"``, ``"D"`` and ``"T"`` name an isotope.
    masses : {"most_common", "average"}
        Mass of an element: that of the most abundant isotope, or the average over its isotopes as for a
        substance in a bottle. With the average the name is the symbol of the element.

    Returns
    -------
    list of Isotope
        In the order of `labels`.

    Raises
    ------
    PolhodeError
        If a label names no element or isotope, or names an element without natural isotopes.
    ModuleNotFoundError
        If periodictable is not installed.

    Examples
    --------
    >>> from polhode.molecules import isotopes
    >>> [isotope.name for isotope in isotopes(["C", "O", "18O", "D"])]
    ['12C', '16O', '18O', '2H']
    """
    table = require("periodictable", extra="chem", purpose="reading isotope masses").elements
    if masses not in ("most_common", "average"):
        raise ValueError(f"masses: expected 'most_common' or 'average', got {masses!r}")
    known: dict[str, Isotope] = {}
    for label in labels:
        if label not in known:
            known[label] = _isotope(table, label, masses)
    return [known[label] for label in labels]


def _isotope(table: Any, label: str, masses: Masses) -> Isotope:
    match = _LABEL.fullmatch(label)
    if match is None:
        raise PolhodeError(
            f"{label[:40]!r} is not an element; write a symbol (O), isotope (18O) or number (8)"
        )
    mass_number = int(match["mass_number"]) if match["mass_number"] else None
    symbol = (match["symbol"] or "").capitalize()
    if symbol in _HYDROGEN and mass_number is None:
        symbol, mass_number = "H", _HYDROGEN[symbol]
    try:
        element = table[int(match["number"])] if match["number"] else table.symbol(symbol)
    except (KeyError, ValueError):
        element = None
    # Entry 0 of the table is the neutron; "D" and "T" are its names of nuclides, not of elements.
    if element is None or element.number == 0 or symbol in _HYDROGEN:
        raise PolhodeError(f"{label!r} is not an element; check the symbol")
    if mass_number is None and masses == "average":
        return Isotope(element.symbol, float(element.mass), _sigma(element))
    if mass_number is None:
        # Of equal abundances (none exists in nature) the lightest, so that the choice never wavers.
        mass_number = max(element.isotopes, key=lambda a: (element[a].abundance, -a))
        if not element[mass_number].abundance > 0.0:
            usual = min(element.isotopes, key=lambda a: abs(a - element.mass))
            raise PolhodeError(
                f"{element.symbol} has no natural abundance on record, so no most abundant isotope; "
                f"write the mass number too, as in {usual}{element.symbol}"
            )
    elif mass_number not in element.isotopes:
        raise PolhodeError(
            f"{label!r}: no isotope {mass_number} of {element.symbol} is on record; check the number"
        )
    nuclide = element[mass_number]
    is_the_unit = (element.symbol, mass_number) == ("C", 12)  # u is a twelfth of it
    sigma = 0.0 if is_the_unit else _sigma(nuclide)
    return Isotope(f"{mass_number}{element.symbol}", float(nuclide.mass), sigma)


def shifted_mass_number(symbol: str, difference: int) -> int:
    """Return the mass number of an element that differs from its own by this number.

    Parameters
    ----------
    symbol : str
    difference : int

    Returns
    -------
    int

    Raises
    ------
    PolhodeError
        If the element's own is not clear: where its average mass, rounded, is not that of its most common
        isotope, some programs count from the one and some from the other.
    ModuleNotFoundError
        If periodictable is not installed.
    """
    table = require("periodictable", extra="chem", purpose="reading isotope masses").elements
    (own,) = isotopes([symbol])
    common, average = round(own.mass), round(table.symbol(symbol).mass)
    if common != average:
        raise PolhodeError(
            f"the mass difference {difference} of {symbol} may count from {common} or from {average}; "
            "write the isotope as 'M  ISO'"
        )
    return common + difference


def _sigma(of: Any) -> float | None:
    """Return the sigma of a mass; 0 or an empty text in the table means that it is unknown."""
    sigma = getattr(of, "_mass_unc", None)
    return float(sigma) if sigma else None


def uncertain_masses(labels: Sequence[str | Isotope], masses: Masses = "most_common") -> _core.Uncertain:
    """Return masses of nuclides with their standard deviations. Atoms of the same nuclide share one error.

    Parameters
    ----------
    labels : sequence of str or Isotope
        Labels as for :func:`isotopes`, or the list that it returned.
    masses : {"most_common", "average"}
        See :func:`isotopes`.

    Returns
    -------
    Uncertain, shape (n,)
        Masses in u. Each nuclide is one source of error, with a name such as ``"mass of 1H"``: all its atoms
        have the same error, also in molecules of other calls.

    Raises
    ------
    PolhodeError
        If a label names no nuclide, or a nuclide whose standard deviation is not tabulated.
    ModuleNotFoundError
        If periodictable is not installed.

    Examples
    --------
    >>> from polhode import RigidBody
    >>> from polhode.molecules import uncertain_masses
    >>> water = [(0, 0, 0), (0.757, 0, 0.587), (-0.757, 0, 0.587)]  # angstrom
    >>> body = RigidBody.from_particles(uncertain_masses(["O", "H", "H"]), water)
    >>> print(f"{body.mass:.9f} ± {body.sigma.mass:.0e}")
    18.010564683 ± 3e-10
    """
    given = _sequence(labels)
    read = iter(isotopes([label for label in given if not isinstance(label, Isotope)], masses))
    found = [label if isinstance(label, Isotope) else next(read) for label in given]
    forms = []
    for isotope in found:
        if isotope.sigma is None:
            raise PolhodeError(
                f"labels: no sigma of the mass of {isotope.name} is on record; "
                "give masses as Uncertain numbers"
            )
        forms.append(_core.Uncertain(0.0, isotope.sigma, source=f"mass of {isotope.name}")._forms()[0])
    return of_forms(np.array([isotope.mass for isotope in found]), forms)


def names_of(labels: Sequence[str | Isotope]) -> list[str]:
    """Return names of nuclides, as ``"16O"``; those of the average where no isotope is known as common."""
    given = _sequence(labels)
    read = iter(isotopes([label for label in given if not isinstance(label, Isotope)], "average"))
    return [(label if isinstance(label, Isotope) else next(read)).name for label in given]


def _sequence(labels: Any) -> list[Any]:
    """Refuse a text, which is a sequence of letters."""
    if isinstance(labels, str):
        message = f"labels: expected a sequence of labels, got the text {labels!r}; write [{labels!r}]"
        raise TypeError(message)
    return list(labels)
