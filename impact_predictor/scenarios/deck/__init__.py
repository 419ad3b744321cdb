"""Cargo on a deck in a sea: waves, the vessel, the units on it, and what their sensors tell."""
