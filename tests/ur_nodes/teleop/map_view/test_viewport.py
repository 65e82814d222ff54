import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur_nodes.teleop.map_view.picture import Viewport, fit_viewport, pan_viewport, resize_viewport, zoom_viewport

VIEW = Viewport(3.0, -2.0, 0.1, 80, 44)


def test_middle_of_the_screen_is_the_viewports_point() -> None:
    assert VIEW.to_map(40, 22) == (3.0, -2.0)


def test_up_on_the_screen_is_up_on_the_map() -> None:
    assert VIEW.to_map(40, 12) == pytest.approx((3.0, -1.0))


@given(st.floats(-50, 50), st.floats(-50, 50))
def test_pixel_and_map_are_inverse(x: float, y: float) -> None:
    assert VIEW.to_map(*VIEW.to_pixel(x, y)) == pytest.approx((x, y), abs=1e-9)


@pytest.mark.parametrize(("width", "height"), [(80, 42), (200, 112), (30, 100)])
def test_fitted_box_is_inside_and_fills_one_direction(width: int, height: int) -> None:
    view = fit_viewport((-1.2, -14.75, 19.8, 1.25), width, height)
    left, bottom = view.to_pixel(-1.2, -14.75)
    right, top = view.to_pixel(19.8, 1.25)
    assert 0 <= left < right <= width
    assert 0 <= top < bottom <= height
    assert (right - left) / width > 0.95 or (bottom - top) / height > 0.95


@given(st.floats(0.5, 2.0), st.floats(0, 80), st.floats(0, 44))
def test_zoom_leaves_the_point_below_the_mouse(factor: float, column: float, row: float) -> None:
    zoomed = zoom_viewport(VIEW, factor, column, row)
    assert zoomed.to_map(column, row) == pytest.approx(VIEW.to_map(column, row), abs=1e-9)
    assert zoomed.scale == pytest.approx(0.1 / factor)


def test_zoom_has_limits() -> None:
    view = VIEW
    for _ in range(100):
        view = zoom_viewport(view, 2.0)
    assert view.scale == 0.005


def test_pan_and_resize_keep_the_scale() -> None:
    panned = pan_viewport(VIEW, 10, -5)
    assert (panned.x, panned.y, panned.scale) == pytest.approx((4.0, -1.5, 0.1))
    resized = resize_viewport(VIEW, 10, 10)
    assert resized.to_map(5, 5) == (3.0, -2.0)
