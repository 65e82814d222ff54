"""The page has the numbers, names and colours that the server has."""

import runpy
from pathlib import Path

import pytest

TOOL = runpy.run_path(str(Path(__file__).parents[2] / "tools" / "make_wire_numbers.py"))


@pytest.mark.parametrize("name", TOOL["FILES"])
def test_committed_files_of_the_page_are_made_from_the_tables_of_the_server(name: str) -> None:
    committed = (TOOL["STATIC"] / name).read_text(encoding="utf-8")
    assert committed == TOOL["FILES"][name](), "run tools/make_wire_numbers.py"


def test_every_layer_of_small_things_is_drawn() -> None:
    from ur_nodes.web.layers.overlays import OVERLAYS

    script = (TOOL["STATIC"] / "overlays.js").read_text(encoding="utf-8")
    drawn = script.partition("const DRAW = {")[2].partition("};")[0]
    assert all(f"  {layer.name.lower()}: " in drawn for layer in OVERLAYS if layer)
