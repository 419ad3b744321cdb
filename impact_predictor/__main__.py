"""`python3 -m impact_predictor` is the command `impact-predictor`."""

from .cli import main

if __name__ == "__main__":
    main()
