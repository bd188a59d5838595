"""A TCP proxy between apps and the station that damages the traffic: `recon sim proxy`.

It delays, stalls, throttles, corrupts and resets connections, of simulated and of real apps alike.
`damage` is pure and seeded; `relay` has the sockets and the clock.
"""

from recon.sim.proxy.damage import Damage
from recon.sim.proxy.relay import ProxyConfig, Towards, run_proxy
