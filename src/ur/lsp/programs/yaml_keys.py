"""Keys of YAML files, known from files of their kind and from the programs that read them.

Keys and values of a YAML file are those of files of its kind: base, world and map files of the launch library, and
files beside it. A comment at a key there is its documentation. The keys of a parameter file are also the parameters
of the nodes that load it.
"""

import re
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path

from ur.complete.yaml_keys import KnownKey, find_parents, plain_parents, survey_keys
from ur.launchfile.world.protocol import PackageNotFound
from ur.lsp.cursor import Candidate
from ur.lsp.programs.parameters import know_parameters
from ur.lsp.programs.starts import programs_of_yaml
from ur.lsp.workspace import Workspace

_LIBRARY = "ubiquity_launches"
_MOST_FILES = 40
_MOST_TEXT = 200_000  # characters of a file
_OF_MAP = re.compile(r"^(image|resolution):", re.MULTILINE)


def is_yaml(path: str) -> bool:
    """Return whether a path is that of a YAML file."""
    return path.endswith((".yaml", ".yml"))


def complete_yaml(workspace: Workspace, path: str, text: str, offset: int) -> list[Candidate]:
    """The candidates at a place of a YAML file: keys at the start of an item, values behind `key: `."""
    parents, before = find_parents(text, offset)
    value = re.search(r"([\w./~-]{1,200}) {0,50}: {1,50}([^{}\[\],#]*)\Z", before)
    typed = value[2] if value is not None else re.search(r"[\w./~-]{0,500}\Z", before)[0]  # type: ignore[index]
    start = offset - len(typed)
    rest = re.match(r"[\w./~-]*", text[offset:])
    end = offset + (len(rest[0]) if rest is not None else 0)
    known = know_keys(workspace, path, text)
    if value is not None:
        here = known.get(plain_parents(parents), {}).get(value[1])
        values = here.values if here is not None else {}
        return [Candidate(each, "value", each, start, end) for each in values if each.startswith(typed)]
    if before.strip(" -") != typed and not re.search(r"[{,] *[\w./~-]*\Z", before):
        return []
    colon = "" if text[end : end + 1] == ":" else ":"
    return [
        Candidate(
            name, "attribute", f"{name}{colon}{' ' if colon and not each.nested else ''}", start, end, "", each.document
        )
        for name, each in known.get(plain_parents(parents), {}).items()
        if name.startswith(typed) and name != text[start:end]
    ]


def know_keys(workspace: Workspace, path: str, text: str) -> dict[tuple[str, ...], dict[str, KnownKey]]:
    """The keys of files of a kind, by the keys around them."""
    known: dict[tuple[str, ...], dict[str, KnownKey]] = {}
    for source in _samples(workspace, path, text):
        survey_keys(source, known)
    programs = programs_of_yaml(path, workspace)
    for parameter in know_parameters(programs, workspace).values():
        *parents, name = parameter.name.split("/")
        found = known.setdefault((*parents,), {}).setdefault(name, KnownKey())
        found.document = found.document or parameter.document
        found.values.update(dict.fromkeys(parameter.values))
    return known


def _samples(workspace: Workspace, path: str, text: str) -> Iterator[str]:
    """The texts of other files of the same kind."""
    folder = Path(path).parent
    with suppress(PackageNotFound):
        library = Path(workspace.world.find_package(_LIBRARY))
        if Path(path).name == "base.yaml":
            yield from _read(workspace, path, sorted(library.glob("bases/*/base.yaml")))
        elif (
            re.search(r"^(floor_plan|boxes|obstacles|fiducials|drops):", text, re.MULTILINE) or folder.name == "worlds"
        ):
            yield from _read(workspace, path, sorted(library.glob("n_simulator/worlds/*.yaml")))
        elif folder.name == "maps" or _OF_MAP.search(text):
            yield _MAP
    if Path(path).name == "base.yaml":
        yield from _read(workspace, path, sorted(folder.parent.glob("*/base.yaml")))
    yield from _read(workspace, path, sorted({*folder.glob("*.yaml"), *folder.glob("*.yml")}))


def _read(workspace: Workspace, path: str, files: Sequence[Path]) -> Iterator[str]:
    for each in files[:_MOST_FILES]:
        if str(each) != path:
            with suppress(OSError):
                yield workspace.source(str(each)).text[:_MOST_TEXT]


_MAP = """image: map.pgm # relative to this file
resolution: 0.05 # m per pixel
origin: [0.0, 0.0, 0.0] # x, y (m) and yaw of the lower left corner
negate: 0 # 1: white is occupied
occupied_thresh: 0.65 # probability from which a pixel is occupied
free_thresh: 0.196 # probability up to which a pixel is free
mode: trinary # or scale, raw
"""
