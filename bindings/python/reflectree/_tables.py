# SPDX-License-Identifier: Apache-2.0
"""The run-time arrays of a sampler, for whoever samples from them in an array language of his own."""

from __future__ import annotations

from typing import Any, Dict, List, NamedTuple, Tuple

import numpy as np

from ._arrays import Array

# Layouts of PackedSlab, PackedLeaf, DescentNode, AlbedoPiece and PackedAlbedo::Segment, and of the albedo's table.
SLAB = np.dtype([("first", "<u4"), ("count", "<u4"), ("first_node", "<u4"), ("bucket", "<u4"), ("volume", "<f4")])
LEAF = np.dtype([("threshold", "<u4"), ("height", "<f4"), ("alias", "<u2"), ("x", "<u2"), ("y", "<u2"),
                 ("slope_x", "i1"), ("slope_y", "i1")])
NODE = np.dtype([("lower", "<f4"), ("lower_leaves_split_x", "<u4")])
PIECE = np.dtype([("base", "<f4"), ("slope", "<f4")])
SEGMENT = np.dtype([("phi_o", "<f4"), ("rows_per_radian", "<f4"), ("first", "<u4"), ("last", "<u4")])


class Parameter(NamedTuple):
    """A known coordinate: the value, or its logarithm, from ``lowest`` to ``highest``."""

    name: str
    low: float
    high: float
    lowest: float
    highest: float
    logarithmic: bool


class Width(NamedTuple):
    """largest exp(slope . (coordinates - corner))."""

    largest: float
    slope: Tuple[float, float]
    corner: Tuple[float, float]


class AlbedoAxis(NamedTuple):
    """Equidistant rows along a coordinate, with one more at both ends; ``stride`` pieces from row to row."""

    low: float
    rows_per_unit: float
    rows: int
    stride: int


class Tables(NamedTuple):
    """What a sampler knows of one mode, as it is sampled from. Read-only.

    The C99 runtime of one file, ``runtime/reflectree_sample.h``, says what is done with each array; its layout is
    the same but for cells, which are apart here.

    Attributes
    ----------
    domain : str
        The map from the square to the directions wi.
    half : bool
        Whether the square is half of one, y in [0, 1], and a coin decides the sign of wi.y.
    exponent, stretch : float
        Of the domains ``stretched`` and ``slope_star``.
    symmetry : str
        ``"isotropic"``; or what leaves an anisotropic function as it is, which folds the viewer's azimuth.
    cos_axis, sin_axis : float
        Of the azimuth of an anisotropic function's own axis.
    turns : bool
        Whether the domain lives in the frame where wo has no y.
    scale : float
        Of the target, and so of the albedo.
    borders : array of float32
        Of the slabs of an isotropic function: cosines of theta_o, ascending, the last one 2. Else empty.
    partition_axis, partition_split : arrays
        The slabs in preorder: 0 splits theta_o, 1 phi_o (radians), 255 is a slab; the splits of inner nodes.
    slabs, leaves, nodes : structured arrays
        Trees: of isotropic functions in the order of ``borders``, else in that of the partition. A leaf has its
        bucket of the alias table, its height (density or majorant per share of the square), slopes / 128, and the
        middle of its cell in 2^-16 of the square, whose lowest bit is half of the cell's width.
        Nodes, in preorder, are there in one-shot mode alone; the top bit of ``lower_leaves_split_x`` says whether
        x is split.
    albedo_borders, albedo_pieces, albedo_segments : arrays
        Lines over the cosine, ordered [cosine][second parameter][first parameter][azimuth]; of the azimuths of
        anisotropic functions the segments tell.
    parameters : list of Parameter
        Of a family; else empty. Their coordinates come last in the partition.
    widths : list of Width
        Of the domain ``scaled_star``, along x and y.
    albedo_axes : list of AlbedoAxis
        Of a family.
    albedo_row : int
        Pieces of one cosine.
    """

    domain: str
    half: bool
    exponent: float
    stretch: float
    symmetry: str
    cos_axis: float
    sin_axis: float
    turns: bool
    scale: float
    borders: Array
    partition_axis: Array
    partition_split: Array
    slabs: Array
    leaves: Array
    nodes: Array
    albedo_borders: Array
    albedo_pieces: Array
    albedo_segments: Array
    parameters: List[Parameter]
    widths: List[Width]
    albedo_axes: List[AlbedoAxis]
    albedo_row: int


TYPES: Dict[str, Any] = {
    "borders": "<f4", "partition_axis": "u1", "partition_split": "<f4", "slabs": SLAB, "leaves": LEAF, "nodes": NODE,
    "albedo_borders": "<f4", "albedo_pieces": PIECE, "albedo_segments": SEGMENT}


def tables_of(core: Any, one_shot: bool) -> Tables:
    found: Dict[str, Any] = core.tables(one_shot)
    arrays: Dict[str, Any] = {name: np.frombuffer(found[name], dtype) for name, dtype in TYPES.items()}
    of_families = dict(parameters=[Parameter(*p) for p in found["parameters"]],
                       widths=[Width(*w) for w in found["widths"]],
                       albedo_axes=[AlbedoAxis(*a) for a in found["albedo_axes"]])
    return Tables(**{**found, **arrays, **of_families})
