"""What mkdocs adds to the documents: films and notebooks, which `make docs` has made in build/."""

import re
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

MADE = {"films": "*.mp4", "notebooks": "**/*.*"}
"""Folders of build/ and of the site, and which of their files belong to it."""


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Add what was made; a notebook's page takes the place of the notebook."""
    build = Path(config.config_file_path).parent / "build"
    for folder, pattern in MADE.items():
        for path in sorted((build / folder).glob(pattern)):
            place = f"{folder}/{path.relative_to(build / folder).as_posix()}"
            files.append(File.generated(config, place, abs_src_path=str(path)))
    for file in list(files):
        if file.src_uri.endswith(".ipynb"):
            files.remove(file)
    return files


def on_page_markdown(markdown: str, **_: object) -> str:
    """Let links to a notebook lead to its page."""
    return re.sub(r"(\]\([\w./-]+)\.ipynb\)", r"\1.md)", markdown)
