"""Where am I, and how do I get there: stand-ins for map_server, amcl and move_base."""
