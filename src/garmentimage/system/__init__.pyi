from .files import (
    check_output as check_output,
    safe_name as safe_name,
    shown_path as shown_path,
    write_atomically as write_atomically,
    write_together as write_together,
)
from .interrupts import (
    ctrl_c_held as ctrl_c_held,
)
from .npy import (
    NPY_MAGIC as NPY_MAGIC,
    ZIP_MAGIC as ZIP_MAGIC,
    npy_bytes as npy_bytes,
    npz_bytes as npz_bytes,
    parse_npy as parse_npy,
    parse_npz as parse_npz,
)
from .processes import (
    Outcome as Outcome,
    TimedOut as TimedOut,
    map_in_processes as map_in_processes,
)
from .provenance import (
    source_commit as source_commit,
    versions as versions,
    weights_hash as weights_hash,
)
from .read import (
    errors_about as errors_about,
    read_limited as read_limited,
)
from .suggest import (
    did_you_mean as did_you_mean,
    join_words as join_words,
)
