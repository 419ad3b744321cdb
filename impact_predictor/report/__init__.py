"""What a reader sees of the results: JSON, tables and pictures."""
