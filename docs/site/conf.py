# SPDX-License-Identifier: Apache-2.0
"""The documentation as a site that needs no network to be read: `./x site`. The pages are those of the repository as they
are; the reference of Python comes from the docstrings, so that the package must be importable. A link that leads nowhere
is a warning, and warnings are errors. Doxygen makes the reference of C++ beside the pages, in cpp/."""

import pathlib
import re
import shutil
import subprocess

import reflectree
from sphinx.errors import ExtensionError

ROOT = pathlib.Path(__file__).resolve().parents[2]

project = "Reflectree"
author = "the authors of Reflectree"
version = release = reflectree.__version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
root_doc = "docs/site/index"
include_patterns = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/**.md"]
html_theme = "furo"
html_title = f"Reflectree {version}"
html_show_sphinx = False
html_show_copyright = False
html_copy_source = False

myst_heading_anchors = 4
suppress_warnings = ["myst.header"]  # pages of results have tables under small headings
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_ivar = True

LINK = re.compile(r"\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^()\s#]+)\)")


def without_folders(app, page, source):
    """A site has files: what a page links to as a folder is named there, and no link."""
    here = (ROOT / page).parent
    source[0] = LINK.sub(lambda m: f"{m[1]} (`{m[2]}`)" if "://" not in m[2] and (here / m[2]).is_dir() else m[0], source[0])


def cpp_reference(app, exception):
    if exception:
        return
    if not shutil.which("doxygen"):
        raise ExtensionError("Doxygen, which makes the reference of C++, is missing: apt-get install doxygen")
    settings = (ROOT / "docs/site/Doxyfile").read_text(encoding="utf-8")
    settings += f"\nOUTPUT_DIRECTORY = \"{app.outdir}\"\nPROJECT_NUMBER = {version}\n"
    if subprocess.run(["doxygen", "-"], input=settings, text=True, cwd=ROOT).returncode:
        raise ExtensionError("Doxygen found faults in the comments of the headers; they stand above")


def setup(app):
    app.connect("build-finished", cpp_reference)
    app.connect("source-read", without_folders)
