"""Records of runs: the registry, ended runs, and the identity of this computer."""
