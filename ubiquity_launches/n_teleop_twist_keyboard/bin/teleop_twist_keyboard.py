#!/bin/bash
##Summary: Drive the robot with the keys.
##Overview: Publishes `cmd_vel` while a key is held. Stands in for the program of the same name in
## `teleop_twist_keyboard`, whose name it has, ending included.
exec "$(dirname "$(readlink -f "$0")")/../../lib/node" ur_nodes.teleop.keyboard.teleop_twist_keyboard_node "$@"
