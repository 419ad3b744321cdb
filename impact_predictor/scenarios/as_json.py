"""What simulated motions answer to programs: JSON of bodies that rock, of a wheel, and of cargo on a deck."""

from __future__ import annotations

from math import hypot, inf
from operator import itemgetter
from typing import TYPE_CHECKING, Any, Final

from ..mechanics.motion import End, RockingImpact, Trajectory
from ..mechanics.types import Mode
from ..stamps import NANOSECONDS
from .deck.voyage import Voyage
from .truth import TrueImpact, TrueLanding
from .wheel import Rolling
from .wheel_closed_forms import downhill, impact_friction, least_friction, steady

if TYPE_CHECKING:
    from .robot.walk import Walk

RESOLVED: Final = 0.05
"""Approach in m/s above which an impact is told from the last small ones of a unit that comes to rest."""


def _impact(time: float, mode: Mode, before: float, after: float) -> dict[str, Any]:
    return {"time": time, "mode": mode.name, "omega_before": abs(before), "omega_after": abs(after)}


def _planar(strike: RockingImpact) -> dict[str, Any]:
    return _impact(strike.time, strike.outcome.mode, strike.before.omega, strike.after.omega)


def _spatial(impact: TrueImpact) -> dict[str, Any]:
    return _impact(impact.stamp / NANOSECONDS, impact.mode, hypot(*impact.angular_before), hypot(*impact.angular_after))


def rocking_as_json(run: Trajectory) -> dict[str, Any]:
    """A motion as JSON: times in s, angular velocities as magnitudes in rad/s.

    `accumulation_time` is when impacts last accumulated so that both contacts stayed closed; null if they never did.
    """
    times = [one.time for one in run.accumulations if len(one.contacts) == 2]
    return {
        "impacts": [_planar(strike) for strike in run.impacts],
        "accumulation_time": times[-1] if times else None,
        "end": run.end.name,
    }


def rolling_as_json(rolling: Rolling) -> dict[str, Any]:
    """A rolling motion as JSON: times in s, angular velocities as magnitudes in rad/s.

    `steps` and `speed` count ahead. `steady` is the closed form of rolling down the slope without slip, with the least
    friction coefficient for it; null where the wheel stops, or no friction is enough.
    """
    known, down = None, downhill(rolling.wheel)
    rolls = steady(down)
    if rolls is not None and (needed := least_friction(down)) < inf:
        known = {
            "omega_before": rolls.before,
            "omega_after": rolls.after,
            "step_time": rolls.time,
            "speed": rolls.speed,
            "friction": needed,
        }
    return {
        "impacts": [{**_planar(strike), "old": old, "new": new} for old, new, strike in rolling.impacts],
        "steps": rolling.steps,
        "speed": rolling.distance / rolling.time if rolling.time > 0.0 else 0.0,
        "steady": known,
        "impact_friction": impact_friction(rolling.wheel.hub, rolling.wheel.alpha),
        "time": rolling.time,
        "end": rolling.end.name,
    }


def voyage_as_json(voyage: Voyage) -> dict[str, Any]:
    """A voyage as JSON: times in s, angular velocities as magnitudes in rad/s, angles in rad, displacements in m.

    `impacts` are those of all units in order of time; `accumulation_time` is when impacts last accumulated so that a
    contact stayed closed, null if they never did; `standing` is the part of the time of all units in which they had not
    toppled. `units` has the same for each unit.
    """
    units: dict[str, dict[str, Any]] = {
        one.unit.name: {
            "impacts": [_spatial(impact) for impact in one.impacts],
            "accumulation_time": one.sums[-1] if one.sums else None,
            "end": one.end.name,
            "time": one.time,
            "resolved_impacts": sum(impact.approach > RESOLVED for impact in one.impacts),
            "onsets": [{"time": it.stamp / NANOSECONDS, "slides": it.slides, "lifts": it.lifts} for it in one.onsets],
            "most_turned": one.most_turned,
            "moved": one.moved,
            "toppled": one.toppled,
        }
        for one in voyage.units
    }
    impacts = [{"unit": name, **impact} for name, unit in units.items() for impact in unit["impacts"]]
    ends = [one.end for one in voyage.units]
    # Of the only unit, of one that was lost, or TIME_UP.
    end = max(ends) if len(ends) == 1 or voyage.broke_off else End.TIME_UP
    return {
        "duration": voyage.duration,
        "impacts": sorted(impacts, key=itemgetter("time")),
        "accumulation_time": max((one.sums[-1] for one in voyage.units if one.sums), default=None),
        "end": end.name,
        "deck": {
            "most_rolled": voyage.most_rolled,
            "most_pitched": voyage.most_pitched,
            "most_lateral": voyage.most_lateral,
        },
        "standing": voyage.standing,
        "units": units,
    }


def walk_as_json(walk: Walk, landings: list[TrueLanding]) -> dict[str, Any]:
    """A robot's walk as JSON: its drives, and each landing with the impulses in N s along the normal after it."""
    machine = walk.machine
    return {
        "robot": machine.files.urdf.stem,
        "mass": machine.mass,
        "height": machine.height,
        "armature": machine.armature,
        "gains": machine.gains,
        "contact_time": machine.physics.contact_time,
        "duration": walk.duration,
        "fallen": walk.fallen,
        "landings": [
            {
                "foot": landing.foot,
                "time": landing.stamp / NANOSECONDS,
                "speed": landing.speed,
                "standing": landing.standing,
                "impulses": [{"after": state.time, "impulse": landing.impulse(state)} for state in landing.after],
            }
            for landing in landings
        ],
    }
