"""A scenario of one's own to begin with: small, commented, and running as it is."""

from __future__ import annotations

OWN_LAW = """
# The law stands in {law} beside this file: read it, change it, and see what it is like by `formation audit {file}`.
[law]
name = "own"
file = "{law}"
factory = "BoundedAngleLaw"
parameters = {{ v_max = 0.1 }}
"""

SCENARIO = """# Four robots form a square around a leader and a first follower that stand still. Change what you like:
#
#     formation show {file}      what it promises, before anything moves
#     formation run {file}       runs it; `--set key=value` tries a change without editing
#     formation keys{blank}       every key that may stand here: its values, its default, its meaning

title = "{title}"
duration_s = 40.0    # simulated seconds

# Each agent senses the relative positions of its neighbours, which have smaller numbers: none, agent 1, then two.
# `start` is where its projected point begins, `target` where it stands in the wanted shape, both x, y in metres. The
# shape may end anywhere, of any size and turned: agents 1 and 2, which stand still, decide that by where they start.
agents = [
    {{ id = 1, neighbours = [],     start = [-0.4, -0.4], target = [0.0, 0.0] }},
    {{ id = 2, neighbours = [1],    start = [0.4, -0.4],  target = [1.0, 0.0] }},
    {{ id = 3, neighbours = [1, 2], start = [0.9, 0.2],   target = [1.0, 1.0] }},
    {{ id = 4, neighbours = [1, 3], start = [-0.8, 0.1],  target = [0.0, 1.0] }},
]
{own_law}
[safety]
filter = "decentralised"    # "none" follows the law literally, through other robots too

[plant]
name = "pymunk"    # bodies with mass; "single_integrator" is the theorem's, "unicycle" and "saturated" lie between

[sensor]
bearing_noise_deg = 0.0    # standard deviation of what is measured; with noise, runs are judged by their mean errors
"""


def scenario(name: str, law: str | None) -> str:
    """The text of a scenario file.

    Args:
        name: of its file, without ``.toml``.
        law: name of the file of its own law beside it; None for the paper's law.
    """
    file = f"{name}.toml"
    own_law = "" if law is None else OWN_LAW.format(law=law, file=file)
    return SCENARIO.format(file=file, blank=" " * len(file), title=name.replace("-", " "), own_law=own_law)
