"""What the page asks for that takes long, or stays: recordings, identification, training, a run."""

import contextlib
import re
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from hilplant.atomic_write import make_folder
from hilplant.extras import need
from hilplant.failure import Failure
from hilplant.modelling.recordings import DATABASES, columns_of, cut, looked_at, named_files
from hilplant.modelling.session import ModellingSession

Asked = Mapping[str, Any]

_OF_IDENTIFICATION = (
    "columns", "hold", "also", "search", "generations", "population", "ordered", "seed", "resume", "date",
    "stages",
)  # fmt: skip
#: Trainings with their settings, those of the commands.
_TRAININGS: dict[str, dict[str, Any]] = {
    "torque": {
        "neurons": 10,
        "harmonics": 2,
        "starts": 10,
        "speeds_rad_s": [1, 3, 5, 7],
        "seed": 1,
        "scenarios": 200,
        "data": None,
        "validation": None,
    },
    "motor": {"seed": 1, "scenarios": 2000, "data": []},
    "tables": {"bound": 1e-8},
    "polynomial": {},
}


#: How long a run may take until its page is there, the compiler included; how often it is looked at [s].
_START_S, _LOOK_S = 300.0, 0.5
_ADDRESS = re.compile(r"http://\S+#token=\S+")
#: What a run says once its bus is open and its loop begins.
_SERVES = "Ctrl-C ends it"
#: How the page names the bench that it shows among what reads frames.
OWN_BENCH = "bench"


class LongAnswers:
    """Recordings and jobs of a session."""

    def __init__(self, session: ModellingSession) -> None:
        """Take the session; `asked_for` has what can be asked for by its name."""
        self._session = session
        self.asked_for: dict[str, Callable[[Asked], Any]] = {
            "recordings": lambda _: named_files(session.recordings),
            "databases": lambda _: named_files(session.recordings, DATABASES),
            "columns": lambda asked: columns_of(self._recording(asked["name"]), self._frames(asked)),
            "look": lambda asked: looked_at(
                self._recording(asked["name"]), asked["columns"], asked.get("mode"), self._frames(asked)
            ),
            "cut": self._cut,
            "identify": self._identify,
            "train": self._train,
            "job": lambda _: session.jobs.state,
            "stop": self._stop,
            "run": self._run,
        }

    def _refuse_problems(self) -> None:
        if self._session.check().bench is None:
            raise Failure("the model has problems; they are listed beside the text")

    def identified_parts(self) -> dict[str, Any]:
        """Return the parts that the last identification found.

        Raises
        ------
        Failure
            When none has come to its end.

        """
        state = self._session.jobs.state
        if state["work"] != "identify" or state["state"] != "done":
            raise Failure("no identification has come to its end")
        return dict(state["answer"]["parts"])

    def trained_files(self, asked: Asked) -> tuple[str | None, str | None]:
        """Return the trained files of load and motor that are asked for; None for one that is not."""
        found = [self._trained(work) if asked.get(work) else None for work in ("torque", "motor")]
        return found[0], found[1]

    def product(self, work: str, name: str) -> tuple[str, bytes]:
        """Return a file that a training has written, with its name."""
        path = self._session.work / "trained" / Path(work).name / Path(name).name
        if not path.is_file():
            raise Failure(f"there is no file {name}")
        return path.name, path.read_bytes()

    def _recording(self, name: Any) -> Path:
        path = self._session.recordings / Path(str(name)).name
        if not path.is_file():
            raise Failure(f"there is no recording {name}")
        return path

    def _frames(self, asked: Asked) -> str | None:
        """Return what reads the frames of CAN logs, as the commands take it: a database that was given, or the bench.

        The page says either's name, and behind an @ the channel of the log.
        """
        name, at, channel = str(asked.get("frames") or "").partition("@")
        if not name:
            return None
        known = str(self._session.laid_out("of_frames")) if name == OWN_BENCH else str(self._recording(name))
        return f"{known}{at}{channel}"

    def _cut(self, asked: Asked) -> dict[str, str]:
        span, mode = (float(asked["from_s"]), float(asked["to_s"])), asked.get("mode")
        return {"name": cut(self._recording(asked["name"]), span, asked["columns"], mode, self._frames(asked)).name}

    def motor_text(self, name: str) -> str:
        """Return the motor file that readings, a data sheet or windings make, section 5.4.

        Raises
        ------
        Failure
            When they make none.

        """
        need("identify")
        from hilplant.motor_bench.motor_file import motor_from_readings

        path, out = self._recording(name), make_folder(self._session.work / "readings") / "motor.yaml"
        try:
            motor_from_readings(path, out)
        except Failure as error:
            raise Failure(str(error).replace(f"{path.parent}/", "")) from error
        return out.read_text(encoding="utf-8")

    def _identify(self, asked: Asked) -> dict[str, Any]:
        self._refuse_problems()
        wanted = {key: asked[key] for key in _OF_IDENTIFICATION if key in asked} | {"frames": self._frames(asked)}
        for key in ("data", "held_out"):
            wanted[key] = [self._named(each) for each in asked.get(key, [])]
        if not wanted["data"]:
            raise Failure("choose at least one recording")
        out = make_folder(self._session.work / "identified") / "identified.yaml"
        wanted |= {"bench": str(self._session.laid_out("to_identify")), "out": str(out)}
        self._session.jobs.start("identify", wanted)
        return self._session.jobs.state

    def _named(self, chosen: Any) -> str:
        words = [word for word in (chosen.get("screen"), chosen.get("mode")) if word]
        return f"{self._recording(chosen['name'])}@{','.join(words)}" if words else str(self._recording(chosen["name"]))

    def _train(self, asked: Asked) -> dict[str, Any]:
        self._refuse_problems()
        work = str(asked["what"])
        if work not in _TRAININGS:
            raise Failure(f"there is no training of {work}; there are {', '.join(_TRAININGS)}")
        out = make_folder(self._session.work / "trained" / work)
        order = _TRAININGS[work] | {key: asked[key] for key in _TRAININGS[work] if key in asked}
        if work == "torque":
            order |= {key: str(self._recording(order[key])) for key in ("data", "validation") if order[key]}
        if work == "motor":
            order["data"] = [self._named({**each, "screen": ""}) for each in order["data"]]
        bench = str(self._session.laid_out("to_train"))
        self._session.jobs.start(work, order | {"bench": bench, "out": str(out)})
        return self._session.jobs.state

    def _trained(self, work: str) -> str:
        path = self._session.work / "trained" / work / f"{work}.yaml"
        if not path.is_file():
            raise Failure(f"no {work} network was trained here yet")
        return str(path)

    def _stop(self, _: Asked) -> dict[str, Any]:
        self._session.jobs.stop()
        return self._session.jobs.state

    def _run(self, asked: Asked) -> dict[str, str]:
        """Start the bench that was saved, with the operator's page; the run goes on when this page is closed.

        Answers with the address of the operator's page, or with what the run said when it did not start.
        """
        model = self._session.model
        if not model.is_saved or model.folder is None:
            raise Failure("save the bench first: a run reads it from its folder")
        self._refuse_problems()
        path, log = model.folder / model.bench, self._session.work / "run.log"
        command = [sys.executable, "-m", "hilplant", "run", str(path), "--page=127.0.0.1:0"]
        command += ["--logs", str(model.folder / "logs")]
        command += ["--channel", str(asked["channel"])] if asked.get("channel") else []
        with log.open("wb") as said:
            child = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=said, stderr=said, start_new_session=True
            )
        for _ in range(round(_START_S / _LOOK_S)):
            text = log.read_text(encoding="utf-8", errors="replace")
            if (found := _ADDRESS.search(text)) and _SERVES in text:
                return {"command": f"hilplant run {path} --page, process {child.pid}", "page": found[0], "said": text}
            with contextlib.suppress(subprocess.TimeoutExpired):
                child.wait(_LOOK_S)
                lines = log.read_text(encoding="utf-8", errors="replace").splitlines()
                raise Failure("\n".join(line for line in lines if not _ADDRESS.search(line)) or "the run ended at once")
        return {"command": f"hilplant run {path} --page, process {child.pid}", "page": "", "said": text}
