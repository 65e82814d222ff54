"""The shapes that a robot's description (URDF) shows, as plain values, and its meshes by the address that it names."""

import base64
import math
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from xml.etree.ElementTree import Element

import numpy as np

from ur.robot.description.mesh_file import read_mesh
from ur.source.foreign.xml_text import parse_xml
from ur_nodes.run import find_package

LONGEST = 1 << 21
"""Characters of a description."""

_MOST = 400  # shapes
_MOST_TRIANGLES = 30_000
_LARGEST_MESH = 20_000_000  # bytes
_ADDRESS = re.compile(r"package://([A-Za-z][\w-]{0,99})/([\w./ +-]{1,300})", re.ASCII)
_MESHES = (".stl", ".dae", ".obj")


class BadModelError(ValueError):
    """A text that is no robot description; the message is the reason, on one line."""


def read_model(text: str) -> list[dict[str, object]]:
    """Read the shapes: link, kind, size, pose in the link (m, rad), colour (0 to 1), and the address of a mesh.

    Malformed shapes are left out. Raises BadModelError.
    """
    try:
        root = parse_xml(text, length=LONGEST)
    except ValueError as problem:
        raise BadModelError(f"the robot's description: {problem}") from None
    colours = {each.get("name"): each.find("color") for each in root.iter("material") if each.find("color") is not None}
    return [shape for _, shape in zip(range(_MOST), _shapes(root, colours), strict=False)]


def _shapes(root: Element, colours: dict[str | None, Element | None]) -> Iterator[dict[str, object]]:
    for link in root.findall("link"):
        for visual in link.findall("visual"):
            geometry = visual.find("geometry")
            found = None if geometry is None else _read_shape(geometry)
            if found is None:
                continue
            origin, material = visual.find("origin"), visual.find("material")
            xyz = _numbers(origin, "xyz", 3, 0.0)
            rpy = _numbers(origin, "rpy", 3, 0.0)
            own = None if material is None else material.find("color")
            colour = own if own is not None else colours.get(None if material is None else material.get("name"))
            rgba = _numbers(colour, "rgba", 4, 0.7)
            if xyz is not None and rpy is not None:
                yield {
                    "link": (link.get("name") or "")[:100],
                    **found,
                    "xyz": xyz,
                    "rpy": rpy,
                    "rgba": rgba or [0.7] * 4,
                }


def _read_shape(geometry: Element) -> dict[str, object] | None:
    for kind, names in (("box", ("size",)), ("cylinder", ("radius", "length")), ("sphere", ("radius",))):
        found = geometry.find(kind)
        if found is not None:
            sizes = [_numbers(found, name, 3 if name == "size" else 1, None) for name in names]
            flat = [each for size in sizes if size for each in size]
            return {"kind": kind, "size": flat} if all(sizes) and all(each > 0 for each in flat) else None
    mesh = geometry.find("mesh")
    address = "" if mesh is None else mesh.get("filename", "")
    if not _ADDRESS.fullmatch(address):
        return None
    return {"kind": "mesh", "mesh": address, "size": _numbers(mesh, "scale", 3, 1.0) or [1.0] * 3}


def _numbers(element: Element | None, name: str, count: int, default: float | None) -> list[float] | None:
    text = None if element is None else element.get(name)
    if text is None:
        return None if default is None else [default] * count
    try:
        numbers = [float(each) for each in text.split()]
    except ValueError:
        return None
    return (
        numbers if len(numbers) == count and all(math.isfinite(each) and abs(each) < 1e4 for each in numbers) else None
    )


def find_mesh(address: str, package_folder: str) -> Path | None:
    """Return the file of a mesh within the folder of its package; None if it is no mesh or lies outside."""
    match = _ADDRESS.fullmatch(address)
    if match is None:
        return None
    root = Path(package_folder).resolve()
    path = (root / match[2]).resolve()
    return path if path.is_relative_to(root) and path.suffix.lower() in _MESHES else None


def package_of(address: str) -> str:
    """Return the package that the address of a mesh names; "" for none."""
    match = _ADDRESS.fullmatch(address)
    return match[1] if match else ""


def describe_model(description: object) -> Mapping[str, object]:
    """Answer a request for the robot's model with the shapes of the parameter /robot_description."""
    if not isinstance(description, str):
        return {"ok": False, "text": "no description of the robot: the parameter /robot_description is not set"}
    try:
        return {"value": read_model(description)}
    except BadModelError as problem:
        return {"ok": False, "text": str(problem)[:300]}


def describe_mesh(address: str, description: object) -> Mapping[str, object]:
    """Answer a request for a mesh that the description names, with its triangles or its extent."""
    try:
        shapes = read_model(description) if isinstance(description, str) else []
    except BadModelError:
        shapes = []
    if not any(each.get("mesh") == address for each in shapes):
        return {"ok": False, "text": f"{address}: the robot's description does not name it"}
    folder = find_package(package_of(address))
    if folder is None:
        return {"ok": False, "text": f"{address}: the package is not installed on this computer"}
    path = find_mesh(address, str(folder))
    if path is None or not path.is_file() or path.stat().st_size > _LARGEST_MESH:
        return {"ok": False, "text": f"{address}: no mesh of at most {_LARGEST_MESH} bytes within its package"}
    points = read_mesh(path)
    if not len(points):
        return {"ok": False, "text": f"{address}: no points in it"}
    extent = [points.min(axis=0).tolist(), points.max(axis=0).tolist()]
    if path.suffix.lower() != ".stl" or len(points) > 3 * _MOST_TRIANGLES:
        return {"value": {"extent": extent}}
    data = base64.b64encode(points.astype(np.float32).tobytes()).decode()
    return {"value": {"extent": extent, "triangles": data}}
