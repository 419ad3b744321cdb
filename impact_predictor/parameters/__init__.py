"""What the node and the offline commands may be told: the parameters, their rules, and the files they come in."""
