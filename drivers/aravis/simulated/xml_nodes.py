"""The GenICam nodes that the description of a camera is made of.

Source: EMVA GenICam standard, GenApi 1.1 schema.
"""

from collections.abc import Mapping, Sequence
from xml.etree.ElementTree import Element, SubElement

from drivers.aravis.simulated.registers import Register


def element(parent: Element, kind: str, name: str, **children: object) -> Element:
    """Add `<kind Name=name>`; each child that is not None becomes an element, in this order."""
    node = SubElement(parent, kind, Name=name, NameSpace="Standard")
    for tag, value in children.items():
        if value is not None:
            SubElement(node, tag).text = str(value)
    return node


def category(parent: Element, name: str, features: Sequence[str]) -> None:
    """Add a category of `features`."""
    node = element(parent, "Category", name)
    for feature in features:
        SubElement(node, "pFeature").text = feature


def register(parent: Element, name: str, at: Register, access: str = "RW") -> str:
    """Add a four-byte unsigned register that clients never cache; return its name."""
    _memory(
        parent,
        "IntReg",
        name,
        at=at,
        length=4,
        access=access,
        Sign="Unsigned",
        Endianess="BigEndian",
    )
    return name


def text(parent: Element, name: str, at: tuple[int, int]) -> None:
    """Add a read-only text."""
    address, length = at
    _memory(parent, "StringReg", name, at=address, length=length, access="RO")


def measured(parent: Element, name: str, at: Register, unit: str) -> None:
    """Add a read-only float, kept as one."""
    _memory(parent, "FloatReg", f"{name}Reg", at=at, length=4, access="RO", Endianess="BigEndian")
    element(parent, "Float", name, pValue=f"{name}Reg", Unit=unit)


def constant(parent: Element, name: str, value: int) -> None:
    """Add an integer that never changes."""
    element(parent, "Integer", name, Value=value)


def integer(
    parent: Element,
    name: str,
    at: Register,
    *,
    low: int,
    high: int | str,
    step: int = 1,
    lockable: bool = False,
) -> None:
    """Add an integer; `high` is a number or the name of the node that tells it."""
    element(
        parent,
        "Integer",
        name,
        pIsLocked="TLParamsLocked" if lockable else None,
        pValue=register(parent, f"{name}Reg", at),
        Min=low,
        **({"pMax": high} if isinstance(high, str) else {"Max": high}),
        Inc=step,
    )


def scaled(
    parent: Element,
    name: str,
    at: Register,
    *,
    to_register: str,
    from_register: str,
    low: float,
    high: float | str,
    unit: str,
    register_low: int = 0,
) -> None:
    """Add a float over an integer register; `FROM` is the float, `TO` the register's value.

    `register_low` must be 1 where a formula divides by the register: Aravis works out the range
    of the converter from that of the register.
    """
    reg = register(parent, f"{name}Reg", at)
    element(parent, "Integer", f"{name}Int", pValue=reg, Min=register_low, Max=0x7FFFFFFF)
    element(
        parent,
        "Converter",
        f"{name}Conv",
        FormulaTo=to_register,
        FormulaFrom=from_register,
        pValue=f"{name}Int",
    )
    element(
        parent,
        "Float",
        name,
        pValue=f"{name}Conv",
        Min=low,
        **({"pMax": high} if isinstance(high, str) else {"Max": high}),
        Unit=unit,
    )


def formula(parent: Element, kind: str, name: str, formula: str, **variables: str) -> None:
    """Add an `IntSwissKnife` or `SwissKnife`: `variables` name the nodes it reads."""
    node = element(parent, kind, name)
    for variable, source in variables.items():
        SubElement(node, "pVariable", Name=variable).text = source
    SubElement(node, "Formula").text = formula


def choice(
    parent: Element,
    name: str,
    at: Register,
    entries: Mapping[str, int],
    *,
    lockable: bool = False,
) -> None:
    """Add an enumeration."""
    node = element(parent, "Enumeration", name, pIsLocked="TLParamsLocked" if lockable else None)
    for entry, value in entries.items():
        element(node, "EnumEntry", entry, Value=value)
    SubElement(node, "pValue").text = register(parent, f"{name}Reg", at)


def only_choice(parent: Element, name: str, entry: str) -> None:
    """Add an enumeration with one entry."""
    node = element(parent, "Enumeration", name)
    element(node, "EnumEntry", entry, Value=1)
    SubElement(node, "Value").text = "1"


def command(parent: Element, name: str, register_name: str, value: int) -> None:
    """Add a command that writes `value`."""
    element(parent, "Command", name, pValue=register_name, CommandValue=value)


def _memory(
    parent: Element,
    kind: str,
    name: str,
    *,
    at: int,
    length: int,
    access: str,
    **more: str,
) -> None:
    element(
        parent,
        kind,
        name,
        Address=f"{int(at):#x}",
        Length=length,
        AccessMode=access,
        pPort="Device",
        Cachable="NoCache",
        **more,
    )
