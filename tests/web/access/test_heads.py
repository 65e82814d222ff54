import pytest

from ur.web.access.origin import find_cookies, find_head

HEAD = b"POST /login HTTP/1.1\r\nHost: localhost:8090\r\ncontent-length:  12\r\nCookie: %s\r\n\r\n"


@pytest.mark.parametrize("size", [1, 3, 100])
def test_head_is_found_whatever_the_pieces_are_that_it_arrives_in(size: int) -> None:
    data, buffer, found = HEAD % b"a=b" + b"body", bytearray(), None
    for start in range(0, len(data), size):
        before = len(buffer)
        buffer += data[start : start + size]
        found = find_head(buffer, before)
        if found is not None:
            break
    assert found is not None
    assert found.data == HEAD % b"a=b"
    assert (found.target, found.body) == (b"/login", 12)


@pytest.mark.parametrize(
    "line", [b"Transfer-Encoding: chunked", b"Content-Length: 1\r\nContent-Length: 1", b"TRANSFER-ENCODING:x"]
)
def test_body_of_unknown_length_is_known_to_be_one(line: bytes) -> None:
    found = find_head(b"POST / HTTP/1.1\r\n" + line + b"\r\n\r\n")
    assert found is not None
    assert found.body is None


@pytest.mark.parametrize(
    ("line", "values"),
    [
        (b"ur_web_8090=abc-_1", ["abc-_1"]),
        (b'other=1; ur_web_8090="abc"; x=y', ["abc"]),
        (b"ur_web_8090=old; ur_web_8090=new", ["old", "new"]),
        (b"xur_web_8090=abc; ur_web_80901=abc; ur_web_809=abc", []),
        (b"ur_web_8090=a b; ur_web_8090=", []),
        (b"ur_web_8090=\xc3\xa9", []),
    ],
)
def test_cookies_of_a_server_are_told_from_those_of_others(line: bytes, values: list[str]) -> None:
    found = find_head(HEAD % line)
    assert found is not None
    assert find_cookies(found, "ur_web_8090") == values


def test_malformed_request_lines_have_no_target() -> None:
    found = find_head(b"\r\n\r\n")
    assert found is not None
    assert found.target == b""


def test_cookies_that_almost_match_are_looked_at_a_few_times_only() -> None:
    near = b"; ".join([b"ur_web_8090=" + 129 * b"a"] * 220)
    found = find_head(HEAD % near)
    assert found is not None
    assert find_cookies(found, "ur_web_8090") == []
    found = find_head(HEAD % (b"ur_web_8090=abc; " + near))
    assert found is not None
    assert find_cookies(found, "ur_web_8090") == ["abc"]
