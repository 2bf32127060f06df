"""The keys of the paper's bibliography: which law stands for each, and why some have none."""

from __future__ import annotations

from typing import NamedTuple


class Citation(NamedTuple):
    """One key.

    Attributes:
        key: of the paper's bibliography.
        law: by name; several with commas; empty where there is none.
        remark: what was looked at, or why there is no law.
    """

    key: str
    law: str
    remark: str


RECALLED = "formula recalled, not checked against the text"

CITATIONS = (
    Citation("kang2015", "displacement, displacement-undirected", RECALLED),
    Citation("An2008", "distance-undirected", RECALLED),
    Citation("Anderson", "distance-undirected", RECALLED),
    Citation("park2015", "distance, distance-undirected", RECALLED),
    Citation("zsy2016", "bearing-undirected", RECALLED),
    Citation("LFF2019", "bearing", "seen through the abstract of arXiv 2501.12355, which extends it"),
    Citation("ycb2009", "persistent", RECALLED),
    Citation("ycb2011", "persistent", f"{RECALLED}; graphs with cycles among the followers are not covered"),
    Citation("kwon2020hybrid", "area, area-undirected", "abstract of arXiv 1912.12952 seen; the gradient it describes"),
    Citation("Jing2019", "cosine", "abstract of arXiv 1803.04276 seen; the gradient of the cosines' errors"),
    Citation("CLM2020tac", "bisector", "abstract of arXiv 1908.01542 seen; the formula is recalled"),
    Citation("CLM2022auto", "angle", "source of eq. (clm), for localisation; it names no control law"),
    Citation("CLM2022tac", "triangular", RECALLED),
    Citation("Lin2016", "laplacian, affine, affine-undirected", "abstract of Lin et al. 2014 seen; gains by search"),
    Citation("Lin2018", "laplacian, affine, affine-undirected", RECALLED),
    Citation("basiri2010", "triangle-angles", RECALLED),
    Citation("bishop2012", "triangle-mixed", "a gradient of its kind: two distances and an angle; formula not found"),
    Citation(
        "magnus2021",
        "",
        "Buckley, Egerstedt: motions that keep inner products of bearings; no control law was found "
        "in what is public. `cosine` descends errors of the same inner products",
    ),
    Citation(
        "Jing2020",
        "",
        "Jing, Wang, flocking with angle-based shape control: no text was found, and no formula could "
        "be established; as flocking it would need velocities, which no law here measures",
    ),
    Citation(
        "fang2023integrated",
        "",
        "integrated localisation and formation control: agents exchange estimates, which no "
        "law here does; its complex constraint is the one of `laplacian` and `redundant`",
    ),
    Citation("fang2023distributed", "", "as fang2023integrated: agents communicate; constraint as `laplacian`"),
    Citation("Fangtac", "", "localisation, no control law"),
    Citation("Fangauto", "", "localisation and maneuver, with communication; constraint as `laplacian`"),
    Citation("eren2003", "", "states the problem, names no law"),
)
