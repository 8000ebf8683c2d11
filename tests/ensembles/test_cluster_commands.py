"""The commands of the page about clusters, as plain processes of this machine where there is no SLURM."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest
from places import ROOT
from polhode.cli.ensemble import client_at
from polhode.errors import PolhodeError

pytest.importorskip("distributed")
pytestmark = pytest.mark.skipif(os.name != "posix", reason="the script is for a shell")
PAGE = ROOT / "docs" / "ensembles.md"

#: What stands for SLURM's: as many processes as it says, two at most, which take any ports.
SRUN = """#!{python}
import subprocess, sys
options = [word for word in sys.argv[1:] if word.startswith("--")]
count = min(int(options[0].removeprefix("--ntasks=")), 2)
command = sys.argv[1:][2:]
assert options[:2][1] == "--exact"
if command[:2] == ["dask", "scheduler"]:
    command += ["--port", "0", "--no-dashboard"]
if command[:2] == ["dask", "worker"]:
    command += ["--no-dashboard"]
if command[0] in ("dask", "python"):
    command = [sys.executable, *(["-m", "dask"] if command[0] == "dask" else []), *command[1:]]
running = [subprocess.Popen(command) for _ in range(count)]
sys.exit(max(one.wait() for one in running))
"""

CLONES = """
import sys
import numpy as np
from dask.distributed import Client
from polhode import RigidBody, distributions, ensemble

def main():
    spin = distributions.normal((0, 0, 1), sigma=0.1)
    body = RigidBody.from_principal(1.0, (1, 2, 2.5))
    with Client(scheduler_file=sys.argv[1]) as client:
        client.wait_for_workers(2, timeout=60)
        found = ensemble(body, [0, 1], spin, n=400, seed=1, chunk=50, client=client).compute()
        client.shutdown()
    here = ensemble(body, [0, 1], spin, n=400, seed=1).compute()
    print("the same bits:", all(np.array_equal(found[name], here[name]) for name in here))

if __name__ == "__main__":
    main()
"""


def test_the_script_for_slurm_runs_with_plain_processes(tmp_path: Path) -> None:
    (script,) = re.findall(r"```bash\n(#!/bin/bash\n#SBATCH.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
    (tmp_path / "job.sh").write_text(script, "utf-8")
    (tmp_path / "clones.py").write_text(CLONES, "utf-8")
    (tmp_path / "bin").mkdir()
    srun = tmp_path / "bin" / "srun"
    srun.write_text(SRUN.format(python=sys.executable), "utf-8")
    srun.chmod(0o755)
    slurm = {"SLURM_CPUS_PER_TASK": "1", "SLURM_JOB_ID": "7"}
    paths = {"PATH": f"{srun.parent}{os.pathsep}{os.environ['PATH']}"}
    job = subprocess.Popen(
        ["bash", "job.sh"],
        cwd=tmp_path,
        env=os.environ | slurm | paths,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        out, told = job.communicate(timeout=100)
    finally:
        # SLURM ends what a script leaves behind.
        with suppress(ProcessLookupError):
            os.killpg(job.pid, signal.SIGKILL)
    assert job.returncode == 0, told[-3000:]
    assert "the same bits: True" in out


# The client of the option ``--client``.

dask = pytest.importorskip("dask")
distributed = pytest.importorskip("distributed")


def test_one_that_finds_no_scheduler_leaves_dask_as_it_was() -> None:
    before = dask.config.get("scheduler", None)
    with pytest.raises(PolhodeError, match="no scheduler of dask answers at 'nowhere'"), client_at("nowhere"):
        pass
    assert dask.config.get("scheduler", None) == before
    with pytest.raises(ValueError, match="No clients found"):
        distributed.default_client()
