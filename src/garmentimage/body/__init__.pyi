from .body import (
    Body as Body,
    Points3 as Points3,
    Vector3 as Vector3,
    load_body as load_body,
)
from .body_measurements import (
    BodyMeasurements as BodyMeasurements,
    load_measurements as load_measurements,
    measurements as measurements,
    presets as presets,
    save_measurements as save_measurements,
)
from .measure import (
    back_length as back_length,
    girth as girth,
    outline_at as outline_at,
    shoulder_point as shoulder_point,
    taut_girth as taut_girth,
    trunk_outline as trunk_outline,
)
from .mend import (
    agreeing as agreeing,
    mesh_edges as mesh_edges,
)
from .mesh_file import (
    MESH_FORMATS as MESH_FORMATS,
    load_body_file as load_body_file,
)
from .stance import (
    stand_straight as stand_straight,
    wearer as wearer,
)
