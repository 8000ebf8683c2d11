"""``python -m polhode``."""

from __future__ import annotations

import sys

from polhode.cli import main

sys.exit(main())
