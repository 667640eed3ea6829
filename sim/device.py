"""Warp, started quietly, and the device that a run was asked for."""

import functools

import warp as wp

from sim.errors import DeviceError
from sim.native_output import silenced_native_output

__all__ = ["start_device"]


@functools.cache
def _start_warp() -> None:
    """Initialise Warp without its banner and without its native library's note on CUDA."""
    wp.config.log_level = wp.LOG_WARNING
    with silenced_native_output():
        wp.init()


def start_device(name: str) -> str:
    """Start Warp and return the name of the device, which exists.

    Raises:
        DeviceError: there is no such device on this machine.
    """
    _start_warp()
    available = [str(device) for device in wp.get_devices()]
    if name not in available:
        raise DeviceError(f"device: no device {name!r} here; allowed: {', '.join(available)}")
    return name
