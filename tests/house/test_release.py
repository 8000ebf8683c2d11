"""What is published: its links lead from anywhere, its versions agree, its bytes are those of the sources."""

from __future__ import annotations

import base64
import hashlib
import json
import re
import runpy
import subprocess
import sys
import tomllib
import zipfile
from importlib.metadata import requires
from pathlib import Path
from typing import Any

import pytest
import yaml
from packaging.requirements import Requirement
from places import ROOT

PACKAGING = ROOT / "packaging"


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> Any:
    """The names of a file in ``packaging``."""
    monkeypatch.syspath_prepend(PACKAGING)
    return lambda name: runpy.run_path(str(PACKAGING / f"{name}.py"))


def test_make_build_installs_what_the_extra_asks_for() -> None:
    told = subprocess.check_output([sys.executable, PACKAGING / "needs.py", "all"], text=True).split()
    asked, extras = {"numpy>=2.0"}, ["all"]
    for extra in extras:  # which grows
        for line in map(Requirement, requires("polhode") or []):
            if line.marker and line.marker.evaluate({"extra": extra}):
                extras += sorted(line.extras)
                asked |= {f"{line.name}{line.specifier}"} if line.name != "polhode" else set()
    assert set(told) == asked
    assert len(told) > 10


class TestLinks:
    def test_every_link_of_the_readme_is_absolute_where_it_is_published(self, script: Any) -> None:
        dress = script("dress")
        text = dress["absolute"]((ROOT / "README.md").read_text("utf-8"))
        targets = re.findall(r"\]\(([^)\s]+)\)", text)
        assert len(targets) > 13
        assert [target for target in targets if not target.startswith("https://")] == []
        home = dress["address"]()
        within = [target.removeprefix(home) for target in targets if target.startswith(home)]
        for target in within:
            kind, version, path = re.fullmatch(r"/(raw|tree|blob)/v([\d.]+)/(.+)", target).groups()  # type: ignore[union-attr]
            assert version == dress["manifest"]()["version"]
            assert (ROOT / path).is_dir() == (kind == "tree")
            assert (ROOT / path).exists()
        assert any(target.startswith("/raw/") for target in within)

    @pytest.mark.parametrize(
        ("text", "found"),
        [
            ("[a](docs/index.md#b)", "[a]({}/blob/v{}/docs/index.md#b)"),
            ("![a [b]](docs/images/t-handle.png)", "![a [b]]({}/raw/v{}/docs/images/t-handle.png)"),
            ("[e](examples)", "[e]({}/tree/v{}/examples)"),
            ("[a](https://b.c/d) [e](#f) x](y", "[a](https://b.c/d) [e](#f) x](y"),
        ],
    )
    def test_links_of_each_kind(self, script: Any, text: str, found: str) -> None:
        dress = script("dress")
        assert dress["absolute"](text) == found.format(dress["address"](), dress["manifest"]()["version"])

    def test_the_address_stands_in_one_place(self, script: Any) -> None:
        address = script("dress")["address"]()
        holding = [
            path.relative_to(ROOT).as_posix()
            for pattern in ("*.*", ".github/**/*.*", "rust/*/*.*", "docs/*.*", "packaging/**/*.*")
            for path in ROOT.glob(pattern)
            if path.is_file() and path.suffix in (".toml", ".md", ".yml", ".yaml", ".cff", ".py")
            if address in path.read_text("utf-8")
        ]
        # A source distribution is dressed: there links and addresses are whole.
        dressed = ["README.md", "pyproject.toml"] if (ROOT / "PKG-INFO").exists() else []
        assert sorted(holding) == sorted(["Cargo.toml", *dressed])

    @pytest.mark.parametrize(
        ("target", "held"),
        [
            ("{}/blob/v0.1.0/README.md#a", True),
            ("{}/tree/v0.1.0/docs", True),
            ("https://b.c/d", True),
            ("{}/blob/v0.1.0/GONE.md", False),
            ("docs/index.md", False),
        ],
    )
    def test_links_of_a_wheel(self, script: Any, tmp_path: Path, target: str, held: bool) -> None:
        found = script("try_wheel")
        home = script("dress")["address"]()
        with zipfile.ZipFile(tmp_path / "a.whl", "w") as archive:
            for name in ("licenses/LICENSE-MIT", "licenses/LICENSE-APACHE", "sboms/a.cyclonedx.json"):
                archive.writestr(f"a.dist-info/{name}", "")
            for name in ("polhode/py.typed", "polhode/_core.pyi"):
                archive.writestr(name, "")
            link = f"[words]({target.format(home)})"
            archive.writestr("a.dist-info/METADATA", f"Project-URL: Repository, {home}\n\n{link}\n")
        lacking = found["lacks"](tmp_path / "a.whl")
        assert lacking.pop(0) == r"no /licenses/LICENSE-THIRD-PARTY$"
        assert (lacking == []) == held


class TestVersions:
    def test_the_citation_the_crates_and_the_package_agree(self, script: Any) -> None:
        import polhode

        version = script("dress")["manifest"]()["version"]
        cited = (ROOT / "CITATION.cff").read_text("utf-8")
        assert f"\nversion: {version}\n" in cited
        assert polhode.__version__ == version
        workspace = tomllib.loads((ROOT / "Cargo.toml").read_text("utf-8"))["workspace"]
        assert workspace["dependencies"]["polhode"]["version"] == version
        assert f'version: "{version}"' in (PACKAGING / "conda" / "recipe.yaml").read_text("utf-8")

    def test_notes_are_the_section_of_the_changelog(self, script: Any) -> None:
        notes = script("notes")["notes"]
        log = "# Log\n\n## [Unreleased]\n\n- c\n\n## [1.10.0] - 2026-01-02\n\n- b\n\n## [1.1.0]\n- a\n"
        assert [notes(tag, log) for tag in ("Unreleased", "v1.10.0", "1.1.0", "v1.1", "v2.0.0")] == [
            "- c\n",
            "- b\n",
            "- a\n",
            None,
            None,
        ]
        assert notes("Unreleased", (ROOT / "CHANGELOG.md").read_text("utf-8"))

    @pytest.mark.parametrize("words", [["v9.9.9"], ["Unreleased", "--to-publish"]])
    def test_notes_of_what_is_no_release_are_refused(
        self,
        script: Any,
        words: list[str],
        monkeypatch: pytest.MonkeyPatch,
        capsys: pytest.CaptureFixture[str],
    ) -> None:
        monkeypatch.setattr(sys, "argv", ["notes.py", *words])
        with pytest.raises(SystemExit):
            script("notes")["main"]()
        assert "v9.9.9" not in capsys.readouterr().out

    def test_nothing_is_built_to_publish_without_an_address(
        self, script: Any, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
    ) -> None:
        build = script("build")
        if ".invalid/" not in build["address"]():
            pytest.skip("the project has an address")
        monkeypatch.setattr(sys, "argv", ["build.py", "--to-publish"])
        with pytest.raises(SystemExit):
            build["main"]()
        assert "`repository` is still a placeholder" in capsys.readouterr().err

    def test_the_workflow_tries_the_least_rust_that_is_stated(self) -> None:
        workflow = (ROOT / ".github" / "workflows" / "release.yml").read_text("utf-8")
        least = tomllib.loads((ROOT / "Cargo.toml").read_text("utf-8"))["workspace"]["package"][
            "rust-version"
        ]
        assert f"cargo +{least} test" in workflow

    def test_the_places_of_wheels_are_those_of_the_changelog(self) -> None:
        workflow = (ROOT / ".github" / "workflows" / "release.yml").read_text("utf-8")
        places = re.findall(r"target: \w+, triple: (\w+)-(\w+-[\w-]+)", workflow)
        systems = {system for _, system in places}
        assert len(places) == 2 * len(systems) == 8
        assert {system.split("-")[-1] for system in systems} == {"gnu", "musl", "darwin", "msvc"}
        assert 'python: ["3.11", "3.14t"]' in workflow


class TestPins:
    """Compiler and tools of a release are those of its commit: the same bytes can be made later."""

    def test_every_tool_that_builds_has_its_version(self) -> None:
        pins = [
            Requirement(line) for line in (PACKAGING / "pins.txt").read_text().splitlines() if line[0] != "#"
        ]
        versions = {pin.name: str(pin.specifier).removeprefix("==") for pin in pins}
        assert all(re.fullmatch(r"==[\d.]+", str(pin.specifier)) for pin in pins)
        project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
        for line in project["dependency-groups"]["package"] + project["build-system"]["requires"]:
            tool = Requirement(line)
            assert tool.specifier.contains(versions[tool.name])

    def test_the_workflow_takes_them(self) -> None:
        workflow = (ROOT / ".github" / "workflows" / "release.yml").read_text("utf-8")
        builds = re.findall(r"python -m pip install --group package(.*)", workflow)
        assert set(builds) == {" --constraint packaging/pins.txt"}
        jobs = yaml.safe_load(workflow)["jobs"]
        compilers = {
            job["env"]["RUSTUP_TOOLCHAIN"]
            for job in jobs.values()
            if "RUSTUP_TOOLCHAIN" in job.get("env", {})
        }
        (compiler,) = compilers
        least = tomllib.loads((ROOT / "Cargo.toml").read_text("utf-8"))["workspace"]["package"][
            "rust-version"
        ]
        assert [*map(int, compiler.split("."))] >= [*map(int, least.split("."))]
        calls = re.compile(r"build\.py|cargo (?:package|publish)")
        building = {name for name, job in jobs.items() if calls.search(str(job["steps"]))}
        assert building == {"sdist", "wheels", "same-bytes", "crate"}
        assert all("RUSTUP_TOOLCHAIN" in jobs[name]["env"] for name in building)

    def test_what_is_published_was_tried(self) -> None:
        jobs = yaml.safe_load((ROOT / ".github" / "workflows" / "release.yml").read_text("utf-8"))["jobs"]
        assert set(jobs["publish"]["needs"]) == set(jobs) - {"publish", "crate"}
        assert jobs["crate"]["needs"] == "publish"
        assert jobs["crate"]["if"] == jobs["publish"]["if"]

    def test_the_lowest_versions_are_tried_of_each_extra_but_the_large_ones(self, script: Any) -> None:
        lowest = script("try_lowest")
        assert {"cli", "plot", "chem", "image", "cluster", "all"} <= set(lowest["extras"]())
        assert all((ROOT / name).exists() for name in lowest["TESTS"])


class TestLicences:
    def test_licences_of_all_that_is_compiled_in(self, script: Any) -> None:
        text = script("dress")["third_party"]()
        for crate in ("nalgebra", "pyo3", "numpy", "thiserror"):
            assert re.search(rf"^- {crate} [\d.]+", text, re.MULTILINE)
        for other in ("proptest", "serde", "glam", "num-bigint", "syn ", "polhode 0", "/root/", "/home/"):
            assert other not in text

    def test_the_expression_names_what_leaves_no_choice(self, script: Any) -> None:
        dress = script("dress")
        expression, own = dress["expression"], dress["manifest"]()["license"]
        crates = [
            "Apache-2.0/MIT",
            "Zlib OR Apache-2.0 OR MIT",
            "BSD-2-Clause",
            "ISC OR Zlib",
            "BSD-2-Clause",
        ]
        told = expression(own, [{"license": each} for each in crates])
        assert told == "(MIT OR Apache-2.0) AND BSD-2-Clause AND (ISC OR Zlib)"
        recipe = (PACKAGING / "conda" / "recipe.yaml").read_text("utf-8")
        assert f"\n  license: {expression(own, dress['linked']())}\n" in recipe
        assert "packaging/dress.py  # writes LICENSE-THIRD-PARTY\n" in recipe

    def test_lints_and_workflow_look_at_the_licences_of_both_lockfiles(self) -> None:
        makefile = (ROOT / "Makefile").read_text("utf-8")
        assert re.search(r"^lint:.* licences ", makefile, re.MULTILINE)
        rule = makefile[makefile.index("\nlicences:") :].split("\n\n")[0]
        assert "Cargo.toml rust/fuzz/Cargo.toml" in rule
        assert "licenses bans sources" in rule
        workflow = (ROOT / ".github" / "workflows" / "release.yml").read_text("utf-8")
        assert "- run: make licences\n" in workflow
        assert "--config packaging/deny.toml check advisories\n" in workflow

    def test_both_licences_stand_in_the_crate(self) -> None:
        for name in ("LICENSE-MIT", "LICENSE-APACHE"):
            assert (ROOT / "rust" / "core" / name).read_bytes() == (ROOT / name).read_bytes()


class TestBytes:
    def test_a_wheel_without_traces(self, script: Any, tmp_path: Path) -> None:
        plain = script("plain")["without_traces"]
        wheels = []
        for number in (1, 2):
            wheel, out = tmp_path / f"{number}.whl", tmp_path / f"out{number}.whl"
            bill = {
                "serialNumber": f"urn:{number}",
                "metadata": {"timestamp": number, "name": f"file:///tmp/x{number}/rust"},
            }
            library = zipfile.ZipInfo("a.so", (2000 + number, 1, 1, 0, 0, 0))
            # What one machine lets its group write, and another does not.
            library.external_attr = (0o100775, 0o100755)[number - 1] << 16
            files: list[tuple[zipfile.ZipInfo | str, bytes]] = [
                (library, b"code"),
                ("a.dist-info/sboms/a.cyclonedx.json", json.dumps(bill).encode()),
                ("a.dist-info/RECORD", b"old"),
            ]
            with zipfile.ZipFile(wheel, "w") as archive:
                for name, data in files[:: (1, -1)[number - 1]]:
                    archive.writestr(name, data)
            plain(wheel, out, f"/tmp/x{number}")
            wheels.append(out.read_bytes())
        assert wheels[0] == wheels[1]
        with zipfile.ZipFile(out) as archive:
            record = archive.read("a.dist-info/RECORD").decode().splitlines()
            assert [line.split(",")[0] for line in record] == archive.namelist()
            assert archive.namelist()[-1] == "a.dist-info/RECORD"
            assert [entry.external_attr >> 16 for entry in archive.infolist()] == [
                0o100644,
                0o100755,
                0o100644,
            ]
            assert json.loads(archive.read(archive.namelist()[0])) == {
                "metadata": {"name": "file:///polhode/rust"}
            }
            digest = base64.urlsafe_b64encode(hashlib.sha256(b"code").digest()).decode().rstrip("=")
            assert record[1] == f"a.so,sha256={digest},4"


def test_the_program_that_tries_a_wheel_runs_here(script: Any) -> None:
    program = script("try_wheel")["PROGRAM"]
    done = subprocess.run([sys.executable, "-c", program], check=False, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert re.fullmatch(r"polhode \S+ on 3\.\S+ with(out)? the lock\n", done.stdout)


class TestStrangers:
    def test_the_source_distribution_holds_all_files(self, script: Any, tmp_path: Path) -> None:
        for name in ("tests/a/b.py", "docs/c.md", "Makefile", ".ci/run"):
            (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
            (tmp_path / name).write_text("", "utf-8")
        told = tomllib.loads(f"include = [{script('dress')['everything'](tmp_path)}]")["include"]
        assert [line["path"] for line in told] == [".ci/**/*", "Makefile", "docs/**/*", "tests/**/*"]
        assert {line["format"] for line in told} == {"sdist"}
        held = {path for line in told for path in tmp_path.glob(line["path"]) if path.is_file()}
        assert len(held) == 4

    def test_what_dressing_replaces_is_there(self, script: Any) -> None:
        text = (ROOT / "pyproject.toml").read_text("utf-8")
        assert text.count("[project.scripts]") == 1
        assert text.count('\nlicense = "') == 1
        if (ROOT / "PKG-INFO").exists():  # the sources of a release are dressed already
            assert text.count('"LICENSE-APACHE", "LICENSE-THIRD-PARTY"]') == text.count("[project.urls]") == 1
        else:
            assert text.count(script("dress")["SOME"]) == text.count('"LICENSE-APACHE"]') == 1

    def test_words_after_two_dashes_go_to_pytest(self, script: Any) -> None:
        divided = script("try_tests")["divided"]
        assert divided(["dist", "--quick", "--", "-k", "x"]) == (["dist", "--quick"], ["-k", "x"])
        assert divided(["dist"]) == (["dist"], [])

    def test_the_pythons_of_this_machine(self, script: Any) -> None:
        tests = script("try_tests")
        found = tests["found"]()
        mine = tests["mine"]()
        if mine.endswith("t"):
            assert mine not in found
        else:
            assert found[mine] == sys.executable
        for version, path in found.items():
            told = subprocess.check_output([path, "-c", "import sys; print(*sys.version_info[:2], sep='.')"])
            assert told.decode().strip() == version

    def test_all_tests_are_run_but_in_a_quick_share(self, script: Any) -> None:
        asked = script("try_tests")["tests"]
        assert [word for word in asked(quick=False) if word.endswith(".py")] == []
        makefile = (ROOT / "Makefile").read_text("utf-8")
        assert asked(quick=False)[3:5] == ["-m", "not long and not alone"]
        assert '-m pytest -m "not long and not alone"' in makefile
        assert "packaging/try_tests.py dist --other --quick\n" in makefile
        assert makefile.count("packaging/try_tests.py dist\n") == 1

    def test_the_quick_share_is_there(self, script: Any) -> None:
        tests = script("try_tests")
        for name in tests["QUICK"]:
            assert (ROOT / tests["test_file"](name)).exists()

    def test_a_folder_without_both_files_is_refused(
        self,
        script: Any,
        tmp_path: Path,
        monkeypatch: pytest.MonkeyPatch,
        capsys: pytest.CaptureFixture[str],
    ) -> None:
        monkeypatch.setattr(sys, "argv", ["try_tests.py", str(tmp_path)])
        with pytest.raises(SystemExit):
            script("try_tests")["main"]()
        assert "one source distribution and one wheel" in capsys.readouterr().err


class TestFiles:
    @pytest.mark.parametrize(
        "name",
        [
            ".github/SECURITY.md",
            ".github/CODE_OF_CONDUCT.md",
            ".github/pull_request_template.md",
            ".github/ISSUE_TEMPLATE/bug.yml",
            ".readthedocs.yaml",
            "packaging/conda/recipe.yaml",
            "packaging/deny.toml",
        ],
    )
    def test_it_is_there(self, name: str) -> None:
        assert (ROOT / name).stat().st_size > 100

    def test_what_crates_may_be_is_what_they_are(self) -> None:
        rules = tomllib.loads((PACKAGING / "deny.toml").read_text("utf-8"))
        sources = {
            package["source"]
            for lock in (ROOT / "Cargo.lock", ROOT / "rust/fuzz/Cargo.lock")
            for package in tomllib.loads(lock.read_text("utf-8"))["package"]
            if "source" in package
        }
        assert [source.partition("+")[0] for source in sources] == ["registry"]
        assert rules["sources"] == {"unknown-registry": "deny", "unknown-git": "deny"}
