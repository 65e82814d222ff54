"""Message types of ROS 2: types as bytes, and packages whose messages are loaded on first use."""
