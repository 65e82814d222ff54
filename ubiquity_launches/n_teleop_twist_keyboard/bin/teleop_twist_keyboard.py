#!/bin/bash
##Summary: Drive the robot with the keys.
##Overview: Publishes `cmd_vel` while a key is held. Stands in for the program of the same name in
## `teleop_twist_keyboard`, whose name it has, ending included.
##Subscribes: `cmd_vel_mux/active`, `cmd_vel_mux/challenge`, `cmd_vel_mux/lease`, `cmd_vel_mux/obstacle_stop`,
## `cmd_vel_mux/stopped`
##Publishes: `cmd_vel_stamped` (remapped to `key_vel_stamped`), `cmd_vel_mux/lease_request`, `cmd_vel` (where there is
## no such mux)
##Calls: `cmd_vel_mux/stop`, `cmd_vel_mux/release`, `cmd_vel_mux/set_obstacle_stop`
exec "$(dirname "$(readlink -f "$0")")/../../lib/node" ur_nodes.teleop.keyboard.teleop_twist_keyboard_node "$@"
