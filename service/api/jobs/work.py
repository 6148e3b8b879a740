"""What jobs do, in a process of their own: nothing here touches the store.

A kind of work is a function of the request and of `tell`, which takes the share that is done. It
returns plain values; what it leaves in the folder `request["files"]`, which is there and empty,
clients may download. Adding one is one file in `kinds` and one line in `KINDS`.
"""

from collections.abc import Callable, Mapping
from typing import Any, Final

from service.api.jobs.kinds.calibration import calibrate
from service.api.jobs.kinds.diagnosis import diagnose
from service.api.jobs.kinds.photon_transfer import photon_transfer
from service.api.jobs.kinds.transfer_function import transfer_function

Work = Callable[[Mapping[str, Any], Callable[[float], None]], dict[str, Any]]

KINDS: Final[dict[str, Work]] = {
    "calibrate": calibrate,
    "photon-transfer": photon_transfer,
    "diagnose": diagnose,
    "transfer-function": transfer_function,
}
