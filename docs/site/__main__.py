"""Build the site into ``build/site``; warnings are errors."""

from __future__ import annotations

import os
import sys

from docs.site.katex import fetched
from docs.site.stage import ROOT, staged


def main() -> int:
    """Gather the pages, then let Sphinx make them; its exit code."""
    from sphinx.cmd.build import build_main

    build = ROOT / "build"
    fetched(build / "katex")
    sources = staged(build / "site-sources")
    os.environ["PYTHONPATH"] = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
    options = ["-W", "--keep-going", "-q", "-b", "html", "-c", str(ROOT / "docs" / "site")]
    return build_main([*options, "-d", str(build / "site-doctrees"), *sys.argv[1:], str(sources), str(build / "site")])


if __name__ == "__main__":
    sys.exit(main())
