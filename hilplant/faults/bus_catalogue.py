"""The faults of the bus: what becomes of the frames that the plant hears or sends."""

from hilplant.bus import frame_faults as on
from hilplant.bus.frame_fault import FrameFault
from hilplant.faults.fault import FaultDefinition, Quantity

_LATER = Quantity("time_s", 0.0, 10.0, "how long after the first [s]", 0.0)


def _time(meaning: str) -> tuple[Quantity]:
    return (Quantity("time_s", 0.0, 10.0, meaning),)


def _fault(  # noqa: PLR0913, PLR0917
    name: str,
    meaning: str,
    effect: str,
    on_frames: type[FrameFault],
    quantities: tuple[Quantity, ...] = (),
    about: tuple[str, ...] = (),
) -> FaultDefinition:
    return FaultDefinition(name, "bus", meaning, effect, (), quantities, on_frames, about)


#: Every fault of the bus.
BUS_FAULTS: tuple[FaultDefinition, ...] = (
    _fault("frames_lost", "frames are lost", "each is lost with the probability `share`", on.Dropped,
           (Quantity("share", 0.0, 1.0, "share of the frames that is lost", 1.0),)),
    _fault("frames_delayed", "frames come late", "each passes `time_s` later", on.Delayed, _time("delay [s]")),
    _fault("frames_jitter", "frames come irregularly", "each passes 0 to `time_s` later, in their order", on.Jittered,
           _time("longest delay [s]")),
    _fault("frames_doubled", "frames come twice", "each passes, and again `time_s` later", on.Duplicated, (_LATER,)),
    _fault("frames_swapped", "frames come in the wrong order", "of each two of a message the second passes first",
           on.Reordered),
    _fault("frames_short", "frames have the wrong length", "`bytes` are missing at the end", on.Shortened,
           (Quantity("bytes", 1.0, 64.0, "whole bytes that are missing", 1.0),)),
    _fault("counter_stuck", "the counter stands", "counter as in the frame before; right checksum", on.CounterStuck,
           about=("message", "protection")),
    _fault("counter_jumps", "the counter jumps", "counter + `steps`; right checksum", on.CounterJumps,
           (Quantity("steps", 1.0, 65535.0, "whole steps that the counter is ahead", 5.0),), ("message", "protection")),
    _fault("crc_wrong", "the checksum is wrong", "one bit of the header outside the counter is turned over",
           on.WrongChecksum, about=("message", "protection")),
    _fault("value_wrong", "a wrong value with the right checksum", "the signal is `value`; own counter, right checksum",
           on.WrongValue, about=("message", "signal", "value")),
    _fault("value_invalid", "a signal is marked as not available", "all bits of the signal are 1; right checksum",
           on.WrongValue, about=("message", "signal")),
    _fault("frames_stale", "old data with a counter that runs", "data of the fault's first frame; right checksum",
           on.Stale, about=("message",)),
    _fault("cycle_wrong", "a message has another cycle time", "the newest data every `time_s`; own running counter",
           on.Paced, (Quantity("time_s", 0.001, 10.0, "cycle time [s]"),), ("message",)),
    _fault("babble", "a third node babbles", "`frames` frames of 8 bytes of 0 in each tick", on.Babbling,
           (Quantity("identifier", 0.0, 2047.0, "their identifier", 0.0),
            Quantity("frames", 1.0, 100.0, "frames a tick", 1.0)), ("direction",)),
    _fault("node_silent", "a node sends nothing", "no frame passes", on.Silent, about=("direction",)),
    _fault("node_restarts", "a node starts late, or again", "no frame passes; then the counters begin at 0",
           on.Restarted, about=("direction",)),
    _fault("bus_off", "a node is off the bus", "it neither sends nor hears; the plant sees its own as a link that is "
           "down", on.BusOff, about=("direction",)),
)  # fmt: skip
