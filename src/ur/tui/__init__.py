"""The terminal interface of a run: a separate process that controls the run over a socket."""
