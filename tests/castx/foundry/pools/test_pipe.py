"""Pipes of plates and cylinders that freeze from their sides, and what belongs to which feeder."""

from __future__ import annotations

from mpi4py import MPI

import numpy as np
import pytest

from castx.case.geometry import Geometry
from castx.domain.mesh import build_mesh
from castx.foundry.pools.pipe import BodyPipe, PipedMetal
from tests.castx.fakes import cylinder_mesh
from tests.partitions import PARTITION, along_x

BETA = 0.065
RADIUS, HEIGHT = 0.02, 0.04
STEPS = 80


def metal(limit=1.0, feeders=("top",), beta=BETA, up=(0.0, 1.0)):
    return PipedMetal(beta, limit, up, feeders)


def on_top(body, share=1.0):
    """Return the nodes of the top, those of its inner part alone if a share is given."""
    points = body.points
    return (points[:, 1] > HEIGHT - 1e-9) & (points[:, 0] <= share * RADIUS + 1e-9)


def plate_mesh(comm, size):
    sizes = {"length": RADIUS, "width": HEIGHT, "size": size}
    description = {"model": "plane-strain", "generator": "slab", "cells": "quadrilaterals", **sizes}
    return build_mesh(Geometry.model_validate(description), ["casting"], comm)


def front(x, left, size):
    """Return the solid fraction of nodes whose cells a front at `left` cuts."""
    return np.clip((x - left) / size + 0.5, 0.0, 1.0)


def freeze(mesh, metal, size, lefts):
    """Return the pipe of a body whose front goes through places from the side to the middle."""
    body = mesh.bodies["casting"]
    pipe = BodyPipe(body, mesh.model, metal)
    levels = []
    for left in lefts:
        pipe.update(front(body.points[:, 0], left, size), {"top": on_top(body)})
        levels.append(pipe.levels["top"] / HEIGHT)
    return pipe, np.array(levels)


LEFTS = RADIUS * np.concatenate([[1.5], np.linspace(1.0, 0.5, 41), np.linspace(0.5, 0.1)])


def test_the_level_of_a_plate_is_exact_on_any_mesh(comm):
    """h/h0 = (w/a)^β at half and a tenth of the width."""
    for size in (4e-3, 2e-3):
        _, levels = freeze(plate_mesh(comm, size), metal(), size, LEFTS)
        assert levels[[41, -1]] == pytest.approx((0.955945, 0.860994), abs=1e-6)
        assert (np.diff(levels) <= 0.0).all()


def test_the_level_of_a_cylinder_converges(comm):
    """(r/R)^(2β) at half and a tenth of the radius, inside of one element."""
    errors = []
    for size in (2e-3, 1e-3):
        mesh = cylinder_mesh(comm, size=size, cells="quadrilaterals")
        _, levels = freeze(mesh, metal(), size, LEFTS)
        errors.append(np.abs(levels[[41, -1]] - (0.913831, 0.741310)).max() * HEIGHT)
        assert errors[-1] < 0.5 * size
    assert errors[1] < errors[0] / 1.6


@pytest.mark.parametrize("model", ["plate", "axisymmetric", "3d"])
def test_the_volume_of_the_pipe_is_exact_on_any_mesh(comm, model):
    """β/(1 + β) = 6.103286 % of the casting, whatever freezes first."""
    for size in (4e-3, 2.5e-3):
        if model == "plate":
            mesh = plate_mesh(comm, size)
        elif model == "3d":
            mesh = cylinder_mesh(comm, model, size=1.6 * size)
        else:
            mesh = cylinder_mesh(comm, model, size=size)
        body = mesh.bodies["casting"]
        up = (0.0, 0.0, 1.0) if model == "3d" else (0.0, 1.0)
        pipe = BodyPipe(body, mesh.model, metal(up=up))
        high = body.points @ np.array(up) > HEIGHT - 1e-9
        for time in np.linspace(0.0, 1.0, 12):
            pipe.update(np.clip(1.5 * time - 10 * body.points[:, 0], 0.0, 1.0), {"top": high})
        volume = comm.allreduce(pipe._volumes.sum())
        assert pipe.volume() / volume == pytest.approx(0.06103286, abs=2e-8)
        assert pipe.unfed == pytest.approx(0.0, abs=1e-12 * volume)


def test_what_is_empty_lies_on_top(comm):
    mesh = cylinder_mesh(comm, size=2e-3)
    pipe, _ = freeze(mesh, metal(), 2e-3, RADIUS * np.linspace(1.5, 0.3, STEPS))
    body = mesh.bodies["casting"]
    column = np.abs(body.points[:, 0]) < 1e-9  # liquid to the end
    order = np.argsort(body.points[column, 1])
    assert (np.diff(pipe.emptied[column][order]) >= -1e-12).all()
    assert comm.allreduce(pipe.emptied.max(initial=0.0), MPI.MAX) == pytest.approx(1.0)
    assert pipe.emptied.min(initial=0.0) >= 0.0


def test_what_freezes_above_the_limit_lacks(comm):
    """With the limit 0.4 only that share is fed of metal that freezes alike everywhere."""
    mesh = cylinder_mesh(comm)
    body = mesh.bodies["casting"]
    volumes = {}
    for limit in (0.4, 0.8):
        pipe = BodyPipe(body, mesh.model, metal(limit))
        for fraction in np.linspace(0.0, 1.0, 11):
            pipe.update(np.full(len(body.points), fraction), {"top": on_top(body)})
        volumes[limit] = pipe.volume()
        whole = comm.allreduce(pipe._volumes.sum())
        # Of the height h, h = (1 - f)^β is left when the limit is reached, and the rest lacks.
        left = (1.0 - limit) ** BETA
        assert pipe.unfed == pytest.approx(BETA * whole * left * (1.0 - limit), rel=1e-9)
        frozen = pipe.volume() / BETA
        assert frozen == pytest.approx(whole * (1.0 - left * (1.0 - limit)) - pipe.volume())
    assert volumes[0.8] > 1.5 * volumes[0.4]


@pytest.mark.ranks
def test_under_a_skin_nothing_sinks(comm):
    mesh = cylinder_mesh(comm)
    body = mesh.bodies["casting"]
    pipe = BodyPipe(body, mesh.model, metal(0.7))
    for time in np.linspace(0.0, 1.0, 6):
        skin = on_top(body)
        pipe.update(np.where(skin, 1.0, 0.9 * time), {"top": on_top(body)})
    assert pipe.volume() == 0.0 and pipe.levels["top"] == HEIGHT
    liquid = comm.allreduce(pipe._volumes[~on_top(body)[: len(pipe._volumes)]].sum())
    assert pipe.unfed == pytest.approx(BETA * 0.9 * liquid, rel=1e-9)


@pytest.mark.ranks
def test_what_freezes_on_one_rank_sinks_on_all(comm, monkeypatch):
    """The outermost nodes freeze, β of their volume lacks, and the pool is one."""
    monkeypatch.setattr(PARTITION, along_x)
    mesh = cylinder_mesh(comm, size=2e-3)
    body = mesh.bodies["casting"]
    pipe, outside = BodyPipe(body, mesh.model, metal()), body.points[:, 0] > RADIUS - 1e-9
    for fraction in (0.0, 0.5):
        pipe.update(np.where(outside, fraction, 0.0), {"top": on_top(body)})
    freezing = 0.5 * comm.allreduce(pipe._volumes[outside[: len(pipe._volumes)]].sum())
    assert pipe.volume() == pytest.approx(BETA * freezing, rel=0.1)


def test_a_cavity_stays_open_when_its_rim_has_frozen(comm):
    """What is below the pipe is fed though no liquid touches the surface any more."""
    mesh = cylinder_mesh(comm, size=2e-3)
    body = mesh.bodies["casting"]
    r, z = body.points.T
    pipe = BodyPipe(body, mesh.model, metal(0.9))
    for level in np.linspace(0.0, 0.8, 5):
        pipe.update(np.where(r < 0.01, level, np.minimum(1.0, 2 * level)), {"top": on_top(body)})
    before = pipe.volume()
    assert before > 0.0
    for level in (0.82, 0.85, 0.88):
        pipe.update(np.where((r < 0.01) & (z < 0.036), level, 1.0), {"top": on_top(body)})
    assert pipe.volume() > before


def test_two_feeders_of_different_heights_sink_to_one_level(comm):
    """The higher one empties first; both are at one height from then on."""
    mesh = plate_mesh(comm, 1e-3)
    body = mesh.bodies["casting"]
    x, z = body.points.T
    solid = (x > 0.005) & (x < 0.015) & (z > 0.01) | (x > 0.005) & (z > 0.037)
    surfaces = {"left": (x < 0.006) & (z > HEIGHT - 1e-9), "right": (x > 0.014) & (
        np.abs(z - 0.037) < 1e-9)}  # fmt: skip
    pipe = BodyPipe(body, mesh.model, metal(0.99, ("left", "right")))
    seen = []
    for fraction in np.linspace(0.0, 0.98, 40):
        pipe.update(np.where(solid, 1.0, fraction), surfaces)
        seen.append((pipe.levels["left"], pipe.levels["right"]))
    left, right = np.array(seen).T
    assert left[0] == HEIGHT and right[0] == pytest.approx(0.037)
    alone = left > 0.038
    np.testing.assert_array_equal(right[alone], right[0])
    np.testing.assert_allclose(left[left < 0.036], right[left < 0.036])
    assert left[-1] < 0.034


def test_the_level_below_one_name_is_that_of_the_highest_pool(comm):
    """Two risers apart, the higher one freezes first: no height is of neither."""
    mesh = plate_mesh(comm, 1e-3)
    body = mesh.bodies["casting"]
    x, z = body.points.T
    tops = {"left": (x < 0.0055) & (z > HEIGHT - 1e-9), "right": (x > 0.0145) & (
        np.abs(z - 0.03) < 1e-9)}  # fmt: skip
    never = (x > 0.0055) & (x < 0.0145) | (x > 0.0055) & (z > 0.0301)
    apart, together = (
        BodyPipe(body, mesh.model, metal(0.6, names)) for names in (("left", "right"), ("free",))
    )
    either = {"free": tops["left"] | tops["right"]}
    seen = []
    first = [(0.1 * k, 0.02 * k) for k in range(6)]
    for left, right in first + [(1.0, 0.15 + 0.05 * k) for k in range(9)]:
        fraction = np.where(never, 1.0, np.where(x < 0.006, left, right))
        apart.update(fraction, tops)
        together.update(fraction, either)
        seen.append((apart.levels["left"], apart.levels["right"], together.levels["free"]))
    high, low, one = np.array(seen).T
    assert high[0] == one[0] == HEIGHT and low[0] == pytest.approx(0.03)
    np.testing.assert_allclose(one[:6], high[:6], rtol=1e-12)
    np.testing.assert_allclose(one[7:], low[7:], rtol=1e-12)
    assert low[-1] < low[7] < 0.03 < high[-1] < HEIGHT
    np.testing.assert_allclose(apart.emptied, together.emptied, atol=1e-14)


@pytest.mark.ranks
def test_remelting_lacks_nothing_twice(comm):
    mesh = cylinder_mesh(comm)
    body = mesh.bodies["casting"]
    found = []
    for path in ((0.0, 0.3, 0.5), (0.0, 0.3, 0.1, 0.3, 0.2, 0.5)):
        pipe = BodyPipe(body, mesh.model, metal(0.9))
        for fraction in path:
            pipe.update(np.full(len(body.points), fraction), {"top": on_top(body)})
        found.append(pipe.volume())
    assert found[1] == pytest.approx(found[0], rel=1e-12)


@pytest.mark.ranks
def test_the_contraction_and_the_way_up_count(comm):
    mesh = cylinder_mesh(comm)
    body = mesh.bodies["casting"]
    base = body.points[:, 1] < 1e-9
    volumes = []
    for beta, up in ((0.03, 1.0), (0.06, 1.0), (0.06, -1.0)):
        pipe = BodyPipe(body, mesh.model, metal(0.9, ("both",), beta, (0.0, up)))
        for fraction in (0.0, 0.8):
            pipe.update(np.full(len(body.points), fraction), {"both": on_top(body) | base})
        volumes.append(pipe.volume())
        emptied = pipe.emptied[base if up > 0 else on_top(body)]
        assert not emptied.any()
    assert volumes[1] > 1.9 * volumes[0] and volumes[2] == pytest.approx(volumes[1], rel=1e-2)


def test_without_feeders_all_lacks(comm):
    mesh = cylinder_mesh(comm)
    body = mesh.bodies["casting"]
    pipe = BodyPipe(body, mesh.model, metal(0.9, ()))
    for fraction in (0.0, 0.8):
        pipe.update(np.full(len(body.points), fraction), {})
    whole = comm.allreduce(pipe._volumes.sum())
    assert pipe.volume() == 0.0 and pipe.unfed == pytest.approx(BETA * 0.8 * whole)


def test_a_restored_pipe_goes_on(comm):
    mesh = cylinder_mesh(comm, size=2e-3)
    body = mesh.bodies["casting"]
    lefts = RADIUS * np.linspace(1.5, 0.3, 10)
    whole, _ = freeze(mesh, metal(), 2e-3, lefts)
    first, _ = freeze(mesh, metal(), 2e-3, lefts[:5])
    second = BodyPipe(body, mesh.model, metal())
    second.restore({name: saved.values for name, saved in first.saved().items()})
    for left in lefts[5:]:
        second.update(front(body.points[:, 0], left, 2e-3), {"top": on_top(body)})
    np.testing.assert_array_equal(second.emptied, whole.emptied)
    assert second.levels == whole.levels and second.unfed == whole.unfed


def flowing(beta=BETA):
    return PipedMetal(beta, 1.0, (0.0, 1.0), ("top",), True)


@pytest.mark.ranks
@pytest.mark.parametrize("steps", [3, 20])
def test_what_the_mechanics_supplies_sinks_like_what_freezes(comm, steps):
    """The mechanics asks β of all that freezes, where the pipe is too: it is s in the end."""
    mesh = cylinder_mesh(comm, size=2.5e-3)
    body = mesh.bodies["casting"]
    thermal, pipe = BodyPipe(body, mesh.model, metal()), BodyPipe(body, mesh.model, flowing())
    whole = comm.allreduce(pipe._volumes.sum())
    owned, fed = slice(len(pipe._volumes)), 0.0
    before = np.zeros(len(body.points))
    for time in np.linspace(0.0, 1.0, steps + 1):
        fraction = np.clip(1.5 * time - 10 * body.points[:, 0], 0.0, 1.0)
        fed += BETA * comm.allreduce(pipe._volumes @ (fraction - before)[owned])
        thermal.update(fraction, {"top": on_top(body)})
        pipe.update(fraction, {"top": on_top(body)}, {"top": fed})
        np.testing.assert_allclose(pipe.emptied, thermal.emptied, atol=1e-9)
        before = fraction
    assert fed == pytest.approx(BETA * whole)
    assert pipe.volume() == pytest.approx(BETA / (1 + BETA) * whole, rel=1e-9)
    assert pipe.unfed == pytest.approx(0.0, abs=1e-9 * whole)


@pytest.mark.ranks
def test_a_supply_without_freezing_sinks_too_and_what_comes_back_waits(comm):
    mesh = cylinder_mesh(comm, size=2.5e-3)
    body = mesh.bodies["casting"]
    pipe, top = BodyPipe(body, mesh.model, flowing()), {"top": on_top(body)}
    whole = comm.allreduce(pipe._volumes.sum())
    half = np.full(len(body.points), 0.5)
    given = [0.0, 0.01, 0.008, 0.009, 0.012]
    for supplied, lost in zip(given, [0.0, 0.01, 0.01, 0.01, 0.012], strict=True):
        pipe.update(half, top, {"top": supplied * whole})
        assert pipe.volume() == pytest.approx(lost * whole, rel=1e-9)
    assert pipe.unfed == pytest.approx(-0.012 * whole, rel=1e-9)
    pipe.update(half, top, {"top": whole})
    assert pipe.volume() == pytest.approx(0.5 * whole)  # all its melt


@pytest.mark.ranks
def test_a_restored_pipe_that_flows_goes_on(comm):
    mesh = cylinder_mesh(comm, size=2.5e-3)
    body = mesh.bodies["casting"]
    whole, second = (BodyPipe(body, mesh.model, flowing()) for _ in range(2))
    for number in range(8):
        pipes = (whole, second) if number >= 4 else (whole,)
        for pipe in pipes:
            fraction = np.full(len(body.points), 0.1 * number)
            pipe.update(fraction, {"top": on_top(body)}, {"top": 1e-7 * number})
        if number == 3:
            second.restore({name: saved.values for name, saved in whole.saved().items()})
    np.testing.assert_array_equal(second.emptied, whole.emptied)
    assert second.volume() > 0.0 and second.unfed == whole.unfed
