"""Change the code in one place at a time and see whether a test notices: which changes live, the tests do not cover.

python tests/mutation.py --mutants 100 --seed 1 [--room models]     # a minute a mutant; not part of CI

Works on a copy of the checkout. The same seed and number give the same mutants of the same code. Exit code 1 when a
mutant lives; each is printed with file, line and change, to be killed by a test or argued to change nothing.
"""

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
#: The rooms, or files, whose code is changed, and the tests that have to notice (names of test files begin so).
ROOMS = {
    "models": ("models", "park", "motor", "plant", "networks", "surrogates", "dynamics_reduction"),
    "bus/protection.py": ("bus", "loop", "mutants"),
    "bus/codec.py": ("bus", "mutants"),
    "runtime/loop.py": ("loop", "ring", "daemon", "velocity", "mutants", "soak"),
    "ecu": ("ecu", "mutants"),
}
TESTS = ("unit", "property", "oracle", "scenario")
TIMEOUT_S = 900
_COMPARE = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq}
_ARITHMETIC = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.BitAnd: ast.BitOr}


class Mutant(NamedTuple):
    """One change: file, line, how it reads before and after, and the whole text of the changed file."""

    file: Path
    line: int
    before: str
    after: str
    text: str


def changes(node: ast.AST) -> Iterator[None]:
    """Change a node in each way that makes sense, one after the other; it is as before after each."""
    if isinstance(node, ast.Compare):
        for index, operator in enumerate(node.ops):
            if type(operator) in _COMPARE:
                node.ops[index] = _COMPARE[type(operator)]()
                yield
                node.ops[index] = operator
    elif isinstance(node, ast.BinOp) and type(node.op) in _ARITHMETIC:
        before = node.op
        node.op = _ARITHMETIC[type(before)]()
        yield
        node.op = before
    elif isinstance(node, ast.BoolOp):
        kind = node.op
        node.op = ast.Or() if isinstance(kind, ast.And) else ast.And()
        yield
        node.op = kind
    elif isinstance(node, ast.Constant) and isinstance(node.value, bool | int | float):
        value = node.value
        node.value = not value if isinstance(value, bool) else value + 1
        yield
        node.value = value
    elif isinstance(node, ast.If | ast.IfExp | ast.While):
        test = node.test
        node.test = ast.UnaryOp(ast.Not(), test)
        yield
        node.test = test
    elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
        call = node.value
        node.value = ast.Constant(None)  # type: ignore[assignment]
        yield
        node.value = call


def mutants_of(file: Path) -> list[Mutant]:
    """Return every change of a file's functions; annotations, docstrings and constants of the module stay."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    found = []
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    for node in dict.fromkeys(inner for function in functions for part in function.body for inner in ast.walk(part)):
        before = ast.unparse(node) if isinstance(node, ast.expr | ast.stmt) else ""
        for _ in changes(node):
            found.append(Mutant(file, getattr(node, "lineno", 0), before, ast.unparse(node), ast.unparse(tree)))
    return found


def chosen(rooms: list[str], number: int, seed: int) -> list[Mutant]:
    """Draw mutants: first a room, then one of its changes, so that small rooms get their share."""
    chance, pools = random.Random(seed), {}
    for room in rooms:
        path = ROOT / "hilplant" / room
        files = sorted(path.rglob("*.py")) if path.is_dir() else [path]
        pools[room] = [mutant for file in files for mutant in mutants_of(file)]
        chance.shuffle(pools[room])
    drawn = []
    while len(drawn) < number and any(pools.values()):
        room = chance.choice([name for name, pool in pools.items() if pool])
        drawn.append(pools[room].pop())
    return drawn


def tests_for(file: Path) -> list[str]:
    """Return the test files that have to notice a change of a file."""
    name = file.relative_to(ROOT / "hilplant").as_posix()
    words = next(words for room, words in ROOMS.items() if name.startswith(room))
    found = [path for folder in TESTS for word in words for path in (ROOT / "tests" / folder).glob(f"test_{word}*.py")]
    return sorted({path.relative_to(ROOT).as_posix() for path in found})


def killed(mutant: Mutant, copy: Path) -> bool:
    """Put the change into the copy, run the tests there, take it out again."""
    changed = copy / mutant.file.relative_to(ROOT)
    whole = changed.read_text(encoding="utf-8")
    changed.write_text(mutant.text, encoding="utf-8")
    environment = os.environ | {"PYTHONPATH": str(copy), "NUMBA_CACHE_DIR": str(copy / "compiled")}
    words = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", "-m", "not vcan"]
    try:
        ran = subprocess.run([*words, *tests_for(mutant.file)], cwd=copy, env=environment, timeout=TIMEOUT_S,
                             stdin=subprocess.DEVNULL, capture_output=True, check=False)  # fmt: skip
        return ran.returncode == 1
    except subprocess.TimeoutExpired:
        return True
    finally:
        changed.write_text(whole, encoding="utf-8")


def main() -> int:
    """Run from the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--mutants", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--room", choices=list(ROOMS), help="this room alone")
    parser.add_argument("--list", action="store_true", help="list the mutants, run nothing")
    options = parser.parse_args()
    drawn = chosen([options.room] if options.room else list(ROOMS), options.mutants, options.seed)
    alive = 0
    with tempfile.TemporaryDirectory(prefix="hilplant-mutants-") as folder:
        copy = Path(folder) / "copy"
        if not options.list:
            shutil.copytree(ROOT, copy, ignore=shutil.ignore_patterns(".*", "__pycache__"))
        for mutant in drawn:
            died = None if options.list else killed(mutant, copy)
            alive += died is False
            place = f"{mutant.file.relative_to(ROOT)}:{mutant.line}"
            verdict = {None: "", True: "killed  ", False: "LIVES   "}[died]
            print(f"{verdict}{place}: {mutant.before.splitlines()[0]}  ->  {mutant.after.splitlines()[0]}", flush=True)
    if not options.list:
        print(f"{len(drawn) - alive} killed, {alive} alive, of {len(drawn)}")
    return 1 if alive else 0


if __name__ == "__main__":
    sys.exit(main())
