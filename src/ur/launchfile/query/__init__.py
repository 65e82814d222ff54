"""Answers to roslaunch's query options: `--nodes`, `--files`, `--find-node`, `--dump-params`, `--ros-args`."""

from ur.launchfile.query.arguments import ArgumentSpec, format_arguments, read_arguments
from ur.launchfile.query.explain import dump_params, find_node_file, list_files, list_nodes

__all__ = [
    "ArgumentSpec",
    "dump_params",
    "find_node_file",
    "format_arguments",
    "list_files",
    "list_nodes",
    "read_arguments",
]
