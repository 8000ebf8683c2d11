"""Ensembles in files: what is written, what goes on after a kill, what is another ensemble's."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray
from ensemble_cases import BODY, TESTS, TIMES, all_bytes, all_reductions, pushed, python, slow, twisted
from polhode import ensemble
from polhode.ensembles.fingerprint import fingerprint
from polhode.errors import FileFormatError


class TestFiles:
    def test_npz(self, tmp_path: Path) -> None:
        many = twisted(100, chunk=30)
        many.to_npz(tmp_path / "out")
        files = sorted((tmp_path / "out").glob("chunk-*.npz"))
        assert len(files) == 4
        want = many.compute()
        for name in want:
            found = np.concatenate([np.load(file)[name] for file in files])
            assert np.array_equal(found, want[name], equal_nan=found.dtype.kind == "f")
        told = json.loads((tmp_path / "out" / "ensemble.json").read_text("utf-8"))
        assert (told["seed"], told["n"], told["chunk"], told["t"]) == (5, 100, 30, list(TIMES))

    def test_zarr(self, tmp_path: Path) -> None:
        many = twisted(100, chunk=30)
        many.to_zarr(tmp_path / "out.zarr")
        with xarray.open_zarr(tmp_path / "out.zarr", chunks=None) as found:
            want = many.compute()
            for name in want:
                assert found[name].dims == want[name].dims
                assert np.array_equal(found[name], want[name], equal_nan=want[name].dtype.kind == "f")
            assert np.array_equal(found.time, TIMES)
            assert found.attrs["seed"] == 5

    @pytest.mark.parametrize("kind", ["npz", "zarr"])
    def test_what_was_killed_goes_on(self, kind: str, tmp_path: Path) -> None:
        whole, part = tmp_path / "whole", tmp_path / "part"
        many = slow()
        getattr(many, f"to_{kind}")(whole)
        process = subprocess.Popen([sys.executable, str(TESTS / "ensemble_cases.py"), kind, str(part)])

        def chunks_in(path: Path) -> set[Path]:
            """Return the files of the chunks, without what a process has half written."""
            pattern = "chunk-*.npz" if kind == "npz" else "status/[0-9]*"
            return {file for file in path.glob(pattern) if file.suffix != ".partial"}

        try:
            deadline = time.monotonic() + 60.0
            while len(chunks_in(part)) < 3 and time.monotonic() < deadline:
                time.sleep(0.005)
        finally:
            process.send_signal(signal.SIGKILL)
            process.wait()
        kept = {file: file.stat().st_mtime_ns for file in chunks_in(part)}
        assert 3 <= len(kept) < 20
        many.resume(part)
        assert all(file.stat().st_mtime_ns == then for file, then in kept.items())
        assert {file.name for file in chunks_in(part)} == {file.name for file in chunks_in(whole)}
        for file in whole.rglob("*"):
            if file.is_file():
                assert (part / file.relative_to(whole)).read_bytes() == file.read_bytes()

    @pytest.mark.parametrize(
        ("kind", "folder", "half", "other"),
        [
            ("npz", "", ".polhode-0123456789abcdef.npz", ".polhode-notes.npz"),
            ("zarr", "status", "1.2683356893ce94c06a0224cb438e3391.partial", "my.partial"),
        ],
    )
    def test_what_a_killed_process_had_half_written_is_removed(
        self, kind: str, folder: str, half: str, other: str, tmp_path: Path
    ) -> None:
        many, path = twisted(20, chunk=10), tmp_path / "out"
        getattr(many, f"to_{kind}")(path)
        for name in (half, other):
            (path / folder / name).write_bytes(b"half")
        many.resume(path)
        assert not (path / folder / half).exists()
        assert (path / folder / other).read_bytes() == b"half"

    def test_nothing_is_left_to_resume(self, tmp_path: Path) -> None:
        many = twisted(20)
        many.to_npz(tmp_path / "out")
        before = {file: file.stat().st_mtime_ns for file in (tmp_path / "out").iterdir()}
        many.resume(tmp_path / "out")
        assert {file: file.stat().st_mtime_ns for file in (tmp_path / "out").iterdir()} == before

    @pytest.mark.parametrize("kind", ["npz", "zarr"])
    def test_another_ensemble_is_refused(
        self, kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        path = tmp_path / "out"
        getattr(twisted(20, chunk=10), f"to_{kind}")(path)
        for other, told in [
            (twisted(20, chunk=10, seed=6), "seed is 5 there and 6 here"),
            (twisted(21, chunk=10), "n is 20 there and 21 here"),
            (twisted(20, chunk=5), "chunk is 10 there and 5 here"),
            (twisted(20, chunk=10, t=(0.0, 1.5, 4.5)), "the times are not the same"),
            (twisted(20, chunk=10, rtol=1e-9), "the start or an option is not the same"),
        ]:
            with pytest.raises(FileFormatError, match=told):
                other.resume(path)
        with pytest.raises(FileExistsError, match="resume goes on with it"):
            getattr(twisted(20, chunk=10), f"to_{kind}")(path)
        monkeypatch.setattr("polhode.ensembles.stores.build", lambda: ("9.9", ""))
        with pytest.raises(FileFormatError, match=r"version is .* there and 9.9 here \(install polhode"):
            twisted(20, chunk=10).resume(path)

    def test_what_is_no_ensemble_is_refused(self, tmp_path: Path) -> None:
        with pytest.raises(FileNotFoundError, match="nothing to go on with"):
            twisted(20).resume(tmp_path / "none")
        with pytest.raises(FileFormatError, match="holds no ensemble"):
            twisted(20).resume(tmp_path)
        (tmp_path / "ensemble.json").write_text("{}")
        with pytest.raises(FileFormatError, match="holds no ensemble"):
            twisted(20).resume(tmp_path)

    def test_a_fingerprint_is_the_same_in_every_process(self) -> None:
        code = (
            "import ensemble_cases as e; from polhode.ensembles.fingerprint import *\n"
            "print(fingerprint(e.twisted().plan))"
        )
        told = {python(code, PYTHONHASHSEED=seed).strip() for seed in ("1", "2")}
        assert told == {fingerprint(twisted().plan)}

    def test_a_fingerprint_sees_what_functions_do(self) -> None:
        def of(function: Any) -> str:
            return fingerprint(ensemble(BODY, TIMES, function, n=2, seed=1).plan)

        def scaled(factor: float) -> Any:
            return lambda rng: rng.normal(size=3) * factor

        assert of(scaled(1.0)) == of(scaled(1.0))
        assert of(scaled(1.0)) != of(scaled(2.0))
        assert of(lambda rng: rng.normal(size=3)) != of(lambda rng: rng.uniform(size=3))


class TestCheckpoints:
    """Reductions that are ended go on with what they have."""

    def ended(self, path: Path, at: float = 0.4, **options: Any) -> float:
        """End a run at a part, and give how far it was."""

        class Enough(Exception):  # noqa: N818
            pass

        told = 0.0

        def end(fraction: float) -> None:
            nonlocal told
            told = fraction
            if fraction >= at:
                raise Enough

        with pytest.raises(Enough):
            self.reduced(progress=end, **options).compute(checkpoint=path)
        return told

    @pytest.fixture(scope="class")
    @classmethod
    def kept(cls, tmp_path_factory: pytest.TempPathFactory) -> bytes:
        """What a run that was ended has written."""
        path = tmp_path_factory.mktemp("ended") / "kept.npz"
        cls().ended(path)
        return path.read_bytes()

    def reduced(self, **options: Any) -> Any:
        return pushed(5 * 4096 + 99, t=(0.0, 0.1), **{"reduce": all_reductions()} | options)

    def test_they_have_the_bits_of_one_run(self, tmp_path: Path) -> None:
        path = tmp_path / "kept.npz"
        want = all_bytes(self.reduced().compute())
        self.ended(path)
        told: list[float] = []
        assert all_bytes(self.reduced(progress=told.append).compute(checkpoint=path)) == want
        assert told[0] > 0.2
        # And again, without any run.
        runs: list[float] = []
        assert all_bytes(self.reduced(progress=runs.append).compute(checkpoint=path)) == want
        assert runs == []

    def test_members_that_fail_are_kept_too(self, tmp_path: Path) -> None:
        """Of bodies and loads that are drawn some are none: one is in the part that was kept."""

        class Enough(Exception):  # noqa: N818
            pass

        def end(fraction: float) -> None:
            if fraction > 0.4:
                raise Enough

        path = tmp_path / "kept.npz"
        drawn: dict[str, Any] = {"t": (0.0, 0.1), "reduce": all_reductions()}
        with pytest.raises(Enough):
            twisted(4096 + 999, progress=end, **drawn).compute(checkpoint=path)
        told: list[float] = []
        found = twisted(4096 + 999, progress=told.append, **drawn).compute(checkpoint=path)
        assert told[0] > 0.8
        whole = twisted(4096 + 999, **drawn).compute()
        assert all_bytes(found) == all_bytes(whole)

    def test_what_was_killed_goes_on(self, tmp_path: Path) -> None:
        path = tmp_path / "kept.npz"
        code = (
            "import sys, ensemble_cases as e, polhode.ensembles.checkpoints as c\n"
            "c._BETWEEN = 0.0\n"
            "e.pushed(12 * 4096, t=(0, 5), reduce=e.all_reductions()).compute(checkpoint=sys.argv[1])"
        )
        process = subprocess.Popen([sys.executable, "-c", code, str(path)], cwd=TESTS)
        try:
            deadline = time.monotonic() + 60.0
            while not path.exists() and time.monotonic() < deadline:
                time.sleep(0.005)
        finally:
            process.send_signal(signal.SIGKILL)
            process.wait()
        told: list[float] = []
        many = pushed(12 * 4096, t=(0, 5), reduce=all_reductions(), progress=told.append)
        found = many.compute(checkpoint=path)
        assert told[0] >= 1 / 12
        assert all_bytes(found) == all_bytes(pushed(12 * 4096, t=(0, 5), reduce=all_reductions()).compute())

    @pytest.mark.parametrize(
        ("change", "words"),
        [
            ({"seed": 6}, "seed is 5 there and 6 here"),
            ({"chunk": 8192}, "chunk is 4096 there and 8192 here"),
            ({"reduce": {"mean": all_reductions()["mean"]}}, "an option or a reduction is not the same"),
            ({"rtol": 1e-9}, "an option or a reduction is not the same"),
        ],
    )
    def test_another_one_is_refused(
        self, change: dict[str, Any], words: str, kept: bytes, tmp_path: Path
    ) -> None:
        path = tmp_path / "kept.npz"
        path.write_bytes(kept)
        with pytest.raises(FileFormatError, match=words):
            self.reduced(**change).compute(checkpoint=path)
        assert path.read_bytes() == kept

    def test_what_is_no_checkpoint_is_refused(self, kept: bytes, tmp_path: Path) -> None:
        path = tmp_path / "kept.npz"
        whole = kept
        np.savez(tmp_path / "other.npz", a=np.ones(3))
        for bad in (whole[: len(whole) // 2], b"anything", b"", (tmp_path / "other.npz").read_bytes()):
            path.write_bytes(bad)
            with pytest.raises(FileFormatError, match="holds no reductions that compute has begun"):
                self.reduced().compute(checkpoint=path)
            assert path.read_bytes() == bad
        with pytest.raises(ValueError, match=r"checkpoint: keeps reductions, .* to_zarr"):
            twisted(20).compute(checkpoint=path)

    @pytest.mark.parametrize(
        "change",
        [
            {"done": list(range(6)), "nodes": []},
            {"done": list(range(6))},
            {"nodes": []},
            {"done": []},
            {"done": [0, 1, 2, 99]},
            {"done": None},
        ],
    )
    def test_what_somebody_has_changed_is_refused(
        self, change: dict[str, Any], kept: bytes, tmp_path: Path
    ) -> None:
        path = tmp_path / "kept.npz"
        path.write_bytes(kept)
        with zipfile.ZipFile(path) as archive:
            members = {name: archive.read(name) for name in archive.namelist()}
        state = json.loads(members["state.json"])
        assert 0 < len(state["done"]) < 6
        for text in (json.dumps(state | change), "[]"):
            with zipfile.ZipFile(path, "w") as archive:
                for name, data in (members | {"state.json": text.encode()}).items():
                    archive.writestr(name, data)
            with pytest.raises(FileFormatError, match=r"has begun \(.*\); give another path"):
                self.reduced().compute(checkpoint=path)

    def test_a_tree_that_has_lost_a_node_is_not_written(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """A run may be ended while two nodes are merged."""
        path = tmp_path / "kept.npz"
        mean = all_reductions()["mean"]
        merged, calls = type(mean).merge, 0

        def ends(*arguments: Any) -> Any:
            nonlocal calls
            calls += 1
            if calls == 2:
                raise KeyboardInterrupt
            return merged(*arguments)

        monkeypatch.setattr("polhode.ensembles.checkpoints._BETWEEN", 0.0)
        with monkeypatch.context() as patch:
            patch.setattr(type(mean), "merge", ends)
            with pytest.raises(KeyboardInterrupt):
                self.reduced(reduce=mean).compute(checkpoint=path)
        told: list[float] = []
        found = self.reduced(reduce=mean, progress=told.append).compute(checkpoint=path)
        assert 0.5 < told[0] < 0.8
        assert all_bytes(found) == all_bytes(self.reduced(reduce=mean).compute())

    def test_one_that_is_complete_is_not_written_again(self, tmp_path: Path) -> None:
        path = tmp_path / "kept.npz"
        self.reduced().compute(checkpoint=path)
        before = path.stat().st_mtime_ns
        self.reduced().compute(checkpoint=path)
        assert path.stat().st_mtime_ns == before


def test_whatever_byte_of_a_chunk_is_wrong(tmp_path: Path, rng: np.random.Generator) -> None:
    """A chunk with one bit turned is written anew, or still gives the same numbers."""
    few = twisted(3)
    few.to_npz(tmp_path / "few")
    chunk = tmp_path / "few" / "chunk-00000000.npz"
    whole = chunk.read_bytes()
    with np.load(chunk) as arrays:
        want = {name: arrays[name].tobytes() for name in arrays}
    for number in range(150):
        # Half of them among the last bytes, which say where all others are.
        place = int(rng.integers(len(whole))) if number % 2 else len(whole) - 1 - int(rng.integers(22))
        wrong = bytearray(whole)
        wrong[place] ^= 1 << int(rng.integers(8))
        chunk.write_bytes(wrong)
        few.resume(tmp_path / "few")
        with np.load(chunk) as arrays:
            assert {name: arrays[name].tobytes() for name in arrays} == want, place
