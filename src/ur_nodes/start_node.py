"""Start a node that needs `requirements/vision.lock`, or report a missing library: start_node NODE [ARG ...]."""

import runpy
import sys
from collections.abc import Callable
from importlib.util import find_spec

from ur.source.project import project_folder

_NEEDS = {
    "calibrate_camera": ("camera.calibration", ("cv2",)),
    "fiducial_detect": ("vision", ("cv2",)),
    "fiducial_slam": ("vision", ("cv2", "gtsam")),
    "slam_gmapping": ("slam", ("gtsam",)),
}  # the package and the libraries of each node
_NAMES = {"cv2": "OpenCV (opencv-python-headless)", "gtsam": "gtsam"}


def main(arguments: list[str], find: Callable[[str], object] = find_spec) -> int:
    """Run the node as a program, which raises SystemExit. Returns 2 when it cannot run here: `find` lacks a library."""
    name = arguments[0] if arguments else ""
    if name not in _NEEDS:
        sys.stderr.write(f"error: start_node: {name!r}, expected one of {', '.join(_NEEDS)}\n")
        return 2
    package, libraries = _NEEDS[name]
    if missing := [_NAMES[library] for library in libraries if find(library) is None]:
        lock = project_folder() / "requirements/vision.lock"
        sys.stderr.write(
            f"error: {name}: {' and '.join(missing)} not installed, expected in {sys.prefix}\n"
            f"  help: {sys.executable} -I -m pip install --require-hashes -r {lock}\n"
        )
        return 2
    runpy.run_module(f"ur_nodes.{package}.{name}_node", run_name="__main__")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:2]))
