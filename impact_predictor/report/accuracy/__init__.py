"""Error against run time: every method of a prediction on the same problems, beside a reference of 40 digits."""
