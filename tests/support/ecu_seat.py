"""The ECU on a bus that a test holds in its hands."""

import cantools
from support.wire import Wire

from hilplant.bench.ecu_side import EcuSide
from hilplant.bus.codec import ReceivedMessage, SentMessage, SignalMapping, Timing, received_message, sent_message
from hilplant.bus.frame import Frame
from hilplant.ecu.node import EcuNode
from hilplant.ecu.vocabulary import Master, RelaySettings, Stalk
from hilplant.signals import ECU_FAULTS, ECU_RX, ECU_STATES, ECU_TX
from hilplant.units import MILLISECOND_NS

STATES, FAULTS = (" ".join(f'{i} "{name}"' for i, name in enumerate(names)) for names in (ECU_STATES, ECU_FAULTS))
DATABASE = cantools.database.load_string(
    f"""
VERSION ""
NS_ :
BS_:
BU_: ECU PLANT
BO_ 256 Relays: 2 ECU
 SG_ Fast : 8|8@1+ (1,0) [0|1] "" PLANT
 SG_ On : 0|8@1+ (1,0) [0|1] "" PLANT
BO_ 257 Supply: 2 ECU
 SG_ Volts : 0|16@1+ (0.01,0) [0|40] "V" PLANT
BO_ 258 Stalk: 2 PLANT
 SG_ Stage : 0|8@1+ (1,0) [0|3] "" ECU
 SG_ Flick : 8|1@1+ (1,0) [0|1] "" ECU
BO_ 259 Told: 2 ECU
 SG_ State : 0|8@1+ (1,0) [0|20] "" PLANT
 SG_ Fault : 8|8@1+ (1,0) [0|8] "" PLANT
BO_ 512 Park: 1 PLANT
 SG_ Open : 0|1@1+ (1,0) [0|1] "" ECU
BO_ 513 Motor: 4 PLANT
 SG_ Current : 0|16@1- (0.01,0) [-100|100] "A" ECU
 SG_ Battery : 16|16@1+ (0.01,0) [0|40] "V" ECU
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;
BA_DEF_DEF_ "GenMsgCycleTime" 20;
VAL_ 258 Stage 3 "fast" 2 "slow" 1 "intermittent" 0 "off" ;
VAL_ 259 State {STATES} ;
VAL_ 259 Fault {FAULTS} ;
""",
    "dbc",
)
TIMEOUT_NS = 100 * MILLISECOND_NS
CLOSED, OPEN = b"\x00", b"\x01"
OFF, SLOW, FAST = Stalk(), Stalk(Master.SLOW), Stalk(Master.FAST)


def received(name: str, timeout_ns: int = TIMEOUT_NS, **signals: SignalMapping | str) -> ReceivedMessage:
    mapping = [at if isinstance(at, SignalMapping) else SignalMapping(signal, at) for signal, at in signals.items()]
    return received_message(DATABASE.get_message_by_name(name), mapping, ECU_RX, timeout_ns)


def sent(name: str, **plant_signals: str) -> SentMessage:
    mapping = [SignalMapping(signal, plant_signal) for signal, plant_signal in plant_signals.items()]
    timing = Timing(on_change=tuple(plant_signals.values()))
    return sent_message(DATABASE.get_message_by_name(name), mapping, ECU_TX, timing)


def side(stalk_timeout_ns: int = 0) -> EcuSide:
    park = received("Park", Open=SignalMapping("Open", "park_contact", invert=True))
    motor = received("Motor", Current="current_a", Battery="supply_v")
    relays = sent("Relays", On="relay_on", Fast="relay_fast")
    stalk = received("Stalk", stalk_timeout_ns, Stage="master_input", Flick="flick_wipe")
    told = sent("Told", State="ecu_state", Fault="ecu_fault")
    return EcuSide((park, motor), (relays, sent("Supply", Volts="supply_v")), (stalk,), (told,))


class Seat:
    """The ECU, its wire and a clock: one place to drive it from."""

    def __init__(self, stalk_timeout_ns: int = 0) -> None:
        self.wire = Wire()
        self.now_ms = 0
        self.node = EcuNode(side(stalk_timeout_ns), self.wire, RelaySettings())

    def poll(self, stalk: Stalk, park: bytes | None, milliseconds: int = 1, motor: bytes | None = None) -> list[Frame]:
        """Poll every millisecond for a while with a park frame each time; return what was sent to the relays."""
        self.wire.sent.clear()
        for _ in range(milliseconds):
            for identifier, data in ((512, park), (513, motor)):
                if data is not None:
                    self.wire.arriving.append(Frame(identifier, data))
            self.node.poll(self.now_ms * MILLISECOND_NS, stalk)
            self.now_ms += 1
        return [frame for frame in self.wire.sent if frame.identifier == 256]

    def hear(self, stage: int, flick: bool = False) -> None:
        self.wire.arriving.append(Frame(258, bytes([stage, flick])))

    def told(self) -> tuple[str, str]:
        """Return state and fault in the ECU's last message about itself."""
        data = next(frame.data for frame in reversed(self.wire.sent) if frame.identifier == 259)
        return ECU_STATES[data[0]], ECU_FAULTS[data[1]]


REST, RUN, RUN_FAST = Frame(256, b"\x00\x00"), Frame(256, b"\x01\x00"), Frame(256, b"\x01\x01")


def motor(current_a: float, supply_v: float) -> bytes:
    return DATABASE.encode_message("Motor", {"Current": current_a, "Battery": supply_v})
