"""Simulated sensors: lidar, sonars, bumpers, inertial unit, odometry, battery, camera."""
