"""The terminal interface of a run: a process of its own that controls the run over a socket."""
