"""Safety filters: what stands between a law and the wheels, so that robots do not collide."""

from __future__ import annotations

from robots.arena import Arena
from robots.drive import DifferentialDrive
from robots.nid import NearIdentityDiffeomorphism
from robots.safety.barrier import FilterSettings as FilterSettings
from robots.safety.barrier import delayed_settings as delayed_settings
from robots.safety.barrier import sampling_loss as sampling_loss
from robots.safety.protocol import Distributed as Distributed
from robots.safety.protocol import Noise as Noise
from robots.safety.protocol import SafetyFilter as SafetyFilter

__all__ = ["FILTERS", "FilterSettings", "Noise", "SafetyFilter", "make_filter", "sampling_loss"]

FILTERS = ("none", "decentralised", "centralised", "robotarium")
"""The filters by the name that scenario files and the command line use."""


def make_filter(
    name: str,
    shape: tuple[int, ...],
    drive: DifferentialDrive,
    nid: NearIdentityDiffeomorphism,
    settings: FilterSettings,
    arena: Arena | None = None,
) -> SafetyFilter | None:
    """The filter ``name`` for robots (..., n), ``None`` for ``"none"``.

    Raises:
        ValueError: ``name`` is not one of :data:`FILTERS`.
    """
    if name == "none":
        return None
    if name == "decentralised":
        from robots.safety.decentralised import DecentralisedFilter

        return DecentralisedFilter(shape, drive, nid, settings, arena)
    if name == "centralised":
        from robots.safety.centralised import CentralisedFilter

        return CentralisedFilter(shape, drive, nid, settings, arena)
    if name == "robotarium":
        from robots.safety.certificate import RobotariumCertificate

        return RobotariumCertificate(shape, arena)
    raise ValueError(f"safety must be one of {', '.join(FILTERS)}, got {name!r}")
