"""The stalk position automatic: more rain at once, less of it a stage at a time, a silent sensor changes nothing."""

import math

from hilplant.ecu.automatic import STAGES, RainStage, choose_stage, demanded
from hilplant.ecu.chart import Phase
from hilplant.ecu.relay_controller import ControllerState, take
from hilplant.ecu.stalk import move_named, moved, stalk_words
from hilplant.ecu.vocabulary import EcuInputs, Master, RelaySettings, Stalk

SETTINGS = RelaySettings()
AUTOMATIC = Stalk(Master.INTERMITTENT, automatic=True)


def after(stage: RainStage, signal: float, seconds: float, start_s: float = 0.0) -> RainStage:
    for k in range(round(seconds / 0.005) + 1):
        stage = choose_stage(stage, signal, start_s + 0.005 * k, SETTINGS)
    return stage


def test_each_level_takes_its_stage_at_once() -> None:
    assert len(STAGES) == len(SETTINGS.rain_levels) + 1
    for number, level in enumerate(SETTINGS.rain_levels, start=1):
        assert choose_stage(RainStage(), level, 0.0, SETTINGS).stage == number
        assert choose_stage(RainStage(), level - 1e-9, 0.0, SETTINGS).stage == number - 1
    assert [master for master, _ in STAGES] == [Master.OFF] + [Master.INTERMITTENT] * 6 + [Master.SLOW, Master.FAST]
    assert [interval for _, interval in STAGES[1:7]] == [6, 5, 4, 3, 2, 1]


def test_less_rain_lowers_one_stage_after_each_hold() -> None:
    hold = SETTINGS.rain_hold_s
    assert after(RainStage(8), 0.0, hold - 0.02).stage == 8
    assert after(RainStage(8), 0.0, hold + 0.02).stage == 7
    begun = choose_stage(RainStage(8), 0.0, 1.0, SETTINGS)
    assert [choose_stage(begun, 0.0, 1.0 + hold + late, SETTINGS).stage for late in (-1e-9, 0.0)] == [8, 7]
    assert after(RainStage(8), 0.0, 8.0 * hold + 0.2).stage == 0
    dipped = choose_stage(after(RainStage(8), 0.0, hold - 0.1), 0.9, hold - 0.05, SETTINGS)
    assert after(dipped, 0.0, hold - 0.1, hold).stage == 8  # a short look at much rain begins the hold anew


def test_a_silent_sensor_keeps_the_stage_and_from_the_start_means_intermittent() -> None:
    assert after(RainStage(5), math.nan, 60.0).stage == 5
    assert demanded(AUTOMATIC._replace(interval=3), RainStage(), math.nan)[:2] == (Master.INTERMITTENT, 3)
    assert demanded(AUTOMATIC, RainStage(), 0.0).master is Master.OFF
    assert demanded(Stalk(Master.FAST), RainStage(3), 0.2) == Stalk(Master.FAST)


def test_the_words_of_the_stalk() -> None:
    move = move_named("automatic")
    assert move is not None and move_named("au") == move
    stalk = moved(Stalk(Master.SLOW, 4), move, 0.0)
    assert stalk == Stalk(Master.INTERMITTENT, 4, automatic=True) and stalk_words(stalk) == "automatic"
    for word, master in (("off", Master.OFF), ("slow", Master.SLOW), ("i2", Master.INTERMITTENT)):
        other = move_named(word)
        assert other is not None
        assert moved(stalk, other, 0.0).automatic is False and moved(stalk, other, 0.0).master is master
    assert move_named("automatic3") is None


def test_the_chart_sees_what_the_rain_demands() -> None:
    state, phases = ControllerState(), []
    for k in range(1200):
        rain = 0.0 if k < 200 else 0.9
        state, _ = take(state, EcuInputs(AUTOMATIC, True, 0.0, 13.5, rain), 0.005 * k, SETTINGS)
        phases.append(state.phase)
    assert set(phases[:200]) == {Phase.OFF}
    assert phases[201] is Phase.FAST


def test_a_current_that_is_high_without_a_break_is_a_stall_below_the_cold_threshold_too() -> None:
    """A motor 40 K warm stalls at 9.4 A; a wiper that runs has breaks in its current at both ends of each wipe."""
    for pattern, stalls in (((9.4, 9.4), True), ((9.4, 4.9), False), ((4.9, 4.9), False)):
        state = ControllerState()
        for k in range(1400):  # 7 s: the contact is open, no timeout comes
            current = pattern[0] if k % 400 < 390 else pattern[1]
            inputs = EcuInputs(Stalk(Master.SLOW), k < 20, current, 13.5)
            state, _ = take(state, inputs, 0.005 * k, SETTINGS)
        assert (state.fault.value == "stall") is stalls, pattern
