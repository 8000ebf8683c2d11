"""The notes of a release, from the changelog: ``python packaging/notes.py v1.2.3``.

With ``--to-publish`` only where version, citation and tag agree, and the project has an address.
"""

from __future__ import annotations

import argparse
import re

from dress import ROOT, absolute, address, manifest


def notes(tag: str, changelog: str) -> str | None:
    """The section of the changelog that has the name of the tag."""
    version = re.escape(tag.removeprefix("v"))
    found = re.search(rf"^## \[{version}\][^\n]*\n(.*?)(?=^## \[|\Z)", changelog, re.MULTILINE | re.DOTALL)
    return found and found[1].strip() + "\n"


def main() -> None:
    """Print the notes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("tag", help="v and the version; or Unreleased")
    parser.add_argument("--to-publish", action="store_true")
    options = parser.parse_args()
    found = notes(options.tag, (ROOT / "CHANGELOG.md").read_text("utf-8"))
    if found is None:
        parser.error(
            f"CHANGELOG.md has no section [{options.tag.removeprefix('v')}]: rename [Unreleased] to it"
        )
    if options.to_publish:
        version = manifest()["version"]
        cited = (ROOT / "CITATION.cff").read_text("utf-8")
        if options.tag != f"v{version}":
            parser.error(f"the tag {options.tag} is not v{version}, as Cargo.toml says")
        if f"\nversion: {version}\n" not in cited or not re.search(r"^date-released: ", cited, re.MULTILINE):
            parser.error("CITATION.cff needs this version and its date-released")
        if ".invalid/" in address():
            parser.error(
                "Cargo.toml: `repository` is still a placeholder; write the address of the project there"
            )
    print(absolute(found), end="")


if __name__ == "__main__":
    main()
