"""The sequences of Euler angles: twelve about axes of the body, twelve about axes of space."""

from __future__ import annotations

import itertools

INTRINSIC = ["".join(s) for s in itertools.product("XYZ", repeat=3) if s[0] != s[1] and s[1] != s[2]]
SEQUENCES = INTRINSIC + [s.lower() for s in INTRINSIC]
