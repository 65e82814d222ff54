"""Facts that rules ask about packages, programs, comments and YAML files."""
