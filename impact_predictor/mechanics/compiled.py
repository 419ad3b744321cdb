"""Law code compiled by numba where it is installed: the same functions, and the same answers to the last bit."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator
from contextlib import contextmanager
from hashlib import sha256
from inspect import getmembers, getsource, isfunction
from types import ModuleType
from typing import Any, TypeVar, cast

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


def door(
    make: Callable[[str], Callable[..., Any]], modules: Iterable[ModuleType], inlined: Collection[object] = ()
) -> Callable[..., Any]:
    """The function that `make` makes, compiled if that can be; else it runs on lists, which are faster there."""
    found = compiled(make, modules, lambda function: function in inlined)
    return on_lists(make("")) if found is None else found


def on_lists(function: Callable[..., Any]) -> Callable[..., Any]:
    """Law code that runs as Python on lists, which are faster there, and fills the arrays that it is given."""

    def called(*given: Any) -> Any:
        lists = [as_lists(one) for one in given]
        result = function(*lists)
        for array, values in zip(given, lists, strict=True):
            fill(array, values)
        return result

    return called


def as_lists(given: Any) -> Any:
    if isinstance(given, tuple):
        return tuple(map(as_lists, given))
    return given.tolist() if hasattr(given, "tolist") else given


def fill(given: Any, values: Any) -> None:
    if isinstance(given, tuple):
        for array, part in zip(given, values, strict=True):
            fill(array, part)
    elif hasattr(given, "tolist"):
        given[...] = values


@contextmanager
def told_of_compiling(tell: Callable[[], None], is_over: Callable[[], bool] = bool) -> Iterator[None]:
    """Tell once when numba compiles meanwhile, instead of taking what it compiled before.

    Raises:
        KeyboardInterrupt: `is_over` says so between two of the many steps in which it compiles.
    """
    try:
        from numba.core import event
    except ImportError:
        yield
        return

    class Teller(event.Listener):
        told = False

        def on_start(self, event: Any) -> None:
            if not self.told:
                self.told = True
                tell()
            if is_over():
                raise KeyboardInterrupt

        def on_end(self, event: Any) -> None:
            """Nothing is told then."""

    with event.install_listener("numba:run_pass", Teller()):
        yield
