"""Settings of Sphinx."""

import sys
from pathlib import Path

from pygments.lexers.special import TextLexer
from sphinx.highlighting import lexers

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "src")]

import flexapod  # noqa: E402

project = "flexapod"
author = "The flexapod developers"
copyright = author
version = release = flexapod.__version__
language = "en"

extensions = [
    "myst_nb",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx_copybutton",
    "sphinx_design",
    "docs.site.equations",
    "docs.site.finish",
    "docs.site.katex",
]
html_math_renderer = "katex"
nitpicky = False
suppress_warnings = ["myst.xref_ambiguous"]
default_role = "code"
lexers["csv"] = TextLexer()
highlight_language = "text"

# Pages are Markdown as they are read in the repository, too.
source_suffix = {".md": "myst-nb", ".rst": "restructuredtext"}
exclude_patterns = ["files/**"]
myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_dmath_allow_labels = False
myst_fence_as_directive = ["math"]
myst_heading_anchors = 4
myst_links_external_new_tab = False
nb_custom_formats = {".py": ["jupytext.reads", {"fmt": "py:percent"}]}
nb_execution_mode = "cache"
nb_execution_cache_path = str(ROOT / "build" / "site-notebooks")
nb_execution_raise_on_error = True
nb_execution_timeout = 120
nb_merge_streams = True

autodoc_typehints = "none"
autodoc_member_order = "bysource"
autodoc_default_options = {"show-inheritance": False}
toc_object_entries = False
numpydoc_show_class_members = False
numpydoc_xref_param_type = False
copybutton_prompt_text = r">>> |\.\.\. |\$ "
copybutton_prompt_is_regexp = True

html_theme = "pydata_sphinx_theme"
html_title = "flexapod"
html_static_path = [str(ROOT / "docs" / "site" / "static"), str(ROOT / "build" / "katex" / "static")]
html_css_files = ["katex.min.css", "flexapod.css"]
html_search_scorer = str(ROOT / "docs" / "site" / "scorer.js")
html_show_sourcelink = False
html_copy_source = False
html_sidebars = {"index": [], "changelog": [], "contributing": []}
html_theme_options = {
    "header_links_before_dropdown": 8,
    "navbar_align": "left",
    "navbar_persistent": ["search-button"],
    "navbar_end": ["theme-switcher"],
    "navigation_depth": 3,
    "show_toc_level": 2,
    "footer_start": ["copyright"],
    "footer_end": [],
    "secondary_sidebar_items": ["page-toc"],
    "back_to_top_button": False,
}
html_context = {"default_mode": "auto"}
