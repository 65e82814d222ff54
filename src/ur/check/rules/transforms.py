"""Rules about transforms: arguments of static_transform_publisher, and transforms that two nodes publish."""

import math
from collections.abc import Iterable, Mapping

from ur.check.example_parts import make_launch
from ur.check.rule import LaunchedNode, PlanView, Rule, RuleFinding, RuleGroup, launch_examples
from ur.check.worlds import has_marker
from ur.launchfile.plan.specs import NodeSpec
from ur.source.arguments import split_words
from ur.source.diagnostic import Note, Severity

_STATIC = "static_transform_publisher"
_ANGLES = ("yaw", "pitch", "roll")
_ORDER = "x y z yaw pitch roll PARENT CHILD"
_PERIOD = "100"  # ms, which the manual of tf recommends
# Nodes that publish the transform to the odometry's frame, with the parameters of that frame and that switch it off
_LOCALISATIONS = {
    ("amcl", "amcl"): ("odom_frame_id", "tf_broadcast"),
    ("gmapping", "slam_gmapping"): ("odom_frame", "transform_publish_period"),
}


def _find_bad_arguments(view: LaunchedNode) -> Iterable[RuleFinding]:
    words = _arguments_of(view.node)
    if words is None or "args" not in view.element.attributes:
        return
    place, text = view.element.value_span("args"), " ".join(words)
    if fault := _find_mixture(view.node.package, words):
        message, help_ = fault
        yield RuleFinding(place, f"{view.node.package}'s {_STATIC} {message}", help_, subject=text)
        return
    if not _has_angles(words):
        return
    for name, word in zip(_ANGLES, words[3:6], strict=True):
        if _is_number(word) and abs(float(word)) > 2 * math.pi:
            help_ = f"write {math.radians(float(word)):.6g} if {word} degrees are meant"
            yield RuleFinding(place, f"the {name} of {_STATIC} is {word}, expected radians", help_, subject=text)
            return


def _find_mixture(package: str, words: list[str]) -> tuple[str, str] | None:
    # Wrong numbers of arguments, and a period where tf2_ros expects the frames or the other way round.
    count, angles = len(words), _has_angles(words)
    if package == "tf" and (count == 8 or (count == 9 and not angles)):
        help_ = f'append the period in ms, {_PERIOD}, or take pkg="tf2_ros"'
        return f"has {count} arguments without a period, expected {count + 1}", help_
    if package == "tf2_ros" and count in (9, 10) and _is_number(words[-1]) and angles is (count == 9):
        help_ = f'remove the period {words[-1]}, or take pkg="tf"'
        return f"has a period in its {count} arguments, expected {count - 1} without it", help_
    expected = (9, 10) if package == "tf" else (1, 8, 9)
    if count not in expected:
        order = f"{_ORDER} {_PERIOD}" if package == "tf" else _ORDER
        return f"has {count} arguments, expected {expected[-2]} or {expected[-1]}", f"write them as {order}"
    return None


def _has_angles(words: list[str]) -> bool:
    # With a quaternion the seventh argument is a number; with angles it is the name of the parent.
    return len(words) > 6 and not _is_number(words[6])


def _is_number(word: str) -> bool:
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False


def _arguments_of(node: NodeSpec) -> list[str] | None:
    if node.type != _STATIC or node.package not in ("tf", "tf2_ros") or has_marker(node.args):
        return None
    try:
        return [word for word in split_words(node.args) if ":=" not in word]
    except ValueError:
        return None


def _find_two_publishers(view: PlanView) -> Iterable[RuleFinding]:
    params: dict[str, object] = {param.name: param.value for param in view.plan.params}
    if any(name.endswith("/tf_prefix") for name in params):
        return
    first: dict[str, NodeSpec] = {}
    for node in view.plan.nodes:
        child = _child_of(node, params)
        if not child or has_marker(child) or any("tf" in name for pair in node.remaps for name in pair):
            continue
        other = first.setdefault(child, node)
        element = view.element_at(node.origin.span.file.path, node.origin.span.start)
        if other is not node and element is not None:
            yield RuleFinding(
                element.value_span("type"),
                f"{node.full_name} publishes the transform to '{child}', which {other.full_name} publishes, too",
                "remove one of them: a frame has one parent, and the robot's pose jumps between the two",
                (Note(f"{other.full_name} is here", other.origin.span),),
                subject=child,
            )


def _child_of(node: NodeSpec, params: Mapping[str, object]) -> str:
    words = _arguments_of(node)
    if words is not None:
        at = len(words) - (2 if node.package == "tf" else 1)
        return "" if len(words) == 1 or _find_mixture(node.package, words) else words[at].lstrip("/")
    names = _LOCALISATIONS.get((node.package, node.type))
    if names is None or params.get(f"{node.full_name}/{names[1]}", True) in (False, 0):
        return ""
    return str(params.get(f"{node.full_name}/{names[0]}", "odom")).lstrip("/")


def _node(args: str, package: str = "tf2_ros", name: str = "laser") -> str:
    return f'<node name="{name}" pkg="{package}" type="{_STATIC}" args="{args}"/>'


_MAP = _node("0 0 0 0 0 0 map odom", name="map")

RULES = (
    Rule(
        id="static-transform",
        group=RuleGroup.VALUES,
        severity=Severity.ERROR,
        summary="The arguments of static_transform_publisher do not fit.",
        explanation=f"""
Angles are in radians, in the order yaw, pitch, roll. tf takes `{_ORDER} PERIOD`, in milliseconds; tf2_ros takes the
same without a period, and reads a ninth argument as part of a quaternion.
""",
        bad=launch_examples(
            make_launch(_node("«0.1 0 0 180 0 0 base_link laser»")),
            make_launch(_node("«0.1 0 0 0 0 0 base_link laser 100»")),
            make_launch(_node("«0.1 0 0 0 0 0 base_link laser»", "tf")),
            make_launch(_node("«0.1 0 0 base_link laser»")),
        ),
        good=launch_examples(
            make_launch(
                _node("0.1 0 0 3.14159 0 0 base_link laser"),
                _node("0.1 0 0 0 0 0 1 base_link left", name="left"),
                _node("0.1 0 0 0 0 0 base_link right 100", "tf", "right"),
            )
        ),
        node=_find_bad_arguments,
    ),
    Rule(
        id="two-transforms",
        group=RuleGroup.NAMES,
        severity=Severity.WARNING,
        summary="Two nodes publish the transform to one frame.",
        explanation="""
A frame has one parent and one pose. With two publishers every reader gets now one and now the other. Examined are
static_transform_publisher, amcl and slam_gmapping, with the options as they are by default.
""",
        bad=launch_examples(
            make_launch(_MAP, '<node name="amcl" pkg="amcl" type="«amcl»"/>'),
            make_launch(_MAP, _node("0 0 1 0 0 0 base odom").replace(f'"{_STATIC}"', f'"«{_STATIC}»"')),
        ),
        good=launch_examples(
            make_launch(
                _MAP,
                '<node name="amcl" pkg="amcl" type="amcl"><param name="tf_broadcast" value="false"/></node>',
                _node("0 0 0 0 0 0 base_link laser"),
            )
        ),
        plan=_find_two_publishers,
    ),
)
