"""Goals and their clients: goals are accepted, pursued, held or cancelled depending on the lease."""
