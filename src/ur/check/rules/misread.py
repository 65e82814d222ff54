"""Rule for values that YAML and roslaunch read otherwise than they look."""

import re
from collections.abc import Iterable, Iterator

from ur.check.example_parts import make_launch
from ur.check.rule import Example, LaunchView, Rule, RuleFinding, RuleGroup, YamlView, launch_example
from ur.check.rules.files import compose_documents, is_plain_yaml, span_at
from ur.check.rules.robot_files import is_map
from ur.launchfile.syntax import Element
from ur.source.diagnostic import Severity
from ur.source.file import SourceFile, Span

_EXPONENT = re.compile(r"([-+]?\d+)(\.\d*)?[eE]([-+]?)(\d+)")
_INFINITE = re.compile(r"[-+]?(?:inf|nan)", re.IGNORECASE)
# What no misread value is without: most texts need no reading of their own
_SUSPECT = re.compile(
    r"(?<![\w.])(?:[-+]?\d+(?:\.\d*)?e|(?:inf|nan|yes|no|on|off|true|false)\b|0\d|\d[\d_]*:|\d{4}-)", re.IGNORECASE
)
_SWITCH = {"yes": "true", "on": "true", "no": "false", "off": "false"}
# Of robot_localization, MoveIt's OMPL and camera_info_manager, which make numbers of texts themselves
_READ_FROM_TEXT = re.compile(
    r"initial_estimate_covariance|process_noise_covariance|planner_configs|(camera|rectification|projection)_matrix|"
    r"distortion_coefficients"
)
_LONGEST_TEXT = 50_000  # characters of <rosparam>: reading more takes memory that a check may not take
_LONGEST = 60  # characters of what someone may take for a number


def _find_in_yaml(view: YamlView) -> Iterable[RuleFinding]:
    # map_server and ROS 2 read numbers from texts, too
    elsewhere = is_map(view) or "ros__parameters" in view.source.text
    return _find_in_text(view.source) if is_plain_yaml(view.source) and not elsewhere else ()


def _find_in_text(source: SourceFile) -> Iterator[RuleFinding]:
    if not _SUSPECT.search(source.text):
        return
    import yaml

    try:
        documents = compose_documents(source)
    except yaml.YAMLError:
        return  # bad-yaml speaks of it
    stack: list[tuple[yaml.Node, bool]] = [(document, False) for document in documents]
    seen: set[int] = set()  # an alias may lead to a node above it
    while stack:
        node, beside_texts = stack.pop()
        if id(node) in seen:
            continue
        seen.add(id(node))
        if isinstance(node, yaml.MappingNode):
            stack.extend((value, False) for key, value in node.value if not _READ_FROM_TEXT.fullmatch(str(key.value)))
        elif isinstance(node, yaml.SequenceNode):
            texts = any(each.tag.endswith(":str") for each in node.value)
            stack.extend((each, texts) for each in node.value)
        elif (
            isinstance(node, yaml.ScalarNode)
            and not node.style
            and (read := _read_scalar(str(node.value), node.tag[18:], beside_texts))
        ):
            place = span_at(source, node.start_mark, node.end_mark)
            yield RuleFinding(place, f"'{node.value}' is {read[0]} in YAML", read[1], subject=str(node.value))


def _read_scalar(text: str, tag: str, beside_texts: bool) -> tuple[str, str] | None:
    # What YAML makes of a plain scalar that looks like something else, and the help.
    if len(text) > _LONGEST:
        return None
    quoted = f"for a text write '{text}' in quotes"
    if tag == "str" and (match := _EXPONENT.fullmatch(text)):
        whole, fraction, sign, exponent = match.groups()
        return "a text", f"for a number write {whole}{fraction or '.0'}e{sign or '+'}{exponent}"
    if tag == "str" and _INFINITE.fullmatch(text):
        return "a text", f"for a number write {re.sub('[-+]?', lambda sign: sign[0] + '.', text.lower(), count=1)}"
    if tag == "int" and re.fullmatch(r"[-+]?0[0-7]+", text) and int(text, 8) != int(text):
        return f"{int(text, 8)}, an octal number,", f"write {int(text)}; {quoted}"
    if tag == "str" and re.fullmatch(r"[-+]?0\d+", text):
        return "a text", f"for a number write {int(text)}; {quoted}"
    if tag in ("int", "float") and ":" in text:
        seconds = 0.0
        for part in text.lstrip("+-").replace("_", "").split(":"):
            seconds = 60 * seconds + float(part)
        return f"{seconds:g}, a number of base 60,", quoted
    if tag == "timestamp":
        return "a date", quoted
    if tag == "bool" and beside_texts:
        return f"{_SWITCH.get(text.lower(), text)}, beside texts,", quoted
    return None


def _find_in_launch(element: Element, _view: LaunchView) -> Iterable[RuleFinding]:
    value, kind = element.attributes.get("value", "").strip(), element.attributes.get("type", "auto")
    named = element.attributes.get("param", "").rpartition("/")[2]
    if element.name == "rosparam" and not _READ_FROM_TEXT.fullmatch(named) and len(element.text) <= _LONGEST_TEXT:
        for found in _find_in_text(SourceFile("", element.text)):
            start, end = element.text_offset(found.span.start), element.text_offset(found.span.end)
            yield RuleFinding(Span(element.source, start, end), found.message, found.help, subject=found.subject)
    if element.name != "param" or kind not in ("auto", "yaml") or len(value) > _LONGEST:
        return
    if kind == "yaml":
        for found in _find_in_text(SourceFile("", value)):
            yield RuleFinding(element.value_span("value"), found.message, found.help, subject=value)
        return
    help_ = ""
    # roslaunch tries float() only for a text with a point
    if _INFINITE.fullmatch(value) or ("." not in value and _EXPONENT.fullmatch(value)):
        help_ = 'add type="double"'
    elif re.fullmatch(r"[-+]?0[xX][0-9a-fA-F]+", value):
        help_ = f'write {int(value, 16)}, or add type="str"'
    elif value.lower() in _SWITCH:
        help_ = f'write {_SWITCH[value.lower()]}, or add type="str"'
    if help_:
        place = element.value_span("value")
        yield RuleFinding(
            place, f"roslaunch sets the text '{value}', which looks like another value", help_, subject=value
        )


def _yaml_example(text: str) -> Example:
    return Example({"params/drive.yaml": text})


RULES = (
    Rule(
        id="misread-value",
        group=RuleGroup.YAML,
        severity=Severity.WARNING,
        summary="A value is read otherwise than it looks.",
        explanation="""
YAML 1.1 needs a point and a sign in `1.0e-3`; `1e-3` is a text, and a node that expects a number takes its default.
`010` is 8, `12:30` is 750, `2026-01-02` is a date, and `on`, `off`, `yes` and `no` are true or false.
`<param value=...>` without `type` has rules of its own: `1e-3`, `0x1F`, `inf`, `on` and `yes` are texts.
Beside launch files, only YAML files that one of them loads are examined.
""",
        bad=(
            _yaml_example("tolerance: «1e-3»\n"),
            _yaml_example("code: «010»\n"),
            _yaml_example("start: «12:30»\n"),
            _yaml_example("built: «2026-01-02»\n"),
            _yaml_example("states: [blink, «on»]\n"),
            launch_example(make_launch('<param name="tolerance" value="«1e-3»"/>')),
            launch_example(make_launch('<param name="address" value="«0x1F»"/>')),
            launch_example(make_launch('<param name="start" type="yaml" value="«12:30»"/>')),
            launch_example(make_launch("<rosparam>", "  tolerance: «1e-3»", "</rosparam>")),
        ),
        good=(
            _yaml_example("tolerance: 1.0e-3\ncode: '010'\nstart: '12:30'\nstates: [blink, 'on']\nuse_map: yes\n"),
            _yaml_example("process_noise_covariance: [1e-9, 0.0]\nplanner_configs: {SBL: {range: 1e-6}}\n"),
            launch_example(make_launch('<rosparam param="process_noise_covariance">[1e-9, 0.0]</rosparam>')),
            launch_example(make_launch('<param name="tolerance" type="double" value="1e-3"/>')),
        ),
        yaml_file=_find_in_yaml,
        only_parameters=True,
        element=_find_in_launch,
    ),
)
