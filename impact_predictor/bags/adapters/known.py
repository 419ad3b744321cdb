"""Which types of messages have an adapter.

Only the name of a type is taken from a bag, and looked up among the adapters that are built in or installed: no bag
decides which code runs.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib.metadata import EntryPoint, entry_points
from typing import Any, Final, NamedTuple

from ...errors import InputError
from ...ros.messages import MalformedMessage
from ..read import Bag, UnusableMessage
from .adapted import Adapted, Adapter

GROUP: Final = "impact_predictor.adapters"
"""Entry points of this group are adapters, named by the types of their messages."""

BUILT_IN: Final = (EntryPoint("xpp_msgs/msg/RobotStateCartesian", "impact_predictor.bags.adapters.xpp:adapt", GROUP),)


class Read(NamedTuple):
    """Reads a message in CDR, through an adapter that is `named` in sentences."""

    named: str
    decode: Callable[[bytes], Any]
    adapt: Adapter

    def __call__(self, data: bytes) -> Adapted:
        """What a message tells.

        Raises:
            MalformedMessage: its bytes are none of its type, or as UnusableMessage: the adapter refuses it.
            InputError: the adapter fails.
        """
        try:
            message = self.decode(data)
        # The decoder of damaged bytes may raise anything from its depths.
        except Exception as error:
            raise MalformedMessage(_reason(error)) from None
        try:
            told = self.adapt(message)
        except ValueError as error:
            raise UnusableMessage(f"the adapter {self.named} refuses it: {_reason(error)}") from None
        # Anything else is no fault of this one message.
        except Exception as error:
            raise InputError(
                f"the adapter {self.named} fails with {type(error).__name__} ({_reason(error)}); "
                "compare it with the definition of the message in the bag"
            ) from error
        if not isinstance(told, Adapted):
            raise InputError(
                f"the adapter {self.named} returns {'None' if told is None else type(told).__name__}, not an Adapted; "
                "look at what it returns"
            )
        return told

    def check_stands(self, told: Adapted, feet: tuple[str, ...]) -> None:
        """Whether a message that tells which feet stand does so for each of them.

        Raises:
            InputError: it does not.
        """
        if len(told.stands) not in (0, len(feet)):
            raise InputError(
                f"the adapter {self.named} tells in `stands` of {len(told.stands)} feet, but feet.names has "
                f"{len(feet)}; give a flag for each of them in that order, or none"
            )


def known() -> dict[str, EntryPoint]:
    """The adapters by the types of their messages; an installed one goes before one that is built in."""
    return {one.name: one for one in (*BUILT_IN, *entry_points(group=GROUP))}


def readers(bag: Bag, adapted: Mapping[str, str]) -> dict[str, Read]:
    """What reads the messages of some topics of a bag, from the topics and their types, which have adapters.

    Raises:
        InputError: an adapter cannot be imported, or the bag holds no definition of a type; while reading: an adapter
            fails.
    """
    adapters = known()
    decode = bag.decoders(adapted)
    return {
        topic: Read(f"{adapters[type_name].value} of {type_name}", decode[topic], _load(adapters[type_name]))
        for topic, type_name in adapted.items()
    }


def _load(adapter: EntryPoint) -> Adapter:
    try:
        loaded: Adapter = adapter.load()
    # A module that is imported may raise anything.
    except Exception as error:
        raise InputError(
            f"the adapter {adapter.value} of {adapter.name} cannot be imported ({_reason(error)}); "
            "install its package again, or remove it"
        ) from error
    return loaded


def _reason(error: Exception) -> str:
    return " ".join(str(error).split()).rstrip(".") or type(error).__name__
