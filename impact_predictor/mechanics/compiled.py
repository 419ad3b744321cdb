"""Law code by numba where it is installed, else as machine code or as Python: the same answers to the last bit."""

from __future__ import annotations

import sys
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from functools import cache
from hashlib import sha256
from inspect import getmembers, getsource, isfunction, signature
from types import ModuleType
from typing import TYPE_CHECKING, Any, Final, TypeVar, cast

from ..native import as_python, is_compiled

if TYPE_CHECKING:
    from librt.vecs import vec
    from mypy_extensions import i64

    Floats = vec[float]
    """A flat sequence of numbers that law code reads and writes: an array for numba, a vector in machine code, a list
    in Python. Its parts are views of an array, else copies."""
    Ints = vec[i64]
    Count = i64
    """What counts and indexes them."""

COMPILING: Final = "numba compiles the impact laws, once for a machine: half a minute"

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(
    function: Function, used: Sequence[ModuleType], inlined: Callable[[object], bool], nogil: bool = False
) -> Function | None:
    """A function of law code, compiled; None where numba is not installed.

    It calls functions of the modules `used` besides its own; those that are `inlined` become a part of their callers.
    What was compiled is kept where a folder can be written. Of a function with `nogil` several threads run at once.
    """
    try:
        from numba import njit
        from numba.extending import register_jitable
    except ImportError:
        return None
    modules = *used, sys.modules[function.__module__]
    for module in modules:
        for _, part in getmembers(module, isfunction):
            if part.__module__ == module.__name__:
                register_jitable(forceinline=inlined(part))(part)
    text = sha256("".join(map(getsource, modules)).encode()).hexdigest()

    def law(*given: object) -> object:
        text  # noqa: B018  numba keeps what it compiled under the values that are bound here
        return function(*given)

    law.__qualname__ = function.__name__  # which names the files of what is kept
    # Divisions are as in C: law code never divides by zero.
    try:
        return cast(Function, njit(law, cache=True, error_model="numpy", nogil=nogil))
    except RuntimeError:  # no folder to keep the compiled code in
        return cast(Function, njit(law, error_model="numpy", nogil=nogil))


def door(
    function: Callable[..., Any],
    used: Sequence[ModuleType] = (),
    inlined: Collection[Callable[..., object]] = (),
) -> Callable[..., Any]:
    """A function of law code, which fills the arrays that it is given, compiled if that can be.

    It calls functions of the modules `used` besides its own; the functions `inlined` become a part of their callers.
    Without numba it is machine code, or runs as Python.
    """
    read = as_python(function.__module__.partition(".")[2])
    modules = [as_python(module.__name__.partition(".")[2]) for module in used]
    names = {function.__name__ for function in inlined}
    found = compiled(getattr(read, function.__name__), modules, lambda part: getattr(part, "__name__", "") in names)
    return without_numba(function) if found is None else found


def without_numba(function: Callable[..., Any]) -> Callable[..., Any]:
    """A function of law code without numba, which fills the arrays that it is given.

    As machine code it runs on vectors, as Python on lists, which are faster there than arrays. What it takes as `work`
    it only works with: that is not copied.
    """
    flat = vectors if is_compiled(function.__module__) else lists
    names = list(signature(function).parameters)
    scratch: dict[int, Any] = {}  # of each size

    def called(*given: Any) -> Any:
        taken = []
        for name, one in zip(names, given, strict=True):
            if name == "work":
                if len(one) not in scratch:
                    scratch[len(one)] = flat(one)
                taken.append(scratch[len(one)])
            else:
                taken.append(flat(one) if hasattr(one, "tolist") else one)
        result = function(*taken)
        for name, one, values in zip(names, given, taken, strict=True):
            if name != "work" and hasattr(one, "tolist"):
                one[...] = values
        return result

    return called


def lists(array: Any) -> Any:
    return array.tolist()


def vectors(array: Any) -> Any:
    """The numbers of an array (n) as a vector, or those of one (k, n) as a list of them."""
    of_floats, of_ints = vector_types()
    if array.ndim > 1:
        return [of_floats(row) for row in array.tolist()]
    return (of_floats if array.dtype.kind == "f" else of_ints)(array.tolist())


@cache
def vector_types() -> tuple[Callable[[list[float]], Any], Callable[[list[int]], Any]]:
    """What makes vectors of numbers: only machine code needs them."""
    from librt.vecs import vec
    from mypy_extensions import i64

    return vec[float], vec[i64]


@contextmanager
def told_of_compiling(tell: Callable[[str], object], is_over: Callable[[], bool] = bool) -> Iterator[None]:
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
                tell(COMPILING)
            if is_over():
                raise KeyboardInterrupt

        def on_end(self, event: Any) -> None:
            """Nothing is told then."""

    with event.install_listener("numba:run_pass", Teller()):
        yield
