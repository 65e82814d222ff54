"""Parameters of programs, as launch files, YAML files and Python sources document them."""
