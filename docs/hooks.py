"""What mkdocs adds to the documents: films and notebooks, which `make docs` has made in build/, and CONTRIBUTING.md."""

import ast
import re
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.exceptions import PluginError
from mkdocs.structure.files import File, Files

MADE = {"films": "*.mp4", "notebooks": "**/*.*"}
"""Folders of build/ and of the site, and which of their files belong to it."""


def on_files(files: Files, *, config: MkDocsConfig) -> Files:
    """Add what was made, and the guide for contributors; a notebook's page takes the place of the notebook."""
    build = Path(config.config_file_path).parent / "build"
    for folder, pattern in MADE.items():
        for path in sorted((build / folder).glob(pattern)):
            place = f"{folder}/{path.relative_to(build / folder).as_posix()}"
            files.append(File.generated(config, place, abs_src_path=str(path)))
    guide = (build.parent / "CONTRIBUTING.md").read_text(encoding="utf-8").replace("](docs/", "](")
    files.append(File.generated(config, "contributing.md", content=guide))
    for file in list(files):
        if file.src_uri.endswith(".ipynb"):
            files.remove(file)
    return files


def on_page_markdown(markdown: str, **_: object) -> str:
    """Let links to a notebook lead to its page."""
    return re.sub(r"(\]\([\w./-]+)\.ipynb\)", r"\1.md)", markdown)


def on_post_build(*, config: MkDocsConfig) -> None:
    """Require that the reference has every public name.

    Raises:
        PluginError: one lacks.
    """
    root = Path(config.config_file_path).parent
    for package in ("formation", "robots", "scenarios"):
        page = (Path(config.site_dir) / "reference" / f"{package}.html").read_text(encoding="utf-8")
        tree = ast.parse((root / package / "__init__.py").read_text(encoding="utf-8"))
        [public] = [node.value for node in tree.body if ast.unparse(node).startswith("__all__ =")]
        names = set(ast.literal_eval(public)) - {"__version__"}
        if missing := sorted(name for name in names if not re.search(rf'id="{package}\.([\w.]+\.)?{name}"', page)):
            raise PluginError(f"reference/{package}.md lacks {', '.join(missing)}: without a docstring?")
