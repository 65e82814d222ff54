"""XML within limits."""

import pytest

from ur.source.foreign.xml_text import parse_xml


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("<a>" * 101 + "</a>" * 101, "nested deeper than 100"),
        ("<a>" * 300_000, "nested deeper than 100"),
        ("<a>" + "<b/>" * 200_000 + "</a>", "more than 200,000 elements"),
        ("x" * 20_000_001, "20,000,001 characters"),
        ("<!DOCTYPE a><a/>", "a document type"),
        ('<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>', "a document type"),
        ('<!DOCTYPE a [<!ENTITY b "c">]><a>&b;</a>'.encode("utf-16"), "a document type"),
        (b'<?xml version="1.0" encoding="no-such"?><a/>', "encoding"),
        ("<a>&b;</a>", "undefined entity"),
        ("<a>", "no element|unclosed"),
        ("", "no element"),
        ("<a>\0</a>", "not well-formed"),
        ("<a \ud800=''/>", "surrogates"),
    ],
)
def test_what_is_no_plain_document_is_refused(text: str | bytes, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        parse_xml(text)


def test_document_is_read_as_by_the_standard_library() -> None:
    root = parse_xml(b"<?xml version='1.0'?><a b='c'>t<d/>u<!-- v --></a>")
    assert (root.tag, root.attrib, root.text, root[0].tag, root[0].tail) == ("a", {"b": "c"}, "t", "d", "u")
