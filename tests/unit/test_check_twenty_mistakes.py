"""A bench with twenty planted mistakes gets twenty messages, each with file and line, and does not start.

The truth stands beside each mistake: a comment `# wrong NN: words that the message must hold`.
"""

import re
from pathlib import Path

import pytest

from hilplant.bench import BenchError, check_bench, load_bench

FOLDER = Path(__file__).parents[1] / "data" / "benches" / "twenty_mistakes"
MARK = re.compile(r"# wrong (\d\d): (.*)$")


def planted() -> dict[int, tuple[str, int, str]]:
    """Return the marked mistakes by their number: file, line, words."""
    marks = {}
    for path in sorted(FOLDER.glob("*.yaml")):
        for line, text in enumerate(path.read_text().splitlines(), start=1):
            if found := MARK.search(text):
                assert int(found[1]) not in marks
                marks[int(found[1])] = (path.name, line, found[2].strip())
    return marks


def test_twenty_mistakes_are_planted() -> None:
    assert sorted(planted()) == list(range(1, 21))


@pytest.mark.parametrize("number", range(1, 21))
def test_a_planted_mistake_gets_its_message_at_its_line(number: int) -> None:
    file, line, words = planted()[number]
    texts = [
        problem.text
        for problem in check_bench(FOLDER / "bench.yaml")
        if (Path(problem.file).name, problem.line) == (file, line)
    ]
    assert len(texts) == 1
    assert words in texts[0]


def test_twenty_mistakes_get_twenty_messages_and_nothing_starts() -> None:
    with pytest.raises(BenchError) as caught:
        load_bench(FOLDER / "bench.yaml")
    assert len(caught.value.problems) == 20
    assert list(caught.value.problems) == check_bench(FOLDER / "bench.yaml")
    for line, problem in zip(str(caught.value).splitlines(), caught.value.problems, strict=True):
        assert line == f"{problem.file}:{problem.line}: {problem.text}"
