"""The plan for large ensembles: its second table is what follows from the first, and bytes are those told."""

from __future__ import annotations

import math
import pickle
import re
from typing import Any

import pytest
from ensemble_cases import all_reductions, pushed
from places import ROOT
from polhode import RigidBody, flybys, orbits
from polhode.ensembles.merge_tree import nodes_of_chunk

PAGE = (ROOT / "docs" / "scaling.md").read_text("utf-8")
CHUNK = 120 * 4096


def measured(words: str, unit: str) -> float:
    """A number of the first table."""
    (found,) = re.findall(rf"^\| {re.escape(words)}[^|]*\| ([\d.]+) {unit} \|", PAGE, re.MULTILINE)
    return float(found)


MEMBER = measured("time of a member, on one thread", "µs") * 1e-6
TASK = measured("time of client and scheduler for a chunk", "ms") * 1e-3
BYTES = measured("states of a member", "bytes")
ROWS = [
    [float(cell) for cell in row.split(" | ")]
    for row in re.findall(r"^\| (1e\d+ \| .*) \|$", PAGE, re.MULTILINE)
]


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row[0]:.0e}")
def test_the_table_follows_from_what_was_measured(row: list[float]) -> None:
    n, hours, chunks, scheduler, seconds, disk = row
    assert chunks == math.ceil(n / CHUNK)
    assert hours == pytest.approx(n * MEMBER / 3600, rel=5e-3)
    assert scheduler == pytest.approx(chunks * TASK, rel=2e-2)
    assert disk == pytest.approx(n * BYTES / 1e9, rel=5e-3)
    # Whole rounds of 2600 chunks, or the scheduler where it is slower.
    rounds = math.ceil(chunks / 2600) * min(n / chunks, CHUNK) * MEMBER
    assert seconds == pytest.approx(max(rounds, scheduler), rel=5e-2)


def test_the_table_goes_to_ten_thousand_million() -> None:
    assert [row[0] for row in ROWS] == [1e6, 1e8, 1e9, 1e10]
    assert f"{CHUNK:,} members, which are 120 blocks of 4096." in PAGE
    assert f"chunks of {CHUNK:,} members" in PAGE
    seconds, kept, least = CHUNK * MEMBER, CHUNK * BYTES, TASK / MEMBER
    assert seconds == pytest.approx(10.0, rel=0.02)
    assert seconds / TASK == pytest.approx(2600, rel=0.03)
    assert f"3.8 ms / {MEMBER * 1e6:.1f} µs     (about 190 for each thread)" in PAGE
    assert least == pytest.approx(190, rel=0.03)
    assert "90 MB a chunk" in PAGE
    assert kept == pytest.approx(90e6, rel=0.01)
    # At 1 GB/s.
    assert "row takes half an hour" in PAGE
    assert ROWS[-1][-1] == pytest.approx(1800, rel=0.03)


def test_bytes_of_a_member_are_those_that_the_ensemble_tells() -> None:
    orbit = orbits.from_elements(398600.4418, eccentricity=4.25, periapsis=38011.5, since_periapsis=-2e5)
    body = RigidBody.from_principal(1.0, (0.64, 0.97, 1.0))
    periods: Any = {"rotation_period": 951040.8, "precession_period": 98591.7, "mode": "short-axis"}
    clones = flybys.clones(body, orbit, 4e5, **periods, n=CHUNK, chunk=CHUNK)
    assert clones.memory.results / len(clones) == BYTES
    of_states = measured("memory of a worker that keeps states", "kB") * 1e3
    assert clones.memory.worker / CHUNK == pytest.approx(of_states, rel=0.02)
    kept = measured("memory of a worker with reductions", "MB") * 1e6
    reduced = flybys.clones(
        body, orbit, 4e5, **periods, n=CHUNK, chunk=CHUNK, reduce=all_reductions()["modes"]
    )
    assert reduced.memory.worker == pytest.approx(kept, rel=0.1)


def test_reductions_send_as_little_as_is_said() -> None:
    """The state of a chunk does not grow with its members, but that of quantiles."""
    plan = pushed(8192, t=(0.0, 0.01), chunk=8192).plan
    for name, reduction in all_reductions().items():
        sent = len(pickle.dumps(nodes_of_chunk(plan, (reduction,), 0)))
        assert sent < 1.1e3 or name == "quantiles"
        assert sent > 300
    # Three components, each of them 65536 numbers of eight bytes.
    assert 3 * 65536 * 8 < 1.6e6
    assert "up to 0.5 MB in each chunk for each component of the quantity" in PAGE
