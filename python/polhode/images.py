"""Images of scanners and simulations: voxels in files, segmentations, densities from grey values.

``RigidBody.from_file`` and ``polhode report`` read an image as one body; ``RigidBody.from_labelled_voxels``
makes a body for each label of a segmentation. The functions here are what they are built on.
"""

from __future__ import annotations

from polhode.io.images import Image, body_of_image, grey_value_density, is_image, read_image

__all__ = ["Image", "body_of_image", "grey_value_density", "is_image", "read_image"]
