"""Modules of this package that the core and the larger parts of a scene load, by their names in it."""

from __future__ import annotations

from typing import Final

CORE: Final = frozenset(
    {
        *("mechanics", "mechanics.answer", "mechanics.first_root", "mechanics.impact"),
        *("mechanics.motion", "mechanics.one_answer", "mechanics.pair", "mechanics.path_law", "mechanics.path_states"),
        *("mechanics.problem", "mechanics.radau", "mechanics.sliding_events", "mechanics.sliding_stance"),
        *("mechanics.sliding_sweep", "mechanics.stretch", "mechanics.total_law"),
        *("mechanics.turning_stance", "mechanics.types"),
        *("prediction", "prediction.approach", "prediction.checks", "prediction.monitor", "prediction.planar"),
        *("prediction.predictor", "prediction.scene", "prediction.score", "prediction.types", "prediction.vectors"),
        "stamps",
    }
)
"""The modules that the predictor loads in every scene."""

CORE_OF_NODE: Final = frozenset(
    {
        *("prediction.inputs", "prediction.monitor", "prediction.remedies"),
        *("ros", "ros.backlog", "ros.body_topics", "ros.cdr", "ros.diagnostics", "ros.endpoints", "ros.input_topic"),
        *(
            "ros.markers.topic",
            "ros.messages",
            "ros.messages.inputs",
            "ros.messages.outputs",
            "ros.node",
            "ros.node_parameters",
        ),
        *("ros.predictor_node", "ros.process", "ros.qos", "ros.reporter"),
    }
)
"""Those that the node loads besides."""

ROCKING: Final = (
    *("mechanics.bodies", "mechanics.rocking", "mechanics.rocking.arcs", "mechanics.rocking.bodies"),
    *("mechanics.rocking.contacts", "mechanics.rocking.course", "mechanics.rocking.disc", "mechanics.rocking.flight"),
    *("mechanics.rocking.follow", "mechanics.rocking.loop", "mechanics.rocking.motion", "mechanics.rocking.points"),
    *("mechanics.rocking.run", "mechanics.rocking.shape", "mechanics.rocking.step", "mechanics.rocking.strike"),
    *("mechanics.rocking.tail", "mechanics.rocking.turn", "mechanics.rocking.wait", "mechanics.support"),
)
"""What follows a body until it strikes where no closed form does."""

WALKING: Final = (
    *("mechanics.contact_space", "mechanics.mobility", "mechanics.mobility_total"),
    *("prediction.walking.ahead", "prediction.walking.arrival", "prediction.walking.base"),
    *("prediction.walking.course", "prediction.walking.cubic", "prediction.walking.forces"),
    *("prediction.walking.habit", "prediction.walking.impact", "prediction.walking.mechanism"),
    *("prediction.walking.plan", "prediction.walking.point", "prediction.walking.stance", "prediction.walking.sums"),
    *("prediction.walking.walker",),
    *("ros.feet_report", "ros.feet_topics", "ros.latched_topic", "ros.messages.feet", "ros.messages.walking"),
)
"""What follows feet over the ground."""
