"""Images of scanners and simulations: voxels in files, segmentations, densities from grey values.

``RigidBody.from_file`` and ``polhode report`` read an image as one body; :class:`polhode.labelled.Labelled`
has a
``from_file`` that reads a segmentation as one body for each label. The functions here are what they are
built on.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from polhode.io.images import Image, body_of_image, grey_value_density, is_image, read_image
from polhode.io.images import bodies_of_labels as _bodies_of_labels
from polhode.labelled import Labelled

if TYPE_CHECKING:
    from typing import Any

__all__ = ["Image", "body_of_image", "grey_value_density", "is_image", "read_image"]


def bodies_of_labels(*arguments: Any) -> Labelled:
    """Make a body for each label: the compiled library calls it for ``RigidBody.from_labelled_voxels``."""
    return Labelled(*_bodies_of_labels(*arguments))
