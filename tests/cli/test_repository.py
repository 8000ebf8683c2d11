"""The hook and the action of this repository, tried in a fresh one that holds a robot, without a network."""

from __future__ import annotations

import base64
import gzip
import json
import os
import re
import shlex
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import jsonschema
import pytest
import yaml
from markdown_code import blocks
from places import ROOT
from robot_texts import BALL, link, urdf
from sarif_log import SCHEMA

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="runs the shell of Linux and macOS")
BAD, GOOD = urdf(link("arm", 5.0, 1.0, BALL)), urdf(link("arm", 5.0, 0.02, BALL))
SAYS = re.compile(
    r"^robots/arm\.urdf:1:\d+: error: arm: 1 1 1 is the unit tensor; .* \[placeholder\]$", re.MULTILINE
)


def git(folder: Path, *words: str) -> str:
    identity = ["-c", "user.name=a", "-c", "user.email=a@example.org", "-c", "commit.gpgsign=false"]
    return subprocess.check_output(["git", *identity, *words], cwd=folder, text=True, stderr=subprocess.PIPE)


@pytest.fixture
def surroundings(tmp_path: Path) -> dict[str, str]:
    """What a process finds: this polhode as a program, no proxy and no address of a package index."""
    programs = tmp_path / "programs"
    programs.mkdir()
    program = programs / "polhode"
    program.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -m polhode "$@"\n')
    program.chmod(0o755)
    found = {
        "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}",
        "PYTHONPATH": os.environ.get("PYTHONPATH", ""),
        "HOME": str(tmp_path),
        "PRE_COMMIT_HOME": str(tmp_path / "cache"),
        "GIT_CONFIG_GLOBAL": os.devnull,
        "PIP_INDEX_URL": "file:///nowhere",
        "LC_ALL": "C.UTF-8",
    }
    # A path of the checkout may be missing in a process of another folder.
    found["PYTHONPATH"] = os.pathsep.join(
        [str(Path(p).resolve()) for p in found["PYTHONPATH"].split(os.pathsep) if p]
    )
    return found


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    folder = tmp_path / "robot"
    (folder / "robots").mkdir(parents=True)
    (folder / "robots" / "arm.urdf").write_text(BAD)
    (folder / "package.xml").write_text("<package><name>robot</name></package>")
    git(folder, "init", "--quiet")
    git(folder, "add", ".")
    return folder


def hook() -> dict[str, Any]:
    (found,) = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text())
    assert isinstance(found, dict)
    return found


def called(command: list[str], folder: Path, surroundings: dict[str, str]) -> tuple[int, str]:
    done = subprocess.run(command, cwd=folder, env=surroundings, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


class TestHook:
    def test_its_entry_finds_the_fault(self, repository: Path, surroundings: dict[str, str]) -> None:
        """As pre-commit calls it: with the files of the index that its pattern finds."""
        files = [name for name in git(repository, "ls-files").split() if re.search(hook()["files"], name)]
        assert files == ["package.xml", "robots/arm.urdf"]
        entry = [*shlex.split(hook()["entry"]), *files]
        code, out = called(entry, repository, surroundings)
        assert code == 1
        assert SAYS.search(out)
        (repository / "robots" / "arm.urdf").write_text(GOOD)
        assert called(entry, repository, surroundings)[0] == 0

    def test_pre_commit_refuses_the_commit(
        self, repository: Path, surroundings: dict[str, str], tmp_path: Path
    ) -> None:
        if find_spec("pre_commit") is None:
            pytest.skip("pre-commit is not installed")
        hooks = tmp_path / "hooks"  # what of this repository a hook needs
        hooks.mkdir()
        (hooks / ".pre-commit-hooks.yaml").write_bytes((ROOT / ".pre-commit-hooks.yaml").read_bytes())
        git(hooks, "init", "--quiet")
        git(hooks, "add", ".")
        git(hooks, "commit", "--quiet", "--message", "hooks")
        revision = git(hooks, "rev-parse", "HEAD").strip()
        config = {"repos": [{"repo": str(hooks), "rev": revision, "hooks": [{"id": "polhode-check"}]}]}
        (repository / ".pre-commit-config.yaml").write_text(yaml.safe_dump(config))
        git(repository, "add", ".")
        command = [sys.executable, "-m", "pre_commit", "run"]
        code, out = called(command, repository, surroundings)
        assert code == 1
        assert SAYS.search(out)
        (repository / "robots" / "arm.urdf").write_text(GOOD)
        git(repository, "add", ".")
        code, out = called(command, repository, surroundings)
        assert (code, "Passed" in out) == (0, True)

    def test_the_page_shows_it(self) -> None:
        """The page names the hook, and holds all of it for a configuration that needs no other repository."""
        page = blocks(ROOT / "docs" / "how_to" / "repository.md")
        configs = [yaml.safe_load(code) for language, code in page if language == "yaml"]
        local, by_release, with_baseline, workflow = configs
        own = {k: v for k, v in hook().items() if k != "description"}
        assert local["repos"][0]["hooks"] == [own]
        assert with_baseline["repos"][0]["hooks"] == [own | {"args": ["--baseline", "accepted.json"]}]
        assert by_release["repos"][0]["hooks"][0]["id"] == hook()["id"]
        (inputs,) = (step["with"] for step in workflow["jobs"]["check"]["steps"] if "with" in step)
        assert set(inputs) <= set(yaml.safe_load((ROOT / "action.yml").read_text())["inputs"])


class TestAction:
    @pytest.fixture
    def steps(self) -> dict[str, Any]:
        return {
            step["id"]: step for step in yaml.safe_load((ROOT / "action.yml").read_text())["runs"]["steps"]
        }

    def run_step(
        self, step: dict[str, Any], folder: Path, surroundings: dict[str, str], **inputs: str
    ) -> tuple[int, str, dict[str, str]]:
        """Run a step as the runner does; exit code, what it prints, its outputs."""
        script, outputs = folder.parent / "step.sh", folder.parent / "outputs"
        script.write_text(step["run"])
        outputs.write_text("")
        assert set(step["env"]) <= set(inputs)
        given = {
            **surroundings,
            "GITHUB_WORKSPACE": str(folder),
            "GITHUB_OUTPUT": str(outputs),
            "GITHUB_REPOSITORY": "someone/robot",
            "GITHUB_SHA": "0" * 40,
            "GITHUB_REF": "refs/pull/1/merge",
            "RUNNER_TEMP": str(folder.parent),
            **inputs,
        }
        code, out = called(
            ["bash", "--noprofile", "--norc", "-e", "-o", "pipefail", str(script)], folder.parent, given
        )
        told = dict(line.split("=", 1) for line in outputs.read_text().splitlines())
        return code, out, told

    def inputs(self, **others: str) -> dict[str, str]:
        given = yaml.safe_load((ROOT / "action.yml").read_text())["inputs"]
        names = {"FILES": "files", "ARGUMENTS": "arguments", "SARIF": "sarif"}
        return {name: given[key]["default"] for name, key in names.items()} | {"POLHODE": "polhode"} | others

    def test_it_finds_the_fault(
        self, steps: dict[str, Any], repository: Path, surroundings: dict[str, str]
    ) -> None:
        code, out, told = self.run_step(steps["check"], repository, surroundings, **self.inputs())
        assert (code, told) == (1, {"sarif": "polhode.sarif"})
        assert SAYS.search(out)
        log = json.loads((repository / "polhode.sarif").read_text())
        jsonschema.Draft202012Validator(SCHEMA).validate(log)
        (result,) = log["runs"][0]["results"]
        place = result["locations"][0]["physicalLocation"]["artifactLocation"]
        assert place == {"uri": "robots/arm.urdf", "uriBaseId": "%SRCROOT%"}

    def test_options_and_patterns_are_handed_on(
        self, steps: dict[str, Any], repository: Path, surroundings: dict[str, str]
    ) -> None:
        done = self.run_step(
            steps["check"],
            repository,
            surroundings,
            **self.inputs(ARGUMENTS="--baseline known.json --accept"),
        )
        assert done[0] == 0
        assert (repository / "known.json").exists()
        for arguments, code in (("--baseline known.json", 0), ("", 1)):
            given = self.inputs(ARGUMENTS=arguments, FILES="robots/*.urdf")
            assert self.run_step(steps["check"], repository, surroundings, **given)[0] == code
        code, out, told = self.run_step(
            steps["check"], repository, surroundings, **self.inputs(FILES="*.sdf")
        )
        assert (code, told) == (2, {})
        assert "no file of this repository fits: *.sdf" in out

    def test_it_uploads_what_it_found(
        self, steps: dict[str, Any], repository: Path, surroundings: dict[str, str], tmp_path: Path
    ) -> None:
        """The program of GitHub gets the file packed, as its interface asks; a stand-in shows it."""
        (repository / "polhode.sarif").write_text('{"version": "2.1.0"}')
        gh = tmp_path / "programs" / "gh"
        gh.write_text('#!/bin/sh\nprintf "%s\\n" "$@"\n')
        gh.chmod(0o755)
        given = {"GH_TOKEN": "none", "SARIF": "polhode.sarif"}
        code, out, _ = self.run_step(steps["upload"], repository, surroundings, **given)
        assert code == 0
        assert "repos/someone/robot/code-scanning/sarifs" in out
        assert f"commit_sha={'0' * 40}\n" in out
        (packed,) = re.findall(r"^sarif=@(.+)$", out, re.MULTILINE)
        assert gzip.decompress(base64.b64decode(Path(packed).read_bytes())) == b'{"version": "2.1.0"}'
