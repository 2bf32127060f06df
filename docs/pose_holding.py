"""How well robots hold their poses under the controller of ``go_to_pose_clf``: a script for rps 2.1, for both sides.

    formation script docs/pose_holding.py --plant pymunk
    PYTHONPATH=RPS PYTHON docs/pose_holding.py

Three starts of six robots, 3000 steps. Counted from when all have been at their poses, to within 0.05 m and 0.2 rad:
the share of robot-steps at the pose, and the furthest that an axle has been from its place.
"""

import numpy as np
from rps.robotarium import Robotarium
from rps.utilities.controllers import create_pose_controller_clf

STEPS = 3000
PLACES = np.array([[-1.0, 0.0, 1.0, -1.0, 0.0, 1.0], [0.5, 0.5, 0.5, -0.5, -0.5, -0.5]])


def main():
    for seed in range(3):
        rng = np.random.default_rng(seed)
        goals = np.vstack([PLACES, rng.uniform(-3.0, 3.0, 6)])
        start = goals + rng.uniform(-0.3, 0.3, (3, 6))
        robots = Robotarium(
            number_of_robots=6,
            show_figure=False,
            sim_in_real_time=False,
            initial_conditions=start,
            skip_initialization=True,
        )
        controller, seen = create_pose_controller_clf(), []
        for _ in range(STEPS):
            x = robots.get_poses()
            seen.append(x)
            robots.set_velocities(np.arange(6), controller(x, goals))
            robots.step()
        off = np.array(seen) - goals
        away = np.hypot(off[:, 0], off[:, 1])
        turned = np.abs(np.arctan2(np.sin(off[:, 2]), np.cos(off[:, 2])))
        at = (away <= 0.05) & (turned <= 0.2)
        begin = max(np.flatnonzero(each)[0] if each.any() else STEPS - 1 for each in at.T)
        print(
            f"start {seed}: all have been there after {begin} steps; {at[begin:].mean():.2f} of robot-steps at the "
            f"pose, axles at most {1e3 * away[begin:].max():.1f} mm away"
        )


if __name__ == "__main__":
    main()
