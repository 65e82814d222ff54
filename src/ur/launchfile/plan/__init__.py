"""The resolver: from a syntax tree, a world and arguments to a Plan."""
