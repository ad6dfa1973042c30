"""Which files of tests are near a function of the code: by the names that they use, and who calls whom by name."""

import ast
import re
from collections import defaultdict
from pathlib import Path

#: Kinds of tests, with the seconds that a file is thought to take until it is measured. Pages and stored numbers are
#: not asked: those would see every change.
KINDS = {"unit": 4, "contract": 8, "analytic": 8, "consistency": 12, "property": 12, "literature": 15,
         "convergence": 20, "conservation": 15, "cli": 25}  # fmt: skip
WORD = re.compile(r"[A-Za-z_]\w+")
LEVELS, FADES = 6, 0.6
STARTING = 1.0  # seconds, of any file


class Nearness:
    """Nearness of files of tests to functions of `root`/src."""

    def __init__(self, root: Path) -> None:
        self.callers = defaultdict(set)  # name -> (module, function) in whose text it stands
        self.defined = defaultdict(set)  # name -> modules
        for path in sorted((root / "src").rglob("*.py")):
            self._read(str(path.relative_to(root)), ast.parse(path.read_text(encoding="utf-8")))
        helpers = {path.stem: set(WORD.findall(path.read_text(encoding="utf-8"))) for path in root.glob("tests/*.py")}
        self.words = {}
        for kind in KINDS:
            for path in sorted((root / "tests" / kind).glob("test_*.py")):
                text = path.read_text(encoding="utf-8")
                self.words[str(path.relative_to(root))] = (
                    set(WORD.findall(text)),
                    {word for name in re.findall(r"from tests\.(\w+) import", text) for word in helpers.get(name, ())},
                )
        counts = defaultdict(int)
        for own, _ in self.words.values():
            for word in own:
                counts[word] += 1
        self.rare = {word: 1 / n**0.7 for word, n in counts.items()}

    def _read(self, module: str, tree: ast.AST) -> None:
        for node in tree.body:
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
        names = {name: FADES**level for level, name in enumerate(reversed(function.split(".")))}
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

    def tests(
        self, module: str, function: str, seconds: float, known: dict[str, float], without: set[str]
    ) -> list[str]:
        """Files near a function that take `seconds` together, those first that are near and quick."""
        names, stem, room = self._names(module, function), Path(module).stem, Path(module).parent.name
        dotted = ".".join(Path(module).with_suffix("").parts[1:])
        worth = {}
        for file, (own, lent) in self.words.items():
            near = sum(w * self.rare[name] for name, w in names.items() if name in own)
            near += 0.2 * sum(w * self.rare.get(name, 0.3) for name, w in names.items() if name in lent - own)
            near += 0.5 * (stem in own) + 0.7 * (stem in Path(file).stem) + 0.2 * (room in own)
            near += 1.0 * (dotted in self.text(file))
            worth[file] = near
        takes = {file: STARTING + known.get(file, KINDS[file.split("/")[1]]) for file in worth}
        order = sorted((f for f in worth if f not in without), key=lambda f: (-worth[f] / takes[f] ** 0.5, f))
        chosen, total = [], 0.0
        for file in order:
            if worth[file] > 0.02 and total + takes[file] <= seconds:
                chosen.append(file)
                total += takes[file]
        return chosen or order[:1]

    def text(self, file: str) -> str:
        """Text of a file of tests."""
        if not hasattr(self, "_texts"):
            self._texts = {f: (Path(__file__).parents[1] / f).read_text(encoding="utf-8") for f in self.words}
        return self._texts[file]
