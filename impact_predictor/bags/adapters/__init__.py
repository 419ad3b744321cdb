"""Messages of robots' own types as what the predictor takes; docs/adapters.md tells how to add a robot."""

from .adapted import Adapted as Adapted
from .adapted import Adapter as Adapter
from .adapted import of_world as of_world
