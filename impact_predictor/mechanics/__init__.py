"""Impact mechanics of a rigid planar body: numbers in, numbers out."""
