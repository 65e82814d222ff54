"""Types of messages of ROS 2: those that travel as bytes, and packages whose messages are loaded when they are used."""
