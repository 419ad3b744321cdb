"""Friction, restitution and inertia from recorded touchdowns."""
