"""The site, ``make docs``: what exists elsewhere is read from there when it is built; nothing is fetched."""

from __future__ import annotations

import re
import shutil
import sys
from pathlib import Path

from sphinx.application import Sphinx

import gearmath

HERE = Path(__file__).parent
ROOT = HERE.parent
sys.path.insert(0, str(HERE))

project = "gearmath"
author = "The gearmath engineers"
version = release = gearmath.__version__
copyright = author

extensions = ["myst_nb", "sphinx.ext.autodoc", "sphinx.ext.mathjax", "sphinx_click"]
exclude_patterns = ["_build"]
html_theme = "furo"
html_title = "gearmath"
html_static_path = ["_static"]
html_css_files = ["gearmath.css"]
html_show_sphinx = False

myst_enable_extensions = ["dollarmath", "colon_fence"]
myst_heading_anchors = 3
nb_execution_mode = "off"  # `prepare` takes them as `make notebooks` ran them, and runs what is missing
nb_merge_streams = True
nb_render_markdown_format = "myst"  # tables and equations of outputs, too
nb_ipywidgets_js: dict[str, dict[str, str]] = {}  # no script from elsewhere, and no Python behind a page
_WIDGET = "application/vnd.jupyter.widget-view+json"

autodoc_member_order = "bysource"
autodoc_typehints = "description"
autodoc_preserve_defaults = True  # a default by its name, not by its address in memory
autodoc_default_options = {"members": True, "undoc-members": False}

# MathJax, with its fonts, comes with the wheel of jupyter-server-mathjax
mathjax_path = "mathjax/MathJax.js"
mathjax2_config = {
    "config": ["TeX-AMS-MML_HTMLorMML-full.js"],
    "HTML-CSS": {"availableFonts": [], "webFont": "STIX-Web", "imageFont": None, "linebreaks": {"automatic": True}},
    "showProcessingMessages": False,
    "showMathMenu": False,
    # myst marks the text as not to be searched for math, and what is math by a class
    "tex2jax": {
        "inlineMath": [["\\(", "\\)"]],
        "displayMath": [["\\[", "\\]"]],
        "processClass": "tex2jax_process|mathjax_process|math|output_area",
    },
}


def prepare(app: Sphinx) -> None:
    """What the site takes from elsewhere: notebooks as they were run, chapters typeset, MathJax."""
    import jupyter_server_mathjax
    import nbformat
    from chapters import write_chapters
    from nbclient import NotebookClient

    target = HERE / "notebooks"
    target.mkdir(exist_ok=True)
    for source in sorted((ROOT / "notebooks").glob("*.ipynb")):
        executed = ROOT / "build" / "notebooks" / source.name
        fresh = executed.is_file() and executed.stat().st_mtime > source.stat().st_mtime
        notebook = nbformat.read(executed if fresh else source, as_version=4)
        if not fresh:
            print(f"runs {source.name}", flush=True)  # some take half a minute
            NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(source.parent)}}).execute()
        for output in (output for cell in notebook.cells for output in cell.get("outputs", ())):
            if _WIDGET in output.get("data", {}):
                output["data"] = {
                    "text/markdown": f"*Sliders or a scene to turn: in Jupyter, open notebooks/{source.name}.*"
                }
        nbformat.write(notebook, target / source.name)
    write_chapters(HERE / "mathematics")
    mathjax, place = Path(jupyter_server_mathjax.__file__).parent / "static", HERE / "_static" / "mathjax"
    if not (place / "MathJax.js").is_file():
        shutil.copytree(mathjax, place, dirs_exist_ok=True)


def link_pages(app: Sphinx, what: str, name: str, obj: object, options: object, lines: list[str]) -> None:
    """A docstring names a page by its file, docs/files.md, which is there beside the source: here it is a link."""
    lines[:] = [re.sub(r"\bdocs/([\w/]+)\.md\b", r":doc:`docs/\1.md </\1>`", line) for line in lines]


def setup(app: Sphinx) -> None:
    app.connect("builder-inited", prepare)
    app.connect("autodoc-process-docstring", link_pages)
