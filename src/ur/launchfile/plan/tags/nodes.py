"""`<node>` and `<test>`."""

import re
from typing import Literal, cast

from ur.launchfile.plan.draft import Draft
from ur.launchfile.plan.names import canonical_name, is_legal_name, join_names
from ur.launchfile.plan.problems import TagRefused, refuse
from ur.launchfile.plan.scope import Scope
from ur.launchfile.plan.specs import MachineSpec, NodeSpec, ParamSpec, ReadyCondition, ReadyKind, TestSpec
from ur.launchfile.plan.tags.attributes import (
    as_flag,
    as_number,
    check_attributes,
    is_wanted,
    private_scope,
    read_flag,
    read_optional,
    read_required,
    resolve_namespace,
)
from ur.launchfile.plan.tags.params import resolve_param, resolve_rosparam
from ur.launchfile.plan.tags.simple import read_remap, resolve_env
from ur.launchfile.syntax import Element
from ur.source.suggest import did_you_mean, suggest

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


NODE_ATTRIBUTES = (
    *("pkg", "type", "machine", "name", "args", "output", "respawn", "respawn_delay", "cwd", "ns", "clear_params"),
    *("launch-prefix", "required"),
)
TEST_ATTRIBUTES = (*NODE_ATTRIBUTES, "test-name", "time-limit", "retry")
_CHILDREN = ("remap", "param", "rosparam", "env")
_TERMINAL = re.compile(r"\s*terminal\s*:")
_TOPICS = re.compile(r"\s*(publishes|subscribes)\s*:(.*)", re.DOTALL)
DEFAULT_TIME_LIMIT = 60.0


def resolve_node(element: Element, draft: Draft, scope: Scope, default_machine: MachineSpec | None) -> None:
    """Add a `<node>` with its parameters to the draft. Raises TagRefused."""
    check_attributes(element, NODE_ATTRIBUTES, draft, scope)
    name = read_required(element, "name", draft, scope)
    node = _resolve(element, name, draft, scope, default_machine, is_test=False)
    draft.add_node(node, element, scope)


def resolve_test(element: Element, draft: Draft, scope: Scope, default_machine: MachineSpec | None) -> None:
    """Add a `<test>` with its parameters to the draft. Raises TagRefused."""
    check_attributes(element, TEST_ATTRIBUTES, draft, scope)
    name = read_optional(element, "name", draft, scope)
    for attribute in ("respawn", "respawn_delay", "output"):
        if attribute in element.attributes:
            raise refuse(
                f"<test> with attribute '{attribute}', expected none: it belongs to <node>",
                element.name_span(attribute),
                "misplaced-attribute",
                "remove it",
            )
    test_name = read_required(element, "test-name", draft, scope)
    time_limit = _time_limit(element, draft, scope)
    text = read_optional(element, "retry", draft, scope)
    try:
        retry = int(text) if text else 0
    except ValueError:
        raise refuse(
            f"'retry' of <test> is '{text}', expected a whole number", element.value_span("retry"), "bad-number"
        ) from None
    node = _resolve(element, name or test_name, draft, scope, default_machine, is_test=True)
    draft.tests.append(TestSpec(node, test_name, time_limit, retry))


def _time_limit(element: Element, draft: Draft, scope: Scope) -> float:
    text = read_optional(element, "time-limit", draft, scope)
    if not text:
        return DEFAULT_TIME_LIMIT
    seconds = as_number(text, element, "time-limit")
    if seconds <= 0:
        raise refuse(f"'time-limit' is {text}, expected more than 0", element.value_span("time-limit"), "bad-number")
    return seconds


def _resolve(
    element: Element, name: str, draft: Draft, scope: Scope, default_machine: MachineSpec | None, *, is_test: bool
) -> NodeSpec:
    if not is_legal_name(name) and "$(anon " not in name:  # where such names stay as they are written
        draft.warn(
            f"'{name}' is not a legal ROS name, expected a letter, then letters, digits and '_'",
            element.value_span("name" if element.attributes.get("name") else "test-name"),
            scope,
            "bad-name",
            "other ROS tools will not understand it: rename the node",
        )
    namespace = resolve_namespace(element, draft, scope, node_name=name)
    private = private_scope(element, name, namespace, scope)
    package = read_required(element, "pkg", draft, scope)
    type_ = read_required(element, "type", draft, scope)
    machine = read_optional(element, "machine", draft, scope)
    args = read_optional(element, "args", draft, scope)
    output = read_optional(element, "output", draft, scope)
    respawn_text = read_optional(element, "respawn", draft, scope)
    delay = read_optional(element, "respawn_delay", draft, scope)
    cwd = read_optional(element, "cwd", draft, scope)
    prefix = read_optional(element, "launch-prefix", draft, scope)
    required = read_flag(element, "required", draft, scope)
    respawn = as_flag(respawn_text, element, "respawn") if respawn_text is not None else False
    respawn_delay = as_number(delay, element, "respawn_delay") if delay is not None else 0.0
    if not machine and default_machine is not None:
        machine = default_machine.name
    remaps, env = _resolve_children(element, draft, scope, private)
    _add_private_params(draft, scope, private)
    if machine:
        draft.machine_uses.append((machine, element, scope))
    return NodeSpec(
        name=_checked_name(name, element),
        namespace=re.sub("//+", "/", namespace),
        package=_not_empty(package, element, "pkg"),
        type=_not_empty(type_, element, "type"),
        args=args or "",
        machine=machine or None,
        respawn=respawn and not is_test,
        respawn_delay=0.0 if is_test else respawn_delay,
        required=_checked_required(required, respawn, element) and not is_test,
        output=cast(Literal["log", "screen"], _choice(output, element, "output", ("log", "screen")) or "log"),
        cwd=_choice("ROS_HOME" if cwd == "ros_home" else cwd, element, "cwd", ("ROS_HOME", "node")),
        launch_prefix=prefix or None,
        remaps=tuple(remaps),
        env=tuple(env),
        origin=draft.origin(element.span, scope),
        terminal=any(_TERMINAL.match(comment.text) for comment in element.comments),
        ready=_read_ready(element, name, re.sub("//+", "/", namespace), draft, scope),
        topics=tuple(
            (found[1], topic)
            for comment in element.comments
            if (found := _TOPICS.match(comment.text))
            for topic in found[2].split()
            if is_legal_name(topic)
        ),
    )


def _read_ready(element: Element, name: str, namespace: str, draft: Draft, scope: Scope) -> tuple[ReadyCondition, ...]:
    conditions: tuple[ReadyCondition, ...] = ()
    for comment in element.comments:
        if not is_ready_comment(comment.text):
            continue
        found, wrong = parse_ready(comment.text, namespace + name, namespace)
        conditions += found
        if wrong:
            draft.warn(
                f"ready: '{wrong[0]}' is no condition, expected {EXPECTED}",
                comment.span,
                scope,
                "bad-ready",
                "correct it: what is not understood is not waited for",
                subject=wrong[0],
            )
    return conditions


def _resolve_children(
    element: Element, draft: Draft, scope: Scope, private: Scope
) -> tuple[list[tuple[str, str]], list[tuple[str, str]]]:
    own = Scope("/", scope.filename, scope.args)  # collects this node's remaps and environment
    own.parent = scope
    own.env = scope.env[:]
    failed = False
    for child in element.elements:
        try:
            _resolve_child(child, element, draft, scope, private, own)
        except TagRefused as refused:  # noqa: PERF203 - the next tag is to be looked at
            draft.refuse(refused, scope)
            failed = True
    if failed:
        raise TagRefused(None)
    return own.all_remaps(), own.env


def _resolve_child(child: Element, element: Element, draft: Draft, scope: Scope, private: Scope, own: Scope) -> None:
    kind = child.name.lower()
    if kind == "param":
        if is_wanted(child, draft, private):
            resolve_param(child, draft, private, force_private=True)
    elif kind == "rosparam":
        if is_wanted(child, draft, private):
            resolve_rosparam(child, draft, private)
    elif kind == "remap":
        if is_wanted(child, draft, scope):
            own.add_remap(read_remap(child, draft, scope))
    elif kind == "env":
        if is_wanted(child, draft, scope):
            resolve_env(child, draft, scope, own)
    else:
        near = did_you_mean(kind, _CHILDREN)
        draft.warn(
            f"unknown tag <{child.name}> inside <{element.name}>, expected one of {', '.join(_CHILDREN)}",
            child.span,
            scope,
            "unknown-tag",
            f"did you mean <{near}>?" if near else "remove it: roslaunch ignores it",
        )


def _add_private_params(draft: Draft, scope: Scope, private: Scope) -> None:
    for param in [*scope.params, *private.params]:
        name = canonical_name(private.namespace + param.name.removeprefix("~"))
        draft.add_param(ParamSpec(name, param.value, param.origin, param.command, param.command_type), scope)


def _checked_name(name: str, element: Element) -> str:
    if "/" in name:
        raise refuse(
            f"node name '{name}' holds a namespace, expected a plain name",
            element.value_span("name" if element.attributes.get("name") else "test-name"),
            "bad-name",
            'put the namespace into ns="..."',
        )
    return name


def _not_empty(value: str, element: Element, name: str) -> str:
    if not value.strip():
        raise refuse(
            f"'{name}' of <{element.name}> is empty, expected a name", element.name_span(name), "empty-attribute"
        )
    return value


def _choice(value: str | None, element: Element, name: str, choices: tuple[str, ...]) -> str | None:
    if value is None or value in choices:
        return value
    raise refuse(
        f"'{name}' of <{element.name}> is '{value}', expected {' or '.join(choices)}",
        element.value_span(name),
        "bad-choice",
        suggest(value, choices),
        expected=choices,
    )


def _checked_required(required: bool, respawn: bool, element: Element) -> bool:
    if required and respawn and element.name != "test":
        raise refuse(
            "a node that is both 'required' and 'respawn', expected one of them",
            element.name_span("required"),
            "required-and-respawn",
            "required ends everything when the node ends, respawn starts it again: choose one",
        )
    return required
