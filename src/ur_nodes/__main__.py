"""Run a node's module, or a file with one: python -I -m ur_nodes MODULE|FILE.py [ARG ...].

Nodes start isolated (`-I`), so that nothing in the current folder or in PYTHONPATH replaces their modules. Messages of
a workspace are found all the same: the folders of PYTHONPATH are searched last.

NumPy computes on one thread: the matrices of nodes are small, and more threads would wait for one another in a busy
loop. OPENBLAS_NUM_THREADS sets another number.

An interrupt while the module is still importing ends it without a message; rospy sets its own handler once it starts.
"""

import os
import signal
import sys
from types import FrameType


def _leave(_number: int, _frame: FrameType | None) -> None:
    os._exit(128 + signal.SIGINT)


def list_message_folders(python_path: str) -> list[str]:
    """List the absolute folders of PYTHONPATH. Relative and empty entries depend on the current folder: left out."""
    return [folder for folder in python_path.split(os.pathsep) if folder.startswith("/")]


if __name__ == "__main__":
    signal.signal(signal.SIGINT, _leave)
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before NumPy is imported
    import runpy
    from importlib.util import find_spec

    from ur_nodes.message_packages import defer_catkin, load_when_used
    from ur_nodes.run import backend_name

    if backend_name() == "ros2" or sys.argv[1] != "ur_nodes.fork_server":  # nodes share all messages of ROS 1
        load_when_used()
    if backend_name() == "ros1":
        from ur_nodes.ros1.repairs.logs import skip_log_link

        defer_catkin()
        skip_log_link()
    if sys.flags.isolated:
        sys.path += list_message_folders(os.environ.get("PYTHONPATH", ""))
    if backend_name() == "ros2" and find_spec("rclpy") is None:
        sys.stderr.write(f"error: {sys.argv[1]}: rclpy is not found\n  help: source the setup file of ROS 2 first\n")
        sys.exit(2)
    del sys.argv[0]
    if sys.argv[0].endswith(".py"):
        sys.path.append(os.path.dirname(os.path.abspath(sys.argv[0])))  # noqa: PTH100, PTH120 - as Python itself does
        runpy.run_path(sys.argv[0], run_name="__main__")
    else:
        runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
