# SPDX-License-Identifier: Apache-2.0
"""The fields of a tensor_file, from the format's description, for the independent readings."""
import math
import struct

SIZES = {1: 1, 2: 1, 3: 2, 4: 2, 5: 4, 6: 4, 7: 8, 8: 8, 9: 2, 10: 4, 11: 8}  # of the types of number


def read_tensor_file(path):
    """name -> (shape, type of number, bytes)"""
    with open(path, "rb") as file:
        data = file.read()
    assert data[:12] == b"tensor_file\0"
    (count,) = struct.unpack_from("<I", data, 14)
    at, fields = 18, {}
    for _ in range(count):
        (length,) = struct.unpack_from("<H", data, at)
        name = data[at + 2:at + 2 + length].decode()
        at += 2 + length
        dims, dtype, offset = struct.unpack_from("<HBQ", data, at)
        shape = struct.unpack_from(f"<{dims}Q", data, at + 11)
        at += 11 + 8 * dims
        fields[name] = shape, dtype, data[offset:offset + math.prod(shape) * SIZES[dtype]]
    return fields
