"""Recorded runs as tests, for pytest."""
