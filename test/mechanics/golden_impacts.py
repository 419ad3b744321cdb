"""The impacts of golden/impacts.json, decided in exact rational arithmetic (see golden/README.md)."""

import json
from pathlib import Path

from impact_predictor import Contact, TwoPointBody

CASES = json.loads((Path(__file__).parent / "golden" / "impacts.json").read_text())["cases"]
KINDS = sorted({case["kind"] for case in CASES})


def body_of(case, restitution=0.0):
    """The body of a case; the restitution is that of the new contact."""
    old, new = (
        Contact(each["x"], each["y"], each["friction"], tuple(each["normal"]), 0.0, tuple(each["velocity"]))
        for each in case["contacts"]
    )
    return TwoPointBody(case["mass"], case["inertia"], old, new._replace(restitution=restitution))
