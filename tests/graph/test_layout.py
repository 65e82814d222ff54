"""Where boxes stand."""

from hypothesis import given
from hypothesis import strategies as st

from ur.graph.boxes import Arrow, DrawnGraph, GraphBox
from ur.graph.svg import HEIGHT, lay_out_graph

GRAPHS = st.integers(1, 12).flatmap(
    lambda count: st.lists(st.tuples(st.integers(0, count - 1), st.integers(0, count - 1)), max_size=30).map(
        lambda pairs: make(count, *pairs)
    )
)


def make(count: int, *pairs: tuple[int, int]) -> DrawnGraph:
    boxes = tuple(GraphBox(f"b{n}", "x" * (n + 1), "node") for n in range(count))
    return DrawnGraph(boxes, tuple(Arrow(f"b{a}", f"b{b}") for a, b in dict.fromkeys(pairs)))


def test_chain_goes_from_left_to_right() -> None:
    places = lay_out_graph(make(3, (0, 1), (1, 2), (0, 2))).positions
    assert places["b0"].x < places["b1"].x < places["b2"].x


def test_arrow_that_passes_a_layer_goes_round_its_boxes() -> None:
    picture = lay_out_graph(make(3, (0, 1), (1, 2), (0, 2)))
    between = picture.positions["b1"]
    assert [not between.y <= y <= between.y + HEIGHT for _, y in picture.routes["b0", "b2"]] == [True, True]


def test_crossings_are_avoided() -> None:
    places = lay_out_graph(make(4, (0, 3), (1, 2))).positions
    assert (places["b0"].y < places["b1"].y) == (places["b3"].y < places["b2"].y)


@given(GRAPHS)
def test_no_two_boxes_overlap_and_all_lie_inside(graph: DrawnGraph) -> None:
    picture = lay_out_graph(graph)
    assert set(picture.positions) == {box.id for box in graph.boxes}
    placed = list(picture.positions.values())
    for number, one in enumerate(placed):
        assert 0.0 <= one.x <= one.x + one.width <= picture.width + 1e-6
        assert 0.0 <= one.y <= one.y + HEIGHT <= picture.height + 1e-6
        for other in placed[number + 1 :]:
            apart_x = one.x + one.width <= other.x or other.x + other.width <= one.x
            assert apart_x or one.y + HEIGHT <= other.y or other.y + HEIGHT <= one.y


def test_graph_without_boxes_is_empty() -> None:
    assert lay_out_graph(make(0)).positions == {}
