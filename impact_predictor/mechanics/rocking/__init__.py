"""Long motion of a body on two contacts over a fixed or moving support: from event to event, impacts by either law.

Between events the body flies, turns about a contact that sticks or slips, or rests or slides on both. Where it leaves
which state follows from Coulomb's law in accelerations (`contacts`); where a contact strikes, from the impact
laws. Impacts that accumulate are passed to the contacts closed for good (`tail`).
"""

from .motion import rock, standing
from .run import Accumulation, End, Phase, Run, Strike
from .strike import next_strike

__all__ = ["Accumulation", "End", "Phase", "Run", "Strike", "next_strike", "rock", "standing"]
