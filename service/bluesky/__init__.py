"""An open bench for Bluesky's RunEngine: devices that satisfy its protocols, by structure alone.

Nothing here imports Bluesky (`pip install darkflat[bluesky]` brings it). What the RunEngine records
is its own; a recording that calibrates is made by `darkflat sweep` or the service.
"""

from service.bluesky.devices import BenchDevices, devices_of

__all__ = ["BenchDevices", "devices_of"]
