# SPDX-License-Identifier: Apache-2.0
"""Arrays in and out: shapes, types, seeds. Nothing is copied that need not be."""

from __future__ import annotations

from typing import Any, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from ._error import Error

Array = np.ndarray
Rng = Union[None, int, np.random.Generator, np.random.BitGenerator, np.random.SeedSequence]


class Samples(NamedTuple):
    """Directions drawn, with what belongs to them; arrays of one leading shape.

    Attributes
    ----------
    wi : array, shape (..., 3)
        Unit directions towards the light, in the surface's frame.
    pdf : array, shape (...)
        Density per solid angle, sr^-1.
    weight : array, shape (..., c), or (...) of a function without channels
        f cos / pdf: the mean of ``weight * light(wi)`` is the reflected radiance.
    valid : array of bool, shape (...)
        False is "no sample" (a viewer at or below the horizon, albedo 0, trials used up): all else is 0 there.
    """

    wi: Array
    pdf: Array
    weight: Array
    valid: Array


def as_floats(value: Any, name: str) -> Array:
    """An array of float32 or float64: the caller's own where it is one, also by DLPack."""
    if isinstance(value, np.ndarray):
        if np.any(getattr(value, "mask", False)):  # of numpy.ma, whose data there is anything
            raise Error("it has masked entries", name, "leave such rows out")
        array = np.asarray(value)
    elif hasattr(value, "__dlpack__"):
        array = from_dlpack(value, name)
    else:
        try:
            array = np.asarray(value)
        except ValueError as error:
            raise Error(f"it is no array ({error})", name, "give numbers of one shape") from error
    if array.dtype.kind in "iub":
        array = array.astype(np.float64)
    if array.dtype.kind != "f" or array.dtype.itemsize not in (4, 8):
        raise Error(f"its type is {array.dtype}", name, "make it float32 or float64")
    return array if array.dtype.isnative else array.astype(array.dtype.newbyteorder("="))


def from_dlpack(value: Any, name: str) -> Array:
    try:
        return np.from_dlpack(value)
    except Exception as error:  # each library has its own
        raise Error(f"DLPack gives no NumPy array ({error})", name, "move it to the CPU, without gradients") from error


def as_vectors(value: Any, width: int, name: str) -> Array:
    """The same, of shape (..., width)."""
    array = as_floats(value, name)
    if array.ndim < 1 or array.shape[-1] != width:
        raise Error(f"its shape is {array.shape}", name, f"give it the shape (..., {width})")
    return array


def common_shape(shapes: Sequence[Tuple[int, ...]], names: str) -> Tuple[int, ...]:
    try:
        return np.broadcast_shapes(*shapes)
    except ValueError:
        text = " and ".join(str(s) for s in shapes)
        raise Error(f"their leading shapes {text} cannot be broadcast together", names,
                    "make them equal, or 1 where they differ") from None


def spread(array: Array, shape: Tuple[int, ...]) -> Array:
    """A view of vectors over a leading shape."""
    return np.broadcast_to(array, shape + array.shape[-1:])


def common_dtype(*arrays: Array) -> Any:
    """float32 where every array is, else float64."""
    return np.float32 if all(a.dtype == np.float32 for a in arrays) else np.float64


def as_output(value: Any, shape: Tuple[int, ...], dtype: Any, name: str, inputs: Sequence[Array] = ()) -> Array:
    """The array to write to: a new one, or the caller's where it will do."""
    if value is None:
        return np.empty(shape, dtype)
    array = value if isinstance(value, np.ndarray) or not hasattr(value, "__dlpack__") else from_dlpack(value, name)
    if not isinstance(array, np.ndarray):
        raise Error(f"a {type(value).__name__} cannot be written to", name, "give an array")
    wanted = "bool" if dtype is np.bool_ else "float32 or float64"
    good = array.dtype == np.bool_ if dtype is np.bool_ else array.dtype in (np.float32, np.float64)
    if not good or not array.dtype.isnative:
        raise Error(f"its type is {array.dtype}", name, f"make it {wanted}")
    if array.shape != shape:
        raise Error(f"its shape is {array.shape}", name, f"the result has the shape {shape}")
    if not array.flags.writeable:
        raise Error("it is read-only", name, "give an array that may be written to")
    for other in inputs:
        if np.may_share_memory(array, other):
            raise Error("it shares memory with an argument", name, "give an array of its own")
    return array


def sample_outputs(out: Optional[Samples], shape: Tuple[int, ...], value_shape: Tuple[int, ...], dtype: Any,
                   inputs: Sequence[Array]) -> Samples:
    parts: Tuple[Any, ...] = (None, None, None, None) if out is None else tuple(out)
    if len(parts) != 4:
        raise Error(f"it has {len(parts)} arrays", "out", "give rt.Samples(wi, pdf, weight, valid)")
    wi, pdf, weight, valid = parts
    result = Samples(as_output(wi, shape + (3,), dtype, "out.wi", inputs),
                     as_output(pdf, shape, dtype, "out.pdf", inputs),
                     as_output(weight, shape + value_shape, dtype, "out.weight", inputs),
                     as_output(valid, shape, np.bool_, "out.valid", inputs))
    if out is not None:
        for k, name in enumerate(Samples._fields):
            for array in result[:k]:  # the second question is dear, and asked of arrays that lie within each other
                if np.may_share_memory(array, result[k]) and np.shares_memory(array, result[k]):
                    raise Error("it shares memory with another field", f"out.{name}", "give an array of its own")
    return result


def scalar_or_array(array: Array) -> Any:
    """A number in place of an array without axes."""
    return array[()] if array.ndim == 0 else array


def seed_words(rng: Rng) -> Tuple[int, int]:
    """128 bits that a generator gives: the seed and the stream of one call."""
    try:
        generator = np.random.default_rng(rng)
    except (TypeError, ValueError) as error:
        raise Error(f"{type(rng).__name__} is no source of random numbers ({error})", "rng",
                    "give a numpy.random.Generator, a seed, or None") from error
    words = generator.integers(0, 2**64 - 1, size=2, dtype=np.uint64, endpoint=True)
    return int(words[0]), int(words[1])


def as_count(value: Any, name: str) -> int:
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)) or value < 0:
        raise Error(f"{value!r} is no number of directions", name, "give a whole number, 0 or more")
    if value >= 2**48:
        raise Error(f"{value} directions fit into no memory", name, "draw them in several calls")
    return int(value)


def as_whole(value: Any, name: str) -> int:
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)) or not 0 <= value < 2**63:
        raise Error(f"{value!r} is no whole number from 0 to 2^63", name, "give one")
    return int(value)


def as_threads(value: Any) -> int:
    """0 for all cores."""
    count = 0 if value is None else as_whole(value, "threads")
    if count > 1024:
        raise Error(f"{count} threads are too many", "threads", "give 1 to 1024, or None for all cores")
    return count


def as_number(value: Any, name: str) -> float:
    try:
        return float(value)
    except (TypeError, ValueError) as error:
        raise Error(f"{value!r} is no number", name, "give one") from error
