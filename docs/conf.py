"""The site of the pages in this folder: Markdown by MyST, the interface from the docstrings by numpydoc."""

import sys
from pathlib import Path

import polhode

sys.path.insert(0, str(Path(__file__).parent / "site"))

project = "polhode"
author = "The polhode developers"
copyright = author
release = version = polhode.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "numpydoc",
    "maths",
    "interface",
    "gallery",
    "measured",
    "moved",
    "notebooks",
    "written",
]
exclude_patterns = ["_build"]
source_suffix = {".md": "markdown"}

myst_enable_extensions = ["amsmath", "deflist", "dollarmath"]
myst_heading_anchors = 3

autodoc_member_order = "groupwise"
autodoc_typehints = "none"  # the docstrings say shapes, which types cannot
autosummary_generate = False
numpydoc_show_class_members = False
default_role = "py:obj"  # a name in single backticks is a link wherever it has a page

smartquotes_action = "qe"  # two hyphens begin an option; they are no dash

html_theme = "pydata_sphinx_theme"
html_title = "polhode"
html_show_sourcelink = False
html_theme_options = {
    "logo": {"text": "polhode"},
    "header_links_before_dropdown": 7,
    "secondary_sidebar_items": ["page-toc"],
    "show_prev_next": True,
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
}
html_sidebars = {"tutorial": []}  # which has no pages below it
html_static_path = ["static"]
html_css_files = ["polhode.css"]
html_js_files = ["page.js"]
html_math_renderer_name = "mathml"
