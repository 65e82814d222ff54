"""`<!--ready: topic scan 5 Hz; service static_map; frame map; action move_base-->`: readiness conditions of a node."""

from __future__ import annotations

import re

from ur.launchfile.plan.names import canonical_name, is_legal_name, join_names
from ur.launchfile.plan.specs import ReadyCondition, ReadyKind

_READY = re.compile(r"\s{0,100}ready\s{0,100}:")
_CONDITION = re.compile(r"(topic|service|frame|action)\s+(\S+)(?:\s+(\d+(?:\.\d+)?)\s*Hz)?\Z", re.IGNORECASE)
EXPECTED = (
    "'topic NAME', 'topic NAME 5 Hz', 'service NAME', 'frame NAME', 'action NAME' or 'process', with ';' between them"
)


def is_ready_comment(text: str) -> bool:
    """Return whether the text of a comment states readiness conditions."""
    return _READY.match(text) is not None


def parse_ready(text: str, node: str, namespace: str) -> tuple[tuple[ReadyCondition, ...], tuple[str, ...]]:
    """Parse the conditions of a node's `ready:` comment, with full names; also return its invalid parts.

    Names are relative to the node's namespace, `~name` to the node. Remappings are not applied: the names are those on
    the master.
    """
    conditions = []
    wrong = []
    for part in re.split(r"[;\n]", _READY.sub("", text, count=1)):
        words = " ".join(part.split())
        if not words:
            continue
        if words.lower() == "process":
            conditions.append(ReadyCondition("process", ""))
            continue
        found = _CONDITION.match(words)
        rate = float(found[3]) if found and found[3] else None
        kind = found[1].lower() if found else ""
        if found is None or (rate is not None and (kind != "topic" or rate == 0.0)):
            wrong.append(words)
        elif kind == "frame":
            conditions.append(ReadyCondition("frame", found[2].lstrip("/")))
        elif not is_legal_name(found[2]):
            wrong.append(words)
        else:
            name = found[2]
            full = f"{node}/{name[1:]}" if name.startswith("~") else join_names(namespace, name)
            conditions.append(ReadyCondition(_KINDS[kind], canonical_name(full), rate))
    return tuple(conditions), tuple(wrong)


_KINDS: dict[str, ReadyKind] = {"topic": "topic", "service": "service", "action": "action"}
