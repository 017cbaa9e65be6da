# SPDX-License-Identifier: MIT
"""VTK's surfaces of labels, for `make bench-surface`: reads boxes from its input, a side (int32)
and side^3 bytes each; writes for each the numbers of points and triangles (uint32), points, their
normals (float64) and triangles (uint32). The first byte written is +.

Discrete flying edges, and windowed sinc of 20 iterations with pass band 0.1."""

import struct
import sys

import numpy
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy


def mesh_of(side, voxels):
    image = vtk.vtkImageData()
    image.SetDimensions(side, side, side)
    image.GetPointData().SetScalars(numpy_to_vtk(voxels, deep=True))
    edges = vtk.vtkDiscreteFlyingEdges3D()
    edges.SetInputData(image)
    edges.SetValue(0, 1)
    smooth = vtk.vtkWindowedSincPolyDataFilter()
    smooth.SetInputConnection(edges.GetOutputPort())
    smooth.SetNumberOfIterations(20)
    smooth.SetPassBand(0.1)
    smooth.NormalizeCoordinatesOn()
    smooth.BoundarySmoothingOff()
    smooth.FeatureEdgeSmoothingOff()
    normals = vtk.vtkPolyDataNormals()
    normals.SetInputConnection(smooth.GetOutputPort())
    normals.SplittingOff()
    normals.ConsistencyOn()
    normals.AutoOrientNormalsOn()
    normals.Update()
    out = normals.GetOutput()
    points = vtk_to_numpy(out.GetPoints().GetData()).astype(numpy.float64)
    along = vtk_to_numpy(out.GetPointData().GetNormals()).astype(numpy.float64)
    triangles = vtk_to_numpy(out.GetPolys().GetData()).reshape(-1, 4)[:, 1:].astype(numpy.uint32)
    return points, along, triangles


def main():
    write = sys.stdout.buffer.write
    write(b"+")
    sys.stdout.buffer.flush()
    while True:
        head = sys.stdin.buffer.read(4)
        if len(head) < 4:
            return
        side = struct.unpack("=i", head)[0]
        voxels = numpy.frombuffer(sys.stdin.buffer.read(side**3), numpy.uint8)
        points, along, triangles = mesh_of(side, voxels)
        write(struct.pack("=II", len(points), len(triangles)))
        write(points.tobytes() + along.tobytes() + triangles.tobytes())
        sys.stdout.buffer.flush()


main()
