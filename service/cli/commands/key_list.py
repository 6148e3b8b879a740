"""`darkflat key list`: all keys, without their secrets."""

from service.cli.answering import Json, answering


def list_keys(json: Json = None) -> None:
    """List all keys, oldest first; those that are over stay on record."""
    with answering(json) as answer:
        from service.cli.key_record import show_keys, told  # noqa: PLC0415
        from service.cli.opened_store import opened_store  # noqa: PLC0415

        with opened_store() as store:
            records = store.keys.list()
        answer.give({"items": [told(each) for each in records]}, show_keys(records))
