"""Which files of tests are near a function of the code: by the names that they use, and who calls whom by name."""

import ast
import re
import tomllib
from collections import defaultdict
from pathlib import Path
from typing import Protocol

#: Kinds of tests, with the seconds that a file is thought to take until it is measured. Pages and stored numbers are
#: not asked: those would see every change.
KINDS = {"unit": 3, "contract": 5, "analytic": 6, "consistency": 7, "property": 8, "literature": 8,
         "convergence": 10, "conservation": 10, "cli": 15}  # fmt: skip
PROOF = re.compile(rf"^pytestmark = \[?\s*pytest\.mark\.({'|'.join(KINDS)})\b", re.MULTILINE)
WORD = re.compile(r"[A-Za-z_]\w+")
LEVELS, FADES = 6, 0.6
SYMBOLIC = tuple(f"src/flexapod/mechanics/{room}/" for room in ("elements", "leg", "symbolic"))
STARTING = 1.0  # seconds, of any file


class Known(Protocol):
    """What was seen of files of tests: seconds that they take, and the functions that they call."""

    seconds: dict[str, float]
    called: dict[str, list[str]]


class Nearness:
    """Nearness of files of tests to functions of `root`/src."""

    def __init__(self, root: Path) -> None:
        self.callers = defaultdict(set)  # name -> (module, function) in whose text it stands
        self.defined = defaultdict(set)  # name -> modules
        self.constants = defaultdict(set)  # module -> names outside of functions
        for path in sorted((root / "src").rglob("*.py")):
            self._read(str(path.relative_to(root)), ast.parse(path.read_text(encoding="utf-8")))
        helpers = {
            path.stem: set(WORD.findall(path.read_text(encoding="utf-8"))) for path in root.glob("tests/helpers/*.py")
        }
        self.first = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
        self.words, self.takes = {}, {}
        for path in sorted((root / "tests").glob("*/test_*.py")):
            text, file = path.read_text(encoding="utf-8"), str(path.relative_to(root))
            proof = PROOF.search(text)
            if proof is None:
                continue
            self.takes[file] = KINDS[proof[1]]
            self.words[file] = (
                set(WORD.findall(text)),
                {
                    word
                    for name in re.findall(r"from tests\.helpers\.(\w+) import", text)
                    for word in helpers.get(name, ())
                },
            )
        counts = defaultdict(int)
        for own, _ in self.words.values():
            for word in own:
                counts[word] += 1
        self.rare = {word: 1 / n**0.7 for word, n in counts.items()}

    def _read(self, module: str, tree: ast.AST) -> None:
        for node in tree.body:
            if not isinstance(node, ast.FunctionDef):
                self.constants[module] |= {x.id for x in getattr(node, "targets", ()) if isinstance(x, ast.Name)}
            parts = node.body if isinstance(node, ast.ClassDef) else [node]
            for part in parts:
                name = getattr(part, "name", getattr(node, "name", "")) or ""
                place = (module, name if isinstance(part, ast.FunctionDef) else getattr(node, "name", ""))
                self.defined[place[1]].add(module)
                used = {x.id for x in ast.walk(part) if isinstance(x, ast.Name)}
                used |= {x.attr for x in ast.walk(part) if isinstance(x, ast.Attribute)}
                for word in used:
                    self.callers[word].add(place)

    def _names(self, module: str, function: str) -> dict[str, float]:
        """Names through which a function is reached, with weights that fade from caller to caller."""
        names = {name: 0.5 for name, modules in self.defined.items() if modules == {module} and name[:1] != "_"}
        names |= {name: FADES**level for level, name in enumerate(reversed(function.split(".")))}
        edge, weight = set(names), 1.0
        for _ in range(LEVELS):
            weight *= FADES
            found = set()
            for name in edge:
                places = self.callers[name]
                alike = len(self.defined[name]) or 1
                if len(places) / alike <= 25 and alike <= 6:  # else a word of all days
                    found |= {place[1] for place in places}
            edge = {name for name in found if name and name not in names}
            names |= dict.fromkeys(edge, weight)
        return names

    def tests(self, module: str, function: str, seconds: float, known: Known, without: set[str]) -> list[str]:
        """Files near a function that take `seconds` together, those first that are near and quick."""
        names, stem, room = self._names(module, function), Path(module).stem, Path(module).parent.name
        dotted = ".".join(Path(module).with_suffix("").parts[1:])
        worth = {}
        for file, (own, lent) in self.words.items():
            near = sum(w * self.rare[name] for name, w in names.items() if name in own)
            near += 0.2 * sum(w * self.rare.get(name, 0.3) for name, w in names.items() if name in lent - own)
            near += 0.5 * (stem in own) + 0.7 * (stem in Path(file).stem) + 0.2 * (room in own)
            near += 1.0 * (dotted in self.text(file))
            worth[file] = near * self._called(module, function, known.called.get(file))
        takes = {file: STARTING + known.seconds.get(file, self.takes[file]) for file in worth}
        order = sorted((f for f in worth if f not in without), key=lambda f: (-worth[f] / takes[f] ** 0.6, f))
        chosen = [file for file in self._first(module) if file not in without]
        total = sum(takes[file] for file in chosen)
        order = [file for file in order if file not in chosen]
        for file in order:
            if worth[file] > 0.02 and total + takes[file] <= seconds:
                chosen.append(file)
                total += takes[file]
        return chosen or order[:1]

    def _first(self, module: str) -> list[str]:
        """Files that are to be asked first."""
        own = module.removeprefix("src/flexapod/")
        return [f"tests/{file}.py" for name, files in self.first.items() if own.startswith(name) for file in files]

    def _called(self, module: str, function: str, called: list[str] | None) -> float:
        """How much a file of tests counts that calls a function, does not, or has not been looked at."""
        if called is None or module.startswith(SYMBOLIC):  # equations are built where their kernel is not yet there
            return 1.0
        inside = {name.split(":")[1] for name in called if name.startswith(module + ":")}
        if function in inside or (inside and function.split(".")[0] in self.constants[module]):
            return 4.0
        return 0.1 if inside else 0.01

    def text(self, file: str) -> str:
        """Text of a file of tests."""
        if not hasattr(self, "_texts"):
            self._texts = {f: (Path(__file__).parents[1] / f).read_text(encoding="utf-8") for f in self.words}
        return self._texts[file]
