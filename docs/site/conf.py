# SPDX-License-Identifier: Apache-2.0
"""The documentation as a site that needs no network to read: `./x site`. Pages are docs/*.md as they are; the reference
of Python comes from its docstrings, so that the package must be importable."""

import pathlib
import re

import reflectree

ROOT = pathlib.Path(__file__).resolve().parents[2]

project = "Reflectree"
author = "the authors of Reflectree"
version = release = reflectree.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
html_theme = "furo"
html_title = f"Reflectree {version}"
html_show_sphinx = False
html_copy_source = False
exclude_patterns = ["site/requirements.txt"]

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
autodoc_typehints = "description"
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_ivar = True
