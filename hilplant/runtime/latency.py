"""How late ticks start: a histogram that never grows."""

from hilplant.units import MICROSECOND_NS

_BINS = 20_000


class Latency:
    """Counts of whole microseconds from deadline to start; the last bin holds everything of 20 ms and more."""

    def __init__(self) -> None:
        self.worst_ns = 0
        self._bins = [0] * _BINS

    def add(self, late_ns: int) -> None:
        """Count one tick."""
        self.worst_ns = max(self.worst_ns, late_ns)
        self._bins[min(late_ns // MICROSECOND_NS, _BINS - 1)] += 1

    def quantile_us(self, share: float) -> float:
        """Return the latency that `share` of the ticks did not exceed [us]; 0 before the first tick."""
        wanted = share * sum(self._bins)
        seen = 0
        for microseconds, count in enumerate(self._bins):
            seen += count
            if seen >= wanted:
                return float(microseconds)
        return float(_BINS)
