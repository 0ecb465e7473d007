"""The same garment draped by newton (PyPI `newton`, Apache-2.0), on the CPU.

Both ways start from our triangles, our places and our body, and run for as many frames as ours:

- "style3d" is newton's solver for garments. Its sewing helper makes springs between vertices that
  are close already, and the solver leaves springs out of account (newton 1.8), so seams are sewn
  vertices as in ours.
- "vbd" takes the panels apart and sews them with springs of no length.

Cloth does not meet cloth in either, as it does not in ours. Steps and iterations are those of
newton's own examples of garments and of hanging cloth.
"""

from dataclasses import dataclass
from time import process_time
from typing import Any

import newton
import numpy as np
import warp as wp

from garmentimage.body.body import Body, load_body
from garmentimage.body.stance import stand_straight
from garmentimage.drape.cloth import Cloth
from garmentimage.drape.fabric import Fabric
from garmentimage.drape.mesh.meshing import mesh
from garmentimage.drape.mesh.rest import rest_of, strain
from garmentimage.drape.solver.distance_field import body_field
from garmentimage.drape.solver.solver import SolverSettings
from garmentimage.drape.start.placement import place_on_body
from garmentimage.drape.start.starting import start_points
from garmentimage.pattern.model import Pattern

CM = 0.01
"""[m]"""
DYN_PER_CM = 1e-3
"""[N/m]"""
DYN_CM = 1e-7
"""[N m]"""
G_PER_CM2 = 10.0
"""[kg/m2]"""
FRAME = 1 / 60
"""[s]"""
SUBSTEPS = 10
ITERATIONS = {"style3d": 4, "vbd": 10}
POISSON = 1 / 3
CONTACT_STIFFNESS, CONTACT_DAMPING = 100.0, 1e-5
"""Of a vertex against the body [N/m, N s/m]."""
CONTACT_REACH = 0.15
"""How deep under the skin a vertex is still pushed out [m]."""
SEAM_STIFFNESS = 1e3
"""Of the springs that sew panels together [N/m]."""


@dataclass(frozen=True)
class Outcome:
    """How a drape by newton went."""

    seconds: float
    """CPU time of building the model and of all frames, compiled before [s]."""
    compiling: float
    """CPU time of the same with two frames, kernels compiled or loaded [s]."""
    seam_gap: float
    """Greatest distance between corners that are sewn together [cm]."""
    penetration: float
    """Depth of the deepest vertex under the skin [cm]."""
    strain: float
    """99th percentile of the triangles' greatest stretch."""
    speed: float
    """Mean speed of the vertices at the end [cm/s]."""
    points: np.ndarray
    """Vertices [cm]; the mean of the corners that are sewn together."""


def newton_drape(
    pattern: Pattern, body_name: str, fabric: Fabric, *, vertices: int, frames: int, solver: str
) -> Outcome:
    """Drape a garment that hangs from the shoulders with one of newton's solvers."""
    wp.config.log_level = wp.LOG_ERROR
    body = stand_straight(load_body(body_name))
    cloth = mesh(place_on_body(pattern, body)[0], vertices=vertices)
    with wp.ScopedDevice("cpu"):
        began = process_time()
        _run(cloth, body, fabric, 2, solver)
        compiled = process_time()
        corners, speed = _run(cloth, body, fabric, frames, solver)
        ended = process_time()
    points = cloth.sewn(corners)
    gap = 2 * np.linalg.norm(corners - points[cloth.vertex], axis=1).max()
    return Outcome(
        seconds=ended - compiled,
        compiling=compiled - began,
        seam_gap=float(gap),
        penetration=max(0.0, -float(body_field(body).at(points).min())),
        strain=float(np.percentile(strain(rest_of(cloth), points), 99)),
        speed=speed,
        points=points,
    )


def _run(
    cloth: Cloth, body: Body, fabric: Fabric, frames: int, solver_name: str
) -> tuple[np.ndarray, float]:
    """Places of the corners [cm] and mean speed of the vertices [cm/s] after some frames."""
    sewn = solver_name == "style3d"
    builder = newton.ModelBuilder(up_axis=newton.Axis.Y)
    if sewn:
        _add_sewn(builder, cloth, start_points(cloth, body), fabric)
    else:
        _add_panels(builder, cloth, fabric)
    skin = newton.Mesh((body.vertices * CM).astype(np.float32), body.faces.ravel().astype(np.int32))
    builder.add_shape_mesh(-1, mesh=skin, cfg=newton.ModelBuilder.ShapeConfig(mu=fabric.friction))
    model = builder.finalize()
    model.soft_contact_ke, model.soft_contact_kd = CONTACT_STIFFNESS, CONTACT_DAMPING
    model.soft_contact_mu = fabric.friction
    if sewn:
        config = newton.solvers.SolverStyle3D.Config(iterations=ITERATIONS[solver_name])
        solver = newton.solvers.SolverStyle3D(model, config=config)
        contact = solver.collision
        contact.stiff_vf = contact.stiff_ee = contact.stiff_ef = 0.0
    else:
        solver = newton.solvers.SolverVBD(model, iterations=ITERATIONS[solver_name])
    points, speeds = _simulate(model, solver, fabric, frames)
    return (points[cloth.vertex] if sewn else points), speeds


def _simulate(model: Any, solver: Any, fabric: Fabric, frames: int) -> tuple[np.ndarray, float]:
    """As our solver does: first no gravity and much damping, then gravity and little."""
    settings = SolverSettings()
    state, following, control = model.state(), model.state(), model.control()
    # Cloth that begins under the skin is only found within this distance.
    pipeline = newton.CollisionPipeline(model, soft_contact_gap=CONTACT_REACH)
    contacts = pipeline.contacts()
    for frame in range(frames):
        gathering = frame < settings.gather_frames
        model.set_gravity((0.0, 0.0 if gathering else -9.81, 0.0))
        keep = np.exp(-(settings.gather_damping if gathering else fabric.damping) * FRAME)
        pipeline.collide(state, contacts)
        for _ in range(SUBSTEPS):
            state.clear_forces()
            solver.step(state, following, control, contacts, FRAME / SUBSTEPS)
            state, following = following, state
        state.particle_qd.assign(state.particle_qd.numpy() * np.float32(keep))
    speed = np.linalg.norm(state.particle_qd.numpy(), axis=1).mean() / CM
    return state.particle_q.numpy().astype(float) / CM, float(speed)


def _add_sewn(builder: Any, cloth: Cloth, start: np.ndarray, fabric: Fabric) -> None:
    """Sewn vertices, at rest in the flat panels."""
    newton.solvers.SolverStyle3D.register_custom_attributes(builder)
    stretch = fabric.stretch * DYN_PER_CM
    shear = stretch / (2 * (1 + POISSON))
    newton.solvers.style3d.add_cloth_mesh(
        builder,
        **_still(),
        vertices=(start * CM).tolist(),
        indices=cloth.vertex_faces.ravel().tolist(),
        panel_verts=(_turning_left(cloth) * CM).tolist(),
        panel_indices=cloth.faces.ravel().tolist(),
        density=fabric.weight * G_PER_CM2,
        tri_aniso_ke=wp.vec3(stretch, stretch, shear),
        edge_aniso_ke=wp.vec3(*3 * [fabric.bend * DYN_CM]),
        particle_radius=fabric.thickness * CM,
    )


def _add_panels(builder: Any, cloth: Cloth, fabric: Fabric) -> None:
    """Panels apart, at rest where they start, and springs along the seams."""
    places = np.empty((len(cloth.flat), 3))
    for k, panel in enumerate(cloth.pattern.panels):
        own = cloth.panel == k
        places[own] = panel.to_world(cloth.flat[own])
    stretch = fabric.stretch * DYN_PER_CM
    builder.add_cloth_mesh(
        **_still(),
        scale=1.0,
        vertices=(places * CM).tolist(),
        indices=cloth.faces.ravel().tolist(),
        density=fabric.weight * G_PER_CM2,
        tri_ke=stretch / (2 * (1 + POISSON)),
        tri_ka=stretch * POISSON / (1 - POISSON**2),
        tri_kd=0.0,
        edge_ke=fabric.bend * DYN_CM,
        edge_kd=0.0,
        particle_radius=fabric.thickness * CM,
    )
    order = np.argsort(cloth.vertex, kind="stable")
    for a, b in zip(order[:-1].tolist(), order[1:].tolist(), strict=True):
        if cloth.vertex[a] == cloth.vertex[b]:
            builder.add_spring(a, b, SEAM_STIFFNESS, 0.0, 0.0)
            builder.spring_rest_length[-1] = 0.0
    builder.color(include_bending=True)


def _still() -> dict[str, Any]:
    return {"pos": wp.vec3(0.0), "rot": wp.quat_identity(), "vel": wp.vec3(0.0)}


def _turning_left(cloth: Cloth) -> np.ndarray:
    """The flat corners; panels whose triangles turn right are turned over [cm]."""
    a, b, c = (cloth.flat[cloth.faces[:, k]] for k in range(3))
    turn = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    sign = np.ones(len(cloth.pattern.panels))
    sign[cloth.face_panel[turn < 0]] = -1.0
    return cloth.flat * np.stack([sign[cloth.panel], np.ones(len(cloth.flat))], axis=1)
