"""What every node shell shares: starting, parameters with good errors, messages to and from arrays."""
