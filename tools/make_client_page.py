"""Make docs/reference/client.md from the docstrings of `ur_nodes.client`. A test compares it."""

import inspect
import re
from pathlib import Path

from ur_nodes.client import Interrupted, Lost, Refused, Robot, RobotError, TakenOver
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.values import Battery, Map, PackedPicture, Scan

PAGE = Path(__file__).resolve().parents[1] / "docs" / "reference" / "client.md"
HEAD = """# The Python library `ur_nodes.client`

Made by `tools/make_client_page.py` from the docstrings in `src/ur_nodes/client/script/`: edit those instead.
[Write a script](../how-to/write-a-script.md) shows how to begin.

Places and poses are in the frame of the map, in m, m and rad.
Angles grow to the left; those that a program gives are in degrees where their name says so.

"""


def make_page() -> str:
    """The page as Markdown."""
    parts = [HEAD, describe_class(Robot), "## Errors\n\n"]
    parts += [
        f"- **`{each.__name__}`**: {text_of(each)}\n" for each in (RobotError, Refused, Lost, TakenOver, Interrupted)
    ]
    parts.append("\n## Values\n\n")
    parts += [
        f"- **`{describe_fields(each)}`**: {text_of(each)}\n"
        for each in (Pose2, Scan, Map, Grid, Battery, PackedPicture)
    ]
    return "".join(parts)


def describe_class(kind: type) -> str:
    """A class with its public methods, in the order of its source."""
    lines = [f"## `{kind.__name__}`\n\n{text_of(kind)}\n\n{text_of(kind.__dict__['__init__'])}\n\n"]
    for name, method in vars(kind).items():
        if inspect.isfunction(method) and not name.startswith("_"):
            lines.append(f"### `{describe_signature(name, method)}`\n\n{text_of(method)}\n\n")
    return "".join(lines)


def describe_signature(name: str, method: object) -> str:
    """The signature of a method, without `self`."""
    assert inspect.isfunction(method)
    found = inspect.signature(method)
    arguments = [str(each).replace("'", "") for each in found.parameters.values() if each.name != "self"]
    result = str(found.return_annotation).strip("'")
    return f"{name}({', '.join(arguments)})" + ("" if result == "None" else f" -> {result}")


def describe_fields(kind: type) -> str:
    """A value's name and the names of its fields."""
    fields = list(getattr(kind, "__dataclass_fields__", ()))
    return f"{kind.__name__}({', '.join(fields)})" if fields else kind.__name__


def text_of(thing: object) -> str:
    """A docstring, one paragraph a line."""
    paragraphs = re.split(r"\n\s*\n", inspect.getdoc(thing) or "")
    return "\n\n".join(" ".join(each.split()) for each in paragraphs)


if __name__ == "__main__":
    PAGE.write_text(make_page(), encoding="utf-8")
