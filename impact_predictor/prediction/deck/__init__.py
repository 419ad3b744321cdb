"""Bodies over a moving support: its motion now and ahead, and what a body does in its frame."""
