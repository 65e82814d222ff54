import pytest

from ur.web.wire.frames import Layer
from ur.web.wire.layers import LAYERS, read_layers
from ur.web.wire.reading import BadRequestError

ALWAYS = {Layer.NONE, Layer.MAP}


@pytest.mark.parametrize(
    ("text", "layers"),
    [
        (None, {Layer.SCAN, Layer.PLAN, Layer.FRONTIERS}),
        ("", set()),
        ("local", {Layer.LOCAL}),
        (",".join(LAYERS), set(Layer) - ALWAYS - {Layer.CAMERA, Layer.PLOTS}),  # which are asked for otherwise
    ],
)
def test_page_gets_what_it_names_besides_the_map(text: str | None, layers: set[Layer]) -> None:
    assert read_layers(text) == layers | ALWAYS


@pytest.mark.parametrize("text", ["scan,", "SCAN", "tile", " scan", "scan\n", "scan," * 1000, "\0"])
def test_other_texts_are_refused_in_a_line(text: str) -> None:
    with pytest.raises(BadRequestError, match=r"^layers: expected some of scan,plan,local,global,particles,"):
        read_layers(text)
