"""Programs of nodes, their parameters and YAML files: documentation, values and places."""
