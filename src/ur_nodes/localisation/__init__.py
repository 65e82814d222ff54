"""Monte Carlo localisation on a known map from scans and odometry: the stand-in for `amcl`."""
