"""Write the URDF of every base and variant, and the meshes of their bodies: make_urdf.py [PACKAGE].

PACKAGE is a launch package, or `share/PACKAGE` of a workspace that adds bases to one (see `ur.robot.base.search`). The
files are n_robot_state_publisher/{urdf/<base>[.<variant>].urdf,meshes/<base>[.<variant>].stl}; a variant whose body is
that of the plain base has no mesh of its own. Files of bases that are no more are taken away.
"""

import re
import sys
from pathlib import Path

from ur.robot.base import list_bases, list_variants, load_base
from ur.robot.base.body_mesh import make_body, write_stl
from ur.robot.base.urdf import write_urdf
from ur.source.diagnostic import UserError, error
from ur.source.render import render_human
from ur.source.user_folders import MARKER

NODE = "n_robot_state_publisher"


def make_urdfs(package: Path) -> dict[str, bytes]:
    """Path in the package to content, for every base and variant of a launch package."""
    here = find_url(package)
    found: dict[str, bytes] = {}
    for name in list_bases(package):
        body = write_stl(make_body(load_base(package, name)))
        for variant in ("", *list_variants(package, name)):
            base = load_base(package, name, variant)
            full = f"{name}.{variant}" if variant else name
            own = write_stl(make_body(base))
            mesh = f"{NODE}/meshes/{name if own == body else full}.stl"
            found[mesh] = own
            found[f"{NODE}/urdf/{full}.urdf"] = write_urdf(base, f"{here}/{mesh}").encode()
    return found


def find_url(package: Path) -> str:
    """Where RViz finds a package's files. Raises UserError: it is no package, nor what a workspace adds to one."""
    path = package / "package.xml"
    found = re.search(r"<name>\s*(\w+)\s*</name>", path.read_text(encoding="utf-8")) if path.is_file() else None
    if found:
        return f"package://{found[1]}"
    folder = package.resolve()
    if folder.parent.name == "share" and (folder.parents[1] / MARKER).is_file():
        return folder.as_uri()  # package:// means the package itself
    raise UserError(error(f"{path}: no name of a package, expected a launch package", rule="bad-package"))


def list_urdfs(package: Path) -> set[str]:
    """The paths of those that are there."""
    return {
        str(path.relative_to(package))
        for folder in ("urdf", "meshes")
        for path in (package / NODE / folder).glob("*")
        if path.suffix in (".urdf", ".stl")
    }


def main() -> int:
    """Write the files."""
    package = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "ubiquity_launches"
    try:
        made = make_urdfs(package)
    except UserError as problem:
        print(render_human(problem.diagnostics), end="", file=sys.stderr)
        return 1
    for path, content in made.items():
        (package / path).parent.mkdir(parents=True, exist_ok=True)
        (package / path).write_bytes(content)
    for path in list_urdfs(package) - set(made):
        (package / path).unlink()
    return 0


if __name__ == "__main__":
    sys.exit(main())
