"""Law code compiled by numba where it is installed: the same functions, and the same answers to the last bit."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from hashlib import sha256
from inspect import getmembers, getsource, isfunction
from types import ModuleType
from typing import TypeVar, cast

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(
    make: Callable[[str], Function], modules: Iterable[ModuleType], inlined: Callable[[object], bool]
) -> Function | None:
    """The function that `make` makes, compiled; None where numba is not installed.

    It may call the functions of `modules`; those that are `inlined` become a part of their callers. What was compiled
    is kept where a folder can be written, under the name that `make` is given and binds in its function: the digest of
    the modules' text.
    """
    try:
        from numba import njit
        from numba.extending import register_jitable
    except ImportError:
        return None
    modules = tuple(modules)
    for module in modules:
        for _, part in getmembers(module, isfunction):
            if part.__module__ == module.__name__:
                register_jitable(forceinline=inlined(part))(part)
    function = make(sha256("".join(map(getsource, modules)).encode()).hexdigest())
    # Divisions are as in C: law code never divides by zero.
    try:
        return cast(Function, njit(function, cache=True, error_model="numpy"))
    except RuntimeError:  # no folder to keep the compiled code in
        return cast(Function, njit(function, error_model="numpy"))
