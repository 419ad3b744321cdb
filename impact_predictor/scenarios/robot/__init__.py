"""Robots of URDFs that walk in MuJoCo, as bags with the truth of every landing."""
