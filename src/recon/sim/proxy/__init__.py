"""A TCP proxy between apps and the station that damages what passes: `recon sim proxy`."""

from recon.sim.proxy.damage import Damage
from recon.sim.proxy.relay import ProxyConfig, Towards, run_proxy

__all__ = ["Damage", "ProxyConfig", "Towards", "run_proxy"]
