"""Namespaces of tags, and the private namespace of a node."""

from __future__ import annotations

from ur.launchfile.plan.draft import Draft
from ur.launchfile.plan.names import join_names, make_namespace
from ur.launchfile.plan.problems import refuse
from ur.launchfile.plan.scope import Scope
from ur.launchfile.plan.tags.attributes import as_flag, read_optional
from ur.launchfile.syntax import Element


def resolve_namespace(element: Element, draft: Draft, scope: Scope, node_name: str | None = None) -> str:
    """Return the namespace that `ns` gives a tag, and record `clear_params`. Raises TagRefused."""
    given: str | None = None
    if "ns" in element.attributes:
        given = read_optional(element, "ns", draft, scope)
        if not given:
            raise refuse(
                f"<{element.name}> with an empty 'ns', expected a namespace",
                element.name_span("ns"),
                "empty-namespace",
                "remove ns, or give it a name",
                subject=element.attributes["ns"],
            )
    try:
        namespace = scope.child_namespace(given)
    except ValueError as problem:
        raise refuse(f"'ns' of <{element.name}>: {problem}", element.value_span("ns"), "bad-name") from None
    clear = read_optional(element, "clear_params", draft, scope)
    if clear and as_flag(clear, element, "clear_params"):
        draft.clear_params.append(_cleared(element, namespace, given, node_name))
    return namespace


def _cleared(element: Element, namespace: str, given: str | None, node_name: str | None) -> str:
    if node_name is None:
        if given:
            return namespace
        raise refuse(
            f"<{element.name}> with 'clear_params' but without 'ns', expected both",
            element.name_span("clear_params"),
            "bad-clear-params",
            'add ns="...": it says what is cleared',
        )
    if not node_name:
        raise refuse(
            f"<{element.name}> with 'clear_params' but without a name, expected both",
            element.name_span("clear_params"),
            "bad-clear-params",
        )
    try:
        return make_namespace(join_names(namespace, node_name))
    except ValueError as problem:
        raise refuse(f"'name' of <{element.name}>: {problem}", element.value_span("name"), "bad-name") from None


def private_scope(element: Element, name: str, namespace: str, scope: Scope) -> Scope:
    """Return the scope in which a node's own <param> and <rosparam> are resolved. Raises TagRefused.

    As in roslaunch, it copies the names that $(anon) has created so far.
    """
    private = Scope(namespace, scope.filename, scope.args)
    try:
        private.namespace = private.child_namespace(name)
    except ValueError as problem:
        raise refuse(f"'name' of <{element.name}>: {problem}", element.value_span("name"), "bad-name") from None
    private.parent = scope
    private.anonymous = dict(scope.anonymous)
    private.declared = scope.declared
    private.missing = scope.missing
    private.poisoned = scope.poisoned
    private.chain = scope.chain
    return private
