"""Parts of bench/stop_network for ROS 2: computers as network namespaces, and a wire that can hold packets back."""
