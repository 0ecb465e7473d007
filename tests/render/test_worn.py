"""Pictures of worn garments: laws of seeing that hold for any scene."""

import dataclasses
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

from garmentimage.body.body import load_body
from garmentimage.drape.cloth import Cloth
from garmentimage.drape.draped_garment import DrapedGarment, DrapeReport
from garmentimage.drape.mesh.normals import vertex_normals
from garmentimage.errors import OutputError, RenderError
from garmentimage.pattern.model import Edge, Loop, Panel, Pattern, Side, Stitch
from garmentimage.render.png import contact_sheet, png_bytes, save_png
from garmentimage.render.worn.background import gradient, plain
from garmentimage.render.worn.camera import ORTHOGRAPHIC_DISTANCE, VIEWS, Camera
from garmentimage.render.worn.light import FLAT, Light
from garmentimage.render.worn.look import Look, photograph
from garmentimage.render.worn.photographing import body_camera, picture
from garmentimage.render.worn.prints import Print, checks, dots, noise, picture_print, stripes
from garmentimage.render.worn.shade import NO_SURFACE
from garmentimage.render.worn.surface import (
    Surface,
    body_surface,
    panel_groups,
    surfaces_of,
)
from garmentimage.render.worn.tint import encoded, linear, rgb

CAMERA = Camera((0.0, 0.0, 0.0), 40.0)
RED, GREEN = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)


def surface(points, faces, *, colour=RED, panel=1, **fields) -> Surface:
    points, faces = np.asarray(points, float), np.asarray(faces)
    return Surface(
        name="made up",
        points=points,
        faces=faces,
        colour=np.tile(np.asarray(rgb(colour)), (len(faces), 1)),
        ids=np.full(len(faces), panel),
        normals=vertex_normals(points, faces),
        **fields,
    )


def square(z: float = 0.0, half: float = 10.0, *, middle=(0.0, 0.0), **fields) -> Surface:
    """A square that faces the front, in two triangles."""
    x, y = middle
    points = [
        (x - half, y - half, z),
        (x + half, y - half, z),
        (x + half, y + half, z),
        (x - half, y + half, z),
    ]
    return surface(points, [(0, 1, 2), (0, 2, 3)], **fields)


def sphere(radius: float, **fields) -> Surface:
    """Latitudes and longitudes, outward."""
    rows, cols = 60, 120
    up = np.linspace(-np.pi / 2, np.pi / 2, rows)[:, None]
    along = np.arange(cols)[None] * 2 * np.pi / cols
    flat = np.cos(up)
    points = radius * np.stack(
        [flat * np.sin(along), np.sin(up) + 0 * along, flat * np.cos(along)], axis=-1
    )
    i, j = np.mgrid[: rows - 1, :cols]
    a, b = i * cols + j, i * cols + (j + 1) % cols
    quads = np.stack([a, b, b + cols, a + cols], axis=-1).reshape(-1, 4)
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return surface(points.reshape(-1, 3), faces, **fields)


def mirrored(s: Surface) -> Surface:
    """The surface on the other side of x = 0, its outside outside again."""
    flip = np.array([-1.0, 1.0, 1.0])
    return replace(s, points=s.points * flip, normals=s.normals * flip, faces=s.faces[:, ::-1])


@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("distance", [None, 300.0])
def test_the_silhouette_of_a_sphere_has_the_area_of_its_outline(view, distance):
    camera = replace(CAMERA, azimuth=VIEWS[view], elevation=0.3, distance=distance)
    radius = 12.0
    # From a finite distance the outline is that of the tangent cone, at the target.
    seen = radius if distance is None else radius / np.sqrt(1 - (radius / distance) ** 2)
    views = picture([sphere(radius)], camera, size=256)
    area = views.silhouette.sum() * (camera.extent / 256) ** 2
    assert area == pytest.approx(np.pi * seen**2, rel=0.005)


def test_the_depth_of_a_plane_is_its_distance():
    for camera in (CAMERA, replace(CAMERA, distance=250.0)):
        depth = picture([square(z=7.0)], camera, size=64).depth
        assert depth[32, 32] == pytest.approx(camera.stand - 7.0, abs=1e-3)
        assert np.isinf(depth[0, 0])
        assert np.isfinite(depth[32]).sum() == pytest.approx(64 / 2, abs=2)
    assert CAMERA.stand == ORTHOGRAPHIC_DISTANCE


def test_the_depth_of_a_tilted_plane_is_true_in_perspective():
    points = [(-10.0, -10.0, 40.0), (10.0, -10.0, 40.0), (10.0, 10.0, -40.0), (-10.0, 10.0, -40.0)]
    tilted = surface(points, [(0, 1, 2), (0, 2, 3)])
    camera = replace(CAMERA, distance=100.0)
    size = 200
    depth = picture([tilted], camera, size=size).depth
    row = np.flatnonzero(np.isfinite(depth[:, size // 2]))
    # The plane is z = -4 y, seen along the ray y = rise x depth / 100 with z = 100 - depth. A pixel
    # describes the nearest of its samples, at most half a pixel off its middle.
    rise = (size / 2 - row - 0.5) * camera.extent / size / 100
    expected = 100 / (1 - 4 * rise)
    slack = 4 * expected**2 / 100 * camera.extent / size / 100 * 50
    assert (np.abs(depth[row, size // 2] - expected) < np.maximum(0.1, slack / 100)).all()


def test_a_nearer_surface_hides_a_further_one_whatever_their_order():
    far, near = square(z=0.0, panel=1), square(z=5.0, half=5.0, colour=GREEN, panel=2)
    one, other = (picture(s, CAMERA, size=64) for s in ([far, near], [near, far]))
    assert (one.panel[24:40, 24:40] == 2).all()
    assert one.panel[20, 20] == 1
    assert (one.colour == other.colour).all() and (one.panel == other.panel).all()


def test_panels_agree_with_colours():
    left = square(half=4.0, middle=(-6.0, 0.0), colour=RED, panel=1)
    right = square(half=4.0, middle=(6.0, 0.0), colour=GREEN, panel=2)
    views = picture([left, right], CAMERA, size=128, background=plain("black"))
    whole = np.isin(views.silhouette, (0.0, 1.0))
    red, green, _ = np.moveaxis(views.colour.astype(int), -1, 0)
    assert (views.panel[whole & (red > green)] == 1).all()
    assert (views.panel[whole & (green > red)] == 2).all()
    assert (views.panel[whole & (red == green)] == NO_SURFACE).all()


def test_row_0_is_the_top_and_column_0_the_left():
    spot = square(half=2.0, middle=(15.0, 10.0))
    rows, cols = np.nonzero(picture([spot], CAMERA, size=80).panel == 1)
    assert rows.mean() == pytest.approx(80 * (20 - 10) / 40 - 0.5, abs=0.5)
    assert cols.mean() == pytest.approx(80 * (20 + 15) / 40 - 0.5, abs=0.5)


def test_side_shows_the_wearers_left():
    left = square(half=3.0)
    turned = replace(left, points=left.points[:, [2, 1, 0]] * [1, 1, -1] + [8.0, 0, 0])
    turned = replace(turned, normals=vertex_normals(turned.points, turned.faces), two_sided=False)
    assert (picture([turned], replace(CAMERA, azimuth=VIEWS["side"]), size=32).panel == 1).any()
    assert not (
        picture([turned], replace(CAMERA, azimuth=-VIEWS["side"]), size=32).panel == 1
    ).any()


def test_the_inside_of_cloth_is_seen_and_darker():
    front = picture([square()], CAMERA, size=32)
    back = picture([square()], replace(CAMERA, azimuth=np.pi), size=32)
    assert back.panel[16, 16] == 1
    assert 20 < back.colour[16, 16, 0] < front.colour[16, 16, 0] - 20
    assert back.normal[16, 16] == pytest.approx((0, 0, 1), abs=1e-6)
    one_sided = picture([square(two_sided=False)], replace(CAMERA, azimuth=np.pi), size=32)
    assert (one_sided.panel == NO_SURFACE).all()


def test_normals_of_a_sphere_point_away_from_its_middle():
    size, radius = 128, 15.0
    normal = picture([sphere(radius)], CAMERA, size=size).normal
    place = (np.arange(size) + 0.5 - size / 2) * CAMERA.extent / size
    x, y = np.meshgrid(place / radius, -place / radius)
    inner = np.hypot(x, y) < 0.9
    expected = np.stack([x, y, np.sqrt(np.maximum(0, 1 - x * x - y * y))], axis=-1)
    assert np.abs(normal - expected)[inner].max() < 0.05


def test_a_mirrored_scene_gives_the_mirrored_picture():
    light = Light(azimuth=0.0)
    scene = [sphere(9.0), square(z=-3.0, middle=(6.0, 5.0), colour=GREEN, panel=2)]
    one = picture(scene, CAMERA, size=96, light=light)
    other = picture([mirrored(s) for s in scene], CAMERA, size=96, light=light)
    assert (one.panel == other.panel[:, ::-1]).mean() > 0.999
    assert np.abs(one.silhouette - other.silhouette[:, ::-1]).max() == 0
    gap = np.abs(one.colour.astype(int) - other.colour[:, ::-1])
    assert gap.mean() < 0.05 and (gap > 8).mean() < 0.002


def test_neighbouring_triangles_leave_no_gap():
    rng = np.random.default_rng(0)
    n = 30
    x, y = np.meshgrid(np.linspace(-35, 35, n), np.linspace(-35, 35, n))
    points = np.stack([x, y, 0 * x], axis=-1) + np.pad(
        rng.uniform(-0.5, 0.5, (n, n, 2)), ((0, 0), (0, 0), (0, 1))
    )
    i, j = np.mgrid[: n - 1, : n - 1]
    a = (i * n + j).ravel()
    faces = np.concatenate([np.stack([a, a + 1, a + n], 1), np.stack([a + 1, a + n + 1, a + n], 1)])
    for turn in (0.0, 0.3):
        views = picture(
            [surface(points.reshape(-1, 3), faces)], replace(CAMERA, roll=turn), size=64
        )
        assert (views.silhouette == 1).all()


def test_the_same_scene_gives_the_same_bits():
    scene = [body_surface(load_body()), sphere(12.0)]
    camera = body_camera(load_body(), "turned")
    first, second = (picture(scene, camera, size=96, seams=True) for _ in range(2))
    picture(scene[1:], CAMERA, size=48)
    third = picture(scene, camera, size=96, seams=True)
    for name in (f.name for f in dataclasses.fields(first)):
        one, two, three = (getattr(v, name) for v in (first, second, third))
        assert one.tobytes() == two.tobytes() == three.tobytes()


def test_a_kept_body_does_not_show_in_a_picture_without_it():
    camera = body_camera(load_body())
    picture([body_surface(load_body())], camera, size=64)
    empty = picture([], camera, size=64)
    assert (empty.panel == NO_SURFACE).all() and (empty.colour == 255).all()


@pytest.mark.parametrize("size", [16, 64, 100, 257, 512])
def test_a_picture_has_the_chosen_size(size):
    views = picture([square()], CAMERA, size=size)
    assert views.colour.shape == (size, size, 3) and views.colour.dtype == np.uint8
    assert views.depth.shape == views.panel.shape == views.silhouette.shape == (size, size)
    assert views.silhouette.mean() == pytest.approx(0.25, rel=0.06)


def test_the_body_fits_into_every_view():
    body = load_body()
    extents = set()
    for view in VIEWS:
        camera = body_camera(body, view)
        extents.add(camera.extent)
        seen = picture([body_surface(body)], camera, size=64).panel == 0
        assert seen.any() and not (seen[[0, -1]].any() or seen[:, [0, -1]].any())
    assert len(extents) == 1


def test_no_skin_shows_through_cloth_on_it():
    """Cloth on the trunk, its vertices up to 0.1 cm under the skin and 0.3 cm above it."""
    body = load_body()
    normals = vertex_normals(body.vertices, body.faces)
    middles = body.vertices[body.faces].mean(axis=1)
    worn = body.faces[(middles[:, 1] > 85) & (middles[:, 1] < 125) & (abs(middles[:, 0]) < 22)]
    rng = np.random.default_rng(3)
    points = body.vertices + normals * rng.uniform(-0.1, 0.3, (len(normals), 1))
    cloth = surface(points, worn, lift=0.35)
    for view in ("front", "back"):
        camera = body_camera(body, view)
        # The inside, seen through the openings, is rightly hidden by the body.
        alone = picture([replace(cloth, two_sided=False)], camera, size=256).silhouette == 1
        dressed = picture([body_surface(body), cloth], camera, size=256).silhouette
        assert (dressed[alone] == 1).all()


def test_seams_show_where_nothing_hides_them():
    across = np.array([[0, 1]])
    seamed = square(seams=across)
    plain_view, drawn = (picture([seamed], CAMERA, size=64, seams=s) for s in (False, True))
    changed = (plain_view.colour != drawn.colour).any(axis=-1)
    rows = np.nonzero(changed.any(axis=1))[0]
    assert changed.sum() > 20 and rows.min() >= 46
    hidden = picture([seamed, square(z=5.0, half=15.0)], CAMERA, size=64, seams=True)
    covered = picture([square(), square(z=5.0, half=15.0)], CAMERA, size=64)
    assert (hidden.colour == covered.colour).all()


def test_stripes_lie_on_the_cloth_in_their_width():
    cloth = square(half=16.0, colour="white")
    place = cloth.points[cloth.faces][:, :, :2]
    striped = replace(cloth, flat=place, cloth_print=stripes("black", "white", period=8.0))
    row = picture([striped], CAMERA, size=160, light=FLAT).colour[80, 17:143, 0].astype(int)
    bright = row > (row.max() + row.min()) / 2
    turns = np.flatnonzero(bright[1:] != bright[:-1])
    assert np.diff(turns) == pytest.approx(16, abs=1)  # 4 cm at 4 pixels a cm


def test_fine_prints_blend_in_small_pictures():
    cloth = square(half=16.0, colour="white")
    place = cloth.points[cloth.faces][:, :, :2]
    fine = replace(cloth, flat=place, cloth_print=checks("black", "white", period=0.1))
    grey = picture([fine], CAMERA, size=64, light=FLAT).colour[16:48, 16:48].astype(int)
    assert np.ptp(grey) <= 2 and 120 < grey.mean() < 235


def test_prints_repeat_without_a_seam():
    rng = np.random.default_rng(0)
    for tile in (dots("white", "black").tile, noise("white", "black", rng).tile):
        for way in (tile, tile.swapaxes(0, 1)):
            inner = np.abs(np.diff(way, axis=0)).mean(axis=(1, 2)).max()
            assert np.abs(way[0] - way[-1]).mean() <= 1.5 * inner + 1e-9


def test_a_nearer_body_casts_a_shadow_and_darkens_its_surroundings():
    wall, ball = square(z=-10.0, half=30.0, colour="white"), sphere(6.0)
    for light in (Light(occlusion=0.0), Light(shadow=0.0, azimuth=0.0)):
        bare, with_ball = (
            picture(s, CAMERA, size=128, light=light).colour.astype(int)
            for s in ([wall], [wall, ball])
        )
        on_wall = picture([wall, ball], CAMERA, size=128).depth > CAMERA.stand + 9
        if light.shadow:
            assert (bare - with_ball)[on_wall].max() > 20
        assert (with_ball - bare)[on_wall].max() <= 0


def test_backgrounds_fill_what_nothing_covers():
    views = picture([], CAMERA, size=33, background=gradient("black", "white"))
    levels = views.colour[:, 5, 0].astype(int)
    assert levels[0] == 0 and levels[-1] == 255 and (np.diff(levels) >= 0).all()
    assert (views.colour == views.colour[:, :1, :1]).all()
    red = picture([], CAMERA, size=16, background=plain("red"))
    assert (red.colour == (255, 0, 0)).all()


def test_encoding_undoes_linear_light():
    levels = np.arange(256)[None, :, None].repeat(3, axis=2)
    assert (encoded(linear(levels / 255)) == levels).all()


def skirt() -> DrapedGarment:
    """Two square panels, front and back, sewn down both sides, round the hips; and a top panel."""
    corners = ((-20.0, 0.0), (20.0, 0.0), (20.0, 40.0), (-20.0, 40.0))
    loop = Loop(corners, tuple(Edge(k, (k + 1) % 4) for k in range(4)))
    front, back = Panel("front", loop, label="cheerful"), Panel("back", loop)
    bib = Panel("bib", loop)
    pattern = Pattern(
        (front, back, bib),
        (
            Stitch(Side("front", 1), Side("back", 3)),
            Stitch(Side("front", 3), Side("back", 1)),
        ),
    )
    flat = np.tile(np.array(corners), (3, 1))
    vertex = np.array([0, 1, 2, 3, 1, 0, 3, 2, 4, 5, 6, 7])
    sides = {
        Side(panel.name, k): np.array([4 * p + k, 4 * p + (k + 1) % 4])
        for p, panel in enumerate(pattern.panels)
        for k in range(4)
    }
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    cloth = Cloth(
        pattern,
        flat,
        np.concatenate([faces, faces + 4, faces + 8]),
        np.repeat([0, 1, 2], 4),
        vertex,
        sides,
    )
    lower = np.array([(-20.0, 60, 18), (20, 60, 18), (20, 100, 18), (-20, 100, 18)])
    points = np.concatenate([lower, lower + np.array([0, 35, 5])])
    report = DrapeReport(True, 1, 0.0, 0.0, 0.0, {}, 0, 0.0, 1, (), 0.0)
    return DrapedGarment(cloth, points, load_body(), report)


def test_panels_are_grouped_by_where_they_hang():
    assert panel_groups(skirt()) == ("bottom", "bottom", "top")


def test_colours_and_prints_go_by_name_then_label_then_group():
    worn = skirt()
    chosen = {"front": "red", "cheerful": "blue", "bottom": "lime", "top": "black"}
    _, cloth = surfaces_of(worn, colours=chosen)
    tints = {int(k): tuple(c) for k, c in zip(cloth.ids, cloth.colour.tolist(), strict=True)}
    assert tints == {1: (1, 0, 0), 2: (0, 1, 0), 3: (0, 0, 0)}
    del chosen["front"]
    _, cloth = surfaces_of(worn, colours=chosen)
    assert tuple(cloth.colour[0]) == (0, 0, 1)
    surfaces = surfaces_of(worn, skin=None, prints={"back": stripes("red", "blue")})
    assert [s.cloth_print is not None for s in surfaces] == [False, True]
    assert (surfaces[1].ids == 2).all() and (surfaces[1].colour == 1).all()


def test_sewn_edges_are_seams_and_free_edges_hems():
    _, cloth = surfaces_of(skirt())
    assert {tuple(sorted(line)) for line in cloth.seams.tolist()} == {(1, 2), (0, 3)}
    assert len(cloth.hems) == 8 and len(cloth.points) == 8


def test_a_random_look_depends_on_its_seed_alone():
    worn = skirt()
    same, again, other = (
        photograph(worn, Look.random(np.random.default_rng(seed)), size=64).colour
        for seed in (7, 7, 8)
    )
    assert (same == again).all() and not (same == other).all()


def test_a_look_moves_the_camera():
    look = Look(azimuth=0.2, zoom=2.0, shift=(0.0, 0.1), lens_mm=50.0)
    camera = look.camera(CAMERA)
    assert camera.extent == 20 and camera.azimuth == 0.2 and camera.target[1] == 2.0
    assert camera.focal_mm == pytest.approx(50.0)
    assert Look().camera(CAMERA) == CAMERA


def test_pictures_are_written_whole_and_repeatably(tmp_path):
    colour = picture([square()], CAMERA, size=32).colour
    save_png(tmp_path / "a.png", colour)
    assert (tmp_path / "a.png").read_bytes() == png_bytes(colour)
    assert (np.asarray(Image.open(tmp_path / "a.png")) == colour).all()
    with pytest.raises(OutputError, match=r"\.png"):
        save_png(tmp_path / "a.jpg", colour)
    with pytest.raises(OutputError, match="no folder"):
        save_png(tmp_path / "none" / "a.png", colour)


def test_a_contact_sheet_holds_every_picture():
    red, green = (np.full((20, 30, 3), c, np.uint8) for c in ((255, 0, 0), (0, 255, 0)))
    sheet = contact_sheet([red, green, red], ["a", "b", "c\n"], columns=2)
    assert (sheet == (255, 0, 0)).all(axis=-1).sum() == 2 * 600
    assert (sheet == (0, 255, 0)).all(axis=-1).sum() == 600
    for bad in ({"columns": 0}, {"labels": ["a"]}):
        with pytest.raises(RenderError, match="sheet"):
            contact_sheet([red, green], **bad)


def test_a_picture_of_ones_own_becomes_a_print(tmp_path):
    save_png(tmp_path / "a.png", np.full((10, 20, 3), 128, np.uint8))
    own = picture_print(tmp_path / "a.png", width=8.0)
    assert own.height == 4.0 and own.tile.shape == (10, 20, 3)
    (tmp_path / "text.png").write_text("no picture")
    for name in ("text.png", "missing.png", "."):
        with pytest.raises(RenderError, match="picture"):
            picture_print(tmp_path / name, width=8.0)


@pytest.mark.parametrize(
    "make",
    [
        lambda: picture([], CAMERA, size=8),
        lambda: picture([], CAMERA, size=4096),
        lambda: picture([sphere(30.0)], replace(CAMERA, distance=20.0)),
        lambda: Camera(extent=0.0),
        lambda: Camera(azimuth=np.nan),
        lambda: Camera(distance=1.0),
        lambda: body_camera(load_body(), "top"),
        lambda: Light(key=-1.0),
        lambda: Light(shadow=2.0),
        lambda: Look(zoom=0.0),
        lambda: rgb("bluish"),
        lambda: rgb((0.0, 2.0, 0.0)),
        lambda: Print(np.zeros((2, 2, 3)), 0.0, 1.0),
        lambda: square(z=np.nan),
    ],
)
def test_bad_arguments_are_refused_in_one_sentence(make):
    with pytest.raises(RenderError) as caught:
        make()
    assert "\n" not in str(caught.value) and len(str(caught.value)) > 10
