"""The client of the option ``--client``."""

from __future__ import annotations

import pytest
from polhode.cli.cluster import client_at
from polhode.errors import PolhodeError

dask = pytest.importorskip("dask")
distributed = pytest.importorskip("distributed")


def test_one_that_finds_no_scheduler_leaves_dask_as_it_was() -> None:
    before = dask.config.get("scheduler", None)
    with pytest.raises(PolhodeError, match="no scheduler of dask answers at 'nowhere'"), client_at("nowhere"):
        pass
    assert dask.config.get("scheduler", None) == before
    with pytest.raises(ValueError, match="No clients found"):
        distributed.default_client()
