"""People who walk in a simulated world."""
