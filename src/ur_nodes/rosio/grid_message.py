"""Grids and messages, for nodes that are still written against rospy."""

from __future__ import annotations

from ur_nodes.codecs.genpy.grid import GridMessage as GridMessage
from ur_nodes.codecs.genpy.grid import GridResponse as GridResponse
from ur_nodes.codecs.genpy.grid import GridService as GridService
from ur_nodes.codecs.maps import grid_message as grid_message
from ur_nodes.codecs.maps import grid_of_message as grid_of_message
from ur_nodes.codecs.maps import metadata_message as metadata_message
