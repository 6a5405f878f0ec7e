"""The soak holds for some minutes of virtual time, and its rules notice what they are there for."""

import numpy as np
from soak import FIRST_OUTPUT, OUTPUT_INDEX, Car, broken_rules, rounds, soak

from hilplant.bench import load_bench
from hilplant.ecu.vocabulary import Stalk


def test_some_minutes_at_random_break_no_rule() -> None:
    assert soak(load_bench("default"), seed=3, minutes=2) == []


def test_each_rule_notices_what_it_is_there_for() -> None:
    bench = load_bench("default")
    tape, loop = next(rounds(bench, seed=1))
    assert broken_rules(bench, tape, loop) == []
    good, sent = tape.rows.copy(), dict(tape.frames)

    tape.frames[bench.send[0].identifier] //= 2
    assert "frames of" in broken_rules(bench, tape, loop)[0]
    tape.frames.update({key: sent[key] - tape.frames[key] for key in sent})

    for name, factor, said in (("load_torque_n_m", 1.1, "not explained"), ("park_contact", 0.0, "not parked")):
        tape.rows[:] = good
        tape.rows[:, FIRST_OUTPUT + OUTPUT_INDEX[name]] *= factor
        assert any(said in line for line in broken_rules(bench, tape, loop)), name
    tape.rows[:] = good
    tape.rows[100, FIRST_OUTPUT] = np.nan
    assert "is not finite" in broken_rules(bench, tape, loop)[0]


def test_the_driver_is_the_same_for_the_same_seed_and_parks_at_the_end_of_a_minute() -> None:
    one, same, other = Car(5), Car(5), Car(6)
    moves = [[car.at(0.1 * k) for k in range(400)] for car in (one, same, other)]
    assert moves[0] == moves[1] != moves[2]
    assert one.at(59.0) == Stalk()
