"""A demonstration that needs no CAN in the kernel and no privileges: plant and ECU on an in-memory bus."""

from hilplant.demo.command import run_demo

__all__ = ["run_demo"]
