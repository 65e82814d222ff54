"""Rules about values that roslaunch splits into words: `args` and `launch-prefix`."""

import re
from collections.abc import Iterable, Iterator

from ur.check.example_parts import directory_example, make_talk_launch
from ur.check.rule import LaunchView, Rule, RuleFinding, RuleGroup, launch_examples
from ur.launchfile.syntax import Element, Substitution, SubstitutionProblem, is_eval, parse_substitutions
from ur.source.diagnostic import Severity

_PREFIX, _ARGUMENTS = "launch-prefix", "args"
_FOLDERS = ("find", "dirname", "env", "optenv")
_PATH_NAME = re.compile(r"(?:^|_)(?:file|filename|path|folder|dir|directory|config|map|world)$")
_PATH_START = ("/", "~", "$(find ", "$(dirname)", "$(env ", "$(optenv ")
_TRUTHS = ("true", "false")


def _find_argument_in_prefix(element: Element, view: LaunchView) -> Iterable[RuleFinding]:
    value = element.attributes.get(_PREFIX, "")
    for piece in _pieces(value):
        # An argument at the beginning is a command with its options, `gdb --args`: it is meant to be split.
        if piece.command == "arg" and value[: piece.start].strip() and not _is_plain(_name(piece), view):
            yield _found(element, _PREFIX, piece)


def _find_path_in_words(element: Element, view: LaunchView) -> Iterable[RuleFinding]:
    for attribute in (_ARGUMENTS, _PREFIX):
        value = element.attributes.get(attribute, "")
        for piece in _pieces(value):
            if piece.command in _FOLDERS or (attribute == _ARGUMENTS and _may_break(piece, value, view)):
                yield _found(element, attribute, piece)


def _pieces(value: str) -> Iterator[Substitution]:
    if is_eval(value):
        return
    try:
        yield from parse_substitutions(value)
    except SubstitutionProblem:  # another rule reports it
        return


def _may_break(piece: Substitution, value: str, view: LaunchView) -> bool:
    if piece.command != "arg" or _is_plain(_name(piece), view):
        return False
    is_list = piece.end - piece.start == len(value.strip()) and not _is_path(_name(piece), view)
    return not is_list


def _name(piece: Substitution) -> str:
    return piece.words[0].text if piece.words else ""


def _is_plain(name: str, view: LaunchView) -> bool:
    """Return whether an argument is a number, true or false, or a fixed text, according to all its declarations."""
    declared = view.declared.get(name, ())
    return bool(declared) and all(_is_plain_declaration(element) for element in declared)


def _is_plain_declaration(element: Element) -> bool:
    if "value" in element.attributes:
        return "$(" not in element.attributes["value"] or is_eval(element.attributes["value"])
    default = element.attributes.get("default", "").strip()
    if default.lower() in _TRUTHS:
        return True
    try:
        float(default)
    except ValueError:
        return False
    return True


def _is_path(name: str, view: LaunchView) -> bool:
    defaults = [element.attributes.get("default", "") for element in view.declared.get(name, ())]
    return bool(_PATH_NAME.search(name)) or any(default.startswith(_PATH_START) for default in defaults)


def _found(element: Element, attribute: str, piece: Substitution) -> RuleFinding:
    text = f"$({piece.content})"
    what = f"argument '{_name(piece)}'" if piece.command == "arg" else f"'{text}'"
    variable = re.sub(r"\W", "_", _name(piece) or "folder").upper()
    return RuleFinding(
        element.piece_span(attribute, piece.start, piece.end),
        f"'{attribute}' of <{element.name}> holds {what}, whose blanks and quotation marks become ends of words",
        f'pass it in a variable, <env name="{variable}" value="{text}"/>, or in a parameter or remap of the node',
        subject=_name(piece) or piece.command,
    )


_FILE = '<arg name="map_file"/>'

RULES = (
    Rule(
        id="argument-in-prefix",
        group=RuleGroup.VALUES,
        severity=Severity.WARNING,
        summary="A value in launch-prefix can become a command of its own.",
        explanation="""
roslaunch splits `launch-prefix` into words as a shell does, and starts the first one. Quotation marks do not help: a
value with an apostrophe ends them, and the rest of it becomes further words. So the name of a downloaded file can run a
command, and a folder such as `/home/o'brien` breaks the file. Pass the value in a variable: `<env>` inside of the node,
and `"$NAME"` in the program that the prefix names.

Left alone are arguments that are numbers, `true` or `false` by their default, an argument at the beginning of the
prefix (its words, such as `gdb --args`, are what it is for), and what `$(eval ...)` computes.
""",
        bad=launch_examples("""
<launch>
  <arg name="map_file"/>
  <node name="rviz" pkg="demo_nodes" type="talker" launch-prefix="fit_view '«$(arg map_file)»'"/>
</launch>
"""),
        good=launch_examples("""
<launch>
  <arg name="delay" default="2.5"/>
  <arg name="debugger" default=""/>
  <arg name="map_file"/>
  <node name="late" pkg="demo_nodes" type="talker" launch-prefix="bash -c 'sleep $(arg delay); exec $0 $@'"/>
  <node name="debugged" pkg="demo_nodes" type="talker" launch-prefix="$(arg debugger)"/>
  <node name="rviz" pkg="demo_nodes" type="talker" launch-prefix="fit_view">
    <env name="MAP_FILE" value="$(arg map_file)"/>
  </node>
</launch>
"""),
        element=_find_argument_in_prefix,
    ),
    Rule(
        id="path-in-args",
        group=RuleGroup.CONVENTIONS,
        severity=Severity.WARNING,
        summary="A value in args can become further arguments.",
        explanation="""
roslaunch splits `args` into words as a shell does. A value with a blank becomes several arguments of the node, and one
with an apostrophe ends a quotation. Paths and topics travel in a parameter, a remap or a variable (`<env>`). The same
holds for `$(find ...)`, `$(dirname)` and `$(env ...)`, in `launch-prefix` as well.

Left alone are arguments that are numbers, `true` or `false` by their default, one that is all of `args` and no path,
and what `$(eval ...)` computes.
""",
        bad=(
            directory_example(make_talk_launch(_FILE, "<!--map_file: The map.-->", says="'«$(arg map_file)»'")),
            directory_example(make_talk_launch(says="«$(find my_robot)»/words.txt")),
        ),
        good=(
            directory_example(
                make_talk_launch(
                    '<arg name="options" default=""/>', "<!--options: Options of the program.-->", says="$(arg options)"
                )
            ),
            directory_example(
                make_talk_launch(
                    '<arg name="rate" default="1"/>', "<!--rate: How often, in Hz.-->", says="--rate $(arg rate)"
                )
            ),
        ),
        element=_find_path_in_words,
    ),
)
