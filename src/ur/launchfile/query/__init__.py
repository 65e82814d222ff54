"""Answers to roslaunch's query options: `--nodes`, `--files`, `--find-node`, `--dump-params`, `--ros-args`."""
