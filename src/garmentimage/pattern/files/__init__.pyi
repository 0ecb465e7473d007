from .json_file import (
    LongInteger as LongInteger,
    parse as parse,
    read_bytes as read_bytes,
)
from .spec import (
    load_pattern as load_pattern,
    pattern_from_spec as pattern_from_spec,
    pattern_text as pattern_text,
    read_pattern as read_pattern,
    save_pattern as save_pattern,
)
from .spec_reader import (
    CM_PER_METRE as CM_PER_METRE,
    read_spec as read_spec,
)
from .spec_writer import (
    pattern_to_spec as pattern_to_spec,
)
from .svg import (
    lay_out as lay_out,
)
from .values import (
    as_integer as as_integer,
    as_list as as_list,
    as_number as as_number,
    as_numbers as as_numbers,
    as_object as as_object,
    as_point as as_point,
    member as member,
    shown as shown,
    without as without,
)
