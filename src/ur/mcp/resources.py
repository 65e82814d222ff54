"""The resources of the server: the robot as values and pictures, what runs, logs, plans of launch files, and pages."""

import json
import re
from pathlib import Path

import mcp_types as types

from ur.mcp.assistant import Assistant, mark_data
from ur.mcp.calls import hint
from ur.mcp.commands import run_command
from ur.source.printable import printable
from ur.source.project import project_folder
from ur.source.suggest import did_you_mean

_MOST_LINES = 200
_PAGES = "docs://docs/"
_JSON, _TEXT, _PNG, _MARKDOWN = "application/json", "text/plain", "image/png", "text/markdown"

RESOURCES = {
    "robot://pose": ("The pose of the robot in the map: m, m, degrees", _JSON),
    "robot://plan": ("The path that the robot is driving, in the map, m", _JSON),
    "robot://map": ("The map as a picture, with y up; its scale is in robot://map/scale", _PNG),
    "robot://map/scale": ("Metres for each pixel, and the place of the lower left corner", _JSON),
    "robot://nodes": ("The programs and nodes that run", _TEXT),
    "robot://log": ("What the program that runs has reported", _TEXT),
    "robot://actions": ("The log of what assistants have asked for", _TEXT),
}
COMMANDS = {"robot://nodes": ("ps",), "robot://log": ("logs", "--lines", str(_MOST_LINES))}
TEMPLATES = {
    "log://{node}": ("What a node has printed, its last lines", _TEXT),
    "launch-plan://{package}/{file}": ("What a launch file starts: nodes, parameters, arguments", _JSON),
}
_NODE = re.compile(r"log://(/?[A-Za-z][\w/]{0,200})")
_LAUNCH = re.compile(r"launch-plan://([A-Za-z][\w.-]{0,100})/([A-Za-z0-9_][\w.-]{0,100})")

Contents = types.TextResourceContents | types.BlobResourceContents


async def read_resource(assistant: Assistant, uri: str) -> Contents:
    """The contents of a resource. Raises ValueError, which names those that there are, and LinkError."""
    verb, names = _command_of(uri)
    if verb:
        text = (await run_command(verb, names))[1]
        return types.TextResourceContents(uri=uri, mime_type=_TEXT, text=mark_data(text))
    if uri in list_pages():
        path = project_folder() / "docs" / f"{uri.removeprefix(_PAGES)}.md"
        return types.TextResourceContents(uri=uri, mime_type=_MARKDOWN, text=path.read_text(encoding="utf-8"))
    if uri == "robot://actions":
        lines = "\n".join(assistant.log.read()[-_MOST_LINES:])
        return types.TextResourceContents(uri=uri, mime_type=_TEXT, text=mark_data(lines))
    if uri not in RESOURCES:
        expected = ", ".join((*RESOURCES, *TEMPLATES))
        unknown, near = repr(printable(uri)[:80]), hint(did_you_mean(uri[:80], (*RESOURCES, *list_pages())))
        raise ValueError(f"unknown resource {unknown}, expected a page of the list, or one of {expected}{near}")
    values = await assistant.look(picture=uri.startswith("robot://map"))
    if not uri.startswith("robot://map"):
        value = json.dumps(values.get(uri.removeprefix("robot://")))
        return types.TextResourceContents(uri=uri, mime_type=_JSON, text=value)
    found = values.get("map")
    drawn = found if isinstance(found, dict) else {}
    picture = str(drawn.pop("png", ""))
    if uri == "robot://map":
        return types.BlobResourceContents(uri=uri, mime_type=_PNG, blob=picture)
    return types.TextResourceContents(uri=uri, mime_type=_JSON, text=json.dumps(drawn))


def list_pages() -> dict[str, tuple[str, str]]:
    """The pages of the documentation, where this is a clone."""
    folder = project_folder() / "docs"
    pages = [each for part in ("how-to", "explain") for each in sorted((folder / part).glob("*.md"))]
    return {f"{_PAGES}{each.relative_to(folder).with_suffix('')}": (_title(each), _MARKDOWN) for each in pages}


def _command_of(uri: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The command that prints a resource, () for none, and the names that the URI gives to it."""
    if found := _NODE.fullmatch(uri):
        return ("logs", "--lines", str(_MOST_LINES)), (found[1],)
    if found := _LAUNCH.fullmatch(uri):
        return ("launch", "--dump", "json", "--no-commands"), found.groups()
    return COMMANDS.get(uri, ()), ()


def _title(page: Path) -> str:
    with page.open(encoding="utf-8") as file:
        return file.readline().lstrip("# ").strip()
