"""The measure of wake-up latency that everybody knows: cyclictest of rt-tests."""

import shutil
import subprocess
from typing import NamedTuple

from hilplant.perf.results import NotMeasurable
from hilplant.perf.samples import histogram_quantile

_LONGEST_US = 20_000
_PERIOD_US = 1000


class Latencies(NamedTuple):
    """How late wake-ups were [us]."""

    p50_us: float
    p99_us: float
    p999_us: float
    max_us: float


def run_cyclictest(priority: int, cpu: int, seconds: float) -> Latencies:
    """Run it once at the loop's period, policy, priority and processor."""
    program = shutil.which("cyclictest")
    if program is None:
        raise NotMeasurable("cyclictest is not here; as root: apt-get install rt-tests")
    loops = round(seconds * 1e6 / _PERIOD_US)
    options = f"-m -q -t 1 -p {priority} -a {cpu} -i {_PERIOD_US} -l {loops} -h {_LONGEST_US} --policy fifo"
    ended = subprocess.run([program, *options.split()], capture_output=True, text=True, check=False)
    if ended.returncode:
        said = (ended.stderr.strip() or ended.stdout.strip() or "no message").splitlines()[-1]
        raise NotMeasurable(f"cyclictest: {said}; it needs root, or CAP_SYS_NICE and CAP_IPC_LOCK")
    return latencies(ended.stdout)


def latencies(report: str) -> Latencies:
    """Read the histogram that `cyclictest -q -h` prints; samples beyond it count with the greatest one."""
    counts: dict[int, int] = {}
    said: dict[str, int] = {}
    for line in report.splitlines():
        if line.startswith("#"):
            name, _, value = line[1:].partition(":")
            if value.strip().isdecimal():
                said[name.strip()] = int(value)
        elif len(words := line.split()) == 2:
            counts[int(words[0])] = int(words[1])
    greatest = said["Max Latencies"]
    counts[greatest] = counts.get(greatest, 0) + said.get("Histogram Overflows", 0)
    p50_us, p99_us, p999_us = (histogram_quantile(counts, share) for share in (0.5, 0.99, 0.999))
    return Latencies(p50_us, p99_us, p999_us, float(greatest))
