import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ur.launchfile.syntax import Element, LaunchFile, parse_launch_file


def _parse(text: str, encoding: str = "utf-8") -> LaunchFile:
    return parse_launch_file("x.launch", text.encode(encoding))


def _first(file: LaunchFile) -> Element:
    assert file.launch is not None
    return next(file.launch.elements)


def test_attribute_places_cover_name_and_value() -> None:
    element = _first(_parse('<launch>\n  <node pkg=\'p\'\n    type = "t" name="n>"/>\n</launch>'))
    assert element.name_span("type").text == "type"
    assert element.value_span("type").text == "t"
    assert element.value_span("name").text == "n>"
    assert str(element.value_span("type")) == "x.launch:3:13"
    assert element.tag_span.text == '<node pkg=\'p\'\n    type = "t" name="n>"/>'


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig"])
def test_places_count_characters_not_bytes(encoding: str) -> None:
    element = _first(_parse("<launch><!-- ☃ü --><param name='ä' value='x$(arg ö)'/></launch>", encoding))
    assert element.span.text == "<param"
    assert element.value_span("name").text == "ä"
    assert element.piece_span("value", 1, 9).text == "$(arg ö)"


@pytest.mark.parametrize("encoding", ["iso-8859-1", "utf-16"])
def test_other_encodings_keep_their_places(encoding: str) -> None:
    text = f"<?xml version='1.0' encoding='{encoding}'?><launch><!-- ü --><param name='ä' value='b'/></launch>"
    assert _first(_parse(text, encoding)).value_span("name").text == "ä"


def test_piece_behind_references_is_found() -> None:
    element = _first(_parse("<launch><param name='a' value='&lt;&#65; $(arg b) &amp; $(arg c)'/></launch>"))
    value = element.attributes["value"]
    start = value.index("$(arg c)")
    assert element.piece_span("value", start, start + 8).text == "$(arg c)"


def test_text_of_rosparam_knows_where_it_stands() -> None:
    text = "<launch><rosparam>a: 1<!-- c --><![CDATA[\nb: <]]>&lt;\nlast: 2</rosparam></launch>"
    element = _first(_parse(text))
    assert element.text == "a: 1\nb: <<\nlast: 2"
    offset = element.text_offset(element.text.index("last"))
    assert text[offset : offset + 4] == "last"


def test_comments_stay_in_the_tree_with_their_place() -> None:
    file = _parse("<!-- before --><launch><!--Summary: x--><arg name='a'/><!--a: y--></launch><!-- after -->")
    assert file.launch is not None
    assert [comment.text for comment in file.launch.comments] == ["Summary: x", "a: y"]
    assert [comment.span.text for comment in file.comments] == ["<!-- before -->", "<!-- after -->"]


def test_broken_file_gives_what_stood_before() -> None:
    file = _parse("<launch><param name='a' value='1'/><node")
    assert file.diagnostics[0].rule == "bad-xml"
    assert file.root is not None
    assert [element.name for element in file.root.elements] == ["param"]


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        ("<launch>\n<group>\n</launch>", "3:1", "does not close <group>"),
        ("<launch>\n<group>", "2:8", "ends inside <group>"),
        ("<launch>\n<param name=a/></launch>", "2:13", "not well-formed"),
        ("<launch><param name='b & c'/></launch>", "1:24", "&amp;"),
        ("", "1:1", "no element"),
        ("<launch/>\n<launch/>", "2:1", "one root element"),
    ],
)
def test_broken_xml_is_explained_at_its_place(text: str, place: str, words: str) -> None:
    found = _parse(text).diagnostics[0]
    assert str(found.span) == f"x.launch:{place}"
    assert words in found.message


@pytest.mark.parametrize(
    ("data", "place", "words"),
    [
        (b"<launch>\n<!-- a -- b -->\n</launch>", "2:8", "instead of '--'"),
        (b"<launch>\n<!-- a --->\n</launch>", "2:8", "instead of '--'"),
        (b"<launch>\n<!-- a\n</launch>", "2:1", "write --> at the end of the comment"),
        (b"<launch><param name='a' value='b < c'/></launch>", "1:34", "write &lt; instead of <"),
        (b"<launch><param name='a' value='b/>\n  <node/></launch>", "2:3", "close the quotes of the line above"),
        (b"<launch/>\nhello", "2:1", "before </launch>"),
        (b"hello\n<launch/>", "1:1", "make it a comment"),
        (b"\n<?xml version='1.0'?>\n<launch/>", "2:1", "remove what is before it"),
        (b"<?xml version='1.0' encoding='utf-16'?>\n<launch/>", "1:31", 'write encoding="utf-8"'),
        (b"<?xml version='1.0' encoding='none'?>\n<launch/>", "1:1", 'write encoding="utf-8"'),
        (b"<launch>\n<param name='\xfc' value='1'/></launch>", "2:14", "iconv -f latin1 -t utf-8 FILE"),
        (b"<launch>&nbsp;</launch>", "1:9", "write the character itself"),
        (b"<launch><xacro:include/></launch>", "1:9", "xmlns:PREFIX"),
    ],
)
def test_cause_of_broken_xml_has_its_own_help(data: bytes, place: str, words: str) -> None:
    found = parse_launch_file("x.launch", data).diagnostics[0]
    assert str(found.span) == f"x.launch:{place}"
    assert words in (found.help or "")


NAMES = st.sampled_from(["a", "b-c", "_d", "ns:e"])
VALUES = st.text(
    st.characters(codec="utf-8", exclude_characters="\r\n\t\x00", exclude_categories=["Cc", "Cs"]), max_size=8
)


@settings(max_examples=150, deadline=None, derandomize=True, database=None)
@given(
    st.dictionaries(NAMES, VALUES, max_size=4),
    st.sampled_from(["'", '"']),
    st.sampled_from([" ", "\n\t", "\r\n "]),
    st.sampled_from(["=", " = ", "=\n"]),
)
def test_every_value_is_found_where_it_was_written(values: dict[str, str], quote: str, gap: str, equals: str) -> None:
    from xml.sax.saxutils import escape

    written = {name: escape(value, {quote: "&quot;" if quote == '"' else "&apos;"}) for name, value in values.items()}
    tag = "<param" + "".join(f"{gap}{name}{equals}{quote}{text}{quote}" for name, text in written.items()) + "/>"
    element = _first(_parse(f"<launch xmlns:ns='u'>é{tag}</launch>"))
    assert element.attributes == values
    assert element.tag_span.text == tag
    for name, text in written.items():
        assert element.name_span(name).text == name
        assert element.value_span(name).text == text
