"""The ROS master of a run: its APIs, XML-RPC, TCPROS, and monitors of the master and of the link to it."""
