"""Formulas with one coefficient changed by a hundredth: each has to make a test of its equation fail.

Changed are, one at a time, every number that is written, and the coefficient 1 that is not: of each summand, of what
a minus stands before, of each entry of a vector, of each argument of an elementary function, of each side of a
comparison, of an exponent, of what a name is given, and of the whole. Left alone are indices, keyword arguments and
sizes of arrays.
"""
import ast
import contextlib
import copy

import numpy as np

PART = 1.01
#: Functions whose arguments are numbers that a coefficient can stand before.
ELEMENTARY = {"sqrt", "exp", "log", "sin", "cos", "tan", "arctan", "arctan2", "arccos", "abs", "maximum", "minimum",
              "max", "min", "hypot"}
#: Functions whose arguments are sizes.
OF_SIZES = {"range", "eye", "zeros", "ones"}
#: Nothing that a coefficient can stand before.
CONTAINERS = (ast.Tuple, ast.List, ast.Dict, ast.ListComp, ast.GeneratorExp, ast.Lambda, ast.Starred)


def _name(call):
    return call.func.attr if isinstance(call.func, ast.Attribute) else getattr(call.func, "id", "")


class _Change(ast.NodeTransformer):
    """Changes the place with that index, in the order of the visit; -1: none, so that `count` is how many there are."""

    def __init__(self, index=-1):
        self.index, self.count, self.text = index, 0, ""

    def _place(self, node, changed):
        self.count += 1
        if self.count - 1 != self.index:
            return node
        self.text = f"{ast.unparse(node)} becomes {ast.unparse(changed)} in line {node.lineno}"
        return ast.copy_location(changed, node)

    def term(self, node):
        """The node visited, and a coefficient before it."""
        node = self.visit(node)
        if isinstance(node, (ast.Constant, *CONTAINERS)):
            return node
        return self._place(node, ast.BinOp(node, ast.Mult(), ast.Constant(PART)))

    def visit_Constant(self, node):
        if isinstance(node.value, bool) or not isinstance(node.value, (int, float, complex)):
            return node
        return self._place(node, ast.Constant(node.value * PART if node.value else PART - 1.0))

    def visit_Subscript(self, node):
        node.value = self.visit(node.value)
        return node

    def visit_BinOp(self, node):
        sums = isinstance(node.op, (ast.Add, ast.Sub))
        node.left = self.term(node.left) if sums else self.visit(node.left)
        node.right = self.term(node.right) if sums or isinstance(node.op, ast.Pow) else self.visit(node.right)
        return node

    def visit_UnaryOp(self, node):
        node.operand = self.term(node.operand)
        return node

    def visit_Compare(self, node):
        node.left, node.comparators = self.term(node.left), [self.term(side) for side in node.comparators]
        return node

    def _entries(self, node):
        if isinstance(node.ctx, ast.Store):
            return node
        node.elts = [self.term(entry) for entry in node.elts]
        return node

    visit_List = visit_Tuple = _entries

    def visit_Call(self, node):
        if _name(node) in OF_SIZES:
            return node
        if isinstance(node.func, ast.Attribute):
            node.func.value = self.visit(node.func.value)
        visit = self.term if _name(node) in ELEMENTARY else self.visit
        node.args = [visit(argument) for argument in node.args]
        return node

    def visit_Assign(self, node):
        node.value = self.term(node.value) if isinstance(node.targets[0], ast.Name) else self.visit(node.value)
        return node

    def visit_Return(self, node):
        node.value = self.term(node.value)
        return node


def mutants(formula):
    """[(what is changed, function)], one for each place of a `Formula`."""
    tree, counter, made = formula.tree(), _Change(), []
    counter.visit(copy.deepcopy(tree))
    for index in range(counter.count):
        change = _Change(index)
        changed = ast.fix_missing_locations(change.visit(copy.deepcopy(tree)))
        names = {}
        exec(compile(changed, f"{formula.original.__name__} changed", "exec"), formula.original.__globals__, names)
        made.append((f"{formula.original.__name__}: {change.text}", names[formula.original.__name__]))
    return made


@contextlib.contextmanager
def exchanged(formula, function):
    """Within, the formula is this function."""
    formula.function = function
    try:
        yield
    finally:
        formula.function = formula.original


def survivors(formulas, tests):
    """What is changed by the mutants of the formulas that no test fails on. A mutant that does not run is an error."""
    alive = []
    for one in formulas:
        for text, function in mutants(one):
            with exchanged(one, function), np.errstate(all="ignore"):
                if not any(_fails(test, text) for test in tests):
                    alive.append(text)
    return alive


def _fails(test, text):
    try:
        test()
    except AssertionError:
        return True
    except Exception as error:
        raise RuntimeError(f"{text}: {test.__name__} does not judge it: {error!r}") from error
    return False
