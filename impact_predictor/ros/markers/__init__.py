"""What the predictor knows, as markers for RViz and Foxglove."""
