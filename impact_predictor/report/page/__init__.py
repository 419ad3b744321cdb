"""The page of error against run time: one file that opens without a network."""
