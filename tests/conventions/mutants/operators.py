"""Mutants of Python source: small faults, each in one place, as a slip of the hand makes them.

Operators:
    compare     < and <=, > and >=, == and !=, is and is not, in and not in take each other's place
    negate      the condition of if, while, a conditional expression or a comprehension is turned round; `not` goes
    logic       `and` and `or` take each other's place
    arithmetic  + and -, * and / take each other's place; ** becomes *; // becomes /; the operands of @ are swapped
    sign        a minus sign goes
    number      a number becomes the next one: 0 becomes 1, 2 becomes 3, 0.1 becomes 0.2; True and False are swapped
    function    min and max, minimum and maximum, any and all, sin and cos, floor and ceil take each other's place
    delete      a statement goes: an assignment to an attribute or entry, an augmented assignment, a call, raise
    return      the value of a return becomes None

Annotations, texts for readers and what only changes how a figure looks (width of lines, size of letters, gaps between
panels) stay as they are.
"""
import ast
import copy

_COMPARE = {ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
            ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In}
_ARITHMETIC = {ast.Add: ast.Sub, ast.Sub: ast.Add, ast.Mult: ast.Div, ast.Div: ast.Mult, ast.Pow: ast.Mult,
               ast.FloorDiv: ast.Div}
_PAIRS = [("min", "max"), ("minimum", "maximum"), ("any", "all"), ("sin", "cos"), ("floor", "ceil"),
          ("argmin", "argmax")]
_FUNCTIONS = {a: b for pair in _PAIRS for a, b in (pair, pair[::-1])}
#: Calls whose arguments say what a reader sees, and no behaviour: texts of keys, warnings about versions.
_TEXTS = ("help", "unit", "symbol", "label", "color", "colour")
#: Arguments of matplotlib of which no figure is right or wrong.
_LOOKS = ("alpha", "dpi", "figsize", "fontsize", "ha", "hspace", "labelpad", "linewidth", "linewidths", "markersize",
          "pad", "s", "va", "wspace", "zorder")


def mutants(source):
    """All mutants of a module: list of (operator, line), which `mutated` takes by their index."""
    tree = ast.parse(source)
    found = []
    for node, field, operator in _sites(tree):
        target = getattr(node, field) if isinstance(field, str) else getattr(node, field[0])[field[1]]
        found.append((operator, getattr(target, "lineno", getattr(node, "lineno", 0))))
    return found


def mutated(source, index):
    """(source of the mutant of this index, the expression or statement around it before, and after)."""
    tree = ast.parse(source)
    node, field, operator = list(_sites(tree))[index]
    entries, place = (node.__dict__, field) if isinstance(field, str) else (getattr(node, field[0]), field[1])
    shown = isinstance(entries[place], ast.stmt)
    before = _unparsed(entries[place] if shown else node)
    entries[place] = _changed(entries[place], operator)
    after = _unparsed(entries[place] if shown else node)
    ast.fix_missing_locations(tree)
    return ast.unparse(tree) + "\n", before, after


def _unparsed(node):
    """The node on one line, without what stands in its blocks."""
    shown = copy.copy(node)
    for block in ("body", "orelse", "finalbody", "handlers"):
        if isinstance(getattr(shown, block, None), list) and not isinstance(shown, ast.Module):
            setattr(shown, block, [])
    return " ".join(ast.unparse(shown).split())


def _sites(tree):
    """(node, field or (field, index), operator) of every place that a mutant changes, in the order of the source."""
    silent = _silent(tree)
    for node in ast.walk(tree):
        if id(node) in silent:
            continue
        for field, value in ast.iter_fields(node):
            for place, child in enumerate(value if isinstance(value, list) else [value]):
                if isinstance(child, (ast.AST, bool, int, float)) and id(child) not in silent:
                    where = (field, place) if isinstance(value, list) else field
                    for operator in _operators(node, field, child):
                        yield node, where, operator


def _silent(tree):
    """ids of the nodes in which nothing is changed: annotations, docstrings, and texts for readers."""
    found = set()

    def silence(node):
        if node is not None:
            found.update(id(inner) for inner in ast.walk(node))

    for node in ast.walk(tree):
        for annotation in ("annotation", "returns"):
            silence(getattr(node, annotation, None))
        for decorator in getattr(node, "decorator_list", []):
            silence(decorator)
        if isinstance(node, ast.keyword) and node.arg in (*_TEXTS, *_LOOKS):
            silence(node.value)
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
            silence(node)
        if isinstance(node, (ast.JoinedStr, ast.FormattedValue)):
            silence(node)
        if isinstance(node, ast.Raise):  # the words of an error
            silence(node.exc)
    return found


def _operators(node, field, child):
    kinds = []
    if isinstance(child, ast.Compare) and type(child.ops[0]) in _COMPARE:
        kinds.append("compare")
    if field == "test" or (isinstance(node, ast.comprehension) and field == "ifs"):
        kinds.append("negate")
    elif isinstance(child, ast.UnaryOp) and isinstance(child.op, ast.Not):
        kinds.append("negate")
    if isinstance(child, ast.BoolOp):
        kinds.append("logic")
    if isinstance(child, (ast.BinOp, ast.AugAssign)) and not _is_text(child):
        if type(child.op) in _ARITHMETIC or isinstance(child.op, ast.MatMult):
            kinds.append("arithmetic")
    if isinstance(child, ast.UnaryOp) and isinstance(child.op, ast.USub):
        kinds.append("sign")
    if isinstance(child, ast.Constant) and isinstance(child.value, (bool, int, float)):
        kinds.append("number")
    if isinstance(child, ast.Call) and _function(child.func) in _FUNCTIONS:
        kinds.append("function")
    if field in ("body", "orelse", "finalbody") and isinstance(child, ast.stmt) and _may_go(child):
        kinds.append("delete")
    if isinstance(child, ast.Return) and child.value is not None and not (
            isinstance(child.value, ast.Constant) and child.value.value is None):
        kinds.append("return")
    return kinds


def _is_text(node):
    left = getattr(node, "left", getattr(node, "value", None))
    return isinstance(left, (ast.JoinedStr, ast.List, ast.Tuple)) or \
        isinstance(left, ast.Constant) and isinstance(left.value, str)


def _function(function):
    return getattr(function, "id", getattr(function, "attr", None))


def _may_go(statement):
    if isinstance(statement, ast.Assign):
        return not any(isinstance(target, (ast.Name, ast.Tuple)) for target in statement.targets)
    return isinstance(statement, (ast.AugAssign, ast.Raise)) or \
        isinstance(statement, ast.Expr) and isinstance(statement.value, (ast.Call, ast.YieldFrom))


def _changed(child, operator):
    child = copy.copy(child)
    if operator == "compare":
        child.ops = [_COMPARE[type(child.ops[0])](), *child.ops[1:]]
    elif operator == "negate":
        if isinstance(child, ast.UnaryOp) and isinstance(child.op, ast.Not):
            return child.operand
        return ast.UnaryOp(ast.Not(), child)
    elif operator == "logic":
        child.op = ast.Or() if isinstance(child.op, ast.And) else ast.And()
    elif operator == "arithmetic":
        if isinstance(child.op, ast.MatMult):
            child.left, child.right = child.right, child.left
        else:
            child.op = _ARITHMETIC[type(child.op)]()
    elif operator == "sign":
        return child.operand
    elif operator == "number":
        value = child.value
        child.value = (not value) if isinstance(value, bool) else value + 1 if isinstance(value, int) else \
            2.0 * value or 1.0
    elif operator == "function":
        child.func = copy.copy(child.func)
        setattr(child.func, "id" if isinstance(child.func, ast.Name) else "attr", _FUNCTIONS[_function(child.func)])
    elif operator == "delete":
        return ast.Pass()
    elif operator == "return":
        child.value = None
    return child
