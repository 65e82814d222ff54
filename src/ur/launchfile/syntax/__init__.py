"""Launch text to a tree with positions; pure; never raises on user input."""
