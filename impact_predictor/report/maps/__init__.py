"""Maps of the modes: which one follows an impact, over any two parameters of a body."""
