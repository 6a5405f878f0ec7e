"""Which file may touch the world: the bus, the clock, the date, the terminal, the pictures."""

from typing import Any

#: The stand-in ECU decides without knowing that there is a bus, a bench or a clock.
PURE_ECU = {
    f"ecu/{name}.py"
    for name in ("chart", "conditions", "mermaid", "relay_controller", "sensing", "stalk", "vocabulary")
}
#: The only files that open a CAN bus or read and write a CAN log.
CAN_FILES = {
    "bus/transport.py",
    "bus/socketcan.py",
    "recording/blf_log.py",
    "recording/frame_logs.py",
    "recording/read_logs.py",
    "doctor/can_bus.py",
    "testing/virtual_can.py",
}
#: Of the time module. The loop's clock is one file; the others are start-up, other processes and tools.
CLOCK_FILES = {
    "runtime/clock.py": {"monotonic_ns", "sleep", "thread_time_ns"},
    "runtime/health.py": {"monotonic", "sleep"},
    "bus/arrival.py": {"time_ns"},
    "recording/drain.py": {"monotonic", "sleep"},
    "vcan/user_mode_linux.py": {"monotonic", "sleep"},
    "operator_page/live.py": {"time"},
    "operator_page/datagrams.py": {"time"},
    "cli/display.py": {"monotonic", "sleep"},
    "cli/actions/ecu.py": {"monotonic"},
    "cli/progress.py": {"monotonic"},
    "identify/three_stages.py": {"perf_counter"},
    "thesis/twin_study.py": {"perf_counter"},
    "reports/torque.py": {"perf_counter", "process_time"},
    "train/motor_fit.py": {"perf_counter"},
    "train/torque_study.py": {"perf_counter"},
}
START_TIME_FILES = {"recording/recorder.py", "cli/commands/identify.py"}


#: Programs of their own, started by their module's name: their output is what the starter reads.
OWN_PROGRAMS = {
    "vcan/private_vcan.py",
    "recording/drain.py",
    "channel/door.py",
    "operator_page/server.py",
    "perf/own_process.py",
    "measurements/mf4_process.py",
    "modelling/job_process.py",
}


def test_only_the_command_line_prints(sources: list[Any]) -> None:
    others = [source for source in sources if source.room != "cli"]
    wrong = [source.name for source in others if "print" in source.calls or {"typer", "rich"} & source.libraries]
    wrong += [
        source.name
        for source in others
        if source.name not in OWN_PROGRAMS and {"stdout", "stderr"} & source.attributes_of("sys")
    ]
    assert not wrong, f"these print: {wrong}"


def test_only_the_plots_import_matplotlib(sources: list[Any]) -> None:
    wrong = [source.name for source in sources if "matplotlib" in source.libraries and source.room != "plots"]
    assert not wrong, f"these draw: {wrong}"


def test_the_deciding_part_of_the_ecu_knows_no_bus_and_no_clock(sources: list[Any]) -> None:
    for source in sources:
        if source.name in PURE_ECU:
            assert source.rooms <= {"units", "declaration", "signals", "failure"}, source.name


def test_only_the_transport_the_frame_logs_and_the_examination_touch_can(sources: list[Any]) -> None:
    wrong = []
    for source in sources:
        uses_library = any(module.split(".")[0] == "can" for module in source.imports)
        uses_family = "AF_CAN" in source.attributes_of("socket")
        if (uses_library or uses_family) and source.name not in CAN_FILES:
            wrong.append(source.name)
    assert not wrong, f"these open CAN as well: {wrong}"


def test_the_clock_is_read_in_named_files_only(sources: list[Any]) -> None:
    wrong = []
    for source in sources:
        if source.room != "perf":
            excess = source.attributes_of("time") - CLOCK_FILES.get(source.name, set())
            wrong += [f"{source.name} uses time.{name}" for name in sorted(excess)]
    assert not wrong, "\n".join(wrong)


def test_the_date_is_read_in_named_files_only(sources: list[Any]) -> None:
    wrong = [
        source.name
        for source in sources
        if source.name not in START_TIME_FILES and {"now", "utcnow", "today"} & source.attributes_of_dates()
    ]
    assert not wrong, f"these read the date: {wrong}"


def test_compiled_rooms_import_nothing_that_touches_the_world(sources: list[Any]) -> None:
    allowed = {"math", "typing", "numpy", "collections", "dataclasses", "enum"}
    for source in sources:
        if source.room == "models":
            foreign = {module.split(".")[0] for module in source.imports} - allowed - {"hilplant"}
            assert not foreign, f"{source.name} imports {sorted(foreign)}"
