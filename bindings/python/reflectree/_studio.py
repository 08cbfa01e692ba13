# SPDX-License-Identifier: Apache-2.0
"""Pictures and comparisons, for which the libraries of pictures and of the renderer are needed."""

from __future__ import annotations

import html
import importlib
import os
import pathlib
import warnings
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from ._arrays import Array, as_number, as_threads, as_whole
from ._brdf import Brdf, BrdfLike, as_brdf
from ._checks import rows_html
from ._error import Error
from ._files import as_path
from ._progress import Progress, opened

DEMO = pathlib.Path(__file__).with_name("demo.xml")


def need_studio(who: str) -> Any:
    """The module in C++, where it was built and its libraries are there."""
    try:
        return importlib.import_module("reflectree._studio_core")
    except ModuleNotFoundError:
        raise Error("the package was built without the studio, for which the libraries of pictures and of the renderer "
                    "are needed", who, "install them and repeat pip install --force-reinstall with "
                    "-C cmake.define.REFLECTREE_PYTHON_STUDIO=ON (docs/python.md); or use the command reflectree") from None
    except ImportError as error:
        raise Error(f"the studio's libraries are not there ({error})", who, "install them (docs/python.md)") from None


class RenderWarning(UserWarning):
    """A word of a scene that has no effect here."""


def render(scene: Union[None, str, "os.PathLike[str]"] = None, *, material: Optional[str] = None,
           spp: Optional[int] = None, sampler: str = "one-shot", integrator: Optional[str] = None,
           technique: str = "balance", defines: Optional[Dict[str, Any]] = None, seed: int = 1,
           threads: Optional[int] = None, progress: Progress = None) -> Array:
    """Renders a scene in Mitsuba's XML, or the demo: three balls under a sky and a sun.

    Parameters
    ----------
    scene : path, optional
        An XML file; docs/render.md says what it may hold. Without it the demo, whose middle ball is of ``material``
        and which takes ``defines={"size": 256}``, its width in pixels.
    material : str, optional
        What ``$material`` stands for in the scene: a material's text.
    spp : int, optional
        Samples per pixel; else the scene's.
    sampler : str
        Of ``type="reflectree"`` and ``"measured"`` materials: one of :func:`samplers`.
    integrator : "path", "direct", "recursive", "photons", optional
        Else the scene's.
    technique : "balance", "power", "light", "brdf", "resampled"
        How lights are found: both ways by a heuristic, or one way alone.
    defines : dict, optional
        What ``$name`` stands for in the scene.
    seed : int
        The picture depends on it, and not on threads.
    threads : int, optional
        All cores by default.
    progress : True or callable, optional
        As in :class:`Sampler`.

    Returns
    -------
    array of float32, shape (h, w, 3)
        Linear radiance, red, green, blue of sRGB's primaries; rows from the top.

    Raises
    ------
    Error
        For a scene that is wrong, with its line, and where the studio is missing.
    KeyboardInterrupt
        Ctrl-C ends the work.

    Warns
    -----
    RenderWarning
        For each word of the scene that has no effect.
    """
    core = need_studio("rt.render")
    words = {str(key): str(value) for key, value in (defines or {}).items()}
    if material is not None:
        words["material"] = str(material)
    samples = 0 if spp is None else as_whole(spp, "spp")
    if spp is not None and not 1 <= samples <= 2**30:
        raise Error(f"{spp} samples per pixel", "spp", "give 1 to 2^30, or None for the scene's")
    path = as_path(DEMO if scene is None else scene)
    with opened(progress) as tell:
        picture, notes = core.render(path, xml="", defines=words, sampler=sampler, integrator=integrator or "",
                                     technique=technique, samples=samples, seed=as_whole(seed, "seed"),
                                     threads=as_threads(threads), progress=tell)
    for note in notes:
        warnings.warn(note, RenderWarning, stacklevel=2)
    return np.asarray(picture)


# Columns of a material's table after the sampler.
HEAD = ("theta_o", "variance", "sum", "worst", "dead %", "bias", "+-", "ns", "x floor", "pdf ns", "KiB", "build s")


class Comparison(NamedTuple):
    """What every sampler costs and is worth on materials.

    Attributes
    ----------
    rows : list of dict
        A row per material, sampler and elevation of the viewer, with the columns of ``reflectree compare --csv``:
        relative variances of the weight, share of dead samples, bias and half its 95 % interval, nanoseconds, bytes,
        seconds to build, and ``efficiency``, a dictionary by light: 1 / (RMSE^2 seconds).
    scores : list of dict
        A row per sampler; ``efficiency`` is relative to the better of our modes, the geometric mean over materials.
    losses : list of dict
        Materials on which a general competitor is more efficient than ours, and why.
    faults : list of (material, sampler, words)
        Samplers that could not be built.
    materials, won : int
        Where ours and a general competitor were measured, and on how many of these ours is best.
    """

    rows: List[Dict[str, Any]]
    scores: List[Dict[str, Any]]
    losses: List[Dict[str, Any]]
    faults: List[Tuple[str, str, str]]
    materials: int
    won: int

    def _tables(self) -> List[Tuple[Tuple[str, ...], List[Tuple[str, ...]]]]:
        """Head and rows of each material's table, then of the scores."""
        tables: List[Tuple[Tuple[str, ...], List[Tuple[str, ...]]]] = []
        for name in dict.fromkeys(row["material"] for row in self.rows):
            mine = [row for row in self.rows if row["material"] == name]
            head = (name,) + HEAD + tuple(f"eff {light}" for light in mine[0]["efficiency"])
            tables.append((head, [(
                r["sampler"], f"{r['theta_o_deg']:g}", f"{r['target_variance']:.3g}", f"{r['sum_variance']:.3g}",
                f"{r['worst_variance']:.3g}", f"{100 * r['dead']:.2g}", f"{r['bias']:.1e}" + "!" * r["biased"],
                f"{r['bias_interval']:.0e}", f"{r['sample_ns']:.0f}", f"{r['sample_ns'] / r['floor_ns']:.1f}",
                f"{r['pdf_ns']:.0f}" if r["pdf_ns"] > 0 else "-", f"{r['bytes'] / 1024:.0f}",
                f"{r['build_seconds']:.2f}", *(f"{e:.2e}" for e in r["efficiency"].values())) for r in mine]))
        tables.append((("sampler", "kind", "materials", "efficiency", "biased cells", "faults"), [
            (s["sampler"], s["kind"], str(s["materials"]), f"{s['efficiency']:.3g}", str(s["biased_cells"]),
             str(s["faults"])) for s in self.scores]))
        return tables

    def _verdict(self) -> str:
        if self.materials == 0:
            return "no verdict: ours and a general competitor are wanted on one material at least"
        return f"ours is best of all general methods on {self.won} of {self.materials} materials"

    def __str__(self) -> str:
        blocks = []
        for head, rows in self._tables():
            width = [max(len(row[k]) for row in [head, *rows]) for k in range(len(head))]
            blocks.append("\n".join("  ".join(cell.ljust(w) if k == 0 else cell.rjust(w) for k, (cell, w) in
                                              enumerate(zip(row, width))) for row in [head, *rows]))
        blocks += [f"{material}: {sampler}: {words}" for material, sampler, words in self.faults]
        blocks += [f"loss  {x['material']}: {x['ratio']:.3g} of {x['winner']}: {x['cause']}" for x in self.losses]
        return "\n\n".join(blocks + [self._verdict()])

    def __repr__(self) -> str:
        return f"<reflectree.Comparison of {len(self.scores)} samplers: {self._verdict()}>"

    def _repr_html_(self) -> str:
        return "".join(rows_html(rows, head) for head, rows in self._tables()) + f"<p>{html.escape(self._verdict())}</p>"


def compare(materials: Union[BrdfLike, Sequence[BrdfLike]], *, samplers: Optional[Sequence[str]] = None,
            theta_o: Optional[Sequence[float]] = None, quick: bool = True, seed: int = 1, threads: Optional[int] = None,
            progress: Progress = None) -> Comparison:
    """Measures every sampler on materials: variance, bias, dead samples, nanoseconds, and what that is worth under
    three lights. It is the command ``reflectree compare``.

    Parameters
    ----------
    materials : material, path, or a sequence of them
        A function of NumPy is refused: its calls, one direction at a time, would be all that is measured.
    samplers : sequence of str, optional
        Names of :func:`samplers`; all by default.
    theta_o : sequence of float, optional
        Elevations of the viewer from the normal, radians; 10, 45, 75 and 85 degrees by default.
    quick : bool
        An eighth of the samples; False takes minutes for each material.
    seed : int
        Of all random numbers; times differ from run to run.
    threads : int, optional
        All cores by default. More threads than free cores make times wrong.
    progress : True or callable, optional
        As in :class:`Sampler`.

    Raises
    ------
    Error
        For a function of Python, unknown names, and where the studio is missing.
    KeyboardInterrupt
        Ctrl-C ends the work.
    """
    core = need_studio("rt.compare")
    many: List[Any] = list(materials) if isinstance(materials, (list, tuple)) else [materials]
    brdfs: List[Brdf] = [as_brdf(m) for m in many]
    if not brdfs:
        raise Error("there is no material", "materials", "give one at least")
    for brdf in brdfs:
        if brdf._core.is_function:
            raise Error("a function of Python is no material to compare samplers on: they draw one direction at a time, and "
                        "its calls would be all that is measured", brdf.name, "give a material's text or a file")
    if isinstance(samplers, str):
        raise Error("one name is no sequence of names", "samplers", f"write [{samplers!r}]")
    degrees = [float(np.degrees(as_number(t, "theta_o"))) for t in (theta_o if theta_o is not None else ())]
    if not all(0 <= d < 90 for d in degrees) or (theta_o is not None and not degrees):
        raise Error(f"{theta_o!r} are no elevations above the horizon", "theta_o", "give angles from 0 to below pi/2")
    with opened(progress) as tell:
        found = core.compare([b._core for b in brdfs], names=[b.name for b in brdfs], samplers=list(samplers or ()),
                             theta_o_deg=degrees, quick=bool(quick), seed=as_whole(seed, "seed"),
                             threads=as_threads(threads), progress=tell)
    verdict = found["verdict"]
    return Comparison(list(found["rows"]), list(verdict["scores"]), list(verdict["losses"]), list(found["faults"]),
                      verdict["materials"], verdict["won"])
