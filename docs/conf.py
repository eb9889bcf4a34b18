"""How Sphinx makes the site: ``scripts/docs`` lays out its source and builds it without network."""

import dataclasses
import inspect
from importlib.metadata import version as version_of
from typing import Any

project = "antenna_pin"
author = "antenna_pin developers"
copyright = "antenna_pin developers"  # noqa: A001 - Sphinx' name
version = release = version_of("antenna-pin")

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
    "sphinx_gallery.gen_gallery",
]
root_doc = "docs/index"
exclude_patterns = ["**/.*", "docs/gallery/*.ipynb", "docs/scripts/*.ipynb", "scripts/*/GALLERY_HEADER.rst"]
nitpicky = False
keep_warnings = True

# --- pages: those of docs/ as GitHub shows them, with anchors as GitHub makes them ---

myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 4
# A formula in dollars is one wherever it stands; a shell's prompt stands in a block.
myst_dmath_double_inline = True
# Reference tables hold headings below their page's, at the level that GitHub gives them; and a rule of a
# parameter ("positive"), which stands in its annotation, may be the name of something.
suppress_warnings = ["myst.header", "ref.python"]

# --- notebooks: run by the build, and kept until they change ---

nb_execution_mode = "cache"
nb_execution_timeout = 120
nb_execution_raise_on_error = True
nb_merge_streams = True

# --- formulas: drawn in the browser by a script of the site's own ---

mathjax_path = "mathjax.js"
mathjax3_config = {"svg": {"fontCache": "global"}, "options": {"enableMenu": False}}

# --- names of the code ---

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_default_options = {"members": True, "inherited-members": False, "undoc-members": False}
autodoc_preserve_defaults = True
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True
napoleon_use_rtype = False
toc_object_entries = False
maximum_signature_line_length = 90
add_module_names = False

# --- examples: run by the build, with what they print and draw ---

sphinx_gallery_conf = {
    "examples_dirs": ["scripts/gallery", "scripts/examples"],
    "gallery_dirs": ["docs/gallery", "docs/scripts"],
    "filename_pattern": r"/gallery/|/(three_lines|four_bar|slew|shaken_mass|section)\.py",
    "download_all_examples": False,
    "show_memory": False,
    "show_signature": False,
    "min_reported_time": 1e9,
    "abort_on_example_error": True,
    "remove_config_comments": True,
    "image_scrapers": ("gallery_pictures.figures_of_example",),
    "reset_modules": (),
    "write_computation_times": False,
}

# --- looks ---

html_theme = "pydata_sphinx_theme"
html_title = "antenna_pin"
html_static_path = ["_static"]
html_extra_path = ["extra"]
html_css_files = ["site.css"]
html_show_sourcelink = False
html_copy_source = False
html_sidebars = {"docs/index": []}
html_theme_options = {
    "navigation_with_keys": False,
    "show_nav_level": 1,
    "navigation_depth": 2,
    "show_toc_level": 2,
    "collapse_navigation": True,
    "secondary_sidebar_items": ["page-toc"],
    "footer_start": ["copyright"],
    "footer_end": [],
    "header_links_before_dropdown": 7,
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
}


def signature_of_fields(
    app: Any, what: str, name: str, thing: Any, options: Any, said: str | None, returns: str | None
) -> tuple[str, None] | None:
    """Return what a dataclass is made of, where it refuses in its ``__new__``, which takes anything."""
    if what != "class" or not dataclasses.is_dataclass(thing) or "parameters" not in (said or ""):
        return None
    words = [one.name for one in dataclasses.fields(thing) if one.init]
    taken = inspect.signature(thing.__init__).parameters.values()
    optional = {one.name for one in taken if one.default is not one.empty}
    return (
        f"(*, {', '.join(f'{word}=...' if word in optional else word for word in words)})" if words else "()",
        None,
    )


def setup(app: Any) -> None:
    """Take part in what autodoc writes."""
    app.connect("autodoc-process-signature", signature_of_fields)
