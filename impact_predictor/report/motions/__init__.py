"""A simulated motion in words, as curves and as a moving picture."""
