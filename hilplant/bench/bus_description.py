"""What the bus section of a bench may say, and the messages of the ECU's section."""

from typing import Annotated, ClassVar, Self

from pydantic import ConfigDict, Field, model_validator

from hilplant.bench.durations import Milliseconds
from hilplant.bench.mapping_description import ConditionEntry, EcuStatus, Inputs, Published, SignalEntry, Stalk
from hilplant.bench.protection_description import ProtectionSection
from hilplant.bench.signal_names import EcuStatusName, InputName, InputValues, PublishedName, StalkName
from hilplant.checked_yaml.checked import Checked, Container, MayBeHole, Name, wrong


class InterfaceSection(Checked):
    """Arguments of the CAN interface, passed on as they are; only its name is known here."""

    model_config = ConfigDict(
        extra="allow", json_schema_extra={"examples": [{"interface": "socketcan", "channel": "vcan0"}]}
    )

    interface: Name = Field(description="name of an interface of python-can, such as socketcan or virtual")


_CONDITIONS = "flag of the plant: the signals of the message that decide it"
_SIGNALS = "signal of the database: what it is to the plant"


_FD = "whether its frames are FD; as in the database when left out, and FD beyond 8 bytes"
_BYTES = "length of its frames where it is longer than in the database; the rest is padding"
_PADDING = "byte that fills what no signal uses where it is sent, such as 0xFF or 0xAA"


class FrameEntry(Checked):
    """What kind of frame carries a message, where the database does not say."""

    fd: bool | None = Field(default=None, description=_FD)
    bytes: Annotated[int, Field(ge=1, le=64)] | None = Field(default=None, description=_BYTES)
    padding: Annotated[int, Field(ge=0, le=255)] = Field(default=0, description=_PADDING)


class ReceivedEntry(FrameEntry):
    """A message that is taken in; without `timeout_ms` it may stay away for ten cycle times."""

    holes_inside: ClassVar[bool] = True

    signals: dict[str, tuple[SignalEntry, ...]] = Field(default={})
    conditions: dict[str, ConditionEntry] = Field(default={})
    timeout_ms: Milliseconds | None = Field(
        default=None, description="after how long without it its message counts as lost; 0: it may stay away"
    )
    protection: ProtectionSection | None = Field(default=None, description="end-to-end protection of the message")

    @model_validator(mode="after")
    def _something(self) -> Self:
        if self.signals == {} and self.conditions == {}:
            raise wrong(text="key 'signals' is missing")
        return self

    def targets(self) -> list[tuple[str, tuple[str, ...]]]:
        """Return the signals of the plant that the message sets, each with the keys at which it is written."""
        lines = [
            (each.signal, ("signals", name))
            for name, entries in (self.signals or {}).items()
            for each in entries or ()
            if each is not None
        ]
        return [*lines, *((name, ("conditions", name)) for name in self.conditions or {})]


class SentEntry(FrameEntry):
    """A message that is sent; by default at the database's cycle time."""

    holes_inside: ClassVar[bool] = True

    signals: dict[str, tuple[SignalEntry, ...]]
    period_ms: Milliseconds | None = Field(default=None, description="how often it is sent; 0: on change only")
    offset_ms: Milliseconds = Field(default=0.0, description="by how much its period begins later than tick 0")
    on_change: list[str] = Field(default=[], description="signals whose change sends it in the same tick")
    protection: ProtectionSection | None = Field(default=None, description="end-to-end protection of the message")


class CommandEntry(ReceivedEntry):
    """A message that commands the plant."""

    signals: Inputs = Field(default={}, description=_SIGNALS)  # type: ignore[assignment]
    conditions: dict[InputName, ConditionEntry] = Field(default={}, description=_CONDITIONS)


class ReportEntry(SentEntry):
    """A message that shows the plant."""

    signals: Published = Field(description=_SIGNALS)  # type: ignore[assignment]
    on_change: list[PublishedName] = Field(default=[], description="signals whose change sends it in the same tick")


class StalkMessageEntry(ReceivedEntry):
    """A message from the stalk to the ECU."""

    signals: Stalk = Field(  # type: ignore[assignment]
        default={}, description="signal of the database: signal of the stalk"
    )
    conditions: dict[StalkName, ConditionEntry] = Field(default={}, description=_CONDITIONS)


class EcuStatusMessageEntry(SentEntry):
    """A message in which the ECU tells of itself."""

    signals: EcuStatus = Field(description="signal of the database: what the ECU tells")  # type: ignore[assignment]
    on_change: list[EcuStatusName] = Field(default=[], description="signals whose change sends it in the same tick")


class BusSection(Container):
    """The plant on its bus."""

    interface: InterfaceSection = Field(description="CAN interface with its arguments, as python-can takes them")
    database: Annotated[Name, MayBeHole] = Field(description="file of the bus database: DBC, ARXML, KCD, SYM")
    receive: Annotated[dict[str, CommandEntry], MayBeHole] = Field(
        default={}, description="messages that command the plant"
    )
    send: Annotated[dict[str, ReportEntry], MayBeHole] = Field(default={}, description="messages that show the plant")
    timeout_ms: Annotated[Milliseconds | None, MayBeHole] = Field(
        default=None, description="that of messages that have none and no cycle time in the database"
    )
    safe: InputValues = Field(
        default={}, description="what inputs become while commands are lost; relays open unless named"
    )
