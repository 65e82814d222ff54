"""Documents of packages in memory, and what is in them."""

from collections.abc import Iterator, Mapping
from pathlib import Path

from ur.docs.build import build_documents
from ur.docs.documents import Documents, LaunchDoc, TreeItem
from ur.launchfile.world import MemoryWorld, SystemWorld

ROOT = Path(__file__).parents[2]
LIBRARY = ROOT / "ubiquity_launches"
ROVER = Path(__file__).parent / "data" / "rover_launches"
PACKAGE = "<package><name>my_robot</name><description>Of <b>mine</b>.</description></package>"


def document(files: Mapping[str, str | bytes], path: str = "/ws/my_robot") -> Documents:
    """The documents of files whose paths are relative to the package my_robot."""
    whole = {f"/ws/my_robot/{name}": text for name, text in files.items()}
    if "package.xml" not in files:
        whole["/ws/my_robot/package.xml"] = PACKAGE
    return build_documents(path, MemoryWorld(whole))


def document_one(text: str, files: Mapping[str, str | bytes] | None = None) -> LaunchDoc:
    """The document of one launch file, beside others."""
    documents = document({"launch/one.launch": text, **(files or {})})
    return find(documents, "launch/one.launch")


def document_folder(folder: Path) -> Documents:
    """The documents of a folder of this computer, whatever is installed."""
    return build_documents(str(folder), SystemWorld({}))


def find(documents: Documents, path: str) -> LaunchDoc:
    """The document of a launch file."""
    return next(doc for package in documents.packages for doc in package.launch_files if doc.path == path)


def walk(item: TreeItem) -> Iterator[TreeItem]:
    """An item and everything below it."""
    yield item
    for child in item.children:
        yield from walk(child)
