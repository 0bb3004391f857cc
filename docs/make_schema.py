#!/usr/bin/env python3
"""Makes docs/network.xsd, the XML Schema for editors, of the tables in docs/network-xml.md.

    make_schema.py           writes it
    make_schema.py --check   tells whether it is as it would be written (exit code 1: it is not)

The reader's own table (src/manager/network_config_elements.c) is compared with the page by
tests/test_network_config_doc.c, and what the schema takes with what the reader takes by
tests/test_network_schema.c.

XML Schema 1.0 has no group of elements in any order of which one comes many times. So a network is a choice without end, and identity constraints count: a field has at most one value,
that of a key exactly one.
"""
import re
import sys
from pathlib import Path
from typing import NamedTuple
from xml.sax.saxutils import escape

HERE = Path(__file__).resolve().parent
PAGE, SCHEMA = HERE / "network-xml.md", HERE / "network.xsd"
BLANKS = r"[ \t\n\r]*"
ALSO_TAKEN = {"Baudrate": [100]}  # with a warning
INT16 = (-0x8000, 0x7FFF)
COUNTS = {"three": 3, "four": 4}

HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<!-- XML Schema 1.0 of the configuration file of mcanopen, for editors. Made by docs/make_schema.py
     from docs/network-xml.md, which also tells how editors find it: change that page instead. -->
<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema">
"""
ROOT = """
  <xs:element name="CANopen_Manager">
    <xs:annotation><xs:documentation>
      The CAN networks that one program manages.
    </xs:documentation></xs:annotation>
    <xs:complexType>
      <xs:sequence>
        <xs:element name="Manager_Instance" type="Manager_Instance" maxOccurs="16">
          <xs:annotation><xs:documentation>
            One CAN network. Its elements may come in any order, each but Node_Instance at most once.
          </xs:documentation></xs:annotation>
@COUNTS@        </xs:element>
      </xs:sequence>
    </xs:complexType>
    <xs:unique name="Net_No_is_given_twice">
      <xs:selector xpath="Manager_Instance"/>
      <xs:field xpath="Net_No"/>
    </xs:unique>
  </xs:element>
"""
NODE_CONSTRAINTS = """        <xs:unique name="DCF_File_or_CCF_File_not_both">
          <xs:selector xpath="."/>
          <xs:field xpath="DCF_File|CCF_File"/>
        </xs:unique>
"""


class Row(NamedTuple):
    """An element, as the page has it."""
    name: str
    type: str
    range: str
    default: str
    meaning: str

    @property
    def mandatory(self):
        return self.default == "**must**"

    @property
    def names(self):
        return [self.name, *re.findall(r"`(\w+)` is the same\.", self.meaning)]


def rows_of(page, parent):
    """The table behind a heading."""
    part = page.split(f"## Elements of `<{parent}>`\n", 1)[1].split("\n## ", 1)[0]
    rows = []
    for line in part.splitlines():
        if line.startswith("| `"):
            cells = [cell.strip() for cell in line.strip("| ").split(" |")]
            name = re.match(r"`(\w+)`", cells[0]).group(1)
            rows.append(Row(name, *cells[1:4], cells[-1]))
    return rows


# ---- ranges as patterns ------------------------------------------------------------------------

def span(letters):
    """'f', 'c-f': for use in brackets."""
    return letters if len(letters) < 3 else f"{letters[0]}-{letters[-1]}"


def one_of(low, high):
    """A digit."""
    figures, letters = "0123456789"[low:high + 1], "abcdef"[max(low - 10, 0):max(high - 9, 0)]
    if len(figures) == 1 and not letters:
        return figures
    return f"[{span(figures)}{span(letters)}{span(letters.upper())}]"


def same_length(low, high, base):
    """Patterns of the numbers low..high, given as lists of digits, as many in both."""
    if len(low) == 1:
        return [one_of(low[0], high[0])]
    if low[0] == high[0]:
        return [one_of(low[0], low[0]) + rest for rest in same_length(low[1:], high[1:], base)]
    any_rest = (one_of(0, base - 1)) + (f"{{{len(low) - 1}}}" if len(low) > 2 else "")
    first, last, parts = low[0], high[0], []
    if any(low[1:]):
        parts += [one_of(first, first) + rest
                  for rest in same_length(low[1:], [base - 1] * (len(low) - 1), base)]
        first += 1
    tail = []
    if any(digit != base - 1 for digit in high[1:]):
        tail = [one_of(last, last) + rest
                for rest in same_length([0] * (len(high) - 1), high[1:], base)]
        last -= 1
    middle = [one_of(first, last) + any_rest] if first <= last else []
    return parts + middle + tail


def digits_of(number, base):
    digits = [number % base]
    while number >= base:
        number //= base
        digits.insert(0, number % base)
    return digits


def numbers(low, high, base):
    """A pattern of low..high, both not negative, without zeros in front."""
    parts = []
    size = len(digits_of(low, base))
    while low <= high:
        last = min(high, base ** size - 1)
        parts += same_length(digits_of(low, base), digits_of(last, base), base)
        low, size = last + 1, size + 1
    return "|".join(parts)


def hexadecimal(low, high):
    size = len(digits_of(high, 16))
    if low <= 1 and high == 16 ** size - 1:
        zeros, more = ("0*", f"1,{size}") if low == 0 else (f"0*{one_of(1, 15)}", f"0,{size - 1}")
        return f"0[xX]{zeros}{one_of(0, 15)}{{{more}}}"
    return f"0[xX]0*({numbers(low, high, 16)})"


def signed(low, high):
    """A pattern of low..high around 0, decimal or hexadecimal."""
    def either(limit):
        return f"0*({numbers(0, limit, 10)})|{hexadecimal(0, limit)}"
    return f"{either(high)}|-({either(-low)})"


# ---- types -------------------------------------------------------------------------------------

def restriction(base, *facets):
    lines = "".join(f'\n        <xs:{kind} value="{escape(str(value))}"/>'
                    for kind, value in facets)
    return f'      <xs:simpleType><xs:restriction base="{base}">{lines}\n' \
           "      </xs:restriction></xs:simpleType>\n"


def simple_type(name, *members):
    if len(members) == 1:
        return "\n" + re.sub("(?m)^    ", "", members[0]).replace(
            "<xs:simpleType>", f'<xs:simpleType name="{name}">')
    return f'\n  <xs:simpleType name="{name}">\n    <xs:union>\n{"".join(members)}' \
           "    </xs:union>\n  </xs:simpleType>\n"


def whole(low, high):
    """Members of a union: low..high in decimal and in hexadecimal digits."""
    zero = [("pattern", "-0[xX]0+")] if low == 0 else []
    return [restriction("xs:integer", ("minInclusive", low), ("maxInclusive", high),
                        ("pattern", "[0-9]+|-0+")),
            restriction("xs:token", ("pattern", hexadecimal(low, high)), *zero)]


def number_type(row):
    """Name and text of the type of '0..255', '0 or 100..65535'."""
    apart, low, high = re.fullmatch(r"(?:(\d+) or )?(\d+)\.\.(\w+)", row.range).groups()
    members = whole(int(low), int(high, 0))
    if apart:
        members = whole(int(apart), int(apart)) + members
    name = f"{row.type}_{apart + '_or_' if apart else ''}{low}_{high}"
    return name, simple_type(name, *members)


def list_type(row):
    """'10, 20, 50': numbers, nothing else."""
    listed = [int(number) for number in row.range.split(", ")] + ALSO_TAKEN.get(row.name, [])
    pattern = "|".join(numbers(number, number, 16) for number in sorted(listed))
    enumeration = [("enumeration", number) for number in sorted(listed)]
    return row.name, simple_type(
        row.name, restriction("xs:integer", ("pattern", "[0-9]+"), *enumeration),
        restriction("xs:token", ("pattern", f"0[xX]0*({pattern})")))


def priorities_type(row):
    """'three, `a:b:c`'"""
    count = COUNTS[row.range.split(",")[0]]
    field = f" ?({signed(*INT16)}) ?"
    name = f"INT16_{count}"
    return name, simple_type(name, restriction("xs:token", ("pattern", ":".join([field] * count))))


def bool_type(_row):
    """Other cases than these are taken with a warning."""
    return "BOOL", simple_type(
        "BOOL", restriction("xs:token", ("enumeration", "TRUE"), ("enumeration", "FALSE")),
        restriction("xs:token", ("pattern", "[Tt][Rr][Uu][Ee]|[Ff][Aa][Ll][Ss][Ee]")))


def enum_type(row):
    words = re.findall(r"`(\w+)`", row.range)
    return row.name, simple_type(
        row.name, restriction("xs:token", *[("enumeration", word) for word in words]))


def ascii_type(_row):
    """Blanks around it do not count, but there are no line ends in it."""
    delete = "\x7f"
    pattern = rf"{BLANKS}[^ \t\n\r{delete}][^\t\n\r{delete}]*{BLANKS}"
    return "ASCII", simple_type("ASCII", restriction(
        "xs:string", ("maxLength", 4095), ("pattern", pattern))).replace(delete, "&#x7F;")


def type_of(row):
    if row.type == "INT16":
        return priorities_type(row)
    if row.type == "USHORT" and ", " in row.range:
        return list_type(row)
    maker = {"BOOL": bool_type, "ENUM": enum_type, "ASCII": ascii_type}
    return maker.get(row.type, number_type)(row)


# ---- elements ----------------------------------------------------------------------------------

def plain(text):
    """The page's text without its marks."""
    text = re.sub(r"see \[(?:below|above)\]\([^)]*\)", "see docs/network-xml.md", text)
    return re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", text).replace("`", "")


def documentation(row):
    words = [row.type]
    if row.range:
        words.append(plain(row.range))
    if row.mandatory:
        words.append("must be given")
    elif row.default != "-":
        words.append(f"default {plain(row.default)}")
    return escape(f"{', '.join(words)}. {plain(row.meaning)}")


def element(name, row, occurs=""):
    return f"""      <xs:element name="{name}" type="{type_of(row)[0]}"{occurs}>
        <xs:annotation><xs:documentation>{documentation(row)}</xs:documentation></xs:annotation>
      </xs:element>
"""


def count(row):
    """In a network: once where the element is mandatory, else not more than once."""
    kind, says = ("key", "is_given_once") if row.mandatory else ("unique", "is_given_twice")
    return f"""          <xs:{kind} name="{row.name}_{says}">
            <xs:selector xpath="."/>
            <xs:field xpath="{'|'.join(row.names)}"/>
          </xs:{kind}>
"""


def node_ids():
    return """          <xs:unique name="Node_Id_is_another_ones">
            <xs:selector xpath="Manager_Node_Id|Node_Instance/Node_Id"/>
            <xs:field xpath="."/>
          </xs:unique>
"""


def network(rows):
    elements = "".join(element(name, row) for row in rows for name in row.names)
    return f"""
  <xs:complexType name="Manager_Instance">
    <xs:choice minOccurs="0" maxOccurs="unbounded">
{elements}      <xs:element name="Node_Instance" type="Node_Instance">
        <xs:annotation><xs:documentation>
          One device of the network. Its elements may come in any order, each at most once.
        </xs:documentation></xs:annotation>
{NODE_CONSTRAINTS}      </xs:element>
    </xs:choice>
  </xs:complexType>
"""


def node(rows):
    elements = "".join(element(row.name, row, "" if row.mandatory else ' minOccurs="0"')
                       for row in rows)
    return f"""
  <xs:complexType name="Node_Instance">
    <xs:all>
{elements}    </xs:all>
  </xs:complexType>
"""


def make_schema(page):
    networks, nodes = rows_of(page, "Manager_Instance"), rows_of(page, "Node_Instance")
    counts = "".join(count(row) for row in networks) + node_ids()
    types = dict(type_of(row) for row in networks + nodes)
    return (HEAD + ROOT.replace("@COUNTS@", counts) + network(networks) + node(nodes) +
            "".join(types.values()) + "</xs:schema>\n")


def main(arguments):
    schema = make_schema(PAGE.read_text(encoding="utf-8"))
    if arguments == ["--check"]:
        if SCHEMA.exists() and SCHEMA.read_text(encoding="utf-8") == schema:
            return 0
        print(f"{SCHEMA}: not as of {PAGE.name}: run docs/make_schema.py")
        return 1
    if arguments:
        print(__doc__.strip())
        return 2
    SCHEMA.write_text(schema, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
