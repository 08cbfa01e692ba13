# SPDX-License-Identifier: Apache-2.0
"""Tables as the buffers of Dr.Jit want them, by NumPy alone: cells that are unpacked, trees in preorder, and guides
from which a search begins next to its end."""

from __future__ import annotations

from typing import List, NamedTuple

import numpy as np

from ._arrays import Array
from ._error import Error
from ._tables import Tables

LEAF = 2  # the axis of what is no inner node


def cells(tables: Tables) -> Array:
    """x, y, width, length, slope_x, slope_y, height of every leaf, and one number to spare."""
    leaves = tables.leaves
    cells = np.zeros((len(leaves), 8), np.float32)
    for axis, name in enumerate(("x", "y")):
        middle = leaves[name].astype(np.int64)
        half_width = middle & -middle
        from_zero = axis == 1 and tables.half
        unit = 2.0**-16 if from_zero else 2.0**-15
        cells[:, axis] = (middle - half_width) * unit - (0 if from_zero else 1)
        cells[:, axis + 2] = 2 * half_width * unit
    cells[:, 4], cells[:, 5] = leaves["slope_x"] / 128, leaves["slope_y"] / 128
    cells[:, 6] = leaves["height"]
    return cells


class Trees(NamedTuple):
    """Whole trees in preorder. Of a node the place of its cut, the share below, and a word: of an inner node its upper
    child and the axis (1 is x), of a leaf its number and LEAF. The lower child follows at once. The guide has, for
    each cell of a grid over each slab's square, the smallest node around it."""

    roots: Array
    splits: Array
    lowers: Array
    words: Array
    bits_x: int
    bits_y: int
    guide: Array


def trees(tables: Tables) -> Trees:
    count = 2 * len(tables.leaves) - len(tables.slabs)
    splits, lowers, words = np.zeros(count, np.float32), np.zeros(count, np.float32), np.zeros(count, np.uint32)
    roots = np.zeros(len(tables.slabs), np.uint32)
    # Eight cells for a leaf, four times as many along y, the radius, which is refined most.
    bits = min(max(3 + int(np.ceil(np.log2(len(tables.leaves) / len(tables.slabs)))), 4), 14)
    bits_x = max((bits - 2) // 2, 0)
    bits_y = bits - bits_x
    across, along = 2**bits_x, 2**bits_y
    guide = np.zeros((len(tables.slabs), along, across), np.uint32)
    shares, packed = tables.nodes["lower"], tables.nodes["lower_leaves_split_x"].tolist()
    y0 = 0.0 if tables.half else -1.0
    at = 0
    for k, (first, leaves, node, _, _) in enumerate(tables.slabs.tolist()):
        roots[k] = at
        leaf = first
        grid = guide[k]
        open_nodes = [(leaves, 0.0, 1.0, 0.0, 1.0)]  # start and size along each axis, of the square's unit
        while open_nodes:
            n, x, width, y, length = open_nodes.pop()
            if width * across >= 1 and length * along >= 1:
                grid[int(y * along):int((y + length) * along), int(x * across):int((x + width) * across)] = at
            if n == 1:
                words[at] = leaf << 2 | LEAF
                leaf += 1
            else:
                lower, along_x = packed[node] & 0x7FFFFFFF, packed[node] >> 31
                words[at] = (at + 2 * lower) << 2 | along_x
                lowers[at] = shares[node]
                node += 1
                if along_x:
                    width /= 2
                    splits[at] = 2 * (x + width) - 1
                    open_nodes += [(n - lower, x + width, width, y, length), (lower, x, width, y, length)]
                else:
                    length /= 2
                    splits[at] = y0 + (1 - y0) * (y + length)
                    open_nodes += [(n - lower, x, width, y + length, length), (lower, x, width, y, length)]
            at += 1
    return Trees(roots, splits.view(np.uint32), lowers.view(np.uint32), words, bits_x, bits_y, guide)


def slab_tree(tables: Tables) -> Array:
    """In preorder the cut, a cosine or an azimuth, and a word as above; the axis of a cosine is 0."""
    nodes = np.zeros((len(tables.partition_axis), 2), np.uint32)
    splits = iter(tables.partition_split)
    open_uppers: List[int] = []
    slab = 0
    for at, axis in enumerate(tables.partition_axis.tolist()):
        if axis == 255:
            nodes[at, 1] = slab << 2 | LEAF
            slab += 1
            if open_uppers:
                parent = open_uppers.pop()
                nodes[parent, 1] |= (at + 1) << 2
        else:
            split = np.float32(next(splits))
            nodes[at] = (np.float32(np.cos(split) if axis == 0 else split).view(np.uint32), axis)
            open_uppers.append(at)
    return nodes


class Grid(NamedTuple):
    """Over all borders of the slabs: of the first axis cosines that ascend, with both ends; of every other axis
    coordinates between the ends. And the slab of every cell."""

    cosines: Array
    borders: List[Array]
    slabs: Array


def slab_grid(tables: Tables) -> Grid:
    axes = 1 + (tables.symmetry != "isotropic") + len(tables.parameters)
    inner = tables.partition_axis[tables.partition_axis != 255]
    borders = [np.unique(tables.partition_split[inner == a]) for a in range(axes)]
    cells = np.prod([len(b) + 1.0 for b in borders])
    if cells > 2**22:
        raise Error(f"its slabs have borders for a grid of {cells:.0f} cells", "a family over Dr.Jit",
                    "narrow the ranges of its parameters")
    slabs = np.zeros([len(b) + 1 for b in borders], np.uint32)
    open_boxes = [([0] * axes, list(slabs.shape))]  # of cells, those of nodes that are still to come
    splits, slab = iter(tables.partition_split), 0
    for axis in tables.partition_axis.tolist():
        first, last = open_boxes.pop()
        if axis == 255:
            slabs[tuple(slice(a, b) for a, b in zip(first, last))] = slab
            slab += 1
        else:
            at = int(np.searchsorted(borders[axis], next(splits))) + 1
            open_boxes.append(([*first[:axis], at, *first[axis + 1:]], last))
            open_boxes.append((first, [*last[:axis], at, *last[axis + 1:]]))
    cosines = np.concatenate([[2.0**-17], np.cos(borders[0])[::-1], [2]]).astype(np.float32)
    return Grid(cosines, borders[1:], np.ascontiguousarray(slabs[::-1]))
