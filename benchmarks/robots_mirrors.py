"""Files of a repository at a commit, from a mirror of it or from GitHub."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path

PARTS = frozenset(
    f".{end}"
    for end in "urdf sdf world xml config stl obj mtl dae ply msh gltf glb bin skn png jpg jpeg".split()  # noqa: SIM905
)


def mirror(folder: Path, repository: str, commit: str, may_fetch: bool) -> Path | None:
    """Find the repository that has a commit, or fetch it."""
    owner, name = repository.split("/")
    named = [folder / f"{owner}+{name}", folder / owner / name, *sorted(folder.glob(f"*+{name}"))]
    for top in named:
        for git in (top / "repo" / ".git", top / "repo", top / ".git", top, top.with_name(f"{top.name}.git")):
            if (git / "HEAD").is_file() and not _git(
                git, "cat-file", "-e", f"{commit}^{{commit}}"
            ).returncode:
                return git
    if not may_fetch:
        return None
    git = named[0]
    subprocess.run(["git", "init", "--quiet", "--bare", git], check=True)
    address = f"https://github.com/{repository}"
    return None if _git(git, "fetch", "--quiet", "--depth=1", address, commit).returncode else git


def _git(git: Path, *words: str) -> subprocess.CompletedProcess[bytes]:
    return subprocess.run(["git", "--git-dir", git, *words], capture_output=True, check=False)


def unpacked(git: Path, repository: str, commit: str, scratch: Path) -> Path:
    """Write the parts of robots at a commit into a folder, as in a clone; what a mirror lacks stays out."""
    folder = scratch / f"{repository.replace('/', '+')}@{commit[:12]}" / repository.split("/")[1]
    if folder.exists():
        return folder
    half = folder.with_name(f"{folder.name}.half")
    shutil.rmtree(half, ignore_errors=True)
    (half / ".git").mkdir(parents=True)
    tree = _git(git, "ls-tree", "-r", "-z", commit).stdout.decode(errors="replace")
    entries = [(*line.split("\t")[0].split(), line.split("\t")[1]) for line in tree.split("\0") if line]
    wanted = [e for e in entries if e[0] == "120000" or Path(e[3]).suffix.lower() in PARTS]
    with tempfile.TemporaryFile() as names:
        names.write("".join(f"{blob}\n" for _, _, blob, _ in wanted).encode())
        names.seek(0)
        command = ["git", "--git-dir", git, "cat-file", "--batch"]
        with subprocess.Popen(
            command, stdin=names, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
        ) as batch:
            assert batch.stdout is not None  # it is a pipe
            for mode, _, _, name in wanted:
                told = batch.stdout.readline().split()
                if len(told) < 3:
                    continue
                content = batch.stdout.read(int(told[2]) + 1)[:-1]
                path = half / name
                path.parent.mkdir(parents=True, exist_ok=True)
                if mode == "120000":
                    path.symlink_to(content.decode())
                else:
                    path.write_bytes(content)
    return half.rename(folder)
