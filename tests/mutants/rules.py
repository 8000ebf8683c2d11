"""Places in Rust sources where a small rule makes a mutant, each an expression that a switch can choose.

A mutant keeps the type of what it stands in for, so that many live in one build: the original `a < b` becomes
`(if crate::mutant::is(17) { a <= b } else { a < b })`. Tests, constants' own definitions, patterns, types and
the insides of macros are left alone; a named constant is changed where its file uses it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import tree_sitter_rust
from tree_sitter import Language, Node, Parser

SWAPS = {
    "<": "<=",
    "<=": "<",
    ">": ">=",
    ">=": ">",
    "+": "-",
    "-": "+",
    "*": "/",
    "/": "*",
    "&&": "||",
    "||": "&&",
    "+=": "-=",
    "-=": "+=",
    "*=": "/=",
    "/=": "*=",
    "min": "max",
    "max": "min",
}
RULES = {
    **dict.fromkeys(("<", "<=", ">", ">="), "comparison"),
    **dict.fromkeys(("+", "-", "+=", "-="), "sum"),
    **dict.fromkeys(("*", "/", "*=", "/="), "product"),
    **dict.fromkeys(("&&", "||"), "and, or"),
    **dict.fromkeys(("min", "max"), "min, max"),
}
# What the tool leaves alone, with all that is inside.
OUTSIDE = {
    "array_type",
    "attribute_item",
    "const_item",
    "inner_attribute_item",
    "macro_definition",
    "macro_invocation",
    "match_pattern",
    "range_pattern",
    "static_item",
    "type_arguments",
    "type_item",
}


@dataclass(frozen=True)
class Place:
    """Bytes of a file, what stands there, and what a rule makes of it."""

    line: int
    start: int
    end: int
    rule: str
    old: str
    new: str


def is_test(node: Node) -> bool:
    """Whether an item stands behind `#[cfg(test)]` or `#[test]`, or can only be evaluated by the compiler."""
    before = node.prev_named_sibling
    while before is not None and before.type in {"attribute_item", "line_comment"}:
        if before.type == "attribute_item" and b"test" in (before.text or b""):
            return True
        before = before.prev_named_sibling
    if node.type == "function_item":
        return any(
            child.type == "function_modifiers" and b"const" in (child.text or b"") for child in node.children
        )
    return False


def text_of(node: Node | None) -> str:
    """The source of a node."""
    return (node.text or b"").decode() if node is not None else ""


def constants(node: Node) -> Iterator[str]:
    """Names of the constants that are floats."""
    if node.type == "const_item" and text_of(node.child_by_field_name("type")) == "f64":
        yield text_of(node.child_by_field_name("name"))
    for child in node.named_children:
        yield from constants(child)


def is_constant(node: Node, names: set[str]) -> bool:
    """Whether a node is a number with a fraction, but for zero, or the use of a constant with a name."""
    if node.type == "float_literal":
        return float(text_of(node).removesuffix("f64").replace("_", "")) != 0.0
    is_path = node.parent is not None and node.parent.type in {
        "scoped_identifier",
        "use_list",
        "use_declaration",
    }
    return node.type == "identifier" and text_of(node) in names and not is_path


def mutants_of(node: Node, names: set[str]) -> Iterator[tuple[str, Node, str, str]]:
    """Rule, place, old and new expression of each mutant at a node and below it."""
    if node.type in OUTSIDE or is_test(node):
        return
    old = text_of(node)
    if node.type in {"binary_expression", "compound_assignment_expr"}:
        mark = node.child_by_field_name("operator")
        if mark is not None and text_of(mark) in SWAPS:
            at = mark.start_byte - node.start_byte
            raw = old.encode()
            new = raw[:at].decode() + SWAPS[text_of(mark)] + raw[at + len(mark.text or b"") :].decode()
            yield RULES[text_of(mark)], node, old, new
    elif node.type == "call_expression":
        function = node.child_by_field_name("function")
        field = function.child_by_field_name("field") if function is not None else None
        if field is not None and text_of(field) in {"min", "max"}:
            at = field.start_byte - node.start_byte
            raw = old.encode()
            new = raw[:at].decode() + SWAPS[text_of(field)] + raw[at + 3 :].decode()
            yield "min, max", node, old, new
    elif node.type == "unary_expression" and old.startswith("!"):
        yield "not", node, old, old[1:]
    elif is_constant(node, names):
        yield "constant", node, old, f"10.0 * {old}"
    elif node.type == "if_expression":
        condition = node.child_by_field_name("condition")
        body = node.child_by_field_name("consequence")
        inside = [child for child in body.named_children if "comment" not in child.type] if body else []
        if condition is not None and len(inside) == 1 and node.child_by_field_name("alternative") is None:
            last = inside[0].named_children[0] if inside[0].type == "expression_statement" else inside[0]
            if last.type == "return_expression":
                old = text_of(condition)
                is_let = condition.type in {"let_condition", "let_chain"}
                yield "return", condition, old, old if is_let else f"({old})"
    for child in node.named_children:
        if child.type.endswith("pattern"):
            continue
        yield from mutants_of(child, names)


def places(path: Path) -> list[Place]:
    """All places of a file, in their order."""
    if path.name == "tests.rs":
        return []
    root = Parser(Language(tree_sitter_rust.language())).parse(path.read_bytes()).root_node
    names = set(constants(root))
    return [
        Place(node.start_point[0] + 1, node.start_byte, node.end_byte, rule, old, new)
        for rule, node, old, new in mutants_of(root, names)
    ]
