"""Planar poses, rigid transforms, transform history, occupancy grids and map files, without ROS."""
