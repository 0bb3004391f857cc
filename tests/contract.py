"""The public names of the slave headers, and the table tests/contract.tsv that gives each its test.

The names are computed from the headers. Kinds:

    function   canOpenCreateNodeEx
    error      canOpenCreateNodeEx SCANOPEN_WRONG_PARAMETER: each error of each function, as the
               comment of the function and the rules at the top of scanopen.h have it
    type       SLAVE_NODE_INFO
    member     SLAVE_NODE_INFO.ulOptions
    event      EV_STATE_CHANGE
    macro      BEGIN_DICTIONARY_TABLE: with parameters
    constant   all others; error codes only where they are no function's error

Lines of the table: kind, name, test, remark, with a tab between them. Test is program:function, or
"later" for what the library does not have yet, or "none" for what no test can see; these two need
the remark. '#' begins a comment.
"""
import re
from pathlib import Path
from typing import NamedTuple

HEADERS = ("scanopen.h", "scanopen_types.h", "scanopen_tables.h")
COMMENT = re.compile(r"/\*.*?\*/", re.S)
GUARD = re.compile(r"SCANOPEN\w*_H")
DEFINE = re.compile(r"^\s*#\s*define\s+(\w+)(\(?)", re.M)
STRUCTURE = re.compile(r"\btypedef\s+(?:struct|union)\s*\{(.*?)\n\}\s*([^;]*);", re.S)
ENUM = re.compile(r"\benum\s*\{(.*?)\}\s*;", re.S)
ENUMERATOR = re.compile(r"\b([A-Z]\w*)(?=\s*(?:[=,]|$))")
SIMPLE_TYPE = re.compile(r"\btypedef\s+[^;{}]*?(?:\(\*(\w+)\)\([^;]*\)|\b(\w+))\s*;")
FUNCTION = re.compile(r"\bMCANOPEN_API\s+([\w *]+?)\b(\w+)\(([^;]*)\);")
CODE = re.compile(r"\bSCANOPEN_[A-Z_]+\b")
NO_ERRORS = {"SCANOPEN_OK", "SCANOPEN_NOT_IMPLEMENTED"}

# Functions whose comment refers to that of another one, and what does not hold for them.
LIKE = {"canOpenCreateNode": "canOpenCreateNodeEx",
        "canOpenInitDictionaryTs": "canOpenInitDictionary",
        "canOpenInitDictionaryTS": "canOpenInitDictionary",
        "canOpenReadDictionaryHnd": "canOpenReadDictionary",
        "canOpenWriteDictionaryHnd": "canOpenWriteDictionary",
        "canOpenRequestPDO": "canOpenReadPDO"}
BY_HANDLE = {"SCANOPEN_WRONG_INDEX", "SCANOPEN_WRONG_SUBINDEX"}
# All values of their arguments are good, beside the handle.
ANY_ARGUMENT = {"canOpenWritePDO", "canOpenReadPDO", "canOpenRequestPDO"}
HANDLES = re.compile(r"^(HNODE|HPDO|HDICT)\s+\w+$")


class Function(NamedTuple):
    result: str
    name: str
    parameters: list  # of texts
    comment: str


class Row(NamedTuple):
    line: int
    kind: str
    name: str
    test: str
    remark: str

    @property
    def has_test(self):
        return self.test not in ("later", "none")


# --- headers --------------------------------------------------------------------------------------

def functions_of(text):
    """The functions of a header in order; several behind one comment share it."""
    found = []
    for match in FUNCTION.finditer(text):
        comments = [c for c in COMMENT.finditer(text, 0, match.start())]
        parameters = [re.sub(r"\s+", " ", p).strip() for p in match.group(3).split(",")]
        found.append(Function(match.group(1).strip(), match.group(2), parameters,
                              comments[-1].group() if comments else ""))
    return found


def general_errors(function):
    """What the rules at the top of scanopen.h say of every function."""
    errors, others = set(), [p for p in function.parameters if not HANDLES.match(p)]
    if len(others) < len(function.parameters):
        errors.add("SCANOPEN_INVALID_HANDLE")
    if others and function.name not in ANY_ARGUMENT:
        errors.add("SCANOPEN_WRONG_PARAMETER")
    if "not from callbacks" in re.sub(r"[\s*]+", " ", function.comment).lower():
        errors.add("SCANOPEN_SERVICE_NOT_ALLOWED")
    return errors


def errors_of(function, functions):
    """The error codes that a function is said to return."""
    if function.result == "void":
        return set()
    errors = general_errors(function) | set(CODE.findall(function.comment)) - NO_ERRORS
    if function.name in LIKE:
        model = next((f for f in functions if f.name == LIKE[function.name]), None)
        errors |= errors_of(model, functions) if model else set()
    return errors - BY_HANDLE if function.parameters[0].startswith("HDICT ") else errors


def members_of(body):
    """The names of the members, those of nested unions too."""
    body = re.sub(r"\b(?:__extension__\s+)?union\s*\{|\}\s*\w*\s*;", " ", body)
    declarators = (part for line in body.split(";") for part in line.split(","))
    return [m.group(1) for m in (re.search(r"(\w+)\s*(?:\[\w*\])?\s*$", d) for d in declarators)
            if m]


def structure_names(text):
    for match in STRUCTURE.finditer(text):
        aliases = [a.strip(" *") for a in match.group(2).split(",")]
        yield from (("type", a) for a in aliases)
        yield from (("member", f"{aliases[0]}.{m}") for m in members_of(match.group(1)))


def enum_names(text):
    for match in ENUM.finditer(text):
        yield from (("constant", n) for n in ENUMERATOR.findall(match.group(1)))


def define_names(text):
    for match in DEFINE.finditer(text):
        name = match.group(1)
        if GUARD.fullmatch(name):
            continue
        if match.group(2):
            yield "macro", name
        else:
            yield ("event" if name.startswith("EV_") else "constant"), name


def private(name):
    """Names that the tables are made of, not for use by themselves."""
    return name.startswith("_COS_") and not name.endswith(".handle") or name.endswith("_")


def header_names(text):
    """The (kind, name) of a header without its functions' errors."""
    yield from (("function", f.name) for f in functions_of(text))
    plain = COMMENT.sub(" ", text)
    yield from define_names(plain)
    plain = re.sub(r"^\s*#(?:[^\n]*\\\n)*[^\n]*", "", plain, flags=re.M)
    yield from structure_names(plain)
    yield from enum_names(plain)
    rest = STRUCTURE.sub("", plain)
    yield from (("type", a or b) for a, b in SIMPLE_TYPE.findall(rest))


def public_names(texts):
    """The set of (kind, name) of all headers."""
    functions = [f for text in texts for f in functions_of(text)]
    names = {name for text in texts for name in header_names(text) if not private(name[1])}
    errors = {(f.name, e) for f in functions for e in errors_of(f, functions)}
    names |= {("error", f"{f} {e}") for f, e in errors}
    doubles = {("constant", e) for _, e in errors} | {("macro", f.name) for f in functions}
    return names - doubles


def read_headers(folder):
    return [(Path(folder) / name).read_text(encoding="utf-8") for name in HEADERS]


# --- the table ------------------------------------------------------------------------------------

def parse_rows(text):
    """The rows; a line that is none raises ValueError."""
    rows = []
    for number, line in enumerate(text.splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        fields = line.split("\t")
        if len(fields) not in (3, 4):
            raise ValueError(f"contract.tsv:{number}: not kind, name, test, remark")
        rows.append(Row(number, *(f.strip() for f in fields + [""] * (4 - len(fields)))))
    return rows
