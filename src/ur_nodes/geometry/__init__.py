"""Poses, rigid transforms, transform history, scans as points and occupancy grids, without ROS."""
