"""``polhode ensemble``: the numbers of `polhode.ensemble` bit for bit, whatever ended the run before."""

from __future__ import annotations

import io
import json
import signal
import subprocess
import sys
import time
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import polhode
import pytest
from command_line import one_line, run, write_obj
from oracles.meshes import cube
from polhode import RigidBody, distributions, ensemble, loads
from polhode.cli.ensemble import make_reductions, numbers
from polhode.euler_angles import to_quaternion
from scipy.spatial.transform import Rotation

if TYPE_CHECKING:
    from collections.abc import Callable

MOMENTS = ("--moments", "1.00 ± 0.01, 2.00(2), 2.5")
SPIN = ("--omega", "0, 1.00 ± 0.05, 0.01")
FREE = (*MOMENTS, *SPIN, "--attitude", "any", "--end", "20 s", "--n", "5000", "--seed", "7")
BODY = distributions.apply(
    RigidBody.from_principal,
    1.0,
    distributions.normal((1.0, 2.0, 2.5), sigma=(0.01, 0.02, 0.0)),
)
OMEGA = distributions.normal((0.0, 1.0, 0.01), sigma=(0.0, 0.05, 0.0))


def free(t: Any = (0.0, 20.0), n: int = 5000, **options: Any) -> polhode.Ensemble:
    """The same in Python."""
    return ensemble(BODY, t, OMEGA, distributions.uniform_rotation(), n=n, seed=7, **options)


def told(*words: object) -> dict[str, Any]:
    """What the command says as JSON."""
    code, out, err = run("ensemble", *words, "--format", "json")
    assert (code, err) == (0, "")
    found: dict[str, Any] = json.loads(out)
    return found


def as_rows(many: polhode.Ensemble) -> Any:
    """Mean, sigma and three quantiles of six numbers, from Python's reductions."""
    found = many.compute()
    spread = found["spread"]
    sigma = np.sqrt(np.diagonal(spread.covariance))
    return np.column_stack([spread.mean, sigma, found["shares"].values.T])


def rows_of(values: dict[str, Any]) -> Any:
    return np.array(
        [[row[key] for key in ("mean", "sigma", "low", "median", "high")] for row in values["end"]]
    )


class TestSpread:
    def test_it_is_that_of_python_to_the_last_bit(self) -> None:
        values = told(*FREE)
        want = free(reduce=make_reductions(has_modes=True))
        assert rows_of(values).tobytes() == as_rows(want).tobytes()
        table = want.compute()["modes"].table.sum(axis=0)
        assert sum(row["share"] for row in values["modes"]) == pytest.approx(1.0)
        assert len(values["modes"]) == np.count_nonzero(table)
        assert (values["members"], values["seed"], values["drawn"]) == (5000, 7, "moments, omega, attitude")

    @pytest.mark.parametrize(
        ("words", "body", "omega", "more"),
        [
            (
                ("--moments", "1 2 2.5", "--omega", "0 to 1, 0, 1 to 2 rad/s", "--wheel", "z, 0.5"),
                RigidBody.from_principal(1.0, (1, 2, 2.5)),
                distributions.uniform((0, 0, 1), (1, 0, 2)),
                {"load": loads.rotor((0.0, 0.0, 0.5))},
            ),
            (
                (
                    "--moments", "1.0 to 1.1, 2, 2.5", "--mass", "2.0 ± 0.1 kg", "--omega", "0 0 1",
                    "--wheel", "e1, 0.5", "--wheel", "0, 3, 4, 1 N m s", "--attitude", "0 0.5 0",
                ),
                distributions.apply(
                    RigidBody.from_principal,
                    distributions.normal(2.0, sigma=0.1),
                    distributions.uniform((1.0, 2, 2.5), (1.1, 2, 2.5)),
                ),
                (0.0, 0.0, 1.0),
                {
                    "load": loads.rotor(np.array((0.5, 0.6, 0.8))),
                    "attitude": to_quaternion((0.0, 0.5, 0.0)),
                },
            ),
            (
                (
                    "--moments", "2 2 1", "--mass", "1.0(1)", "--center-of-mass", "0, 0, 0.4 to 0.6",
                    "--gravity", "9.81", "--omega", "0, 0, 20.0 ± 0.5", "--attitude", "0, 0.5 ± 0.1, 0",
                    "--method", "exact",
                ),
                distributions.apply(
                    RigidBody.from_principal,
                    distributions.normal(1.0, sigma=0.1),
                    np.array((2.0, 2.0, 1.0)),
                    center_of_mass=distributions.uniform((0, 0, 0.4), (0, 0, 0.6)),
                ),
                distributions.normal((0, 0, 20.0), sigma=(0, 0, 0.5)),
                {
                    "load": loads.uniform_gravity((0, 0, -9.81)),
                    "about": "origin",
                    "method": "exact",
                    "attitude": distributions.apply(
                        to_quaternion, distributions.normal((0, 0.5, 0), sigma=(0, 0.1, 0))
                    ),
                },
            ),
        ],
        ids=["uniform, a wheel", "two wheels", "a top"],
    )  # fmt: skip
    def test_loads_and_distributions_are_those_of_python(
        self, words: tuple[str, ...], body: Any, omega: Any, more: dict[str, Any]
    ) -> None:
        values = told(*words, "--end", "3", "--n", "300")
        want = ensemble(body, [0, 3], omega, n=300, seed=0, reduce=make_reductions(has_modes=False), **more)
        assert rows_of(values).tobytes() == as_rows(want).tobytes()
        assert "modes" not in values

    def test_a_body_from_a_file(self, tmp_path: Path) -> None:
        path = write_obj(tmp_path / "cube.obj", *cube())
        values = told(path, "--omega", "0, 0, 1 to 2", "--end", "3", "--n", "50")
        want = ensemble(
            RigidBody.from_file(path, density=1.0),
            [0, 3],
            distributions.uniform((0, 0, 1), (0, 0, 2)),
            n=50,
            seed=0,
            reduce=make_reductions(has_modes=True),
        )
        assert rows_of(values).tobytes() == as_rows(want).tobytes()
        assert "density 1 was used" in " ".join(values["notes"])

    def test_the_numbers_of_a_member(self) -> None:
        """The tilt is the angle of SciPy's rotated z axis from z."""
        rng = np.random.default_rng(1)
        body = RigidBody.from_principal(1.0, (1, 2, 2.5))
        motion = body.simulate([0.0, 3.0], rng.normal(size=(20, 3)), Rotation.random(20, rng=2))
        found = numbers(motion)
        z = Rotation.from_quat(motion.quaternion[:, -1]).apply((0, 0, 1))
        np.testing.assert_allclose(found[:, 5], np.degrees(np.arccos(z[:, 2])), atol=1e-6)
        sizes = np.linalg.norm(motion.omega, axis=-1)
        np.testing.assert_allclose(found[:, 3:5], np.column_stack([sizes[:, 1], sizes[:, 1] / sizes[:, 0]]))
        assert found[:, :3].tobytes() == motion.omega[:, -1].tobytes()

    def test_what_is_drawn_has_the_mean_and_the_sigma_that_were_typed(self) -> None:
        """A sphere keeps its angular velocity: the spread at the end is that of the start."""
        values = told(
            "--moments", "1 1 1", "--omega", "0, 1.00 ± 0.05, 2.0(3)", "--end", "9", "--n", "40000"
        )  # fmt: skip
        rows = rows_of(values)
        for row, mean, sigma in ((1, 1.0, 0.05), (2, 2.0, 0.3)):
            assert rows[row, 0] == pytest.approx(mean, abs=5 * sigma / 200)
            assert rows[row, 1] == pytest.approx(sigma, rel=5 / 280)
            np.testing.assert_allclose(
                rows[row, 2:], mean + sigma * np.array((-1.645, 0, 1.645)), atol=sigma / 20
            )

    def test_members_that_make_no_body_are_counted(self) -> None:
        values = told("--moments", "1, 1, 1.9 ± 0.1", "--omega", "0 0 1", "--end", "1", "--n", "500")
        drawn = distributions.normal((1, 1, 1.9), sigma=(0, 0, 0.1)).draw(500, seed=0, argument="body.1")
        many = np.count_nonzero(drawn[:, 2] > 2.0)
        assert 0 < many < 200
        assert f"{many} members failed, and are left out of these numbers" in values["notes"]

    def test_a_checkpoint_goes_on(self, tmp_path: Path) -> None:
        path = tmp_path / "spread.npz"
        once = told(*FREE, "--checkpoint", path)
        assert path.stat().st_size > 0
        again = told(*FREE, "--checkpoint", path)
        assert once == again
        code, _, err = run("ensemble", *FREE[:-1], "8", "--checkpoint", path)
        assert code == 2
        assert "seed is 7 there and 8 here" in err


@cache
def with_a_wheel() -> Any:
    """What `test_after_a_kill_it_goes_on` writes."""
    return ensemble(BODY, [0, 150], OMEGA, load=loads.rotor((0, 0, 0.5)), n=1500, seed=0, chunk=100).compute()


class TestSaved:
    def same(self, path: Path, want: Any) -> None:
        with np.load(path) as found:
            assert set(found.files) == {"ensemble.json", *map(str, want.variables)}
            for name in want.variables:
                assert found[name].tobytes() == want[name].to_numpy().tobytes()
                assert found[name].shape == want[name].shape

    def test_a_file_of_numpy(self, tmp_path: Path) -> None:
        path = tmp_path / "clones.npz"
        values = told(*FREE, "--save", path, "--times", "5", "--chunk", "700")
        self.same(path, free(np.linspace(0.0, 20.0, 5)).compute())
        assert values["status"] == [{"status": "complete", "members": 5000}]
        assert list(tmp_path.iterdir()) == [path]

    def test_a_group_of_zarr(self, tmp_path: Path) -> None:
        xarray = pytest.importorskip("xarray")
        pytest.importorskip("zarr")
        path = tmp_path / "clones.zarr"
        values = told(*FREE, "--save", path, "--chunk", "700")
        want = free().compute()
        with xarray.open_zarr(path, chunks=None) as found:
            for name in want.variables:
                assert np.asarray(found[name], want[name].dtype).tobytes() == want[name].to_numpy().tobytes()
        assert values["status"] == [{"status": "complete", "members": 5000}]

    def test_it_counts_those_that_are_refused(self, tmp_path: Path) -> None:
        words = ("--moments", "1, 1, 1.9 ± 0.1", "--omega", "0 0 1", "--end", "1", "--n", "500")
        rows = told(*words, "--save", tmp_path / "some.npz")["status"]
        assert [row["status"] for row in rows] == ["complete", "refused"]
        assert sum(row["members"] for row in rows) == 500

    @pytest.mark.parametrize("name", ["clones.npz", "clones.zarr"])
    def test_after_a_kill_it_goes_on(self, tmp_path: Path, name: str) -> None:
        if name.endswith("zarr"):
            pytest.importorskip("zarr")
        words = [
            *MOMENTS, *SPIN, "--wheel", "z, 0.5", "--end", "150", "--n", "1500", "--chunk", "100",
            "--save", str(tmp_path / name),
        ]  # fmt: skip
        begun = tmp_path / (f"{name}.parts" if name.endswith("npz") else f"{name}/status")
        process = subprocess.Popen([sys.executable, "-m", "polhode", "ensemble", *words])
        deadline = time.monotonic() + 60.0
        while time.monotonic() < deadline and len(list(begun.glob("[0-9c]*"))) < 2:
            time.sleep(0.005)
        process.send_signal(signal.SIGKILL)
        process.wait()
        code, _, err = run("ensemble", *words)
        assert code == 2
        assert "exists already; add --resume to continue it, or give another name" in err
        code, _, err = run("ensemble", *words, "--seed", "4", "--resume")
        assert code == 2
        assert "holds another ensemble: seed is 0 there and 4 here" in err
        assert told(*words, "--resume")["status"] == [{"status": "complete", "members": 1500}]
        want = with_a_wheel()
        if name.endswith("npz"):
            self.same(tmp_path / name, want)
            assert not begun.exists()
        else:
            import zarr

            group: Any = zarr.open_group(tmp_path / name, mode="r")
            assert group["omega"][:].tobytes() == want.omega.to_numpy().tobytes()
        # Nothing is missing now, and this is told too.
        assert told(*words, "--resume")["status"] == [{"status": "complete", "members": 1500}]

    def test_a_file_that_is_no_ensemble_is_kept(self, tmp_path: Path) -> None:
        path = tmp_path / "other.npz"
        np.savez(path, a=1)
        before = path.read_bytes()
        code, _, err = run("ensemble", *FREE, "--save", path, "--resume")
        assert (code, one_line(err)) == (2, True)
        assert "holds no ensemble that --save has written" in err
        assert path.read_bytes() == before


TOP = ("--moments", "2 2 1", "--omega", "0, 0, 20.0 ± 0.5", "--gravity", "9.81", "--end", "1")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ((), "ensemble: give a file, or principal moments with --moments"),
        (MOMENTS, "--omega: state the start"),
        ((*MOMENTS, *SPIN), "--end: state the time of the end"),
        ((*MOMENTS, *SPIN, "--end", "0"), "--end: expected a time other than 0, got 0"),
        ((*MOMENTS, *SPIN, "--end", "nan"), "--end: 'nan' is not a number"),
        ((*FREE, "--inertia", "1 2 2.5"), "--moments and --inertia: both say what the body is"),
        (("a.obj", *FREE), "--moments: the body is that of a.obj; give one of the two"),
        ((*FREE[:-3], "0"), "--n: expected a number from 1 to 2^62 - 1, got 0"),
        ((*FREE[:-3], str(2**62)), f"--n: expected a number from 1 to 2^62 - 1, got {2**62}"),
        ((*FREE[:-1], "-1"), "--seed: expected an integer from 0 to 2**64 - 1, got -1"),
        ((*FREE[:-1], str(2**64)), f"--seed: expected an integer from 0 to 2**64 - 1, got {2**64}"),
        ((*FREE[:-1], "1.5"), "--seed: expected a whole number, got '1.5'"),
        ((*FREE, "--chunk", "0"), "--chunk: expected a positive integer, got 0"),
        (
            (*FREE, "--chunk", "1000"),
            "--chunk: expected a multiple of 4096, the members that are reduced together, got 1000; 4096 is",
        ),
        ((*FREE, "--rtol", "-1"), "rtol must be between 1e-28 and 0.1"),
        ((*FREE, "--resume"), "--resume: it continues the file of --save"),
        ((*FREE, "--times", "5"), "--times: the report has the spread at the end only"),
        ((*FREE, "--save", "a.npz", "--times", "1"), "--times: 1 is less than 2, the start and the end"),
        ((*FREE, "--save", "a.npz", "--checkpoint", "b.npz"), "--checkpoint: it is for the report on"),
        (
            (*FREE, "--save", "a.txt"),
            "--save: 'a.txt' has a suffix that is not written; use one of .npz, .zarr",
        ),
        ((*FREE, "--save", "no/a.npz"), "--save: no/a.npz: there is no directory no"),
        ((*FREE, "--save", "a.npz", "--output", "a.npz"), "--output: a.npz is written by --save too"),
        ((*FREE, "--save", "a.npz", "--resume"), "--resume: there is nothing at a.npz to continue"),
        ((*FREE, "--gravity", "9.81"), "--gravity: the weight acts at the centre of mass; state --mass and"),
        (
            (*TOP, "--mass", "1.0(1)", "--center-of-mass", "0 0 1"),
            "--method: with --gravity a body that is drawn needs one; state",
        ),
        (
            (*TOP, "--mass", "1", "--center-of-mass", "0 0 1", "--wheel", "z, 1"),
            "--wheel: it cannot be combined with --gravity",
        ),
        ((*FREE, "--wheel", "z"), "--wheel: 'z' is not an axis"),
        (
            (*FREE, "--density", "2700"),
            "--density: it is about a file, and --moments need none; leave it out",
        ),
        (
            ("--moments", "1 2 2.5", "--omega", "0 0 1", "--end", "1"),
            "ensemble: nothing is drawn, so that all members would be the same",
        ),
        ((*MOMENTS, "--omega", "0 to 1, 0 ± 1, 1", "--end", "1"), "has a sigma and bounds"),
        (
            (*MOMENTS, "--omega", "2 to 1, 0, 1", "--end", "1"),
            "--omega: the lower bound must not exceed the upper one, got 2 to 1 rad/s",
        ),
        (
            (*MOMENTS, "--omega", "0 to 1 to 2, 0, 1", "--end", "1"),
            "--omega: expected 3 numbers with commas",
        ),
        (
            (*MOMENTS, "--omega", "-1e308 to 1e308, 0, 1", "--end", "1"),
            "--omega: low, high: their difference",
        ),
        (
            (*MOMENTS, "--omega", "1 kg ± 1 kg, 0 kg, 1 kg", "--end", "1"),
            "--omega: 'kg' cannot be converted",
        ),
        (
            ("--moments", "1, 1, 3.0 ± 0.1", "--omega", "0 0 1", "--end", "1"),
            "none of the first 16 members can begin; member 0: principal moments 1.0, 1.0, 2.",
        ),
        ((*FREE, "--client", "nowhere"), "--client: no scheduler of dask answers at 'nowhere'"),
    ],
)
def test_what_it_refuses(
    words: tuple[str, ...], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if "--client" in words:
        pytest.importorskip("distributed")
    monkeypatch.chdir(tmp_path)
    code, out, err = run("ensemble", *words)
    assert (code, out) == (2, "")
    assert one_line(err)
    assert message in err
    assert not list(tmp_path.iterdir())


def test_a_body_with_sigmas_is_refused_with_the_way_out(tmp_path: Path) -> None:
    path = write_obj(tmp_path / "cube.obj", *cube())
    code, _, err = run("ensemble", path, "--mass", "1.0 ± 0.1", "--omega", "0, 0, 1 to 2", "--end", "1")
    assert code == 2
    assert "ensemble: the body has sigmas" in err


def test_the_help_tells_of_all_that_is_drawn() -> None:
    code, out, _ = run("ensemble", "--help")
    assert code == 0
    for word in (
        "--moments",
        "--omega",
        "--attitude",
        "--n",
        "--seed",
        "--save",
        "--resume",
        "--client",
    ):
        assert word in out


@pytest.mark.parametrize("is_terminal", [True, False])
def test_progress_is_shown_on_a_terminal_alone(
    monkeypatch: pytest.MonkeyPatch, is_terminal: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    class Stream(io.StringIO):
        def isatty(self) -> bool:
            return is_terminal

    stream = Stream()
    monkeypatch.setattr("polhode._progress._SILENT", 0.0)
    monkeypatch.setattr(sys, "stderr", stream)
    main: Callable[[list[str]], int] = polhode.cli.main
    assert main(["ensemble", *FREE, "--chunk", "4096"]) == 0
    assert ("5000 members [" in stream.getvalue()) == is_terminal
    assert "at the end" in capsys.readouterr().out
