"""Rules that hold for all of src but for the folders and modules in exceptions.tsv, each with the reason.

`reads`: files of other people are opened by ur.source.foreign, which limits what it reads.
`json`: JSON is read by ur.source.foreign.json_values, with its limits in a type.
`threads`: nodes make no threads, locks and queues; the backends do, and hand a node one event at a time.
`small`: a module has at least 58 lines, so that a subject is not spread over files; small_modules.txt lists the modules
that were smaller when this rule was made.
"""

from collections.abc import Callable, Iterable, Mapping
from fnmatch import fnmatchcase
from pathlib import Path

import pytest
from tests.form.facts import Facts, find_facts

HERE = Path(__file__).parent
LEAST_LINES = 58
MOST_SMALL = 61
"""Rows of small_modules.txt. Lower it with each change that removes some."""

RULES: Mapping[str, Callable[[Facts], bool]] = {
    "reads": lambda facts: bool(facts.opened),
    "json": lambda facts: facts.reads_json,
    "threads": lambda facts: facts.makes_threads,
    "small": lambda facts: facts.lines < LEAST_LINES and not facts.only_protocols,
}
ONLY_IN = {"threads": "ur_nodes/"}
"""The folder of a rule that does not hold for all of src."""
HELP = {
    "reads": "read it by ur.source.foreign",
    "json": "read it by ur.source.foreign.json_values, with its limits in a type",
    "threads": "move time and threads behind a port",
    "small": "merge it into its caller or a module of the same subject",
}


def read_exceptions() -> list[tuple[str, str]]:
    """Return the rule and the path pattern of each row."""
    head, *lines = (HERE / "exceptions.tsv").read_text(encoding="utf-8").splitlines()
    assert head == "rule\tpath\treason"
    rows = [line.split("\t") for line in lines]
    assert all(len(row) == 3 and row[2] for row in rows)
    return [(rule, pattern) for rule, pattern, _ in rows]


EXCEPTIONS = read_exceptions()


def find_broken(rule: str, modules: Mapping[str, Facts], patterns: Iterable[str]) -> set[str]:
    """Return the modules that break a rule and match none of the patterns."""
    return {
        path
        for path, facts in modules.items()
        if path.startswith(ONLY_IN.get(rule, ""))
        and RULES[rule](facts)
        and not any(fnmatchcase(path, pattern) for pattern in patterns)
    }


def patterns_of(rule: str) -> list[str]:
    return [pattern for name, pattern in EXCEPTIONS if name == rule]


@pytest.mark.parametrize("rule", ["reads", "json", "threads"])
def test_rule_holds_but_for_listed_paths(rule: str, modules: Mapping[str, Facts]) -> None:
    broken = {path: modules[path].opened for path in find_broken(rule, modules, patterns_of(rule))}
    assert not broken, f"{HELP[rule]}, or add a row with the reason to exceptions.tsv"


def test_each_exception_is_needed(modules: Mapping[str, Facts]) -> None:
    broken = {rule: find_broken(rule, modules, ()) for rule in RULES}
    unused = [row for row in EXCEPTIONS if not any(fnmatchcase(path, row[1]) for path in broken[row[0]])]
    assert unused == [], "remove the rows from exceptions.tsv"


def test_modules_are_small_only_for_a_reason_or_as_listed(modules: Mapping[str, Facts]) -> None:
    small = find_broken("small", modules, patterns_of("small"))
    listed = (HERE / "small_modules.txt").read_text(encoding="utf-8").splitlines()
    assert small - {*listed} == set(), f"below {LEAST_LINES} lines: {HELP['small']}"
    assert [path for path in listed if path not in small] == [], "remove the rows from small_modules.txt"
    assert len(listed) <= MOST_SMALL, "small_modules.txt only gets shorter"


@pytest.mark.parametrize(
    "text",
    [
        *("open(a)", "open(a, 'rb')", "open(a, 'r+')", "open('/etc/passwd')", "path.read_text()", "Path(a).open('rb')"),
        *("yaml.safe_load(a)", "np.load(a)", "tarfile.open(fileobj=a, mode='r|gz')", "os.open(a, 0)"),
        *("os.open(a, os.O_RDONLY | os.O_CLOEXEC)", "os.open(a, os.O_RDWR)"),
    ],
)
def test_calls_that_read_files_are_found(text: str) -> None:
    assert find_facts(text).opened


@pytest.mark.parametrize(
    "text",
    [
        *("read_text(a)", "world.read_bytes(a)", "open_file(a)", "json.loads(a)", "finder.open()"),
        *(
            "open(a, 'w')",
            "path.open('xb')",
            "tarfile.open(fileobj=a, mode='w')",
            "os.open(a, os.O_WRONLY | os.O_CREAT)",
        ),
        *("open(f'/proc/{pid}/stat')", "Path('/dev/video0').open('rb')", "(files(__package__) / 'a.tsv').read_text()"),
    ],
)
def test_calls_of_the_reader_and_calls_that_read_no_foreign_file_are_not_found(text: str) -> None:
    assert not find_facts(text).opened


@pytest.mark.parametrize(
    ("text", "makes"),
    [
        ("import threading\nlock: threading.Lock = threading.Lock()\n", True),
        ("import threading\nfield(default_factory=threading.Event)\n", True),
        ("from queue import SimpleQueue as Q\ndef f(q: Q) -> Q:\n    return Q()\n", True),
        ("import threading\nclass Worker(threading.Thread): ...\n", True),
        ("import concurrent.futures as futures\npool = futures.ThreadPoolExecutor()\n", True),
        ("import threading\ndef f(lock: threading.Lock) -> None: ...\n", False),
        ("import threading\nthreading.current_thread()\n", False),
    ],
)
def test_threads_count_where_they_are_made_but_not_in_annotations(text: str, makes: bool) -> None:
    assert find_facts(text).makes_threads is makes


def test_new_small_module_is_found_and_protocols_are_not() -> None:
    protocol = find_facts("from typing import Protocol\nclass Sensor(Protocol): ...\n")
    modules = {"ur/robot/new.py": find_facts("A = 1\n"), "ur/robot/ports.py": protocol}
    assert find_broken("small", modules, patterns_of("small")) == {"ur/robot/new.py"}
