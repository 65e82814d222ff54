"""A base of somebody else, in a workspace of its own: only files that are named after it, for each program."""

from pathlib import Path

from ur.request.programs import PACKAGE
from ur.robot.base import Base, load_base
from ur.robot.base.body_mesh import make_body, write_stl
from ur.robot.base.urdf import write_urdf

NAME = "foobot"
_MODEL = "stage"  # whose parameters it starts from
_OWN = "n_robot_state_publisher"  # made from base.yaml
_SONARS = """  sonars:
    topic: sonars
    rate: 4
    field_of_view: 0.5
    range_min: 0.02
    range_max: 3.0
    noise: 0.01
    at:
      sonar_left: [0.15, 0.1, 0.1, 0.0, 0.0, 0.5]
      sonar_right: [0.15, -0.1, 0.1, 0.0, 0.0, -0.5]
"""


def drop_base(workspace: Path) -> Base:
    """Make the workspace: what is in CMAKE_PREFIX_PATH once its setup.bash is sourced. Returns the base."""
    added = workspace / "share" / PACKAGE.name
    for path in sorted(PACKAGE.rglob("*")):
        place = path.relative_to(PACKAGE)
        if path.is_file() and path.name == f"{_MODEL}.yaml" and place.parts[0] != _OWN:
            _write(added / place.with_name(f"{NAME}.yaml"), path.read_text(encoding="utf-8"))
    text = (PACKAGE / "bases" / _MODEL / "base.yaml").read_text(encoding="utf-8")
    before, found, after = text.partition("sensors:\n")
    assert found
    _write(added / "bases" / NAME / "base.yaml", before + found + _SONARS + after)
    (workspace / ".catkin").touch()
    base = load_base(added, NAME)
    mesh = f"{_OWN}/meshes/{NAME}.stl"
    (added / mesh).parent.mkdir(parents=True)
    (added / mesh).write_bytes(write_stl(make_body(base)))
    _write(added / _OWN / "urdf" / f"{NAME}.urdf", write_urdf(base, f"file://{added / mesh}"))
    return base


def _write(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
