"""Places in Python sources where the rules of `rules` make a mutant.

Only what a function's body computes is changed, since the switch is asked when it runs: the own lines of a
module or class, defaults and types are left alone, and so is text.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

from mutants.rules import RULES, SWAPS, Place

WORDS = {
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.And: "and",
    ast.Or: "or",
}
PYTHON_SWAPS = {**SWAPS, "and": "or", "or": "and", "minimum": "maximum", "maximum": "minimum"}
PYTHON_RULES = {
    **RULES,
    **dict.fromkeys(("and", "or"), "and, or"),
    **dict.fromkeys(("minimum", "maximum"), "min, max"),
}


class Source:
    """The bytes of a file, by the lines and columns that `ast` tells."""

    def __init__(self, text: str) -> None:
        self.data = text.encode()
        self.lines = [0]
        for line in self.data.splitlines(keepends=True):
            self.lines.append(self.lines[-1] + len(line))

    def start(self, node: ast.expr) -> int:
        return self.lines[node.lineno - 1] + node.col_offset

    def end(self, node: ast.expr) -> int:
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        return self.lines[node.end_lineno - 1] + node.end_col_offset

    def text(self, start: int, end: int) -> str:
        return self.data[start:end].decode()

    def swapped(self, node: ast.expr, word: str, between: tuple[int, int]) -> str:
        """An expression with the other operator for the one between two places."""
        start, end = self.start(node), self.end(node)
        at = self.data.index(word.encode(), *between)
        return self.text(start, at) + PYTHON_SWAPS[word] + self.text(at + len(word), end)


def constants(tree: ast.Module) -> set[str]:
    """Names in capitals that are floats on the module's own lines."""
    found = set()
    for line in tree.body:
        target: ast.expr | None = line.target if isinstance(line, ast.AnnAssign) else None
        if isinstance(line, ast.Assign) and len(line.targets) == 1:
            target = line.targets[0]
        value = line.value if isinstance(line, ast.Assign | ast.AnnAssign) else None
        is_float = isinstance(value, ast.Constant) and isinstance(value.value, float)
        if is_float and isinstance(target, ast.Name) and target.id.isupper():
            found.add(target.id)
    return found


def is_text(node: ast.expr) -> bool:
    """Whether an expression is seen to be text, or a list, which only `+` joins."""
    is_string = isinstance(node, ast.Constant) and isinstance(node.value, str)
    return is_string or isinstance(node, ast.JoinedStr | ast.List | ast.ListComp | ast.Tuple)


def is_short(node: ast.If) -> bool:
    """Whether a condition has one line below it and no other case."""
    return len(node.body) == 1 and not node.orelse


def operands(node: ast.expr) -> list[tuple[ast.operator | ast.cmpop | ast.boolop, ast.expr, ast.expr]]:
    """The operators of an expression with what stands on both sides."""
    if isinstance(node, ast.Compare):
        sides = [node.left, *node.comparators]
        return list(zip(node.ops, sides[:-1], sides[1:], strict=True))
    if isinstance(node, ast.BoolOp) and len(node.values) == 2:
        return [(node.op, node.values[0], node.values[1])]
    if isinstance(node, ast.BinOp) and not (is_text(node.left) or is_text(node.right)):
        return [(node.op, node.left, node.right)]
    return []


def mutants_of(node: ast.AST, names: set[str], source: Source) -> Iterator[tuple[str, ast.expr, str]]:
    """Rule, place and new expression of each mutant at a node and below it."""
    if isinstance(node, ast.expr):
        old = source.text(source.start(node), source.end(node))
        for kind, left, right in operands(node):
            word = WORDS.get(type(kind))
            if word is not None:
                between = (source.end(left), source.start(right))
                yield PYTHON_RULES[word], node, source.swapped(node, word, between)
        if isinstance(node, ast.Call):
            function = node.func
            word = function.id if isinstance(function, ast.Name) else getattr(function, "attr", "")
            if word in {"min", "max", "minimum", "maximum"}:
                end = source.end(function)
                yield "min, max", node, source.swapped(node, word, (end - len(word), end))
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            yield "not", node, f"bool({old.removeprefix('not')})"
        if isinstance(node, ast.Constant) and isinstance(node.value, float) and node.value != 0.0:
            yield "constant", node, f"10.0 * {old}"
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load) and node.id in names:
            yield "constant", node, f"10.0 * {old}"
    if isinstance(node, ast.If) and isinstance(node.body[-1], ast.Return | ast.Raise) and is_short(node):
        start, end = source.start(node.test), source.end(node.test)
        yield "return", node.test, f"({source.text(start, end)})"
    if isinstance(node, ast.JoinedStr | ast.Match):  # places within text are not told; cases are patterns
        return
    for name, field in ast.iter_fields(node):
        if name not in {"annotation", "returns", "decorator_list", "args"} or isinstance(node, ast.Call):
            for child in field if isinstance(field, list) else [field]:
                if isinstance(child, ast.AST):
                    yield from mutants_of(child, names, source)


def functions(node: ast.AST) -> Iterator[ast.FunctionDef | ast.AsyncFunctionDef]:
    """The outermost functions of a module and its classes."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef):
            yield child
        elif not isinstance(child, ast.Lambda):
            yield from functions(child)


def places(path: Path) -> list[Place]:
    """All places of a file, in their order."""
    text = path.read_text(encoding="utf-8")
    tree, source = ast.parse(text), Source(text)
    names = constants(tree)
    found = []
    for function in functions(tree):
        for line in function.body:
            for rule, node, new in mutants_of(line, names, source):
                start, end = source.start(node), source.end(node)
                found.append(Place(node.lineno, start, end, rule, source.text(start, end), new))
    return found
