"""The script of three.js: served out of its package, and explained where that cannot be installed."""

from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("aiohttp", reason="aiohttp is not installed: requirements/web.lock")

from aiohttp import web
from aiohttp.test_utils import make_mocked_request

from ur.web.runs.watcher import EndedCommand
from ur.web.server.data.data_pages import ThreeScript


class Commands:
    """Commands of which each fails."""

    def __init__(self) -> None:
        self.run_words: list[tuple[str, ...]] = []

    async def run(self, *words: str, limit: float) -> EndedCommand:
        assert limit > 0
        self.run_words.append(words)
        return EndedCommand(1, "", "installing\nerror: jupyter_threejs_sage could not be installed: no network\n")


async def test_script_that_cannot_be_installed_is_explained() -> None:
    commands: Any = Commands()
    with pytest.raises(web.HTTPServiceUnavailable) as refusal:
        await ThreeScript(commands, lambda: None).serve(make_mocked_request("GET", "/three.js"))
    assert "could not be installed: no network" in (refusal.value.text or "")
    assert commands.run_words == [("web", "--prepare-3d")]


async def test_installed_script_is_served_compressed_and_once(tmp_path: Path) -> None:
    path = tmp_path / "three.min.js"
    path.write_text("script " * 100)
    commands: Any = Commands()
    script = ThreeScript(commands, lambda: path)
    packed = await script.serve(make_mocked_request("GET", "/three.js", headers={"Accept-Encoding": "gzip"}))
    plain = await script.serve(make_mocked_request("GET", "/three.js"))
    assert isinstance(packed.body, bytes)
    assert len(packed.body) < 100
    assert plain.body == path.read_bytes()
    again = await script.serve(
        make_mocked_request("GET", "/three.js", headers={"If-None-Match": plain.headers["ETag"]})
    )
    assert again.status == 304
