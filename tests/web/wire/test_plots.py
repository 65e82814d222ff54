import pytest

from ur.web.wire.reading import BadRequestError
from ur.web.wire.requests import MOST_PLOTS, read_plots, split_plot


def test_page_names_its_plots() -> None:
    assert read_plots(None) is None
    assert read_plots("") == frozenset()
    assert read_plots("/odom:twist.twist.linear.x,/a/b:data") == frozenset({"/odom:twist.twist.linear.x", "/a/b:data"})
    assert split_plot("/a/b:x.y") == ("/a/b", "x.y")


@pytest.mark.parametrize(
    "text", ["odom:x", "/odom", "/odom:", "/odom:x.", "/odom:x[0]", "/o d:x", "/odom:x,", "/é:x", "/a:b\n", "\0"]
)
def test_what_names_no_field_is_refused_in_a_line(text: str) -> None:
    with pytest.raises(BadRequestError, match=r"^plots: expected at most 8"):
        read_plots(text)


def test_too_many_plots_are_refused() -> None:
    with pytest.raises(BadRequestError):
        read_plots(",".join(f"/a{number}:x" for number in range(MOST_PLOTS + 1)))
