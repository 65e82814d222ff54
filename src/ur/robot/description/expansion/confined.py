"""The process in which xacro runs. It imports nothing of `ur`, and is started with `python -I`.

xacro evaluates Python expressions of the description, and its filter does not stop malicious ones. So this process
gives up its rights before it reads the description: the kernel then refuses every system call except those for memory,
the clock and the pipes to the parent process (seccomp). The parent process opens files and finds packages for it.

The protocol is lines of JSON. The first line from the parent process is the request: `library`, `seccomp`, `file`,
`folder`, `arguments`, `memory`, `seconds`. Each `{"ask": KIND, "of": TEXT}` from this process is answered by a line
with `value`, or with `error`. The last line from this process has `end`.
"""

import ctypes
import errno
import glob
import importlib
import io
import json
import os
import resource
import sys
import types
from collections.abc import Iterator
from typing import Any, NoReturn

# What CPython needs to compute: memory that holds no code (see _PROTECTED), locks, clocks, and open descriptors.
_ALLOWED = (
    *("read", "write", "close", "fstat", "brk", "munmap", "mremap", "madvise", "futex", "sched_yield", "getrandom"),
    *("clock_gettime", "clock_gettime64", "gettimeofday", "rt_sigreturn", "rt_sigprocmask", "rt_sigaction"),
    *("sigaltstack", "restart_syscall", "exit", "exit_group", "getpid"),
)
_LATER = (
    "encodings.ascii",
    "encodings.latin_1",
    "encodings.utf_16",
    "xml.dom.expatbuilder",
    "yaml",
)  # imported lazily by other modules
_PROTECTED = ("mmap", "mmap2", "mprotect")  # the third argument holds PROT_EXEC
_PROT_EXEC = 4
_SCMP_ACT_ALLOW = 0x7FFF0000
_SCMP_ACT_ERRNO = 0x00050000
_SCMP_CMP_MASKED_EQ = 7


class _Comparison(ctypes.Structure):
    """The structure scmp_arg_cmp of libseccomp."""

    _fields_ = (
        ("argument", ctypes.c_uint),
        ("operation", ctypes.c_int),
        ("mask", ctypes.c_uint64),
        ("value", ctypes.c_uint64),
    )


def drop_privileges(library: str) -> None:
    """Restrict this process to computing and to open file descriptors. Raises OSError if that fails."""
    seccomp = ctypes.CDLL(library, use_errno=True)
    seccomp.seccomp_init.restype = ctypes.c_void_p
    seccomp.seccomp_rule_add_array.argtypes = (
        *(ctypes.c_void_p, ctypes.c_uint32, ctypes.c_int, ctypes.c_uint),
        ctypes.POINTER(_Comparison),
    )
    seccomp.seccomp_load.argtypes = (ctypes.c_void_p,)
    context = seccomp.seccomp_init(_SCMP_ACT_ERRNO | errno.EPERM)
    if not context:
        raise OSError(errno.ENOMEM, "no filter can be made")
    not_code = _Comparison(2, _SCMP_CMP_MASKED_EQ, _PROT_EXEC, 0)
    for name in (*_ALLOWED, *_PROTECTED):
        number = seccomp.seccomp_syscall_resolve_name(name.encode())
        if number < 0:  # this processor has no such system call
            continue
        rule = (1, ctypes.byref(not_code)) if name in _PROTECTED else (0, None)
        _check(seccomp.seccomp_rule_add_array(context, _SCMP_ACT_ALLOW, number, *rule))
    _check(seccomp.seccomp_load(context))


def _check(result: int) -> None:
    if result < 0:
        raise OSError(-result, os.strerror(-result))


def _limit(memory: int, seconds: int) -> None:
    for kind, most in (
        (resource.RLIMIT_AS, memory),
        (resource.RLIMIT_CPU, seconds),
        (resource.RLIMIT_FSIZE, 0),
        (resource.RLIMIT_CORE, 0),
    ):
        hard = resource.getrlimit(kind)[1]
        least = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(kind, (least, least))


def _ask(kind: str, of: str) -> Any:
    _write({"ask": kind, "of": of})
    answer = json.loads(sys.stdin.buffer.readline())
    if "error" in answer:
        raise FileNotFoundError(errno.ENOENT, answer["error"], of)
    return answer["value"]


def _write(fields: dict[str, Any]) -> None:
    sys.__stdout__.buffer.write(json.dumps(fields).encode() + b"\n")  # type: ignore[union-attr]
    sys.__stdout__.buffer.flush()  # type: ignore[union-attr]


def _open(path: Any, *_: Any, **__: Any) -> io.StringIO:
    return io.StringIO(_ask("file", os.fspath(path)))


class _Environment:
    """The environment variables of the parent process, each requested by its name."""

    def __getitem__(self, name: str) -> str:
        value = _ask("variable", name)
        if value is None:
            raise KeyError(name)
        return str(value)

    def __contains__(self, name: object) -> bool:
        return _ask("variable", str(name)) is not None


def _prepare(library: str, folder: str) -> tuple[Any, list[str]]:
    """Import xacro and route its requests for files and packages; the list collects packages that are not found."""
    missing: list[str] = []

    def find(name: str) -> str:
        found = _ask("package", name)
        if found is None:
            missing.append(name)
            raise LookupError(f"package {name!r} not found")
        return str(found)

    # PyPI's xacro is that of ROS 2, which asks ament for packages.
    packages = types.ModuleType("ament_index_python.packages")
    packages.get_package_share_directory = find  # type: ignore[attr-defined]
    sys.modules["ament_index_python"] = types.ModuleType("ament_index_python")
    sys.modules[packages.__name__] = packages
    if library:
        sys.path.insert(0, library)
    for name in _LATER:
        importlib.import_module(name)
    import xacro
    import xacro.substitution_args

    included = xacro.get_include_files

    # Many accessories are included and never used: a file of a missing package is left out.
    def include(*words: Any) -> Iterator[Any]:
        before = len(missing)
        try:
            yield from included(*words)
        except Exception:
            if len(missing) == before:
                raise

    xacro.get_include_files = include
    xacro.open = _open
    glob.glob = lambda pattern, **_: _ask("files", pattern)
    os.getcwd = lambda: folder
    xacro.substitution_args.os = types.SimpleNamespace(environ=_Environment(), path=os.path)
    return xacro, missing


def _expand(xacro: Any, words: list[str]) -> dict[str, Any]:
    out, errors = io.StringIO(), io.StringIO()
    sys.argv, sys.stdout, sys.stderr = ["xacro", *words], out, errors
    problem = ""
    try:
        xacro.main()
    except SystemExit as end:
        problem = "" if end.code in (None, 0) else str(end.code)
    except MemoryError:
        problem = "it takes too much memory"
    except BaseException as raised:
        problem = f"{type(raised).__name__}: {raised}"[:1000]
    return {"end": "done", "text": out.getvalue(), "errors": errors.getvalue()[:10_000], "problem": problem}


def main() -> NoReturn:
    """Expand one file as requested on standard input."""
    order = json.loads(sys.stdin.buffer.readline())
    try:
        xacro, missing = _prepare(order["library"], order["folder"])
    except ImportError as problem:
        _write({"end": "no xacro", "problem": str(problem)})
        sys.exit(0)
    _limit(order["memory"], order["seconds"])
    if order["seccomp"]:
        try:
            drop_privileges(order["seccomp"])
        except (OSError, AttributeError) as problem:
            _write({"end": "not confined", "problem": str(problem)})
            sys.exit(0)
    report = _expand(xacro, [order["file"], *order["arguments"]])
    _write({**report, "missing": missing})
    os._exit(0)


if __name__ == "__main__":
    main()
