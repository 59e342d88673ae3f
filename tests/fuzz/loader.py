"""What fuzz_loader calls: the ending of the file is in $FUZZ_ENDING."""

import os
import sys
import tempfile
import warnings
from pathlib import Path

import fuzz_counters
import lightcull

_FOLDER = str(Path(lightcull.__file__).parent)
_PATH = Path(tempfile.mkdtemp()) / f"scene{os.environ['FUZZ_ENDING']}"
warnings.simplefilter("ignore")


def _trace(frame, event, argument):
    if not frame.f_code.co_filename.startswith(_FOLDER):
        return None
    if event == "line":
        fuzz_counters.count(hash((frame.f_code.co_name, frame.f_lineno)))
    return _trace


sys.settrace(_trace)


def load(data: bytes) -> None:
    """Throws whatever is not a `lightcull.Error` of one line."""
    _PATH.write_bytes(data)
    try:
        lightcull.load(_PATH)
    except lightcull.Error as error:
        if len(str(error).splitlines()) != 1:
            raise AssertionError("the message has several lines") from error
