"""Bare Chipmunk by pymunk: the six bodies of our contact world, four sub-steps a period, no law and no wheels."""

import pymunk
from work import PERIOD, STARTS, told

SUBSTEPS = 4


def work(runs: int, steps: int) -> None:
    space = pymunk.Space()
    for place in STARTS:
        body = pymunk.Body(0.2, 0.0004)
        body.position = place
        space.add(body, pymunk.Poly.create_box(body, (0.11, 0.1)))
    for _ in range(steps * SUBSTEPS):
        space.step(PERIOD / SUBSTEPS)


told("pymunk", pymunk.version, work, (1, 1818))
