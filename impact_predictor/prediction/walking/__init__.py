"""Machines that walk: their feet, which move against the body, and the impacts that those make."""
