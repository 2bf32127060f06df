"""Compile ahead what most tests run; `make test` does it while the linter has the other processor.

Processes that start together on a fresh machine would each compile all of it.
"""

import numpy as np

from robots.closest_pairs import closest_pairs
from scenarios.studies.sweep.row import run_batch
from scenarios.studies.sweep.seeds import parse_seeds
from scenarios.studies.sweep.study import open_study
from scenarios.studies.sweep.variations import parse_variations

if __name__ == "__main__":
    changes = ("duration_s=0.1",)
    plants = parse_variations(("plant.name=pymunk,saturated,single_integrator",), changes)
    for batch in open_study("shape", changes, plants, parse_seeds("0:2")).batches():
        run_batch(batch)
    closest_pairs(np.eye(2)[None])
