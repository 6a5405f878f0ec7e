"""Plays a test sequence: with a bench's plant in virtual time, or on a real bus as the node that commands the rig."""

import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from hilplant.atomic_write import write_text
from hilplant.failure import Failure
from hilplant.identify.sequence import Player, SequenceStage, advance, figure_5_4, informative, play, scenario_text

SEQUENCES: dict[str, Callable[[Sequence[float]], list[SequenceStage]]] = {
    "figure-5-4": figure_5_4,
    "informative": informative,
}


def stages_of(kind: str, voltages: str) -> list[SequenceStage]:
    """Return a sequence by its name and its voltages as text, such as "10,12,14,16".

    Raises
    ------
    Failure
        For an unknown name or a voltage that is none.

    """
    if kind not in SEQUENCES:
        raise Failure(f"there is no sequence '{kind}'; known: {', '.join(SEQUENCES)}")
    try:
        volts = [float(text) for text in voltages.split(",")]
    except ValueError:
        raise Failure(f"--volts {voltages}: write numbers with commas between, such as 10,12,14,16") from None
    if any(not 0.0 < each <= 40.0 for each in volts):
        raise Failure(f"--volts {voltages}: each must be above 0 and at most 40 V")
    return SEQUENCES[kind](volts)


def write_scenario(bench_name: str, stages: Sequence[SequenceStage], out: Path) -> str:
    """Play a sequence with a bench's plant; write what it was told as a scenario, and return one line about it."""
    from hilplant.bench import load_bench
    from hilplant.models.plant import tick
    from hilplant.signals import INPUT_INDEX, OUTPUT_INDEX, OUTPUTS
    from hilplant.units import SECOND_NS

    bench = load_bench(bench_name)
    state, inputs, outputs = bench.state_row.copy(), bench.input_row.copy(), np.zeros(len(OUTPUTS))

    def contact_after(stage: SequenceStage) -> bool:
        for name, value in (("relay_on", stage.on), ("relay_fast", stage.fast), ("supply_v", stage.voltage_v)):
            inputs[INPUT_INDEX[name]] = float(value)
        tick(state, inputs, bench.parameter_row, bench.tables, outputs)
        return bool(outputs[OUTPUT_INDEX["park_contact"]] > 0.5)

    begun = play(stages, bench.step_ns / SECOND_NS, contact_after)
    _refuse_stuck(begun)
    write_text(out, scenario_text(begun, f"identification of {bench.name}"))
    return f"{out}: {len(begun) - 1} stages, {begun[-1][0]:.4g} s; hilplant simulate {bench_name} {out} --out data.csv"


def _refuse_stuck(begun: Sequence[tuple[float, SequenceStage]]) -> None:
    for (start_s, stage), (end_s, _) in pairwise(begun):
        if stage.edges and end_s - start_s >= stage.longest_s - 1e-9:
            text = f"the wiper does not come to park {stage.edges} times in {stage.longest_s:g} s"
            raise Failure(f"{text} at {stage.voltage_v:g} V; it is too weak there, so take higher --volts")


def play_on_bus(
    bench_name: str, stages: Sequence[SequenceStage], channel: str | None, tell: Callable[[str], None]
) -> None:
    """Command a rig through a bench's mapping: relays and supply are sent, the park contact is read.

    At the end, and on SIGTERM and Ctrl-C, the relays are released. A silent park switch ends the sequence.

    Raises
    ------
    Failure
        When the bench maps no message for a relay, for the supply or for the park contact, or the switch stays silent.

    """
    from hilplant.bench import load_bench
    from hilplant.bus.link import LinkSettings
    from hilplant.bus.node import Node
    from hilplant.bus.transport import open_transport
    from hilplant.runtime.clock import clock_at
    from hilplant.runtime.server import StopRequest, ended_by_signals
    from hilplant.signals import ECU_RX, ECU_TX

    bench = load_bench(bench_name).at(channel)
    places = {signal.name: index for index, signal in enumerate(ECU_TX)}
    side = bench.ecu_side()
    park = next(index for index, signal in enumerate(ECU_RX) if signal.name == "park_contact")
    heard = [message for message in side.receive if park in message.targets]
    names = ("relay_on", "relay_fast", "supply_v")
    _refuse_unmapped(bench_name, bool(heard), [n for n in names if not any(places[n] in m.sources for m in side.send)])
    values = [signal.default for signal in ECU_TX]
    received = [math.nan] * len(ECU_RX)
    wanted = {places[name] for name in names}
    sent = [message for message in side.send if wanted & set(message.sources)]
    transport = open_transport(bench.interface)
    node, stop = Node(heard, sent, transport, LinkSettings(), received), StopRequest()
    with ended_by_signals(stop):
        try:
            drive(Rig(node, values, [places[name] for name in names], park), stages, clock_at(bench.pace), stop, tell)
        finally:
            for place in (places["relay_on"], places["relay_fast"]):
                values[place] = 0.0
            node.send_all(values)
            node.close()


class Rig:
    """A node with the places of what it says (relay, fast relay, supply) and hears (park contact)."""

    def __init__(self, node: Any, values: list[float], places: list[int], park: int) -> None:
        self.node, self.values, self.places, self.park = node, values, places, park

    def command(self, stage: SequenceStage, now_ns: int) -> None:
        """Send what a stage wants, when it is due."""
        for place, value in zip(self.places, (stage.on, stage.fast, stage.voltage_v), strict=True):
            self.values[place] = float(value)
        self.node.send(now_ns, self.values)

    @property
    def contact(self) -> float:
        """The park contact, nan while it is not known."""
        return math.nan if self.node.lost else float(self.node.values[self.park])


#: How often the rig is looked at, and how long its park switch may be silent.
_PERIOD_NS, _SILENCE_NS = 2_000_000, 2_000_000_000


def drive(
    rig: Rig, stages: Sequence[SequenceStage], clock: Any, stop: Callable[[], bool], tell: Callable[[str], None]
) -> None:
    """Go through the stages until the last has ended, or `stop` says so.

    Raises
    ------
    Failure
        When the park contact is unknown for two seconds.

    """
    start_ns, heard_ns, player, told = clock.now_ns(), clock.now_ns(), Player(), -1
    while player.place < len(stages) and not stop():
        now_ns = clock.now_ns()
        rig.node.receive(now_ns)
        if math.isnan(rig.contact):
            if now_ns - heard_ns > _SILENCE_NS:
                raise Failure("the park switch is silent; the sequence was ended and the relays released")
        else:
            heard_ns = now_ns
            player = advance(player, stages, rig.contact > 0.5, (now_ns - start_ns) / 1e9)
        if player.place < len(stages):
            if player.place != told:
                tell(_line(stages[player.place], (now_ns - start_ns) / 1e9))
                told = player.place
            rig.command(stages[player.place], now_ns)
        clock.sleep_until_ns(now_ns + _PERIOD_NS)


def _line(stage: SequenceStage, now_s: float) -> str:
    what = "off" if not stage.on else f"{'fast' if stage.fast else 'slow'}, {stage.voltage_v:g} V"
    return f"{now_s:8.3f} s  {what}"


def _refuse_unmapped(bench_name: str, hears_park: bool, unsaid: Sequence[str]) -> None:
    if not hears_park:
        raise Failure(f"{bench_name}: no message that the plant sends carries park_contact; map one under bus: send:")
    if unsaid:
        raise Failure(f"{bench_name}: no message that the plant receives carries {', '.join(unsaid)}; map one")
