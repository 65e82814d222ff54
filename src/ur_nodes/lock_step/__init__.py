"""Nodes in one process against a recording, in lock step: the same file gives the same run to the last bit."""
