"""VMAS: its differential drive and contact, the law as commands."""

from importlib.metadata import version

import torch
from vmas import make_env
from vmas.simulator.core import Agent, Sphere, World
from vmas.simulator.dynamics.diff_drive import DiffDrive
from vmas.simulator.scenario import BaseScenario
from work import PERIOD, STARTS, commands, told

torch.set_num_threads(1)


class Shape(BaseScenario):
    """Six robots, no reward."""

    def make_world(self, batch_dim, device, **kwargs):
        world = World(batch_dim, device, dt=PERIOD, drag=0.0)
        for number in range(len(STARTS)):
            robot = Agent(f"robot_{number}", shape=Sphere(0.055), u_range=[9.0, 9.0], dynamics=DiffDrive(world))
            world.add_agent(robot)
        return world

    def reset_world_at(self, env_index=None):
        for robot, place in zip(self.world.agents, STARTS, strict=True):
            robot.set_pos(torch.tensor(place), batch_index=env_index)

    def reward(self, agent):
        return torch.zeros(self.world.batch_dim)

    def observation(self, agent):
        return torch.cat([agent.state.pos, agent.state.rot], dim=-1)


def work(runs: int, steps: int) -> None:
    world = make_env(Shape(), num_envs=runs, device="cpu", continuous_actions=True, seed=0)
    states = torch.stack(world.reset(), dim=1)
    for _ in range(steps):
        v, omega = commands(torch, *states.unbind(-1))
        actions = torch.stack([v, omega], dim=-1).clamp(-9.0, 9.0)
        states = torch.stack(world.step(list(actions.unbind(1)))[0], dim=1)


told("vmas", version("vmas"), work, (1, 200), (1000, 200))
