"""Repositories that files of a folder name: lists of vcstool and wstool, submodules, `git clone` in texts, links."""

import re
from collections.abc import Container, Iterable, Iterator
from dataclasses import replace
from functools import cache, lru_cache
from importlib.resources import files
from itertools import islice

from ur.get.index import make_repository
from ur.get.steps import SourceRepository
from ur.source.foreign.yaml_text import load_yaml

LISTS = re.compile(r"\.gitmodules|.*\.repos(\.ya?ml)?|.*\.rosinstall(\..*)?")
TEXTS = re.compile(r"readme.*|.*\.md|.*\.rst|dockerfile.*|.*\.(ba)?sh|\.travis\.yml", re.IGNORECASE)
_CLONE = re.compile(
    r"\bgit\s{1,40}(?:-C\s{1,40}\S{1,200}\s{1,40})?(?:clone|submodule\s{1,40}add)\s{1,40}"
    r"(?P<options>(?:-\S{1,200}\s{1,40}(?:(?!https?:|git@|ssh:)[^\s-]\S{0,200}\s{1,40})?){0,12})"
    r"[\"']?(?P<url>(?:https?://|git@|ssh://)[\w.@:~%+/-]{1,500})[\"']?(?:[ \t]{1,40}(?P<target>[\w./~-]{1,200}))?"
)
_BRANCH = re.compile(r"(?:-b|--branch)[\s=]+(\S+)")
_MODULE = re.compile(r"^[ \t]*(url|path|branch)[ \t]*=[ \t]*(\S{1,500})[ \t]*$", re.MULTILINE)
_HOSTS = r"github\.com|gitlab\.com|bitbucket\.org"
_LINK = re.compile(
    rf"\bhttps?://(?:www\.)?(?P<host>{_HOSTS})/(?P<owner>[A-Za-z0-9][\w.-]*)/(?P<name>\w(?:[\w.-]*\w)?)"
    r"(?:/(?:-/)?tree/(?P<branch>\w[\w.-]*)(?=[\s)\]>\"'#?]|/?$))?"
)
_SECURE_SHELL = re.compile(rf"(?:ssh://)?git@({_HOSTS})[:/](.+)")
_NO_OWNERS = frozenset({"orgs", "topics", "user-attachments", "settings", "sponsors", "marketplace", "apps"})
_MAX_LINKS = 200  # of one file: a document about a robot has fewer
_ROS = re.compile(r"^ros_|(_ros|_ros1)?(_pkgs?|_packages?)?$")  # what is added to the name of what a repository is for
_SHORTEST = 5  # letters of a stem that is more than a common word
# Words that begin the names of packages of many authors.
_COMMON = re.compile(
    "robots?|mobile|turtlebot[23]?|gazebo|moveit|simple|laser|camera|navigation|simulation|catkin|rosbot|rover|"
    "arduino|custom|pioneer|perception|multi"
)


def read_hints(name: str, text: str, owner: str = "") -> Iterator[SourceRepository]:
    """Yield the repositories that a file of this name lists. Invalid entries are left out.

    `owner` is the address ("https://github.com/NAME") that the relative addresses of submodules are below. A repository
    that is cloned into a folder of another name is yielded again with that name.
    """
    if name == ".gitmodules":
        yield from _submodules(text, owner)
    elif LISTS.fullmatch(name):
        yield from _listed(text)
    elif TEXTS.fullmatch(name):
        for each in _CLONE.finditer(text):
            branch = _BRANCH.search(each["options"])
            yield from _cloned(each["url"].rstrip(".,"), branch[1] if branch else "", each["target"] or "")


def read_links(text: str) -> Iterator[SourceRepository]:
    """Yield the repositories that a text links to, each once, with the branch of the link, if any."""
    found: dict[str, SourceRepository] = {}
    for each in islice(_LINK.finditer(text), _MAX_LINKS):
        name = each["name"].removesuffix(".git")
        url = f"https://{each['host']}/{each['owner']}/{name}"
        repository = _clone(url, each["branch"] or "")
        if repository and each["owner"] not in _NO_OWNERS and (url not in found or not found[url].version):
            found[url] = replace(repository, linked=True)
    yield from found.values()


def join_hints(
    hints: Iterable[SourceRepository], links: Iterable[SourceRepository], own: Container[str]
) -> tuple[SourceRepository, ...]:
    """Return the repositories that files clone, then those that are only linked, each once, without those in `own`.

    `own` are plain addresses.
    """
    found = dict.fromkeys(each for each in hints if plain_address(each.url) not in own)
    addresses = {plain_address(each.url) for each in found}
    found.update(
        (each, None)
        for each in links
        if plain_address(each.url) not in addresses and plain_address(each.url) not in own
    )
    return tuple(found)


def plain_address(url: str) -> str:
    """Return a git address without the parts that do not distinguish repositories: ".git", case, user, ssh ..."""
    address = re.sub(r"^https?://([^@/]+@)?(www\.)?", "", _secure(url).lower())
    return address.rstrip("/").removesuffix(".git")


def find_hint(package: str, hints: Iterable[SourceRepository]) -> SourceRepository | None:
    """Find the repository with the name of a package, with "ros" or without."""
    wanted = _plain(package)
    return next((hint for hint in hints if wanted in (_plain(hint.name), _stem(hint))), None)


def find_related_hint(package: str, hints: Iterable[SourceRepository]) -> SourceRepository | None:
    """Find the repository whose name, without "ros", begins the package's; of several the longest is used.

    One that is only linked must have "ros" in its name: others are firmware, models, papers.
    """
    fitting = [
        hint
        for hint in hints
        if len(_stem(hint)) >= _SHORTEST
        and not _COMMON.fullmatch(_stem(hint))
        and (not hint.linked or _stem(hint) != _plain(hint.name))
        and _plain(package).startswith(f"{_stem(hint)}_")
    ]
    return max(fitting, key=lambda hint: len(_stem(hint)), default=None)


def is_of_family(package: str, hint: SourceRepository) -> bool:
    """Return whether a package and a repository begin with the same word, unless that is a common one."""
    word = _plain(package).partition("_")[0]
    return len(word) >= _SHORTEST and not _COMMON.fullmatch(word) and _plain(hint.name).partition("_")[0] == word


def parse_sources(text: str) -> dict[str, SourceRepository]:
    """Parse a table of repositories (see known_sources.tsv) by package. Raises ValueError, which names the line."""
    found: dict[str, SourceRepository] = {}
    rows = [(n, line) for n, line in enumerate(text.splitlines(), 1) if line and not line.startswith("#")]
    for number, line in rows[1:]:
        cells = line.split("\t")
        url, branch, packages = cells if len(cells) == 3 else ("", "", "")
        repository = _clone(url, "" if branch == "-" else branch)
        if repository is None or not packages:
            raise ValueError(f"known_sources.tsv:{number}: expected an address, a branch or -, and packages")
        found.update(dict.fromkeys(packages.split(), repository))
    return found


@cache
def load_sources() -> dict[str, SourceRepository]:
    """Return the table of repositories that are in no index of ROS."""
    return parse_sources((files(__package__) / "known_sources.tsv").read_text(encoding="utf-8"))


def _listed(text: str) -> Iterator[SourceRepository]:
    try:
        document = load_yaml(text)
    except ValueError:
        return
    if isinstance(document, dict) and isinstance(document.get("repositories"), dict):  # of vcstool
        for name, source in document["repositories"].items():
            if isinstance(name, str) and isinstance(source, dict):
                keys = {**source, "url": _secure(source.get("url"))}
                if repository := make_repository(_last(name), keys):
                    yield repository
    for entry in document if isinstance(document, list) else ():  # of wstool
        for kind, source in entry.items() if isinstance(entry, dict) else ():
            if isinstance(source, dict):
                local = source.get("local-name", "")
                name = local if isinstance(local, str) else ""
                keys = {"type": kind, "url": _secure(source.get("uri")), "version": source.get("version")}
                if repository := make_repository(_last(name), keys):
                    yield repository


def _submodules(text: str, owner: str) -> Iterator[SourceRepository]:
    for section in text.split("[submodule")[1:]:
        found = dict(_MODULE.findall(section))
        url, branch = found.get("url", ""), found.get("branch", "")
        if url.startswith("../") and owner:
            url = f"{owner}/{_last(url)}"
        yield from _cloned(url, "" if branch == "." else branch, found.get("path", ""))


def _cloned(url: str, branch: str, target: str) -> Iterator[SourceRepository]:
    if repository := _clone(_secure(url), branch):
        yield repository
        name = _last(target)
        if name != repository.name and re.fullmatch(r"[A-Za-z][\w-]+", name):
            yield replace(repository, name=name)


def _clone(url: str, branch: str) -> SourceRepository | None:
    return make_repository(_last(url).removesuffix(".git"), {"type": "git", "url": url, "version": branch})


def _secure(url: object) -> str:
    """Return the https address in place of one that needs a key or is not encrypted, for hosts that offer both."""
    text = url if isinstance(url, str) else ""
    if found := _SECURE_SHELL.fullmatch(text):
        return f"https://{found[1]}/{found[2]}"
    return re.sub(rf"^http://(?=({_HOSTS})/)", "https://", text)


def _last(path: str) -> str:
    return path.rstrip("/").rpartition("/")[2]


def _stem(hint: SourceRepository) -> str:
    return _stem_of(hint.name)


@lru_cache(maxsize=4096)  # each package is compared with each repository
def _stem_of(name: str) -> str:
    return _ROS.sub("", _plain(name))


@lru_cache(maxsize=4096)
def _plain(name: str) -> str:
    return name.lower().replace("-", "_")
