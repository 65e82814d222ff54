"""Make `static/wire_numbers.js` and `static/layers.css` of the page from `ur.web.wire`. A test compares them."""

import json
from enum import IntEnum
from pathlib import Path

from ur.web.wire.frames import TILE, UNIT, Kind
from ur.web.wire.layers import SHOWN, Layer

STATIC = Path(__file__).resolve().parents[1] / "src/ur/web/static"
_MADE = "Made by tools/make_wire_numbers.py: edit src/ur/web/wire/frames.py or layers.py instead."


def make_script() -> str:
    """Numbers and names of frames and layers, as a module of JavaScript."""
    labels = json.dumps({each.name: each.label for each in SHOWN}, indent=2)
    return "\n".join(
        (
            "// @ts-check",
            f"/** {_MADE} */",
            "",
            f"export const KIND = {_numbers(Kind)};",
            f"export const LAYER = {_numbers(Layer)};",
            f"export const TILE = {TILE};",
            f"export const UNIT = {UNIT};",
            "/** Labels of the layers over the map, by name. @type {Record<string, string>} */",
            f"export const LAYERS = {labels};",
            f"export const SHOWN_AT_FIRST = {json.dumps([each.name for each in SHOWN if each.at_first])};",
            "",
        )
    )


def make_style() -> str:
    """The colours of the layers, on a light and on a dark page."""
    light = "".join(f"  --map-{each.name}: {each.light};\n" for each in SHOWN)
    dark = "".join(f"    --map-{each.name}: {each.dark};\n" for each in SHOWN)
    swatches = "".join(f".swatch.{each.name} {{ background: var(--map-{each.name}); }}\n" for each in SHOWN)
    dark = f"@media (prefers-color-scheme: dark) {{\n  :root {{\n{dark}  }}\n}}\n"
    return f"/* {_MADE} */\n:root {{\n{light}}}\n{dark}{swatches}"


def _numbers(numbers: type[IntEnum]) -> str:
    return f"{{ {', '.join(f'{each.name}: {each.value}' for each in numbers)} }}"


FILES = {"wire_numbers.js": make_script, "layers.css": make_style}

if __name__ == "__main__":
    for name, make in FILES.items():
        (STATIC / name).write_text(make(), encoding="utf-8")
