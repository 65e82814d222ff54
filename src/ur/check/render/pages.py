"""Reference pages of the rules in Markdown, generated from the rules and their examples."""

import re

from ur.check.render.text import shorten_paths
from ur.check.rule import Example, Rule, RuleGroup
from ur.check.session import CheckReport, check_paths
from ur.launchfile.world import MemoryWorld
from ur.source.diagnostic import Severity
from ur.source.render import render_human

FOLDER = "/ws/my_robot"
_PROGRAMS = {
    "demo_nodes": ("talker", "listener"),
    "rviz": ("rviz",),
    "tf": ("static_transform_publisher",),
    "tf2_ros": ("static_transform_publisher",),
    "amcl": ("amcl",),
    "rosbag": ("play",),
    "rplidar_ros": ("rplidarNode",),
}
_PACKAGES = {"my_robot": FOLDER, **{name: f"/opt/{name}" for name in _PROGRAMS}}
_ONLY = "launch/example.launch"  # the output names it
_EXECUTABLES = tuple(f"/opt/{name}/bin/{program}" for name, programs in _PROGRAMS.items() for program in programs)
_OTHERS = {
    **{f"/opt/{name}/package.xml": f"<package><name>{name}</name></package>" for name in _PROGRAMS},
    **dict.fromkeys(_EXECUTABLES, "#!/bin/sh\n"),
}
OPEN, CLOSE = "«", "»"
_EXCERPT = re.compile(r" +\d* \|")  # a line of the file below a finding, or its marks


def render_rule_page(rule: Rule) -> str:
    """Return the page of a rule in Markdown, with its first examples; the others are for tests."""
    kinds = [f"group `{rule.group.value}`", rule.severity.value]
    if rule.group is RuleGroup.CONVENTIONS:
        kinds.append("for packages that follow them")
    if rule.fix is not None:
        kinds.append("repaired by `--fix`, where that is safe")
    parts = [f"# {rule.id}\n", f"{rule.summary}\n", f"*{', '.join(kinds)}*\n", f"{rule.explanation.strip()}\n"]
    for example in rule.bad[:1]:
        found = shorten_paths(check_example(example), FOLDER).findings
        lines = [line for line in render_human(found).splitlines() if not _EXCERPT.match(line)]
        parts += ["## Wrong\n", _show_files(example), "\n".join(["```text", *lines, "```\n"])]
    for example in rule.good[:1]:
        parts += ["## Right\n", _show_files(example)]
    return "\n".join(parts)


def explain_rule(rule: Rule) -> str:
    """Return the page of a rule, and the comment that hides its findings, in the language of most of its examples."""
    in_xml = not rule.bad or any(path.endswith((".launch", ".xml")) for path in rule.bad[0].files)
    words = f"ur: ignore {rule.id}: REASON"
    comment = f"<!--{words}-->" if in_xml else f"# {words}"
    return f"{render_rule_page(rule)}\nHide it with `{comment}` before the place.\n"


def _show_files(example: Example) -> str:
    kinds = {"launch": "xml", "xml": "xml", "yaml": "yaml", "py": "python", "txt": "cmake"}
    parts = []
    for path, text in example.files.items():
        kind = kinds.get(path.rpartition(".")[2], "bash")
        shown = strip_marks(text).strip().replace("\r", "␍")
        caption = "" if [*example.files] == [_ONLY] else f"`{path}`\n\n"
        parts.append(f"{caption}```{kind}\n{shown}\n```\n")
    return "\n".join(parts)


def render_index_page(rules: dict[str, Rule]) -> str:
    """Return the list of all rules as a page in Markdown."""
    lines = [
        "# Rules of `ur check`",
        "",
        "Mistakes are errors unless they are marked as warnings. `--select` and `--ignore` take ids and groups.",
        "",
        "A comment hides findings where they are meant to be so, and says why: `<!--ur: ignore RULE: REASON-->` in the",
        "element that follows, `<!--ur: ignore-file RULE: REASON-->` in the whole file; in YAML and programs",
        "`# ur: ignore RULE: REASON`, at the end of a line or alone above it.",
        "",
    ]
    for group in RuleGroup:
        lines += [f"## {group.value}", ""]
        for rule in (each for each in rules.values() if each.group is group):
            marks = " (warning)" if rule.severity is Severity.WARNING else ""
            marks += " (`--fix`)" if rule.fix else ""
            lines.append(f"- [{rule.id}]({rule.id}.md){marks}: {rule.summary.replace('<', '&lt;')}")
        lines.append("")
    return "\n".join(lines)


def check_example(example: Example) -> CheckReport:
    """Apply all rules to an example."""
    files = {f"{FOLDER}/package.xml": "<package><name>my_robot</name></package>", **_OTHERS}
    files |= {_place(path): strip_marks(text) for path, text in example.files.items()}
    executables = (*_EXECUTABLES, *map(_place, example.executables))
    return check_paths([FOLDER], MemoryWorld(files, _PACKAGES, example.environment, executables))


def strip_marks(text: str) -> str:
    """Return an example's text without the marks, as the checker reads it."""
    return text.replace(OPEN, "").replace(CLOSE, "")


def _place(path: str) -> str:
    return path if path.startswith("/") else f"{FOLDER}/{path}"
