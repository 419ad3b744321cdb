"""In front of the path it stands for numba where that is not installed."""

raise ImportError("numba is not for this process")
