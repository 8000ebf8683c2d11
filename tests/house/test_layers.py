"""Arrows point down and there are no circles: between the files of a language, in the order of the table."""

from __future__ import annotations

from pathlib import Path

import pytest
from layers import circles, faults, python_graph, rooms, upward
from places import ROOT

TABLE = Path(__file__).with_name("layers.toml")


def package(folder: Path, files: dict[str, str]) -> Path:
    """A package of files with these texts."""
    root = folder / "house"
    for name, text in files.items():
        path = root / f"{name}.py"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return root


HOUSE = {
    "__init__": "",
    "ground": "import math",
    "first": "from house import ground",
    "attic/__init__": "from house.attic.chest import gold",
    "attic/chest": "from house.first import door\ngold = 1",
}
ORDER = """
[python]
rooms = [
    { name = "ground", files = ["ground"], uses = [] },
    { name = "first", files = ["first"], uses = ["ground"] },
    { name = "attic", files = ["attic/*"], uses = ["first"] },
    { name = "roof", files = ["__init__"], uses = ["ground", "first", "attic"] },
]
"""


class TestThePackage:
    def test_arrows_point_down_and_there_are_no_circles(self) -> None:
        graph = python_graph(ROOT / "python" / "polhode")
        assert faults(graph, rooms(TABLE, "python")) == []
        assert "io/content" in graph["cli/files"]
        assert sum(map(len, graph.values())) > 200

    def test_what_the_doors_pass_on_is_counted_where_it_stands(self) -> None:
        graph = python_graph(ROOT / "python" / "polhode")
        assert "_core" in graph["cli/brick"]  # from polhode import RigidBody
        assert not any("__init__" in others for others in graph.values())


class TestTheChecker:
    @pytest.mark.parametrize(
        ("changed", "told"),
        [
            ({}, []),
            ({"ground": "import house.attic.chest"}, ["a circle: attic/chest - first - ground"]),
            ({"ground": "def f():\n    from house.first import door"}, ["a circle: first - ground"]),
            ({"ground": "def f():\n    import_module('house.first')"}, ["a circle: first - ground"]),
            ({"first": "import house.ground\nfrom house.attic import gold"}, ["attic/chest - first"]),
            ({"ground": "if TYPE_CHECKING:\n    from house.first import door"}, []),
            ({"ground": "if TYPE_CHECKING:\n    pass\nelse:\n    import house.first"}, ["first - ground"]),
            ({"ground": "if not TYPE_CHECKING:\n    import house.first"}, ["first - ground"]),
        ],
    )
    def test_circles(self, changed: dict[str, str], told: list[str], tmp_path: Path) -> None:
        graph = python_graph(package(tmp_path, HOUSE | changed))
        found = [" - ".join(circle) for circle in circles(graph)]
        assert len(found) == len(told)
        assert all(words.removeprefix("a circle: ") == one for words, one in zip(told, found, strict=True))

    @pytest.mark.parametrize(
        ("changed", "told"),
        [
            ({}, []),
            (
                {"ground": "def f():\n    import house.attic.chest", "first": ""},
                ["ground (ground) uses attic/chest (attic)"],
            ),
            (
                {"attic/chest": "from house import ground\ngold = 1"},
                ["attic/chest (attic) uses ground (ground)"],
            ),
            ({"first": "import house"}, ["first (first) uses __init__ (roof)"]),
            ({"cellar": ""}, ["cellar is in no room"]),
        ],
    )
    def test_arrows_upward(self, changed: dict[str, str], told: list[str], tmp_path: Path) -> None:
        table = tmp_path / "layers.toml"
        table.write_text(ORDER)
        graph = python_graph(package(tmp_path, HOUSE | changed))
        assert upward(graph, rooms(table, "python")) == told

    def test_a_room_may_use_only_what_is_below_it(self, tmp_path: Path) -> None:
        table = tmp_path / "layers.toml"
        table.write_text(ORDER.replace('["ground"], uses = []', '["ground"], uses = ["attic"]'))
        with pytest.raises(ValueError, match=r"ground uses \['attic'\], which is not below it"):
            rooms(table, "python")

    def test_a_room_without_files_is_told(self, tmp_path: Path) -> None:
        table = tmp_path / "layers.toml"
        table.write_text(ORDER)
        graph = python_graph(package(tmp_path, {"__init__": "", "ground": "", "first": ""}))
        assert faults(graph, rooms(table, "python")) == ["the room attic has no file"]
