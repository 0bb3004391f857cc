"""How deep the blocks of a function lie in each other, for C and for Python.

An "else if" is no deeper than its "if", nor an "elif"; a macro that ends in a statement or a block,
like FOR_EACH(...), is a loop; BEGIN_x(...) to END_x() is a declaration. (lizard counts chains of
else as depth, and the blocks of all functions of a Python file as one.)
"""
import ast
import re

CONTROL = ("if", "for", "while", "switch")
TOKEN = re.compile(r'"(?:\\.|[^"\\])*"|\'(?:\\.|[^\'\\])*\'|[A-Za-z_]\w*|\d[\w.]*|\S')
COMMENT = re.compile(r'("(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\')|//[^\n]*|/\*.*?\*/'
                     r"|^[ \t]*#(?:\\\n|[^\n])*", re.S | re.M)
PYTHON_BLOCKS = (ast.If, ast.For, ast.While, ast.With, ast.Try)


class CFunction:
    """Walks through the tokens of one function's body."""

    def __init__(self, text):
        self.tokens = TOKEN.findall(COMMENT.sub(lambda m: m.group(1) or " ", text))
        self.at = 0
        self.deepest = 0

    def peek(self, ahead=0):
        at = self.at + ahead
        return self.tokens[at] if at < len(self.tokens) else ""

    def skip_balanced(self, opening, closing):
        """Behind the bracket that closes the one here."""
        depth = 0
        while self.at < len(self.tokens):
            depth += (self.peek() == opening) - (self.peek() == closing)
            self.at += 1
            if depth == 0:
                return

    def is_word(self):
        return re.match(r"[A-Za-z_]", self.peek()) is not None

    def block(self, depth):
        self.at += 1
        while self.peek() not in ("}", ""):
            self.statement(depth)
        self.at += 1

    def inner(self, depth):
        self.deepest = max(self.deepest, depth + 1)
        self.statement(depth + 1)

    def control(self, depth):
        self.at += 1
        self.skip_balanced("(", ")")
        self.inner(depth)
        if self.peek() == "else":
            self.at += 1
            branch = self.statement if self.peek() == "if" else self.inner
            branch(depth)

    def table(self):
        """A declaration: BEGIN_x(...), entries, END_x()"""
        while self.peek() and not self.peek().startswith("END_"):
            self.at += 1
        self.at += 1
        self.skip_balanced("(", ")")

    def simple(self, depth):
        """Up to the semicolon; or a macro that is a loop."""
        if self.is_word() and self.peek(1) == "(":
            self.at += 1
            self.skip_balanced("(", ")")
            if self.peek() == "{" or self.is_word():
                self.inner(depth)
                return
        while self.peek() not in (";", "}", ""):
            bracket = {"(": ")", "{": "}", "[": "]"}.get(self.peek())
            if bracket:
                self.skip_balanced(self.peek(), bracket)
            else:
                self.at += 1
        self.at += self.peek() == ";"

    def label(self):
        while self.peek() not in (":", ""):
            self.at += 1
        self.at += 1

    def statement(self, depth):
        token = self.peek()
        if token == "{":
            self.block(depth)
        elif token in CONTROL:
            self.control(depth)
        elif token.startswith("BEGIN_"):
            self.table()
        elif token == "do":
            self.at += 1
            self.inner(depth)
            self.simple(depth)
        elif token in ("case", "default") or self.peek(1) == ":":
            self.label()
        else:
            self.simple(depth)


def c_nesting(text):
    """text: a function, its head included"""
    walker = CFunction(text)
    while walker.peek() not in ("{", ""):
        walker.at += 1
    walker.block(0)
    return walker.deepest


def python_node_nesting(node, depth=0):
    deepest = depth
    for child in ast.iter_child_nodes(node):
        is_elif = isinstance(node, ast.If) and isinstance(child, ast.If) and child in node.orelse
        is_block = isinstance(child, PYTHON_BLOCKS) and not is_elif
        deepest = max(deepest, python_node_nesting(child, depth + is_block))
    return deepest


def python_nesting(text):
    """{line of the function: its nesting}"""
    return {node.lineno: python_node_nesting(node) for node in ast.walk(ast.parse(text))
            if isinstance(node, ast.FunctionDef)}
