"""What leaves a run beside the page: Prometheus' text, datagrams for PlotJuggler, MCAP files; and when a log begins."""

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

from hilplant.channel.run_files import column_of, columns
from hilplant.failure import Failure
from hilplant.operator_page.datagrams import target
from hilplant.operator_page.logger import file_in
from hilplant.operator_page.metrics import metrics
from hilplant.operator_page.trigger import Trigger
from hilplant.recording.tables import write_table

_SAMPLE = re.compile(r'[a-zA-Z_:][a-zA-Z0-9_:]*(\{[a-z]+="[^"\\]*"\})? (-?[0-9.e+-]+|NaN)')


def test_the_metrics_are_prometheus_text_with_the_rows_values() -> None:
    row = np.zeros(len(columns()))
    row[column_of("status.overruns")], row[column_of("status.mode")] = 7.0, 1.0
    row[column_of("out.current_a")], row[column_of("out.left_force_n")] = 2.5, math.nan
    text = metrics(row, {"wrong token": 3}, 2)
    samples = [line for line in text.splitlines() if not line.startswith("#")]
    assert all(_SAMPLE.fullmatch(line) for line in samples), samples
    assert {
        "hilplant_status_overruns_total 7",
        'hilplant_mode{mode="running"} 1',
        'hilplant_mode{mode="waiting"} 0',
        "hilplant_out_current_a 2.5",
        "hilplant_out_left_force_n NaN",
        'hilplant_page_refused_total{reason="wrong token"} 3',
        "hilplant_pages 2",
    } <= set(samples)
    named = {line.split()[2] for line in text.splitlines() if line.startswith("# TYPE")}
    assert named == {re.split(r"[ {]", line)[0] for line in samples}


@pytest.mark.parametrize("text", ["", "udp", "udp:1234", "udp:host:0", "udp:host:70000", "tcp:host:1"])
def test_a_stream_that_is_no_udp_address_is_refused(text: str) -> None:
    with pytest.raises(Failure, match="write udp:HOST:PORT"):
        target(text)


@pytest.mark.parametrize(
    ("way", "level", "first"),
    [("now", 0.0, 0), ("above", 2.0, 3), ("below", 0.5, 0), ("rises", 1.0, 2), ("falls", 2.0, 5), ("equals", 3.0, 3)],
)
@pytest.mark.parametrize("cut", [0, 1, 2, 3, 5])
def test_a_trigger_finds_the_same_tick_in_whatever_pieces_rows_come(
    way: str, level: float, first: int, cut: int
) -> None:
    rows = np.zeros((7, len(columns())))
    rows[:, column_of("out.current_a")] = [0.0, 1.0, 2.0, 3.0, 2.0, 1.0, 0.0]
    trigger = Trigger(way, "current_a", level)  # type: ignore[arg-type]
    found = trigger.first(rows[:cut])
    if found is None:
        later = trigger.first(rows[cut:])
        found = None if later is None else cut + later
    assert found == first


def test_a_trigger_that_is_none_is_refused() -> None:
    with pytest.raises(Failure, match="a trigger is one of"):
        Trigger("sometimes", "current_a")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="there is no signal"):
        Trigger("above", "currant_a")


@pytest.mark.parametrize(
    "name", ["../a.csv", "/etc/a.csv", "a/../b.csv", "a..csv", ".a.csv", "a b.csv", "", "a\x00.csv"]
)
def test_a_logs_name_is_a_name_and_no_path(tmp_path: Path, name: str) -> None:
    with pytest.raises(Failure, match="and no folder"):
        file_in(tmp_path, name)


def test_a_log_takes_no_other_files_place_nor_follows_a_link(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("kept")
    (tmp_path / "b.csv").symlink_to(tmp_path / "elsewhere.csv")
    for name in ("a.csv", "b.csv"):
        with pytest.raises(Failure, match="there is such a file already"):
            file_in(tmp_path, name)
    assert file_in(tmp_path, "c.csv") == tmp_path / "c.csv"


def test_an_mcap_file_gives_back_each_row_at_its_time(tmp_path: Path) -> None:
    from mcap.reader import make_reader

    path = tmp_path / "a.mcap"
    values = np.array([1.5, math.nan, -2.0])
    write_table(path, {"time_s": np.array([0.0, 0.001, 0.002]), "current_a": values}, {"current_a": "A"})
    with path.open("rb") as file:
        found = list(make_reader(file).iter_messages())
    assert [message.log_time for _, _, message in found] == [0, 1_000_000, 2_000_000]
    assert [json.loads(message.data) for _, _, message in found] == [
        {"current_a": 1.5},
        {"current_a": None},
        {"current_a": -2.0},
    ]
    schema, channel, _ = found[0]
    assert channel.message_encoding == "json" and schema is not None and schema.encoding == "jsonschema"
    assert json.loads(schema.data)["properties"]["current_a"] == {"type": "number", "description": "[A]"}
