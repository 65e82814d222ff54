"""Discovery of robots: those that announce themselves, were seen before, or were set up from this computer."""
