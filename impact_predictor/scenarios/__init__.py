"""Made scenes whose truth is known."""
