"""JaxRobotarium's simulator, rps_jax: all steps in one compiled scan; `python with_rps_jax.py none|certificate`."""

import sys
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from rps_jax.robotarium import Robotarium
from rps_jax.utilities.barrier_certificates2 import create_robust_barriers
from work import STARTS, commands, told

BARRIER = sys.argv[1]


@partial(jax.jit, static_argnames="steps")
def advance(poses, steps: int):
    robots = Robotarium(number_of_robots=len(STARTS), initial_conditions=poses[0])
    barrier = None if BARRIER == "none" else create_robust_barriers(safety_radius=0.155)

    def one(pose):
        unicycle = jnp.stack(commands(jnp, *pose))
        return robots.batch_step(pose, unicycle if barrier is None else barrier(unicycle, pose, []))

    return jax.lax.scan(lambda state, _: (jax.vmap(one)(state), None), poses, None, steps)[0]


def work(runs: int, steps: int) -> None:
    start = np.array([[x, y, 0.0] for x, y in STARTS]).T
    jax.block_until_ready(advance(jnp.broadcast_to(jnp.array(start), (runs, *start.shape)), steps))


sizes = [(1, 1818), (1000, 1818)] if BARRIER == "none" else [(1, 100)]
told("rps_jax", f"of its repository, jax {jax.__version__}", work, *sizes)
