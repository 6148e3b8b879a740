"""Every feature of a camera and its value, for provenance."""

from collections.abc import Iterator

from drivers.aravis.gi_aravis import aravis, glib_error
from drivers.aravis.gi_types import GiCamera, GiGenicam, GiNode


def all_features(camera: GiCamera) -> dict[str, str]:
    """Return name and value of each feature below `Root`, commands left out.

    A feature that cannot be read now says why in place of its value: one such must not keep the
    others from the record.
    """
    genicam = camera.get_device().get_genicam()
    return {name: _value(node) for name, node in _features(genicam, "Root")}


def _features(genicam: GiGenicam, category: str) -> Iterator[tuple[str, GiNode]]:
    module = aravis()
    node = genicam.get_node(category)
    for name in node.get_features() if node is not None else ():
        child = genicam.get_node(name)
        if isinstance(child, module.GcCategory):
            yield from _features(genicam, name)
        elif child is not None and not isinstance(child, module.GcCommand):
            yield name, child


def _value(node: GiNode) -> str:
    try:
        if not node.is_implemented():
            return "(not implemented)"
        if not node.is_available():
            return "(not available)"
        return str(node.get_value_as_string())
    except glib_error() as error:
        return f"(unreadable: {getattr(error, 'message', error)})"
