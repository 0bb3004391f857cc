"""The public names, and the table tests/contract.tsv that gives each its test.

The names are computed from the headers, and those of elements from the manager's reader. Kinds:

    function   canOpenCreateNodeEx
    error      canOpenCreateNodeEx SCANOPEN_WRONG_PARAMETER: each error of each function, as the
               comment of the function and the rules at the top of its header have it
    type       SLAVE_NODE_INFO
    member     SLAVE_NODE_INFO.ulOptions
    event      EV_STATE_CHANGE, MCANOPEN_MSG_BOOT_UP
    macro      BEGIN_DICTIONARY_TABLE: with parameters
    element    Node_Instance/Guard_Time: of the manager's XML file, by each of its names, and
               Manager_Instance/NMT_Action_On_Error STOP_ALL: by values other than the default
    constant   all others, tables of texts among them; error codes only where they are no function's
               error

Lines of the table: kind, name, test, remark, with a tab between them. Test is program:function, or
"later" for what the library does not have yet, or "none" for what no test can see; these two need
the remark. '#' begins a comment.
"""
import re
from pathlib import Path
from typing import NamedTuple

HEADERS = ("scanopen.h", "scanopen_types.h", "scanopen_tables.h",
           "mcanopen.h", "mcanopen_types.h", "paraInfo.h")
ELEMENTS = "src/manager/network_config_elements.c"
ELEMENT_TABLE = re.compile(r"struct element (\w+)\[\] = \{(.*?)\n\};", re.S)
ELEMENT = re.compile(r'(?:\{ |\.alias = )"(\w+)"')
VALUES = {"NMT_Action_On_Error": ("STOP_ALL",)}  # beside the one of the element's own row
COMMENT = re.compile(r"/\*.*?\*/", re.S)
GUARD = re.compile(r"(SCANOPEN|MCANOPEN|PARA_INFO)\w*_H")
DEFINE = re.compile(r"^\s*#\s*define\s+(\w+)(\(?)", re.M)
STRUCTURE = re.compile(r"\btypedef\s+(?:struct|union)\s*\{(.*?)\n\}\s*([^;]*);", re.S)
ENUM = re.compile(r"\benum\s*\{(.*?)\}\s*;", re.S)
ENUMERATOR = re.compile(r"\b([A-Z]\w*)(?=\s*(?:[=,]|$))")
EVENT = re.compile(r"(EV|MCANOPEN_MSG)_")
VARIABLE = re.compile(r"\bMCANOPEN_API\s+extern\s+[^;]*?\b(\w+)\s*\[\w*\]\s*;")
SIMPLE_TYPE = re.compile(r"\btypedef\s+[^;{}]*?(?:\(\*(\w+)\)\([^;]*\)|\b(\w+))\s*;")
FUNCTION = re.compile(r"\bMCANOPEN_API\s+([\w *]+?)\b(\w+)\(([^;]*)\);")
CODE = re.compile(r"\bSCANOPEN_[A-Z_]+\b")
MANAGER_CODE = re.compile(r"\b(?:MCAL|CANOPEN_DCF)_[A-Z_]*[A-Z]\b")
NO_ERRORS = {"SCANOPEN_OK", "SCANOPEN_NOT_IMPLEMENTED"}
# "CANOPEN_DCF_...": those of the first block, not those that are only defined.
DCF_CODES = re.compile(r"#define (CANOPEN_DCF_\w+)")
ONLY_DEFINED = "Defined so that programs compile"

# Functions whose comment refers to that of another one, and what does not hold for them.
LIKE = {"canOpenCreateNode": "canOpenCreateNodeEx",
        "canOpenInitDictionaryTs": "canOpenInitDictionary",
        "canOpenInitDictionaryTS": "canOpenInitDictionary",
        "canOpenReadDictionaryHnd": "canOpenReadDictionary",
        "canOpenWriteDictionaryHnd": "canOpenWriteDictionary",
        "canOpenRequestPDO": "canOpenReadPDO",
        "mcanOpenWriteSDO": "mcanOpenReadSDO"}
NOT_LIKE = {"mcanOpenWriteSDO": {"MCAL_BUFFER_OVERFLOW", "MCAL_OBJ_NO_MEMORY"}}
BY_HANDLE = {"SCANOPEN_WRONG_INDEX", "SCANOPEN_WRONG_SUBINDEX"}
# All values of their arguments are good, beside the handle.
ANY_ARGUMENT = {"canOpenWritePDO", "canOpenReadPDO", "canOpenRequestPDO"}
HANDLES = re.compile(r"^(HNODE|HPDO|HDICT)\s+\w+$")
NET = re.compile(r"^(int|unsigned short) net$")
NEVER_FAILS = {"mcanOpenNodeControl"}
# Of the headers themselves.
TOOLS = {"MCANOPEN_API", "MCANOPEN_CAST", "MCANOPEN_INLINE", "MCANOPEN_MAYBE_UNUSED"}


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


def manager_errors(function, text):
    """What mcanopen.h says, at its top and at the function."""
    errors = set(MANAGER_CODE.findall(function.comment))
    if NET.match(function.parameters[0]) and function.name not in NEVER_FAILS:
        errors |= {"MCAL_NO_NET", "MCAL_SYS_ERROR", "MCAL_PARA_ERROR"}
    if "CANOPEN_DCF_..." in function.comment:
        errors |= set(DCF_CODES.findall(text.partition(ONLY_DEFINED + ". Real")[0]))
    return errors


def slave_errors(function):
    """What the rules at the top of scanopen.h say of every function, and what is at this one."""
    errors, others = set(), [p for p in function.parameters if not HANDLES.match(p)]
    if len(others) < len(function.parameters):
        errors.add("SCANOPEN_INVALID_HANDLE")
    if others and function.name not in ANY_ARGUMENT:
        errors.add("SCANOPEN_WRONG_PARAMETER")
    if "not from callbacks" in re.sub(r"[\s*]+", " ", function.comment).lower():
        errors.add("SCANOPEN_SERVICE_NOT_ALLOWED")
    return errors | set(CODE.findall(function.comment)) - NO_ERRORS


def errors_of(function, functions, text=""):
    """The error codes that a function is said to return; text: all headers."""
    if function.result == "void":
        return set()
    is_manager = function.name.startswith("mcanOpen")
    errors = manager_errors(function, text) if is_manager else slave_errors(function)
    if function.name in LIKE:
        model = next((f for f in functions if f.name == LIKE[function.name]), None)
        like = errors_of(model, functions, text) if model else set()
        errors |= like - NOT_LIKE.get(function.name, set())
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
        yield from (("event" if EVENT.match(n) else "constant", n)
                    for n in ENUMERATOR.findall(match.group(1)))


def define_names(text):
    for match in DEFINE.finditer(text):
        name = match.group(1)
        if GUARD.fullmatch(name):
            continue
        if match.group(2):
            yield "macro", name
        else:
            yield ("event" if EVENT.match(name) else "constant"), name


def private(name):
    """Names that headers and tables are made of, not for use by themselves."""
    is_inner = name.startswith("_COS_") and not name.endswith(".handle")
    return name in TOOLS or is_inner or name.endswith("_")


def header_names(text):
    """The (kind, name) of a header without its functions' errors."""
    yield from (("function", f.name) for f in functions_of(text))
    plain = COMMENT.sub(" ", text)
    yield from (("constant", name) for name in VARIABLE.findall(plain))
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
    whole = "".join(texts)
    errors = {(f.name, e) for f in functions for e in errors_of(f, functions, whole)}
    names |= {("error", f"{f} {e}") for f, e in errors}
    doubles = {("constant", e) for _, e in errors} | {("macro", f.name) for f in functions}
    return names - doubles


def element_names(text):
    """Those of network_config_elements.c."""
    for parent, rows in ELEMENT_TABLE.findall(text):
        table = {"network_rows": "Manager_Instance", "node_rows": "Node_Instance"}[parent]
        for name in ELEMENT.findall(rows):
            yield "element", f"{table}/{name}"
            yield from (("element", f"{table}/{name} {v}") for v in VALUES.get(name, ()))


def all_names(root):
    """The set of (kind, name) of headers and elements."""
    elements = (Path(root) / ELEMENTS).read_text(encoding="utf-8")
    return public_names(read_headers(Path(root) / "include")) | set(element_names(elements))


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
