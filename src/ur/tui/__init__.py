"""What people see of a run on a terminal. A process of its own: it watches and steers the run over a socket."""
