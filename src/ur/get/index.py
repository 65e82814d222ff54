"""Source repositories of packages: the index of a ROS distribution, and the table of those that are in none."""

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from operator import eq, ge, gt, le, lt, ne

from ur.get.steps import PACKAGE_NAME, SourceRepository
from ur.source.foreign.files import MAX_MANIFEST
from ur.source.foreign.xml_text import parse_xml
from ur.source.foreign.yaml_text import load_yaml

MAX_INDEX = 64 * 1024 * 1024  # bytes; the cache of noetic with all package.xml has 8 MB
_MAX_VALUES = 1_000_000
_MAX_ELEMENTS = 10_000  # of a package.xml
_URL = re.compile(r"https?://[A-Za-z0-9][\w.:@~%+-]*(/[\w.@~%+-]+)*/?")
_WORD = re.compile(r"[A-Za-z0-9_][A-Za-z0-9._/+-]*")
_TAG = re.compile(r"release/([a-z]+)/")
_PARENTHESES = re.compile(r"\(([^()]*)\)")
_COMPARISON = re.compile(r"""\s*(\$?[\w-]+|"[^"]*"|'[^']*')\s*([=!<>]=|[<>])\s*(\$?[\w-]+|"[^"]*"|'[^']*')\s*""")
_OPERATORS = {"==": eq, "!=": ne, "<": lt, "<=": le, ">": gt, ">=": ge}
NEWEST = "noetic"  # the last distribution of ROS 1
_ROS1 = {"ROS_VERSION": "1", "ROS_DISTRO": NEWEST, "ROS_PYTHON_VERSION": "3"}
ROS2 = ("humble", "jazzy", "foxy", "rolling")  # asked last, for a package that ROS 1 has never had
_DEPENDS = ("depend", "exec_depend", "run_depend", "build_depend", "build_export_depend", "buildtool_depend")


@dataclass(frozen=True, slots=True)
class Index:
    """Repositories by package, and the dependencies of packages whose package.xml the index contains."""

    repositories: Mapping[str, SourceRepository] = field(default_factory=dict)
    dependencies: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


def parse_index(text: str, distribution: str = "") -> Index:
    """Parse a distribution file (REP 143) or rosdistro's cache of one.

    `distribution` is stored in its repositories; "" stands for the one that most of its tags name, and for noetic. A
    repository without a source is replaced by its release repository. Repositories with unusual characters in their
    address are left out. Raises ValueError.
    """
    if len(text) > MAX_INDEX:
        raise ValueError(f"more than {MAX_INDEX:,} characters, expected a distribution file")
    try:
        document = load_yaml(text, _MAX_VALUES)
    except ValueError as problem:
        raise ValueError(f"not YAML: {problem}") from None
    if not isinstance(document, dict):
        raise ValueError("no mapping, expected a distribution file with 'repositories'")
    files = document.get("distribution_file", document)
    found: dict[str, SourceRepository] = {}
    known = False
    for file in files if isinstance(files, list) else [files]:
        repositories = file.get("repositories") if isinstance(file, dict) else None
        if isinstance(repositories, dict):
            known = True
            distribution = distribution or _name_of(repositories)
            for name, entry in repositories.items():
                found.update(_read_repository(name, entry, distribution))
    if not known:
        raise ValueError("'repositories' is missing, expected a distribution file")
    xmls = document.get("release_package_xmls")
    return Index(found, _read_all(xmls) if isinstance(xmls, dict) else {})


def merge_indexes(indexes: Sequence[Index]) -> Index:
    """Merge indexes: of those that have a package, the first takes precedence."""
    repositories: dict[str, SourceRepository] = {}
    dependencies: dict[str, tuple[str, ...]] = {}
    for index in reversed(indexes):
        repositories.update(index.repositories)
        dependencies.update(index.dependencies)
    return Index(repositories, dependencies)


def read_dependencies(text: str, environment: Mapping[str, str] | None = None) -> tuple[str, ...]:
    """Return the packages that a package.xml depends on, each once. Raises ValueError for an invalid text.

    Dependencies with a condition (REP 149) count where it holds in an environment, which is that of ROS 1 by default.
    """
    root = parse_xml(text, length=MAX_MANIFEST, elements=_MAX_ELEMENTS)
    if root.tag != "package":
        raise ValueError(f"<{root.tag}>, expected <package>")
    names = [
        (each.text or "").strip()
        for each in root
        if each.tag in _DEPENDS and _holds(each.get("condition", ""), {**_ROS1, **(environment or {})})
    ]
    return tuple(dict.fromkeys(name for name in names if PACKAGE_NAME.fullmatch(name)))


def _holds(condition: str, environment: Mapping[str, str]) -> bool:
    # One that cannot be read holds: better a package too much in the plan.
    while inner := _PARENTHESES.search(condition):
        condition = inner.re.sub("1 == 1" if _holds(inner[1], environment) else "1 == 0", condition, count=1)
    return any(
        all(_compare(each, environment) for each in re.split(r"\band\b", part))
        for part in re.split(r"\bor\b", condition)
    )


def _compare(text: str, environment: Mapping[str, str]) -> bool:
    if not (found := _COMPARISON.fullmatch(text)):
        return True
    left, right = (
        environment.get(each[1:], "") if each.startswith("$") else each.strip("\"'") for each in found.group(1, 3)
    )
    return bool(_OPERATORS[found[2]](left, right))


def _read_all(xmls: Mapping[object, object]) -> dict[str, tuple[str, ...]]:
    found = {}
    for name, text in xmls.items():
        if isinstance(name, str) and isinstance(text, str):
            try:
                found[name] = read_dependencies(text)
            except ValueError:
                continue
    return found


def _name_of(repositories: Mapping[object, object]) -> str:
    """Return the distribution that most release tags name; "" for noetic, and if they name none."""
    names = Counter(
        found[1]
        for entry in repositories.values()
        if isinstance(entry, dict) and (found := _TAG.match(_release_tag(entry.get("release"))))
    )
    name = names.most_common(1)[0][0] if names else ""
    return "" if name == NEWEST else name


def _release_tag(release: object) -> str:
    tags = release.get("tags") if isinstance(release, dict) else None
    tag = tags.get("release") if isinstance(tags, dict) else None
    return tag if isinstance(tag, str) else ""


def _read_repository(name: object, entry: object, distribution: str) -> dict[str, SourceRepository]:
    if not isinstance(name, str) or not isinstance(entry, dict) or not _WORD.fullmatch(name) or "/" in name:
        return {}
    release = entry.get("release")
    packages = release.get("packages") if isinstance(release, dict) else None
    listed = packages if isinstance(packages, list) else [name]
    names = [each for each in listed if isinstance(each, str) and PACKAGE_NAME.fullmatch(each)]
    # A package that is no longer built may have only a `doc`.
    source = make_repository(name, entry.get("source") or entry.get("doc"), distribution)
    if source is not None:
        return dict.fromkeys(names, source)
    if entry.get("source") or entry.get("doc") or not isinstance(release, dict):
        return {}
    template = _release_tag(release).replace("{version}", _text(release.get("version")))
    tagged = {
        each: make_repository(
            each,
            {"type": "git", "url": release.get("url"), "version": template.replace("{package}", each)},
            distribution,
        )
        for each in names
    }
    return {each: repository for each, repository in tagged.items() if repository is not None}


def _text(value: object) -> str:
    # Of plain values only: that of a list can be far longer than the file, by its aliases.
    return str(value) if isinstance(value, (str, int, float)) else ""


def make_repository(name: str, source: object, distribution: str = "") -> SourceRepository | None:
    """Return a repository from the keys `type`, `url` and `version`; None if one of them is unsafe in a shell."""
    if not isinstance(source, dict) or not _WORD.fullmatch(name) or "/" in name:
        return None
    kind, url = source.get("type"), source.get("url")
    version = _text(source.get("version") or "")
    if kind not in ("git", "hg", "svn") or not isinstance(url, str) or not _URL.fullmatch(url):
        return None
    if version and (not _WORD.fullmatch(version) or ".." in version):
        return None
    return SourceRepository(name, kind, url, version, distribution)


def parse_sources(text: str) -> dict[str, SourceRepository]:
    """Parse a table of repositories (see known_sources.tsv) by package. Raises ValueError, which names the line."""
    found: dict[str, SourceRepository] = {}
    rows = [(n, line) for n, line in enumerate(text.splitlines(), 1) if line and not line.startswith("#")]
    for number, line in rows[1:]:
        cells = line.split("\t")
        url, branch, packages = cells if len(cells) == 3 else ("", "", "")
        keys = {"type": "git", "url": url, "version": "" if branch == "-" else branch}
        repository = make_repository(url.rpartition("/")[2].removesuffix(".git"), keys)
        if repository is None or not packages:
            raise ValueError(f"known_sources.tsv:{number}: expected an address, a branch or -, and packages")
        found.update(dict.fromkeys(packages.split(), repository))
    return found


@cache
def load_sources() -> dict[str, SourceRepository]:
    """Return the table of repositories that are in no index of ROS."""
    return parse_sources((files(__package__) / "known_sources.tsv").read_text(encoding="utf-8"))
