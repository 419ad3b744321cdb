"""The parameters of the node and of the offline commands, their rules, and the files that set them."""
