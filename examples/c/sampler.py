#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The C interface from Python by ctypes: a NumPy function becomes a sampler.

Usage: sampler.py LIBRARY, such as sampler.py libreflectree_c.so
"""
import ctypes as c
import sys

import numpy as np

library = c.CDLL(sys.argv[1])
library.reflectree_last_error.restype = c.c_char_p
library.reflectree_info_text.restype = c.c_char_p
library.reflectree_info_text.argtypes = [c.c_void_p]
FLOATS = c.POINTER(c.c_float)
CALLBACK = c.CFUNCTYPE(c.c_int, c.c_void_p, c.c_size_t, FLOATS, FLOATS, FLOATS)


class Pcg32(c.Structure):
    _fields_ = [("state", c.c_uint64), ("increment", c.c_uint64)]


def must(status):
    if status:
        raise RuntimeError(library.reflectree_last_error().decode())


def pointer(a):
    return a.ctypes.data_as(FLOATS)


def dust(wo, wi):
    """Dust that scatters light once, sr^-1, without cosine; rows of both are directions."""
    return 0.3 / (wo[:, 2] + wi[:, 2])


@CALLBACK
def callback(_, n, wo, wi, values):
    try:
        view = np.ctypeslib.as_array
        view(values, (n,))[:] = dust(view(wo, (n, 3)), view(wi, (n, 3)))
        return 0
    except Exception as error:  # must not leave the callback
        print(error, file=sys.stderr)
        return 1


f, sampler, random = c.c_void_p(), c.c_void_p(), Pcg32()
must(library.reflectree_function_callback(b"dust", 1, 0, callback, None, None, c.byref(f)))
must(library.reflectree_build(f, None, c.byref(sampler)))
library.reflectree_pcg32_seed(c.byref(random), c.c_uint64(1), c.c_uint64(0))

n = 100_000
wo = np.tile(np.array([np.sin(0.8), 0, np.cos(0.8)], np.float32), (n, 1))
wi, weight = np.empty((n, 3), np.float32), np.empty(n, np.float32)
bits = c.cast(library.reflectree_pcg32_next, c.c_void_p)
must(library.reflectree_sample_exact(sampler, c.c_size_t(n), pointer(wo), bits, c.byref(random), pointer(wi), None,
                                     pointer(weight)))
light = wi[:, 2] > 0.5  # within 60 degrees of the normal; in closed form the result is 0.484
print(library.reflectree_info_text(sampler).decode(), end="")
print(f"reflected radiance {np.mean(weight * light):.3f}")
for handle, free in ((f, library.reflectree_function_free), (sampler, library.reflectree_sampler_free)):
    free.argtypes = [c.c_void_p]
    free(handle)
