"""The branch coverage of src by probes in the code of its modules, each taken out once it was met often.

A trace function, as coverage.py needs one before Python 3.12, doubled the time of tests that compute.
"""

import ast
import json
import os
import sys
from collections.abc import Callable, Sequence
from importlib.machinery import ModuleSpec
from pathlib import Path
from types import CodeType, ModuleType

try:
    from slipcover import Slipcover, branch, importer
except ModuleNotFoundError:
    sys.exit(
        "error: UR_COVERAGE is set and slipcover is not installed, so coverage cannot be measured\n"
        "  help: unset UR_COVERAGE, or run: bash tools/set_up.bash test (on arm64 with Python 3.12 or later)"
    )

_STUBS = r"\.\.\.$"


def measure(source: Path, folder: Path) -> Callable[[], None]:
    """Measure what is imported below `source` from now on; return what writes the coverage of this process to `folder`.

    A fork has what its parent had met until then. What this process writes has the files that it has not imported, too.
    """
    probes = Slipcover(branch=True, source=[str(source)], exclude_also=[_STUBS], d_miss_threshold=1000)
    sys.meta_path.insert(0, _Finder(probes, importer.FileMatcher(sources=[source])))
    first = os.getpid()

    def save() -> None:
        if os.getpid() != first:
            probes.source = None
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{os.getpid()}.json").write_text(json.dumps(probes.get_coverage()), encoding="utf-8")

    return save


class _Finder(importer.SlipcoverMetaPathFinder):  # type: ignore[misc] # slipcover has no types
    """Finds modules for code that runpy runs, too."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        spec: ModuleSpec | None = super().find_spec(fullname, path, target)
        if spec is not None and isinstance(spec.loader, importer.SlipcoverLoader):
            spec.loader = _Loader(self.sci, spec.loader.orig_loader, spec.origin)
        return spec


class _Loader(importer.SlipcoverLoader):  # type: ignore[misc] # likewise
    def get_code(self, _name: str) -> CodeType:
        """Return the code of a module with probes."""
        tree = branch.preinstrument(ast.parse(self.origin.read_bytes()))
        code: CodeType = self.sci.instrument(compile(tree, str(self.origin), "exec"))
        return code
