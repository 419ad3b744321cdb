"""Recorded bags: read, written and replayed without ROS."""
