"""Missions that live on the robot: their state and requests as values, and the client of the node that drives them."""
