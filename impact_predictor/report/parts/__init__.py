"""What the parts of a scene cost, for each sample and at the start."""
