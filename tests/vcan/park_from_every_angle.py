"""Plant and ECU as two processes on vcan0; the stalk goes off at 360 crank angles, and the wipers must park each time.

Takes a quarter of an hour, so it is no test of the suite: hilplant vcan python tests/vcan/park_from_every_angle.py
"""

import math
import socket
import struct
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import cantools

DATABASE = cantools.database.load_file(Path(__file__).parents[2] / "dbc" / "wiper.dbc")
HILPLANT = (sys.executable, "-m", "hilplant")
PATIENCE_S = 30.0
#: Where the cache of compiled code is cold, a guest compiles for minutes before it serves.
START_PATIENCE_S = 600.0
#: Half the window of the default bench's park switch.
WITHIN_DEG = 7.0


class Bus:
    """The last frame of each message, and a way to send."""

    def __init__(self) -> None:
        self._socket = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        self._socket.bind(("vcan0",))
        self._socket.settimeout(START_PATIENCE_S)
        self.last: dict[str, dict[str, Any]] = {}

    def receive(self) -> str:
        """Take in one frame and return its message's name."""
        can_id, length, data = struct.unpack("=IB3x8s", self._socket.recv(16))
        message = DATABASE.get_message_by_frame_id(can_id)
        self.last[message.name] = message.decode(data[:length])
        return str(message.name)

    def stalk(self, position: str) -> None:
        """Move the stalk."""
        signals = {"Master_Input": position, "Intermittent_Switch": 1, "Flick_Wipe": 0, "Wash": 0, "Automatic": 0}
        data = DATABASE.encode_message("StalkCommand", signals)
        frame_id = DATABASE.get_message_by_name("StalkCommand").frame_id
        self._socket.send(struct.pack("=IB3x8s", frame_id, len(data), data))

    def turning(self) -> tuple[float, float]:
        """Wait for the next angle of the crank; return it [deg] with its speed [deg/s]."""
        while self.receive() != "Linkage" or "MotorStatus" not in self.last:
            pass
        factor = 180.0 / math.pi
        return self.last["Linkage"]["CrankAngle"] * factor, self.last["MotorStatus"]["CrankSpeed"] * factor


def switch_off_at(bus: Bus, target_deg: float) -> float:
    """Start, move the stalk off when the crank comes to an angle, wait for rest; return where it was [deg]."""
    bus.stalk("Fast" if round(target_deg) % 2 else "Slow")
    while True:
        angle, speed = bus.turning()
        left = (target_deg - angle) % 360.0
        if speed > 60.0 and left < 0.03 * speed:
            break
    time.sleep(left / speed)
    bus.stalk("Off")
    switched = (angle + left) % 360.0
    end_s = time.monotonic() + PATIENCE_S
    while not _resting(bus):
        assert time.monotonic() < end_s, f"never at rest after {switched:.1f} deg: {bus.last}"
        bus.turning()
    return switched


def _resting(bus: Bus) -> bool:
    ecu, motor = bus.last.get("EcuStatus", {}), bus.last["MotorStatus"]
    return str(ecu.get("EcuState")) == "Off" and motor["CrankSpeed"] == 0.0 and motor["TerminalVoltage"] == 0.0


def main() -> int:
    """Switch off at each degree; say how far from park the crank stopped at most."""
    nodes = [subprocess.Popen([*HILPLANT, name, "default"], stdin=subprocess.DEVNULL) for name in ("run", "ecu")]
    bus, offs, worst = Bus(), [], 0.0
    while "EcuStatus" not in bus.last or "Linkage" not in bus.last:
        bus.receive()
    try:
        for degree in range(360):
            offs.append(switch_off_at(bus, float(degree)))
            angle, _ = bus.turning()
            worst = max(worst, min(angle, 360.0 - angle))
            fault = str(bus.last["EcuStatus"]["EcuFault"])
            assert fault == "None", f"fault {fault} after switching off at {degree} deg"
            assert worst <= WITHIN_DEG, f"switched off at {degree} deg it stopped at {angle:.1f} deg"
            if degree % 30 == 29:
                print(f"{degree + 1} stops, at most {worst:.2f} deg from park", flush=True)
    finally:
        for node in nodes:
            node.terminate()
            node.wait()
    print(f"{len(offs)} passed, 0 failed")
    return 0


if __name__ == "__main__":
    sys.exit(main())
