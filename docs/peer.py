"""Run a script on the public simulator and write where it ended, for docs/scripts_on_rps.py.

    PYTHONPATH=RPS python docs/peer.py SCRIPT OUT SEED LIMIT STARTS [ARGS]

Needs what ``rps`` needs, nothing of this project. STARTS is ``exact`` for robots that stand at their initial
conditions at once, ``driven`` for its own drive there. Figures are made and never shown; a step waits for nothing, and
on the script's clock it takes 0.033 s. With RPS_EXACT=1 its solver goes on to 1e-9 instead of 1e-2, what it answers
below 1e-7 m/s is 0 (2.1), and robots move on arcs instead of by Euler. With RPS_NUDGE=METRES the first robot starts so
much further in x.
"""

import json
import os
import random
import runpy
import sys
import time
import traceback

os.environ["MPLBACKEND"] = "agg"
import matplotlib.pyplot as plt
import numpy as np
import rps.robotarium as simulator
from matplotlib.backends.backend_agg import FigureCanvasAgg

FigureCanvasAgg.draw_idle = lambda self, *a, **k: None
FigureCanvasAgg.start_event_loop = lambda self, *a, **k: None
plt.show = lambda *a, **k: None

STUCK = 6000
"""Steps, 198 s, after which robots on their way to the start count as stuck."""

LEFT = 1e-7
"""m/s, below which the solver's answer to a robot that is to stand is what its tolerance leaves."""


class Limit(BaseException):
    """The script has not come to its end."""


def main() -> None:
    script, out, seed, limit, starts, *arguments = sys.argv[1:]
    made, base, second = [], simulator.Robotarium, hasattr(simulator.Robotarium, "debug")
    passed, exact = [0.0], os.environ.get("RPS_EXACT") == "1"
    begin, real_sleep = time.time(), time.sleep

    class Robotarium(base):
        def __init__(self, *given, **named):
            named["sim_in_real_time"] = False
            if second and starts == "exact":
                named["skip_initialization"] = True
            made.append(self)
            super().__init__(*given, **named)
            poses = self._poses if second else self.poses
            poses[0, 0] += float(os.environ.get("RPS_NUDGE", "0"))
            self.start = np.array(poses)

        def step(self):
            before = np.array(self._poses if second else self.poses)
            super().step()
            if exact:
                v, omega = self._velocities if second else self.velocities
                turn = 0.033 * omega
                chord = 0.033 * v * np.sinc(turn / (2.0 * np.pi))
                after = self._poses if second else self.poses
                after[:2] = before[:2] + chord * np.array([np.cos(before[2] + turn / 2), np.sin(before[2] + turn / 2)])
            passed[0] += 0.033
            steps = self._iteration if second else self._iterations
            if steps >= int(limit) or (getattr(self, "initializing", False) and steps >= STUCK):
                raise Limit

    simulator.Robotarium = Robotarium
    if exact:
        import rps.utilities.barrier_certificates  # sets its solver's tolerances when it is loaded
        from cvxopt import solvers

        solvers.options |= {"reltol": 1e-9, "abstol": 1e-9, "feastol": 1e-9, "maxiters": 100}
        if second:
            certificates, solve = rps.utilities.barrier_certificates, rps.utilities.barrier_certificates._solve_qp

            def solved(*given):
                answer = solve(*given)
                return answer if answer is None else np.where(np.abs(answer) < LEFT, 0.0, answer)

            certificates._solve_qp = solved

    def now():
        passed[0] += 1e-6
        return begin + passed[0]

    def sleep(seconds):
        passed[0] += seconds
        real_sleep(0)

    time.time, time.sleep = now, sleep
    np.random.seed(int(seed))  # noqa: NPY002 scripts draw from it
    random.seed(int(seed))
    sys.argv = [script, *arguments]
    sys.path[0] = os.path.dirname(os.path.abspath(script))
    outcome, text = "ended", ""
    try:
        runpy.run_path(script, run_name="__main__")
    except Limit:
        outcome = "stopped"
    except SystemExit as end:
        outcome, text = "exited", str(end.code or "")
    except BaseException as error:
        outcome, text = "raised", f"{type(error).__name__}: {error}"
        traceback.print_exc()
    runs = []
    for robots in made:
        poses = getattr(robots, "_poses" if second else "poses", np.zeros((3, 0)))
        errors = getattr(robots, "_errors", {})
        hard = {"robots_too_close", "robots_outside_boundaries", "collision", "boundary"} & set(errors)
        runs.append(
            {
                "robots": int(np.shape(poses)[1]),
                "steps": getattr(robots, "_iteration" if second else "_iterations", 0),
                "start": np.asarray(getattr(robots, "start", poses)).tolist(),
                "end": np.asarray(poses).tolist(),
                "accepted": not hard,
                "initialising": bool(getattr(robots, "initializing", False)),
            }
        )
    with open(out, "w") as file:
        json.dump({"outcome": outcome, "text": text, "runs": runs}, file)


if __name__ == "__main__":
    main()
