"""Something that is true or false is neither."""

from __future__ import annotations

from collections.abc import Iterable

from ur.check.model import Edit, Found, Group, LaunchView, Rule, launch_example
from ur.launchfile.syntax import Element
from ur.source.diagnostic import Diagnostic, Severity

_FLAGS = ("respawn", "required", "clear_params", "pass_all_args", "subst_value")
_MEANT = {"1": "true", "0": "false", "yes": "true", "no": "false", "on": "true", "off": "false"}


def _find_bad_booleans(element: Element, view: LaunchView) -> Iterable[Found]:
    if element is view.tree.launch:
        return
    for name, value in element.attributes.items():
        if "$" in value:
            continue
        if name in ("if", "unless") and value.lower().strip() not in ("true", "false", "1", "0"):
            meant = _MEANT.get(value.lower().strip())
            yield Found(
                element.value_span(name),
                f"'{name}' of <{element.name}> is '{value}', expected true, false, 1 or 0",
                f'write {name}="{meant}"' if meant else None,
            )
        elif name in _FLAGS and value and value.lower() not in ("true", "false"):
            meant = _MEANT.get(value.lower().strip(), value.lower().strip())
            yield Found(
                element.value_span(name),
                f"'{name}' of <{element.name}> is '{value}', expected true or false",
                f'write {name}="{meant}"' if meant in ("true", "false") else None,
            )


def _repair(found: Diagnostic) -> tuple[Edit, ...]:
    span = found.span
    if span is None:
        return ()
    written = span.text.strip().lower()
    meant = _MEANT.get(written, written)
    return (Edit(span, meant),) if meant in ("true", "false") else ()


RULE = Rule(
    id="bad-boolean",
    group=Group.VALUES,
    severity=Severity.ERROR,
    summary="Something that is true or false is neither.",
    explanation="""
`if` and `unless` take `true`, `false`, `1` and `0`; `respawn`, `required`, `clear_params`, `pass_all_args` and
`subst_value` only `true` and `false`. `--fix` writes `true` for 1, yes and on, `false` for 0, no and off.
""",
    bad=(
        launch_example("""
<launch>
  <node name="talker" pkg="demo_nodes" type="talker" respawn="«1»"/>
</launch>
"""),
        launch_example("""
<launch>
  <group if="«yes»">
    <node name="talker" pkg="demo_nodes" type="talker"/>
  </group>
</launch>
"""),
    ),
    good=(
        launch_example("""
<launch>
  <arg name="again"/>
  <group if="1">
    <node name="talker" pkg="demo_nodes" type="talker" respawn="$(arg again)"/>
  </group>
</launch>
"""),
    ),
    element=_find_bad_booleans,
    fix=_repair,
)
