"""The gallery, docs/gallery.md: ``make gallery``. What it says comes from the library and from its baselines alone.

Pictures go to docs/images/gallery; films to build/films, from where ``make docs`` takes them into the site.
A test compares the page with the library and the baselines.
"""

import re
from collections.abc import Callable
from pathlib import Path

from PIL import Image

from scenarios.definition.load import library, load
from scenarios.documents import Sheet, markdown
from scenarios.figures import Frame
from scenarios.figures.films.encode import write_film
from scenarios.figures.films.film import Film
from scenarios.figures.style import print_style
from scenarios.interactive.single import Run, run
from scenarios.storage.files import write_text
from scenarios.studies.check import baseline

DOCS = Path(__file__).parent
PAGE, PICTURES, FILMS = DOCS / "gallery.md", DOCS / "images" / "gallery", DOCS.parent / "build" / "films"

FRAME = Frame(640)
SECONDS, FPS = 8.0, 12.5
"""Of each film."""

COLOURS = 64
"""Of a picture: trails of all agents, and the steps between them and white."""

HEAD = """\
# Gallery

Every scenario of the library as `formation run` runs it, on bodies with mass and contact; the pictures show the ends of
the films, which the site plays. Made by `make gallery`: the words are those at the head of each scenario's file, the
numbers those of its baseline, with seed 0, which `formation check` compares with new runs. *Settled* is the time from
which on the sum of the angle errors stays below the goal, *errors* that sum at the end, *closest* the least distance of
two robots.
"""

CHAPTERS: dict[str, Callable[[str], bool]] = {
    "The angle law": lambda law: law in ("angle", "own"),
    "Other laws": lambda law: law not in ("angle", "own"),
}

NUMBERS = {
    "settled (s)": "settling_time_s",
    "errors (rad)": "angle_error_sum_rad",
    "closest (m)": "min_separation.distance_m",
}
"""Columns, and what the baseline calls them."""

TOLD_BY_NUMBERS = ("Safety",)


def main() -> None:
    """Write the page, the pictures and the films."""
    write_text(PAGE, page(), "gallery")
    PICTURES.mkdir(parents=True, exist_ok=True)
    FILMS.mkdir(parents=True, exist_ok=True)
    for name in library():
        print(name, flush=True)
        film(run(name), name)


def page() -> str:
    """The whole page."""
    parts = [HEAD]
    for title, belongs in CHAPTERS.items():
        parts.append(f"## {title}\n")
        parts += [entry(name) for name in library() if belongs(load(name).scenario.law.name)]
    return "\n".join(parts)


def entry(name: str) -> str:
    """A scenario: picture, words, command, numbers."""
    file = load(name)
    lines = [
        f"### {name}\n",
        f"*{file.scenario.title}*\n",
        f'<video class="film" controls loop muted playsinline preload="none" poster="images/gallery/{name}.webp" '
        f'src="films/{name}.mp4"><img src="images/gallery/{name}.webp" alt="The end of {name}"></video>\n',
        words(file.description) + "\n",
        f"    formation run {name}\n",
        markdown(numbers(name)),
    ]
    return "\n".join(lines)


def words(description: str) -> str:
    """A paragraph from a scenario's head: its first sentences, and what it tells line by line."""
    first, _, rest = description.partition("\n\n")
    told = re.findall(r"^([A-Z]\w+) {2,}(.*(?:\n {3,}.*)*)", rest, re.MULTILINE)
    parts = [first, *(f"*{key}*: {_on_one_line(text)}." for key, text in told if key not in TOLD_BY_NUMBERS)]
    return " ".join(part.replace("\n", " ") for part in parts)


def _on_one_line(text: str) -> str:
    """Times and displacements, which stand below each other there, with semicolons between."""
    text = re.sub(r"(?<!:)(?: {2,}(?=\d+ to )|\n +(?=\d+ to |delta))", "; ", text.replace("*", r"\*"))
    return " ".join(text.split())


def numbers(name: str) -> Sheet:
    """What the baseline has of each plant, with seed 0."""
    columns = ["plant", "filter", "outcome", "testbed", *NUMBERS]
    rows = []
    for of_one in baseline.read(baseline.path_of(name, baseline.FOLDER)).runs:
        if of_one.seed == 0:
            values = [of_one.numbers[key][0] for key in NUMBERS.values()]
            outcome = of_one.texts["outcome"].replace("_", " ")
            texts = [of_one.plant, of_one.texts["safety"], outcome, of_one.texts["testbed"]]
            rounded = [None if value is None else float(f"{value:.3g}") for value in values]
            rows.append([*texts, *rounded])
    return Sheet(columns, rows)


def film(run: Run, name: str) -> None:
    """The film of a run, and its last frame as a picture of few colours."""
    speed = float(run.trajectory.t[-1]) / SECONDS
    make = lambda: Film(run.experiment, run.trajectory, run.metrics, speed, FPS, FRAME)  # noqa: E731
    with print_style():
        pixels = make().last()
    picture = Image.fromarray(pixels[..., :3].copy()).quantize(COLOURS, dither=Image.Dither.NONE)
    picture.convert("RGB").save(PICTURES / f"{name}.webp", lossless=True, method=6)
    seconds = float(run.trajectory.t[-1])
    write_film(make, seconds, FILMS / f"{name}.mp4", speed, FPS, FRAME, lambda done, total: None)


if __name__ == "__main__":
    main()
