"""Many bags, each through the same replay, one after the other or on the workers of a cluster."""
