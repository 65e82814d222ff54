"""Parser of text to a syntax tree, with the standard library's expat. Never raises for the content of a file."""

import codecs
import os
import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from xml.parsers import expat

from ur.launchfile.syntax.tree import WRONG_LAUNCHER, Comment, Element, LaunchFile
from ur.source.diagnostic import Diagnostic, Note, error
from ur.source.file import SourceFile, Span

_DECLARATION = re.compile(rb"""^<\?xml[^>]*?encoding\s*=\s*["']([A-Za-z0-9._-]+)["']""")
_MARKS = ((codecs.BOM_UTF8, "utf-8"), (codecs.BOM_UTF16_LE, "utf-16-le"), (codecs.BOM_UTF16_BE, "utf-16-be"))


def decode_text(data: bytes) -> tuple[str, str]:
    """Return the text of an XML file and its encoding: from the byte order mark, the declaration, else UTF-8.

    Invalid bytes become U+FFFD; the XML parser reports them.
    """
    if data.isascii():
        return data.decode("ascii"), "ascii"
    for mark, encoding in _MARKS:
        if data.startswith(mark):
            return data.decode(encoding, "replace"), encoding
    declared = _DECLARATION.match(data)
    encoding = declared.group(1).decode("ascii").lower() if declared else "utf-8"
    try:
        return data.decode(encoding, "replace"), encoding
    except (LookupError, ValueError):
        return data.decode("utf-8", "replace"), "utf-8"


class Offsets:
    """Converts byte offsets to character offsets. Cheap as long as the requested offsets increase."""

    __slots__ = ("_byte", "_character", "_data", "_encoding", "_same")

    def __init__(self, data: bytes, encoding: str) -> None:
        self._data = data
        self._encoding = encoding
        self._same = encoding == "ascii"
        self._byte = 0
        self._character = 0

    def characters(self, byte: int) -> int:
        """Return the number of characters before a byte."""
        if self._same:
            return byte
        if byte < self._byte:
            self._byte = self._character = 0
        self._character += len(self._data[self._byte : byte].decode(self._encoding, "replace"))
        self._byte = byte
        return self._character


MAX_BYTES = 8 * 1024 * 1024
MAX_ATTRIBUTE = 1024 * 1024
MAX_DEPTH = 900
MAX_ELEMENTS = 200_000

_MISMATCHED_TAG = 7
_NO_ELEMENT = 3
_DUPLICATE_ATTRIBUTE = 8
_INVALID_TOKEN = 4
_UNCLOSED_TOKEN = 5
_CAUSES = {
    _DUPLICATE_ATTRIBUTE: ("duplicate attribute", "keep one of the two"),
    2: ("text before the first tag, expected <launch>", "remove it, or make it a comment: <!-- ... -->"),
    9: (
        "something after the end of the first element, expected one root element",
        "move it into <launch>, before </launch>",
    ),
    11: (
        "an entity that XML does not know",
        "write the character itself: only &lt; &gt; &amp; &quot; &apos; are known",
    ),
    17: ("'<?xml ...?>' after other text, expected it as the first", "remove what is before it, also blank lines"),
    19: ("the declared encoding is not the file's, which is UTF-8", 'write encoding="utf-8" or leave it out'),
    30: ("the XML declaration is not well-formed", 'write <?xml version="1.0"?>'),
    27: ("a prefix that is not declared", "remove it, or add xmlns:PREFIX=... to <launch>"),
}
_LONE_AMPERSAND = re.compile(r"&(?!#?\w+;)")


class _StopParsing(Exception):  # noqa: N818 - not an error: ends expat's loop
    pass


def parse_launch_file(path: str, data: bytes, read: Callable[[str], bytes] | None = None) -> LaunchFile:
    """Return the tree of a launch file. Errors are in its `diagnostics`, and the tree ends there.

    With `read`, which returns the content of a file or raises OSError, the package of the file decides for which
    launcher it is written if its content does not.
    """
    if len(data) > MAX_BYTES:
        source = SourceFile(path, "")
        message = f"{path} has {len(data):,} bytes, expected a launch file of at most {MAX_BYTES:,}"
        return LaunchFile(source, None, None, (), (error(message, rule="file-too-large"),))
    text, encoding = decode_text(data)
    builder = _Builder(SourceFile(path, text), Offsets(data, encoding), len(data))
    builder.run(data)
    launches = builder.launches
    ros2 = find_ros2(builder.source, builder.root, read)
    if ros2 is not None:
        found = () if is_ros2_name(path) else builder.diagnostics
        return LaunchFile(builder.source, builder.root, None, tuple(builder.outer_comments), (ros2, *found))
    if not builder.diagnostics and len(launches) != 1:
        builder.diagnostics.append(_not_one_launch(builder.source, builder.root, launches))
    return LaunchFile(
        builder.source,
        builder.root,
        launches[0] if len(launches) == 1 else None,
        tuple(builder.outer_comments),
        tuple(builder.diagnostics),
    )


class _Builder:
    def __init__(self, source: SourceFile, offsets: Offsets, size: int) -> None:
        self.source = source
        self.offsets = offsets
        self.root: Element | None = None
        self.launches: list[Element] = []
        self.outer_comments: list[Comment] = []
        self.diagnostics: list[Diagnostic] = []
        self.stack: list[Element] = []
        self.count = 0
        self.namespaces: list[tuple[str | None, str]] = []
        self.in_doctype = False
        self.may_have_prefixes = "xmlns" in source.text or "xml:" in source.text
        self.may_be_long = size > MAX_ATTRIBUTE
        # Names are looked up with their prefix resolved, as roslaunch's parser does: an unbound prefix is an error.
        self.parser = parser = expat.ParserCreate(namespace_separator=" ")
        parser.namespace_prefixes = True
        parser.buffer_text = True
        parser.specified_attributes = True
        parser.StartElementHandler = self.start_element
        parser.EndElementHandler = self.end_element
        parser.CommentHandler = self.comment
        parser.EntityDeclHandler = self.entity_declaration
        parser.StartNamespaceDeclHandler = self.namespace_declaration
        parser.StartDoctypeDeclHandler = self.start_doctype
        parser.EndDoctypeDeclHandler = self.end_doctype
        parser.ExternalEntityRefHandler = self.external_entity

    def run(self, data: bytes) -> None:
        try:
            self.parser.Parse(data, True)
        except _StopParsing:
            pass
        except expat.ExpatError as problem:
            self.diagnostics.append(self.explain(problem))
        except (LookupError, ValueError, UnicodeError) as problem:  # an encoding that Python does not know
            self.diagnostics.append(
                error(
                    f"not well-formed XML: {problem}, expected UTF-8",
                    Span(self.source, 0, 1),
                    rule="bad-xml",
                    help='write encoding="utf-8" in the first line, or leave it out',
                )
            )
        for element in self.stack:
            element.end = max(element.end, len(self.source.text))

    def here(self) -> int:
        return self.offsets.characters(self.parser.CurrentByteIndex)

    def start_element(self, name: str, attributes: dict[str, str]) -> None:
        if self.may_have_prefixes:
            # What roslaunch's parser makes of them: declarations are attributes, names keep the prefix that is written.
            declared = {f"xmlns:{prefix}" if prefix else "xmlns": uri for prefix, uri in self.namespaces}
            self.namespaces.clear()
            for key, value in attributes.items():
                declared[_qualified(key) if " " in key else key] = value
            name, attributes = (_qualified(name) if " " in name else name), declared
        element = Element(self.source, name, attributes, self.here())
        stack = self.stack
        if stack:
            stack[-1].add_child(element)
        elif self.root is None:
            self.root = element
        stack.append(element)
        self.count += 1
        if name == "launch":
            self.launches.append(element)
        elif name == "rosparam" or (len(name) == 8 and name.lower() == "rosparam"):
            self.parser.CharacterDataHandler = self.text
        if len(stack) > MAX_DEPTH:
            self.stop(f"<{name}> is nested {len(stack)} deep, expected at most {MAX_DEPTH}", element, "nested-too-deep")
        if self.count > MAX_ELEMENTS:
            self.stop(f"more than {MAX_ELEMENTS:,} elements in one file", element, "file-too-large")
        if self.may_be_long:
            self.check_lengths(element)

    def check_lengths(self, element: Element) -> None:
        for key, value in element.attributes.items():
            if len(value) > MAX_ATTRIBUTE:
                message = f"attribute '{key}' of <{element.name}> has {len(value):,} characters"
                self.stop(f"{message}, expected at most {MAX_ATTRIBUTE:,}", element, "attribute-too-long")

    def end_element(self, _name: str) -> None:
        element = self.stack.pop()
        element.end = self.here()
        if self.parser.CharacterDataHandler is not None and element.name.lower() == "rosparam":
            self.parser.CharacterDataHandler = None

    def text(self, data: str) -> None:
        element = self.stack[-1]
        if element.name.lower() == "rosparam":
            element.text += data

    def comment(self, data: str) -> None:
        if self.in_doctype:
            return
        start = self.here()
        end = self.source.text.find("-->", start + 4)
        comment = Comment(Span(self.source, start, end + 3 if end != -1 else start + 4), data)
        if self.stack:
            self.stack[-1].add_child(comment)
        else:
            self.outer_comments.append(comment)

    def entity_declaration(self, name: str, *_details: object) -> None:
        start = max(self.source.text.rfind("<!ENTITY", 0, self.here()), 0)
        span = Span(self.source, start, start + len("<!ENTITY"))
        message = f"entity '{name}' is declared, expected none: they can make a small file huge"
        help_ = f"write the text itself where it says &{name};, or use an <arg>"
        self.diagnostics.append(error(message, span, rule="entity-declaration", help=help_))
        raise _StopParsing

    def namespace_declaration(self, prefix: str | None, uri: str | None) -> None:
        self.namespaces.append((prefix, uri or ""))

    def start_doctype(self, *_details: object) -> None:
        self.in_doctype = True

    def end_doctype(self) -> None:
        self.in_doctype = False

    def external_entity(self, *_details: object) -> int:
        return 1  # as roslaunch's parser: passed over, never read

    def stop(self, message: str, element: Element, rule: str) -> None:
        self.diagnostics.append(error(message, element.span, rule=rule))
        raise _StopParsing

    def explain(self, problem: expat.ExpatError) -> Diagnostic:
        byte = max(self.parser.ErrorByteIndex, 0)
        offset = min(self.offsets.characters(byte), len(self.source.text))
        text = self.source.text
        span = Span(self.source, offset, min(offset + 1, len(text)))
        notes: tuple[Note, ...] = ()
        help_: str | None = None
        reason = expat.errors.messages[problem.code] if problem.code in expat.errors.messages else str(problem)
        if problem.code == _MISMATCHED_TAG and self.stack:
            start = text.rfind("</", 0, offset + 2)
            start = start if start != -1 else offset
            end = text.find(">", start)
            closing = text[start : end + 1] if end != -1 else text[start : start + 20]
            span = Span(self.source, start, start + len(closing))
            opened = self.stack[-1]
            reason = f"{closing.strip()} does not close <{opened.name}>, expected </{opened.name}>"
            notes = (Note(f"<{opened.name}> was opened here", opened.span),)
            help_ = f"close it with </{opened.name}>, or write <{opened.name} .../>"
        elif problem.code == _NO_ELEMENT:
            if self.stack:
                opened = self.stack[-1]
                reason = f"the file ends inside <{opened.name}>, expected </{opened.name}>"
                notes = (Note(f"<{opened.name}> was opened here", opened.span),)
                help_ = f"add </{opened.name}> at the end"
            else:
                reason = "no element found, expected <launch>"
                help_ = "a launch file starts with <launch> and ends with </launch>"
        elif cause := _find_cause(text, offset, problem.code):
            start, end, reason, help_ = cause
            span = Span(self.source, start, end)
        return error(f"not well-formed XML: {reason}", span, rule="bad-xml", notes=notes, help=help_)


def _find_cause(text: str, offset: int, code: int) -> tuple[int, int, str, str] | None:
    # Start, end, reason and help of an error, of which expat names only the place.
    comment = text.rfind("<!--", 0, offset + 4)
    closed = text.find("-->", comment + 4)
    line = text[text.rfind("\n", 0, offset) + 1 : offset]
    if code in _CAUSES:
        return offset, offset + 1, *_CAUSES[code]
    if code not in (_INVALID_TOKEN, _UNCLOSED_TOKEN):
        return None
    if text.startswith("\ufffd", offset):
        reason = "a character that is not UTF-8, which the file is read as"
        return offset, offset + 1, reason, "save the file as UTF-8: iconv -f latin1 -t utf-8 FILE"
    if comment == offset and code == _INVALID_TOKEN:
        return offset, offset + 4, "a comment inside a tag or value, expected it outside", "move it before the tag"
    if comment != -1 and (closed == -1 or offset <= closed + 2):
        if closed == -1:
            return (
                comment,
                comment + 4,
                "a comment is not closed, expected '-->'",
                "write --> at the end of the comment",
            )
        return (
            offset - 2,
            offset,
            "'--' inside a comment, expected it only at the end",
            "write '-' or '==' instead of '--'",
        )
    if lone := _find_lone_ampersand(text, offset):
        reason = "'&' begins a reference such as &lt;, expected &amp;"
        return lone.start(), lone.end(), reason, "write &amp; instead of &"
    at = offset - text.startswith("<", offset - 1)  # a '<' in a text is noticed behind it
    if text.startswith("<", at) and line.strip():
        return at, at + 1, "'<' inside a value, expected &lt;", "write &lt; instead of <"
    if text.startswith("<", offset):
        return offset, offset + 1, "a tag inside a value that is not closed", "close the quotes of the line above"
    return offset, offset + 1, "invalid token", "check the quotes, the '=' and the '>' around this place"


def _find_lone_ampersand(text: str, offset: int) -> re.Match[str] | None:
    # expat stops at the first character that cannot belong to a reference.
    start = text.rfind("&", max(0, offset - 100), offset + 1)
    if start == -1 or (start < offset and not re.fullmatch(r"#?\w*", text[start + 1 : offset])):
        return None
    return _LONE_AMPERSAND.match(text, start)


def _qualified(name: str) -> str:
    parts = name.split(" ")
    return f"{parts[2]}:{parts[1]}" if len(parts) > 2 else parts[1]


def _not_one_launch(source: SourceFile, root: Element | None, launches: list[Element]) -> Diagnostic:
    if len(launches) > 1:
        return error(
            "a second <launch> in one file, expected one",
            launches[1].span,
            rule="launch-element",
            notes=(Note("the first <launch> is here", launches[0].span),),
            help="put its content into the first one, or into a file of its own and <include> that",
        )
    span = root.span if root else Span(source, 0, 1)
    found = f"<{root.name}>" if root else "nothing"
    return error(
        f"{found} is the root element, expected <launch>",
        span,
        rule="launch-element",
        help="a launch file starts with <launch> and ends with </launch>",
    )


ROS2_SUFFIXES = (".py", ".launch.yaml", ".launch.yml", "_launch.yaml", "_launch.yml")
_PYTHON = (".launch.py", "_launch.py")
_SUBSTITUTIONS = ("$(find-pkg-share", "$(find-pkg-prefix", "$(exec-in-pkg", "$(var ")
_TAGS_OF_ROS2 = (
    "append_env|composable_node|for|for_each|lifecycle_node|load_composable_node|log_info|node_container|"
    "push-ros-namespace|push_ros_namespace|set_env|set_parameter|set_parameters_from_file|set_remap|timer|unset_env"
)
_OF_ROS2 = re.compile(rf"exec|\$\((?:find-pkg|exec-in|var )|<(?:let|{_TAGS_OF_ROS2})\b")
_OF_ROS1 = re.compile(  # an element or a substitution that only roslaunch has
    r"\$\((?:find|arg|anon) |<(?:rosparam|machine|test|master|param|remap|env)\b|\s(?:type|ns|doc|pass_all_args)\s*="
)
_BUILD = re.compile(rb"<build(?:_type|tool_depend)\b[^>]*>\s*(ament|catkin)")
_COMMENT = re.compile(rb"<!--.*?(?:-->|\Z)", re.DOTALL)
_DEEPEST = 8  # folders above a launch file
_HELP = "'ros2 launch' starts it; roslaunch needs a file of the package's branch for ROS 1"


def is_ros2_name(path: str) -> bool:
    """Return whether a file is a launch file for ROS 2 by its name."""
    return path.endswith(ROS2_SUFFIXES)


def is_ros2_tree(tree: LaunchFile) -> bool:
    """Return whether a parsed file is written for ROS 2."""
    return tree.for_other_launcher


def count_unread(paths: Iterable[str]) -> dict[str, int]:
    """Count the launch files of ROS 2 that a command for those of ROS 1 does not read, by kind."""
    names = (path for path in paths if path.endswith((*_PYTHON, *ROS2_SUFFIXES[1:])))
    kinds = Counter("Python" if path.endswith(".py") else "YAML" for path in names)
    return {f"{kind} launch file of ROS 2": number for kind, number in sorted(kinds.items())}


def describe_unread(unread: Mapping[str, int]) -> str:
    """Return `6 Python launch files of ROS 2 were not read`; empty if everything was."""
    kinds = " and ".join(
        f"{number} {kind if number == 1 else kind.replace(' file ', ' files ')}" for kind, number in unread.items()
    )
    return f"{kinds} {'was' if sum(unread.values()) == 1 else 'were'} not read" if kinds else ""


def find_ros2(
    source: SourceFile, root: Element | None, read: Callable[[str], bytes] | None = None
) -> Diagnostic | None:
    """Return the finding that a file is written for ROS 2, at the first evidence of it; None for any other file."""
    if is_ros2_name(source.path):
        return _explain("its name ends like one", Span(source, 0, 1))
    if root is None or root.name != "launch":
        return None
    waiting = [root] if _OF_ROS2.search(source.text) else []
    while waiting:
        element = waiting.pop()
        sign = _find_sign(element)
        if sign:
            return _explain(sign, element.span)
        waiting += reversed(tuple(element.elements))
    if read is None or _OF_ROS1.search(source.text) or not _is_ament(source.path, read):
        return None
    return _explain("its package is built with ament", root.span)


def _is_ament(path: str, read: Callable[[str], bytes]) -> bool:
    """Return whether the package of a file is built for ROS 2 only; the package is the nearest one."""
    folder = os.path.abspath(path)  # noqa: PTH100 - links stay, and pathlib takes time to load
    for _ in range(min(_DEEPEST, folder.count("/"))):
        folder = folder.rpartition("/")[0]
        try:
            kinds = set(_BUILD.findall(_COMMENT.sub(b"", read(f"{folder}/package.xml"))))
        except OSError:
            continue
        return kinds == {b"ament"}
    return False


def _find_sign(element: Element) -> str:
    attributes = element.attributes
    if element.name in _TAGS_OF_ROS2.split("|"):
        return f"it uses <{element.name}>"
    if element.name == "let" and "name" in attributes and "value" in attributes:
        return "it uses <let>"
    if element.name == "node" and "exec" in attributes and "type" not in attributes:
        return "its <node> has exec="
    if element.name == "executable" and "cmd" in attributes:
        return "it uses <executable>"
    for value in attributes.values():
        for mark in _SUBSTITUTIONS:
            if mark in value:
                return f"it uses {mark.strip()} ...)"
    return ""


def _explain(sign: str, span: Span) -> Diagnostic:
    message = f"this is a launch file for ROS 2 ({sign}), expected one for ROS 1"
    return error(message, span, rule=WRONG_LAUNCHER, help=_HELP)
