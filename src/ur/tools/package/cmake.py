"""The install rules in a CMakeLists.txt: a separate block, written and replaced as a whole."""

import re
from collections.abc import Iterable

_BEGIN = "# What is installed: written by `ur check --package --fix`."
_END = "# End of what is installed."
_OLD = r"# What is installed: written by `ur package --write`\."  # until version 0.1
_BLOCK = re.compile(rf"(?:{re.escape(_BEGIN)}|{_OLD}).*?" + re.escape(_END) + r"\n?", re.DOTALL)
_LEFT_OUT = frozenset({"build", "devel", "doc", "docs", "include", "install", "src", "test", "tests", "__pycache__"})


def choose_folders(names: Iterable[str]) -> tuple[str, ...]:
    """Select the folders of a package that have to be installed for its launch files, sorted."""
    return tuple(sorted(name for name in names if name not in _LEFT_OUT and not name.startswith(".")))


def write_block(folders: Iterable[str], files: Iterable[str] = ()) -> str:
    """Return the rules that install folders, and launch files beside package.xml, with their permissions."""
    lines = [_BEGIN]
    for kind, names in (("DIRECTORY", tuple(folders)), ("FILES", tuple(sorted(files)))):
        if names:
            more = ("USE_SOURCE_PERMISSIONS", 'PATTERN "__pycache__" EXCLUDE') if kind == "DIRECTORY" else ()
            lines += [
                f"install({kind}",
                *(f"  {name}" for name in names),
                "  DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}",
                *(f"  {each}" for each in more),
                ")",
            ]
    return "\n".join([*lines, _END, ""])


def describe_changes(before: str, after: str) -> tuple[str, ...]:
    """Describe the differences between the install rules of two versions of a CMakeLists.txt, one line each."""
    if before == after:
        return ()
    old, new = _read_names(before), _read_names(after)
    changes = [f"{name} is not installed" for name in sorted(new - old)]
    changes += [f"{name} is installed and does not exist" for name in sorted(old - new)]
    return tuple(changes) or ("its install rules are out of date",)


def _read_names(text: str) -> frozenset[str]:
    """Return the folders and files that the block installs."""
    block = _BLOCK.search(text)
    rules = re.findall(r"install\((?:DIRECTORY|FILES)\n(.*?)\n  DESTINATION", block.group() if block else "", re.DOTALL)
    return frozenset(name.strip() for rule in rules for name in rule.splitlines())


def put_block(text: str, block: str) -> str:
    """Return a CMakeLists.txt with the block: it replaces an earlier block, else it is appended."""
    if _BLOCK.search(text):
        return _BLOCK.sub(lambda _: block, text, count=1)
    return text.rstrip("\n") + "\n\n" + block
