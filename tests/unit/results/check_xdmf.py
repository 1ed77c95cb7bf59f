"""Reads an XDMF time series as another program would: check_xdmf.py FILE STEPS.

Fails unless there are STEPS time steps in ascending time, and every array that the file refers to exists in the
HDF5 file with the stated dimensions and number type, and triangles point to existing points.
"""
import os
import sys
import xml.etree.ElementTree as ElementTree

import h5py
import numpy

TYPES = {("Float", "8"): "float64", ("Float", "4"): "float32", ("UInt", "4"): "uint32", ("Int", "4"): "int32"}


def array_of(item, folder):
    name, path = item.text.split(":", 1)
    with h5py.File(os.path.join(folder, name), "r") as file:
        values = file[path][()]
    stated = tuple(int(n) for n in item.get("Dimensions").split())
    assert values.shape == stated, f"{path}: {values.shape} in the file, {stated} stated"
    kind = TYPES[item.get("NumberType"), item.get("Precision")]
    assert values.dtype == kind, f"{path}: {values.dtype} in the file, {kind} stated"
    assert numpy.isfinite(values).all(), f"{path}: not finite"
    return values


def check_grid(grid, folder):
    points = array_of(grid.find("Geometry/DataItem"), folder)
    topology = grid.find("Topology")
    cells = int(topology.get("NumberOfElements"))
    corners = array_of(topology.find("DataItem"), folder)
    assert len(corners) == cells and (corners < len(points)).all(), "a cell points to no vertex"
    for attribute in grid.findall("Attribute"):
        values = array_of(attribute.find("DataItem"), folder)
        expected = len(points) if attribute.get("Center") == "Node" else cells
        assert len(values) == expected, f"{attribute.get('Name')}: {len(values)} values for {expected}"


def main():
    file, steps = sys.argv[1], int(sys.argv[2])
    series = ElementTree.parse(file).getroot().find("Domain/Grid")
    assert series.get("CollectionType") == "Temporal"
    times = []
    for step in series.findall("Grid"):
        times.append(float(step.find("Time").get("Value")))
        for grid in step.findall("Grid") or [step]:
            check_grid(grid, os.path.dirname(file))
    assert len(times) == steps, f"{len(times)} time steps, {steps} expected"
    assert all(a < b for a, b in zip(times, times[1:])), f"times {times}"


main()
