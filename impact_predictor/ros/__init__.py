"""What meets ROS 2: messages as bytes, and the node that passes them on."""
