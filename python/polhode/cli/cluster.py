"""The workers of a dask cluster, by the address of its scheduler."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from polhode._extras import require
from polhode.errors import PolhodeError

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["client_at"]


@contextmanager
def client_at(address: str | None) -> Iterator[Any]:
    """Give a client of the scheduler at an address; None without one.

    Parameters
    ----------
    address : str or None

    Yields
    ------
    distributed.Client or None

    Raises
    ------
    PolhodeError
        Where no scheduler answers.
    """
    if address is None:
        yield None
        return
    distributed = require("distributed", extra="cluster", purpose="--client")
    try:
        # Not as dask's default, which one that finds no scheduler would stay: dask would wait for it.
        client = distributed.Client(address, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise PolhodeError(
            f"--client: no scheduler of dask answers at {address!r} ({type(error).__name__}); give the "
            "address that `dask scheduler` prints, as in tcp://127.0.0.1:8786, or leave --client out"
        ) from error
    try:
        yield client
    finally:
        client.close()
