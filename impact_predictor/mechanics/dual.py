"""Numbers that carry their derivatives through the law code.

A Dual is a value with its derivatives by some inputs. The law code (see `impact.contacts`) takes it for any
other number and compares its value; so one impact of Duals gives the exact derivatives of its outcome, on the branch
that it takes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from importlib.util import find_spec, module_from_spec
from types import ModuleType
from typing import Any, Union

Scalar = Union[float, "Dual"]


class Dual:
    """A value and its derivatives (`parts`) by the inputs."""

    __slots__ = ("parts", "value")
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, value: float, parts: tuple[float, ...]) -> None:
        self.value = value
        self.parts = parts

    def __add__(self, other: Scalar) -> Dual:
        if isinstance(other, Dual):
            return Dual(self.value + other.value, tuple([p + q for p, q in zip(self.parts, other.parts, strict=True)]))
        return Dual(self.value + other, self.parts)

    __radd__ = __add__

    def __neg__(self) -> Dual:
        return Dual(-self.value, tuple([-p for p in self.parts]))

    def __sub__(self, other: Scalar) -> Dual:
        if isinstance(other, Dual):
            return Dual(self.value - other.value, tuple([p - q for p, q in zip(self.parts, other.parts, strict=True)]))
        return Dual(self.value - other, self.parts)

    def __rsub__(self, other: float) -> Dual:
        return Dual(other - self.value, tuple([-p for p in self.parts]))

    def __mul__(self, other: Scalar) -> Dual:
        u = self.value
        if isinstance(other, Dual):
            v = other.value
            return Dual(u * v, tuple([p * v + u * q for p, q in zip(self.parts, other.parts, strict=True)]))
        return Dual(u * other, tuple([p * other for p in self.parts]))

    __rmul__ = __mul__

    def __truediv__(self, other: Scalar) -> Dual:
        if isinstance(other, Dual):
            v = other.value
            ratio = self.value / v
            return Dual(ratio, tuple([(p - ratio * q) / v for p, q in zip(self.parts, other.parts, strict=True)]))
        return Dual(self.value / other, tuple([p / other for p in self.parts]))

    def __rtruediv__(self, other: float) -> Dual:
        v = self.value
        ratio = other / v
        return Dual(ratio, tuple([-ratio * q / v for q in self.parts]))

    def __abs__(self) -> Dual:
        return -self if self.value < 0.0 else self

    def __eq__(self, other: object) -> bool:
        return self.value == (other.value if isinstance(other, Dual) else other)

    def __lt__(self, other: Scalar) -> bool:
        return self.value < value_of(other)

    def __le__(self, other: Scalar) -> bool:
        return self.value <= value_of(other)

    def __gt__(self, other: Scalar) -> bool:
        return self.value > value_of(other)

    def __ge__(self, other: Scalar) -> bool:
        return self.value >= value_of(other)


def value_of(number: Scalar) -> float:
    return number.value if isinstance(number, Dual) else number


def sqrt(number: Scalar) -> Scalar:
    """The square root; that of zero, which has no derivative, counts as constant."""
    if not isinstance(number, Dual):
        return math.sqrt(number)
    root = math.sqrt(number.value)
    slope = 0.5 / root if root > 0.0 else 0.0
    return Dual(root, tuple([slope * part for part in number.parts]))


@cache
def dual_answer() -> Callable[..., Any]:
    """`answer.answer` for Duals: the law code loaded a second time, with a square root that knows them."""
    restitution, path_law, answer = load("restitution"), load("path_law"), load("answer")
    restitution.sqrt = sqrt  # type: ignore[attr-defined]
    path_law.span_of_work = restitution.span_of_work  # type: ignore[attr-defined]
    answer.path_law = path_law  # type: ignore[attr-defined]
    return answer.answer  # type: ignore[no-any-return]


def load(name: str) -> ModuleType:
    """Another instance of a module of the impact engine."""
    spec = find_spec(f"{__package__}.impact.{name}")
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
