"""A stream of samples becomes predictions and scores."""
