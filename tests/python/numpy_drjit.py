# SPDX-License-Identifier: Apache-2.0
"""As much of Dr.Jit and of Mitsuba's types as reflectree._drjit needs, by NumPy: its arrays and loops run wherever the
package does."""

import numpy as np

pi = np.pi
eval = lambda *arrays: None  # noqa: E731, A001
abs, sqrt, minimum, maximum = np.abs, np.sqrt, np.minimum, np.maximum  # noqa: A001
clip, power, atan2, select, log, exp = np.clip, np.power, np.arctan2, np.where, np.log, np.exp


def Float(values):
    return np.asarray(values, dtype=np.float32)


def UInt32(values):
    return np.asarray(values).astype(np.uint32)


def rsqrt(x):
    return 1 / np.sqrt(x)


def mulsign(a, b):
    return np.where(np.signbit(b), -a, a)


def mul_hi(a, b):
    return ((np.asarray(a, np.uint64) * np.asarray(b, np.uint64)) >> np.uint64(32)).astype(np.uint32)


def reinterpret_array(to, values):
    return np.asarray(values).view(np.float32 if to is Float else np.uint32)


class _Vector:
    def __init__(self, columns):
        self.x, self.y, self.z, self.w = (list(columns) + [None] * 4)[:4]


class Vector2u(_Vector):
    width = 2


class Vector2f(_Vector):
    width = 2


class Vector4u(_Vector):
    width = 4


class Vector4f(_Vector):
    width = 4


def gather(to, buffer, index, active=True):
    width = getattr(to, "width", 1)
    index = np.clip(np.asarray(index, np.int64), 0, len(buffer) // width - 1)
    if width == 1:
        return buffer[index]
    return to(buffer.reshape(-1, width)[index].T)


def while_loop(state, cond, body, label=""):
    for _ in range(1000):
        going = cond(*state)
        if not np.any(going):
            return state
        state = tuple(np.where(going, new, old) for new, old in zip(body(*state), state))
    raise AssertionError(f"the loop {label} does not end")
