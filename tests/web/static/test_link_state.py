"""The page's state in its address: `static/link_state.js`, run by Node.js."""

import json
import re
import shutil
import subprocess
from typing import Any

import pytest

from ur.web.server.static_files import FOLDER
from ur.web.wire.layers import LAYERS
from ur.web.wire.requests import MOST_PLOTS

NODE = shutil.which("node")
pytestmark = pytest.mark.skipif(NODE is None, reason="Node.js is not installed")


def run(script: str) -> Any:
    assert NODE is not None
    modules = ("wire_numbers.js", "link_state.js")  # one text: imports of a text have no folder
    texts = [(FOLDER / name).read_text().replace("export ", "") for name in modules]
    source = re.sub(r"^import .*;$", "", "".join(texts), flags=re.MULTILINE) + (
        "const read = (text) => { const { layers, plots, ...more } = readLink(text);"
        " const again = writeLink(readLink(text));"
        " return { layers: [...layers], ...more, plots: plots && [...plots], again }; };\n"
        f"console.log(JSON.stringify({script}));"
    )
    command = [NODE, "--input-type=module", "-"]
    done = subprocess.run(command, input=source, capture_output=True, text=True, timeout=120, check=True)
    return json.loads(done.stdout)


def test_links_show_the_same_and_what_is_malformed_is_left_out() -> None:
    assert run("SWITCHES") == [*LAYERS, "trail"]
    texts = [
        "",
        "?layers=scan,local&at=1.5,-2.25,40&follow=1",
        "?layers=",
        "?layers=scan,drop,local,scan&at=1,2&follow=yes",
        "?at=NaN,1e999,-Infinity",
        "?at=1,2,3&turned=1",
    ]
    first, full, none, bad, wild, turned = run(f"{json.dumps(texts)}.map(read)")
    closed: dict[str, Any] = {"turned": False, "plots": None, "panels": [], "dock": 0}
    assert first == {"layers": ["scan", "plan", "frontiers"], "at": None, "follow": False, "again": "", **closed}
    assert full["layers"] == ["scan", "local"]
    assert (full["at"], full["follow"]) == ([1.5, -2.25, 40], True)
    assert full["again"] == "?layers=scan,local&follow=1&at=1.5,-2.25,40"
    assert (none["layers"], none["again"]) == ([], "?layers=")
    assert (bad["layers"], bad["at"], bad["follow"]) == (["scan", "local"], None, False)
    assert bad["again"] == "?layers=scan,local"
    assert wild["at"] is None
    assert (turned["turned"], turned["again"]) == (True, texts[5])


def test_link_holds_the_plots_while_they_are_shown() -> None:
    plots = ["/odom:twist.twist.linear.x", "/a/b:data"]
    many = ",".join(f"/a{number}:x" for number in range(20))
    texts = [
        f"?plots={','.join(plots)}",
        "?plots=",
        f"?plots={plots[0]},odom:x,/a,<b>",
        f"?plots={many}",
        "?layers=trail",
    ]
    two, none, bad, full, trail = run(f"{json.dumps(texts)}.map(read)")
    assert (two["plots"], two["again"]) == (plots, texts[0])
    assert (none["plots"], none["again"]) == ([], "?plots=")
    assert bad["plots"] == plots[:1]
    assert len(full["plots"]) == MOST_PLOTS
    assert run("listLayers(new Set(['trail', 'scan']))") == "scan", "the trail is the page's own"
    assert trail["layers"] == ["trail"]


def test_link_holds_the_open_panels_and_their_width() -> None:
    texts = [
        "?panels=places,camera&dock=420",
        "?panels=places,plots&plots=/a:b",
        "?panels=camera&plots=/a:b",
        "?panels=a,b,a,<i>,c,d,e,f&dock=-5",
        "?plots=/a:b",
    ]
    two, plotted, added, many, plots = run(f"{json.dumps(texts)}.map(read)")
    assert (two["panels"], two["dock"], two["again"]) == (["places", "camera"], 420, texts[0])
    assert (plotted["panels"], plotted["again"]) == (["places", "plots"], texts[1])
    assert added["panels"] == ["camera", "plots"]
    assert (many["panels"], many["dock"]) == (["c", "d", "e", "f"], 0)
    assert (plots["panels"], plots["again"]) == (["plots"], texts[4])
