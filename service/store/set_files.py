"""The files of coefficient sets, each named by its content: `<sha256>.h5`."""

from pathlib import Path
from typing import TYPE_CHECKING

from calib.errors import InputError
from service.store.errors import NotInStoreError, StoreError

if TYPE_CHECKING:
    from calib.radiometric.coefficients.coefficient_set import CoefficientSet


class SetFiles:
    """A folder of immutable files. A file without a record is an orphan, and does no harm."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def path(self, set_id: str) -> Path:
        """Return where the set's file is, or would be."""
        return self.folder / f"{set_id}.h5"

    def put(self, coefficients: "CoefficientSet") -> Path:
        """Keep the set, on the disk itself before this returns; nothing to do where it is kept."""
        path = self.path(coefficients.id)
        if path.is_file() and self._is_whole(path):
            return path
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            msg = f"{self.folder} cannot be made ({error.strerror}); set DARKFLAT_HOME elsewhere"
            raise StoreError(msg, code="store-not-writable") from error
        coefficients.save(path)
        return path

    def load(self, set_id: str) -> "CoefficientSet":
        """Read a set and verify its content.

        Raises:
            NotInStoreError: The file is gone.
            InputError: `altered` or `not-a-coefficient-set`.
        """
        from calib.radiometric.coefficients.coefficient_set import CoefficientSet  # noqa: PLC0415  (heavy)

        path = self.path(set_id)
        if not path.is_file():
            msg = f"the file of coefficient set {set_id[:12]} is gone; restore {path} from a copy"
            raise NotInStoreError(msg)
        coefficients = CoefficientSet.load(path)
        if coefficients.id != set_id:
            msg = f"{path} holds another set than its name says; restore it from a copy"
            raise InputError(msg, code="altered")
        return coefficients

    def _is_whole(self, path: Path) -> bool:
        try:
            self.load(path.stem)
        except InputError:
            return False
        return True
