"""Conversion of mass properties to and from the forms of other libraries.

Each function states the point to which its numbers refer, and their order.

Positive products refer to the centre of mass C. The ten parameters, the pseudo-inertia and the spatial
inertia refer to the origin O of the body frame; they lose digits if the distance from O to C is many times
the size of the body. The log-Cholesky parameters describe a triangular factor of the
pseudo-inertia about O, but they are computed from mass, C and the second moment about C, so that they lose no
digits.

Positive products are read by :meth:`polhode.RigidBody.from_positive_products`, and printouts of CAD programs
by `from_printout`. `to_text` writes the numbers for other programs, each in its own conventions.
"""

from polhode._core import (
    from_log_cholesky,
    from_parameters,
    from_pseudo_inertia,
    from_spatial_inertia,
    to_log_cholesky,
    to_parameters,
    to_positive_products,
    to_pseudo_inertia,
    to_spatial_inertia,
)
from polhode.interop.printouts import from_printout
from polhode.interop.programs import to_text

__all__ = [
    "from_log_cholesky",
    "from_parameters",
    "from_printout",
    "from_pseudo_inertia",
    "from_spatial_inertia",
    "to_log_cholesky",
    "to_parameters",
    "to_positive_products",
    "to_pseudo_inertia",
    "to_spatial_inertia",
    "to_text",
]
