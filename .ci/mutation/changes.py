"""Small changes of a source, one at a time."""

import ast
from collections.abc import Iterator
from dataclasses import dataclass

SWAPS = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Mod: ast.Mult,
    ast.Pow: ast.Mult,
    ast.Lt: ast.GtE,
    ast.LtE: ast.Gt,
    ast.Gt: ast.LtE,
    ast.GtE: ast.Lt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
    ast.And: ast.Or,
    ast.Or: ast.And,
    ast.BitAnd: ast.BitOr,
    ast.BitOr: ast.BitAnd,
}
_CHANGED_ITSELF = (ast.Compare, ast.BoolOp, ast.UnaryOp, ast.Constant)


@dataclass(frozen=True)
class Change:
    """One change of a source.

    Attributes
    ----------
    what : str
        Its place, the line as it was, and the kind of the change.
    lines : range
        The lines that run if the changed code runs.
    """

    what: str
    lines: range


def changes(source: str) -> list[Change]:
    """Return all changes of a source."""
    lines = source.splitlines()
    found = []
    for node, field, index, statement in _places(ast.parse(source)):
        at = node.ifs[index] if field == "filter" else getattr(node, "test", node)
        which = f" {index + 1}" if index else ""
        line = lines[at.lineno - 1].strip()
        what = f"{at.lineno}:{at.col_offset + 1}: {line} [{field}{which}, {_code(at)}]"
        found.append(Change(what, _lines(statement, at)))
    return found


def _code(node: ast.AST) -> str:
    code = ast.unparse(node)
    return code if len(code) <= 40 else f"{code[:18]} … {code[-18:]}"


def changed(source: str, number: int) -> ast.Module:
    """Return the source with its change of that number; every place is that of the original."""
    tree = ast.parse(source)
    node, field, index, _ = list(_places(tree))[number]
    if field == "comparison":
        node.ops[index] = SWAPS[type(node.ops[index])]()
    elif field == "operator":
        node.op = SWAPS[type(node.op)]()
    elif field == "constant":
        node.value = not node.value if isinstance(node.value, bool) else node.value + 1
    elif field == "sign":
        node.op = ast.UAdd()
    elif field == "negation":
        node.operand = ast.UnaryOp(ast.Not(), node.operand)
    elif field == "return":
        node.value = ast.Constant(None)
    elif field == "condition":
        node.test = ast.UnaryOp(ast.Not(), node.test)
    else:
        node.ifs[index] = ast.UnaryOp(ast.Not(), node.ifs[index])
    return ast.fix_missing_locations(tree)


def _places(tree: ast.AST) -> Iterator[tuple[ast.AST, str, int, ast.AST]]:
    """Yield what can be changed: a node, the kind of change, its index, and its statement."""
    spared = {part for root in _spared(tree) for part in ast.walk(root)}
    for node, statement in _with_statements(tree, tree):
        if node not in spared:
            yield from ((node, field, index, statement) for field, index in _kinds(node))


def _spared(tree: ast.AST) -> Iterator[ast.AST]:
    """Yield what changes no result.

    These are decorators, annotations and their imports, messages of errors, and `strict` of zip.
    """
    for node in ast.walk(tree):
        yield from getattr(node, "decorator_list", ())
        for field in ("returns", "annotation"):
            if annotation := getattr(node, field, None):
                yield annotation
        if isinstance(node, ast.Raise) and node.exc:
            yield node.exc
        if isinstance(node, ast.keyword) and node.arg == "strict":
            yield node
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            yield node


def _with_statements(node: ast.AST, statement: ast.AST) -> Iterator[tuple[ast.AST, ast.AST]]:
    """Yield all nodes with the innermost statement or lambda that they are in."""
    if isinstance(node, ast.stmt | ast.Lambda):
        statement = node
    yield node, statement
    for child in ast.iter_child_nodes(node):
        yield from _with_statements(child, statement)


def _kinds(node: ast.AST) -> Iterator[tuple[str, int]]:
    if isinstance(node, ast.Compare):
        yield from (("comparison", i) for i, op in enumerate(node.ops) if type(op) in SWAPS)
    elif isinstance(node, ast.BinOp | ast.BoolOp | ast.AugAssign) and type(node.op) in SWAPS:
        yield "operator", 0
    elif isinstance(node, ast.Constant) and type(node.value) in (int, float, bool):
        yield "constant", 0
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not | ast.USub):
        yield "negation" if isinstance(node.op, ast.Not) else "sign", 0
    elif isinstance(node, ast.Return) and ast.unparse(node) not in ("return", "return None"):
        yield "return", 0
    elif isinstance(node, ast.If | ast.IfExp | ast.While):
        if not isinstance(node.test, _CHANGED_ITSELF):
            yield "condition", 0
    elif isinstance(node, ast.comprehension):
        kept = (i for i, test in enumerate(node.ifs) if not isinstance(test, _CHANGED_ITSELF))
        yield from (("filter", i) for i in kept)


def _lines(statement: ast.AST, node: ast.AST) -> range:
    body = getattr(statement, "body", None)
    if isinstance(body, list) and body[0].lineno > node.lineno:  # the head of a block
        return range(statement.lineno, body[0].lineno)
    return range(statement.lineno, statement.end_lineno + 1)
