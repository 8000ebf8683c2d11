"""What a moving page holds: its motion and its picture, as arrays."""

from __future__ import annotations

import base64
import json
import re
from pathlib import Path
from typing import Any

import numpy as np
from oracles.bodies import matrix

KINDS = {"t": ("<f8", -1), "quaternion": ("<f4", 4), "omega": ("<f4", 3), "inside": ("<f4", 3)}

KINDS |= {"vertices": ("<f4", 3), "faces": ("<u4", 3), "colors": ("u1", 3)}


def data(page: Path) -> dict[str, Any]:
    """What a page holds, its packed arrays unpacked; and L in space, as the page works it out."""
    found = re.search(r'<script type="application/json" id="motion">(.*?)</script>', page.read_text("utf-8"))
    assert found
    motion: dict[str, Any] = json.loads(found[1])
    for name, (kind, width) in KINDS.items():
        if motion[name] is not None:
            numbers = np.frombuffer(base64.b64decode(motion[name]), dtype=kind)
            motion[name] = numbers if width < 0 else numbers.reshape(-1, width)
    axes = np.array(motion["axes"])
    spin = motion["omega"] @ axes.T * motion["moments"] @ axes
    spin = spin if motion["inside"] is None else spin + motion["inside"]
    turned = [matrix(q) @ v for q, v in zip(motion["quaternion"].astype(float), spin, strict=True)]
    return motion | {"momentum": np.array(turned)}
